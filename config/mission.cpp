// SPDX-License-Identifier: BSD-3-Clause
#include "config/mission.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

#include "config/map_reader.hpp"
#include "config/solids.hpp"
#include "config/vehicle_reader.hpp"

namespace jink::config {
namespace {

constexpr std::size_t kMostWaypoints = 10000;

bool is_integer_in(std::string_view text, const Range& range) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.empty() || !std::all_of(text.begin(), text.end(), digit)) return false;
  return range.contains(static_cast<double>(*parse_integer(text)));
}

void check_network_address(const Value& value, std::string_view address, bool needs_host) {
  const Range ports = closed(1, 65535);
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos || !is_integer_in(address.substr(colon + 1), ports)) {
    value.fail("has no valid port; expected " + std::string(needs_host ? "HOST" : "[HOST]") + ":PORT, the port in " +
               ports.text());
  }
  if (needs_host && colon == 0) value.fail("has no host; expected HOST:PORT");
}

void check_serial_address(const Value& value, std::string_view address) {
  const Range bauds = closed(1, 20'000'000);
  const std::size_t colon = address.rfind(':');
  if (address.size() < 2 || address.front() != '/' || colon == 1) {
    value.fail("has no device; expected /DEVICE[:BAUD]");
  }
  if (colon != std::string_view::npos && !is_integer_in(address.substr(colon + 1), bauds)) {
    value.fail("has no valid baud rate; expected /DEVICE[:BAUD], the baud rate in " + bauds.text());
  }
}

/// MAVSDK finds a bad URL only when it connects, and then says little; here it is found with file and line.
std::string read_connection(const Value& value) {
  static constexpr std::array<std::string_view, 8> kSchemes = {"udp",   "udpin",  "udpout", "tcp",
                                                               "tcpin", "tcpout", "serial", "serial_flowcontrol"};
  std::string url = value.text();
  const std::size_t end = url.find("://");
  const std::string_view scheme = std::string_view(url).substr(0, end == std::string::npos ? 0 : end);
  if (std::find(kSchemes.begin(), kSchemes.end(), scheme) == kSchemes.end()) {
    const std::string_view near = nearest(scheme, kSchemes);
    value.fail("is not a MAVSDK URL; expected SCHEME://ADDRESS with a scheme of " + join(kSchemes) +
               (near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"));
  }
  const std::string_view address = std::string_view(url).substr(end + 3);
  if (url.find(' ') != std::string::npos) value.fail("holds a space; expected a MAVSDK URL");
  if (scheme.starts_with("serial")) {
    check_serial_address(value, address);
  } else {
    check_network_address(value, address, scheme == "udpout" || scheme == "tcp" || scheme == "tcpout");
  }
  return url;
}

// A waypoint counts at the height at which it is flown, see load_mission.
Vec3 read_waypoint(const Value& value, const Mission& mission) {
  Vec3 point = value.vec3(kCoordinate);
  Vec3 flown = point;
  if (mission.heights == Heights::kGround) flown.z() = std::max(point.z(), mission.min_height);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Range range = closed(mission.geofence.min[axis], mission.geofence.max[axis]);
    if (range.contains(flown[axis])) continue;
    const bool raised = flown[axis] != point[axis];
    value.list(3, 3)[i].fail((raised ? "raised to min_height, " + number_text(flown[axis]) + "," : std::string()) +
                             (raised ? " " : "") + "is outside the geofence; not in " + range.text());
  }
  return point;
}

void read_heights(const Map& map, Mission& mission) {
  mission.takeoff_height = map.number_or("takeoff_height", above(0, 100), mission.takeoff_height);
  mission.min_height = map.number_or("min_height", closed(0, 1000), mission.min_height);
  if (const auto heights = map.find("heights")) {
    static constexpr std::array<std::string_view, 3> kNames = {"ground", "origin", "amsl"};
    mission.heights = static_cast<Heights>(heights->choice(kNames));
  }
  if (mission.heights != Heights::kGround) return;
  const double ceiling = mission.geofence.max.z();
  if (mission.min_height >= ceiling) {
    map.at("min_height", "").fail("is not below the geofence's top; not in " + below(0, ceiling).text());
  }
  if (mission.takeoff_height > ceiling) {
    map.at("takeoff_height", "").fail("is above the geofence's top; not in " + above(0, ceiling).text());
  }
}

TrackSources read_sources(const Value& value) {
  static constexpr std::array<std::string_view, 4> kNames = {"jink", "autoware", "vision", "adsb"};
  std::array<bool, kNames.size()> named{};
  for (const Value& name : value.list(1, kNames.size())) named[name.choice(kNames)] = true;
  return {named[0], named[1], named[2], named[3]};
}

std::uint32_t read_icao_address(const Value& value) {
  const std::string text = value.text();
  std::uint32_t address = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), address, 16);
  if (text.size() != 6 || read.ptr != text.data() + text.size() || read.ec != std::errc())
    value.fail("is no ICAO address; expected six hexadecimal digits");
  return address;
}

Transport read_transport(const Value& value) {
  static constexpr std::array<std::string_view, 2> kNames = {"mavlink", "dds"};
  return value.choice(kNames) == 0 ? Transport::kMavlink : Transport::kDds;
}

std::string read_namespace(const Value& value) {
  std::string text = value.text();
  if (!is_namespace(text)) value.fail("is not a namespace; expected names of letters, digits and _, parted by /");
  return text;
}

constexpr std::array<std::string_view, kTrackTopics.size()> kTopicNames = {"jink", "autoware", "vision"};

// By topic, the names of DDS participants. Without `sources` of its own the mission reads the topics that have some.
void read_writers(const Value& value, bool sources_given, TrackPolicy& tracks) {
  constexpr std::size_t kMostWriters = 100;
  const Map map(value, {kTopicNames.begin(), kTopicNames.end()});
  const std::array<bool*, kTopicNames.size()> sources = {&tracks.sources.jink, &tracks.sources.autoware,
                                                         &tracks.sources.vision};
  for (std::size_t i = 0; i < kTopicNames.size(); ++i) {
    const auto names = map.find(kTopicNames[i]);
    if (!sources_given) *sources[i] = names.has_value();
    if (names.has_value() != *sources[i]) {
      value.fail("is not as tracks.sources, which " + std::string(names ? "leave out '" : "have '") +
                 std::string(kTopicNames[i]) + "'");
    }
    if (!names) continue;
    for (const Value& name : names->list(1, kMostWriters)) {
      const TrackWriter writer{static_cast<TrackTopic>(i), name.text()};
      const auto same = [&](const TrackWriter& w) {
        return w.topic == writer.topic && w.participant == writer.participant;
      };
      if (std::any_of(tracks.writers.begin(), tracks.writers.end(), same)) name.fail("is named twice");
      tracks.writers.push_back(writer);
    }
  }
}

GeodeticOrigin read_origin(const Value& value) {
  const std::vector<Value> numbers = value.list(3, 3);
  return {numbers[0].number(within(90)), numbers[1].number(within(180)), numbers[2].number(within(10'000))};
}

std::filesystem::path read_security(const Value& value, const std::filesystem::path& mission) {
  const std::filesystem::path folder = mission.parent_path() / value.text();
  const std::string_view missing = missing_security_file(folder);
  if (!missing.empty()) value.fail("holds no file " + std::string(missing));
  return std::filesystem::absolute(folder);
}

TrackPolicy read_tracks(const Value& value) {
  const Map map(value,
                {"required", "timeout_s", "coast_s", "sensed_from", "sources", "namespace", "writers", "origins"});
  TrackPolicy tracks;
  if (const auto required = map.find("required")) tracks.required = required->boolean();
  tracks.timeout_s = map.number_or("timeout_s", above(0, 60), tracks.timeout_s);
  tracks.coast_s = map.number_or("coast_s", closed(0, 60), tracks.coast_s);
  if (const auto from = map.find("sensed_from"))
    tracks.sensed_from = static_cast<SensedFrom>(from->choice(kSensedFrom));
  const auto sources = map.find("sources");
  if (sources) tracks.sources = read_sources(*sources);
  if (const auto name = map.find("namespace")) tracks.name_space = read_namespace(*name);
  if (const auto writers = map.find("writers")) {
    read_writers(*writers, sources.has_value(), tracks);
    if (!tracks.required) map.at("required", "").fail("is at odds with writers, each of which is needed");
  }
  if (const auto origins = map.find("origins")) {
    const Map topics(*origins, {kTopicNames.begin(), kTopicNames.end()});
    for (std::size_t i = 0; i < kTopicNames.size(); ++i) {
      if (const auto origin = topics.find(kTopicNames[i])) tracks.origins[i] = read_origin(*origin);
    }
  }
  return tracks;
}

Endings read_endings(const Value& value) {
  static constexpr std::array<std::string_view, 3> kNames = {"hold", "land", "return"};
  static constexpr std::array<std::string_view, 3> kDangers = {"motors_cut", "return_above_fence", "hover_until_empty"};
  const Map map(value, {"tracks", "link", "position", "battery", "breach", "traffic", "planner", "accept"});
  Endings endings;
  const auto read = [&](std::string_view key, EndsIn& ending) {
    if (const auto name = map.find(key)) ending = static_cast<EndsIn>(name->choice(kNames));
  };
  read("tracks", endings.tracks);
  read("link", endings.link);
  read("position", endings.position);
  read("battery", endings.battery);
  read("breach", endings.breach);
  read("traffic", endings.traffic);
  read("planner", endings.planner);
  if (const auto accept = map.find("accept")) {
    std::array<bool, kDangers.size()> accepted{};
    for (const Value& name : accept->list(1, kDangers.size())) accepted[name.choice(kDangers)] = true;
    endings.motors_cut = accepted[0];
    endings.return_above_fence = accepted[1];
    endings.hover_until_empty = accepted[2];
  }
  if (endings.position == EndsIn::kReturn) map.at("position", "").fail("needs a position; expected hold or land");
  if (endings.battery == EndsIn::kHold && !endings.hover_until_empty) {
    map.at("battery", "")
        .fail("falls when the battery is empty; expected land or return, or accept: [hover_until_empty]");
  }
  return endings;
}

CloudPolicy read_cloud(const Value& value) {
  const Map map(value, {"frame", "mount", "range", "unknown", "timeout_s", "forget_s", "all_round"});
  CloudPolicy cloud;
  if (const auto frame = map.find("frame")) cloud.frame = frame->text();
  if (cloud.frame == "map" || cloud.frame == "ned")
    map.at("frame", "").fail("is known without; expected the frame of a sensor on the vehicle");
  if (const auto mount = map.find("mount")) {
    const Map keys(*mount, {"position", "orientation"});
    cloud.position = keys.vec3_or("position", within(10), cloud.position);
    cloud.orientation = keys.vec3_or("orientation", within(10), cloud.orientation);
  }
  cloud.range = map.number_or("range", closed(2, 25), cloud.range);
  if (const auto unknown = map.find("unknown")) cloud.unknown = static_cast<Unknown>(unknown->choice(kUnknown));
  cloud.timeout_s = map.number_or("timeout_s", above(0, 60), cloud.timeout_s);
  cloud.forget_s = map.number_or("forget_s", closed(1, 3600), cloud.forget_s);
  if (const auto all_round = map.find("all_round")) cloud.all_round = all_round->boolean();
  return cloud;
}

}  // namespace

bool is_namespace(std::string_view text) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), good) && text.front() != '/' && text.back() != '/';
}

std::string_view missing_security_file(const std::filesystem::path& folder) {
  for (const char* name : {"identity_ca.cert.pem", "cert.pem", "key.pem", "permissions_ca.cert.pem", "governance.p7s",
                           "permissions.p7s"}) {
    if (!std::filesystem::is_regular_file(folder / name)) return name;
  }
  return {};
}

Mission load_mission(const std::filesystem::path& file, const std::filesystem::path& vehicles) {
  const Map map(read_document(file), {"format",       "name",      "connection",     "system_id",
                                      "icao_address", "vehicle",   "takeoff_height", "min_height",
                                      "heights",      "waypoints", "arrival",        "geofence",
                                      "map",          "no_fly",    "fence",          "dds",
                                      "tracks",       "cloud",     "endings",        "state",
                                      "setpoints",    "intents",   "time_limit",     "acceptance_radius",
                                      "hold_time"},
                "jink-mission/1");
  Mission mission;
  mission.name = map.text("name");
  mission.connection = read_connection(map.at("connection", "a MAVSDK URL"));
  if (const auto id = map.find("system_id")) mission.system_id = id->integer(closed(1, 255));
  if (const auto address = map.find("icao_address")) mission.icao_address = read_icao_address(*address);
  NamedVehicle vehicle = read_vehicle(map.at("vehicle", "the name of a vehicle or a map"), file, vehicles);
  mission.vehicle_name = std::move(vehicle.name);
  mission.vehicle = vehicle.limits;
  if (const auto geofence = map.find("geofence")) mission.geofence = read_box(*geofence, kCoordinate);
  read_heights(map, mission);
  for (const Value& point : map.at("waypoints", "a list of [x, y, z]").list(1, kMostWaypoints)) {
    mission.waypoints.push_back(read_waypoint(point, mission));
  }
  mission.map = make_map(read_map(map, file));
  if (const auto fence = map.find("fence")) {
    static constexpr std::array<std::string_view, 1> kFences = {"autopilot"};
    mission.autopilot_fence = fence->choice(kFences) == 0;
  }
  if (const auto arrival = map.find("arrival")) {
    static constexpr std::array<std::string_view, 2> kArrivals = {"land", "hold"};
    mission.arrival = arrival->choice(kArrivals) == 0 ? Arrival::kLand : Arrival::kHold;
  }
  if (const auto dds = map.find("dds")) {
    const Map keys(*dds, {"domain", "namespace", "security"});
    if (const auto id = keys.find("domain")) mission.dds_domain = id->integer(closed(0, 232));  // as RTPS's ports allow
    if (const auto name = keys.find("namespace")) mission.dds_namespace = read_namespace(*name);
    if (const auto folder = keys.find("security")) mission.dds_security = read_security(*folder, file);
  }
  if (const auto state = map.find("state")) mission.state = read_transport(*state);
  if (const auto setpoints = map.find("setpoints")) mission.setpoints = read_transport(*setpoints);
  if (const auto intents = map.find("intents")) mission.intents = intents->boolean();
  if (const auto tracks = map.find("tracks")) mission.tracks = read_tracks(*tracks);
  if (const auto cloud = map.find("cloud")) mission.cloud = read_cloud(*cloud);
  if (const auto endings = map.find("endings")) mission.endings = read_endings(*endings);
  mission.acceptance_radius = map.number_or("acceptance_radius", kAcceptance, 0.0);
  mission.hold_time = map.number_or("hold_time", kHoldTime, 0.0);
  mission.time_limit =
      map.number_or("time_limit", above(mission.hold_time, 86400), mission.time_limit + mission.hold_time);
  return mission;
}

Mission in_local_frame(Mission mission, double ground, double origin_amsl) {
  const double up = mission.heights == Heights::kGround ? ground
                    : mission.heights == Heights::kSea  ? -origin_amsl
                                                        : 0.0;
  for (Vec3& waypoint : mission.waypoints) waypoint.z() += up;
  mission.geofence.min.z() += up;
  mission.geofence.max.z() += up;
  mission.map_up += up;
  mission.min_height += ground;
  mission.ground = ground;
  return mission;
}

}  // namespace jink::config
