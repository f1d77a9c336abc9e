// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavlink/messages.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "bridge/frames/conversions.hpp"

namespace jink::bridge::mavlink {

namespace {

using nlohmann::json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegreesE7 = 1e7;
constexpr double kDegreesE2 = 1e2;
constexpr double kPerMetre_mm = 1e3;
constexpr double kPerMetre_cm = 1e2;
constexpr double kPerSecond_us = 1e6;
constexpr std::uint32_t kLocalNed = 1;  // MAV_FRAME
constexpr std::uint32_t kBodyNed = 8;
constexpr std::uint32_t kBodyFrd = 12;

// NaN where the field is missing or not a number (a NaN on the wire comes as null).
double number(const json& fields, const char* key) {
  const auto field = fields.find(key);
  return field != fields.end() && field->is_number() ? field->get<double>() : kNaN;
}

Vec3 vector(const json& fields, const char* x, const char* y, const char* z) {
  return {number(fields, x), number(fields, y), number(fields, z)};
}

// An unsigned field of at most 32 bits; false when it is missing or out of range.
bool read(const json& fields, const char* key, std::uint32_t& value) {
  const double v = number(fields, key);
  if (!(v >= 0.0 && v <= 4294967295.0)) return false;
  value = static_cast<std::uint32_t>(v);
  return true;
}

bool read(const json& fields, const char* key, std::int64_t& value) {
  const auto field = fields.find(key);
  if (field == fields.end() || !field->is_number_integer()) return false;
  value = field->get<std::int64_t>();
  return true;
}

std::string text(const json& fields, const char* key) {
  const auto field = fields.find(key);
  return field != fields.end() && field->is_string() ? field->get<std::string>() : std::string();
}

// Each comparison is false for NaN.
bool believable(const Vec3& position, const Vec3& velocity) {
  return position.norm() <= Limits::kPosition && velocity.norm() <= Limits::kVelocity;
}

bool read(const json& fields, Heartbeat& message) {
  return read(fields, "autopilot", message.autopilot) && read(fields, "base_mode", message.base_mode) &&
         read(fields, "custom_mode", message.custom_mode) && read(fields, "system_status", message.system_status);
}

bool read(const json& fields, CurrentMode& message) {
  return read(fields, "custom_mode", message.custom_mode) &&
         read(fields, "intended_custom_mode", message.intended_custom_mode);
}

bool read(const json& fields, LocalPosition& message) {
  message.position = frames::enu_from_ned(vector(fields, "x", "y", "z"));
  message.velocity = frames::enu_from_ned(vector(fields, "vx", "vy", "vz"));
  return believable(message.position, message.velocity) && read(fields, "time_boot_ms", message.boot_ms);
}

bool read(const json& fields, Attitude& message) {
  const double heading = number(fields, "yaw");
  message.yaw = frames::yaw_enu_from_heading(heading);
  message.pitch = number(fields, "pitch");
  message.roll = number(fields, "roll");
  return std::abs(heading) <= Limits::kHeading && read(fields, "time_boot_ms", message.boot_ms);
}

// The velocity in NED: as it stands (child frame LOCAL_NED, as PX4 has it) or turned from the body's axes; NaN for any
// other frame, and where the attitude is none.
Vec3 odometry_velocity_ned(const json& fields) {
  Vec3 velocity = vector(fields, "vx", "vy", "vz");
  std::uint32_t child_frame = 0;
  (void)read(fields, "child_frame_id", child_frame);
  if (child_frame == kLocalNed) return velocity;
  const auto q = fields.find("q");
  const bool turned = (child_frame == kBodyNed || child_frame == kBodyFrd) && q != fields.end() && q->is_array() &&
                      q->size() == 4 && std::all_of(q->begin(), q->end(), [](const json& c) { return c.is_number(); });
  if (!turned) return Vec3::Constant(kNaN);
  const Eigen::Quaterniond attitude((*q)[0].get<double>(), (*q)[1].get<double>(), (*q)[2].get<double>(),
                                    (*q)[3].get<double>());
  const double norm = attitude.norm();
  if (!(norm > 0.5 && norm < 2.0)) return Vec3::Constant(kNaN);  // zeros, above all: no rotation
  return attitude.normalized() * velocity;
}

bool read(const json& fields, Odometry& message) {
  std::uint32_t frame = 0;
  std::uint32_t counter = 0;
  message.time = number(fields, "time_usec") / kPerSecond_us;
  message.position = frames::enu_from_ned(vector(fields, "x", "y", "z"));
  message.velocity = frames::enu_from_ned(odometry_velocity_ned(fields));
  const bool whole = read(fields, "frame_id", frame) && read(fields, "reset_counter", counter) && counter <= 255;
  message.local_frame = frame == kLocalNed;
  message.reset_counter = static_cast<std::uint8_t>(counter);
  return whole && std::isfinite(message.time) && believable(message.position, message.velocity);
}

bool read(const json& fields, SysStatus& message) {
  message.battery_remaining_percent = number(fields, "battery_remaining");
  return read(fields, "onboard_control_sensors_present", message.present) &&
         read(fields, "onboard_control_sensors_enabled", message.enabled) &&
         read(fields, "onboard_control_sensors_health", message.health);
}

bool read(const json& fields, ExtendedSysState& message) {
  return read(fields, "landed_state", message.landed_state);
}

bool read(const json& fields, EstimatorStatus& message) {
  message.horizontal_accuracy = number(fields, "pos_horiz_accuracy");
  message.vertical_accuracy = number(fields, "pos_vert_accuracy");
  return read(fields, "flags", message.flags);
}

bool read(const json& fields, BatteryStatus& message) {
  (void)read(fields, "charge_state", message.charge_state);
  return read(fields, "id", message.id) && message.id <= 255;
}

bool read(const json& fields, Origin& message) {
  frames::Geodetic& place = message.place;
  place = {number(fields, "latitude") / kDegreesE7, number(fields, "longitude") / kDegreesE7,
           number(fields, "altitude") / kPerMetre_mm};
  return std::abs(place.latitude_deg) <= 90.0 && std::abs(place.longitude_deg) <= 180.0 &&
         std::abs(place.altitude_m) <= Limits::kPosition;
}

bool read(const json& fields, Home& message) {
  message.height = -number(fields, "z");
  return std::abs(message.height) <= Limits::kPosition;
}

bool read(const json& fields, CommandAck& message) {
  std::uint32_t command = 0;
  std::uint32_t result = 0;
  if (!read(fields, "command", command) || !read(fields, "result", result)) return false;
  (void)read(fields, "target_system", message.target_system);
  (void)read(fields, "target_component", message.target_component);
  message.command = static_cast<std::uint16_t>(command);
  message.result = static_cast<int>(result);
  return command <= 0xffffU && result <= 0xffU;
}

bool read(const json& fields, AutopilotVersion& message) {
  return read(fields, "flight_sw_version", message.flight_sw_version);
}

bool read(const json& fields, Ping& message) {
  return read(fields, "time_usec", message.time_us) && read(fields, "target_system", message.target_system) &&
         read(fields, "target_component", message.target_component);
}

bool read(const json& fields, ParamValue& message) {
  message.name = text(fields, "param_id");
  message.field = number(fields, "param_value");
  const double largest = static_cast<double>(std::numeric_limits<float>::max());
  if (std::abs(message.field) > largest) return false;  // no float, which the field is on the wire
  return !message.name.empty() && read(fields, "param_type", message.type);
}

bool read(const json& fields, MissionCount& message) {
  (void)read(fields, "mission_type", message.mission_type);  // an extension field
  (void)read(fields, "target_component", message.target_component);
  return read(fields, "count", message.count) && message.count <= 0xffffU;
}

bool read(const json& fields, MissionItem& message) {
  (void)read(fields, "mission_type", message.mission_type);
  (void)read(fields, "target_component", message.target_component);
  message.param1 = number(fields, "param1");
  message.latitude_deg = number(fields, "x") / kDegreesE7;
  message.longitude_deg = number(fields, "y") / kDegreesE7;
  return read(fields, "seq", message.seq) && read(fields, "command", message.command) &&
         std::abs(message.latitude_deg) <= 90.0 && std::abs(message.longitude_deg) <= 180.0;
}

bool read(const json& fields, StatusText& message) {
  (void)read(fields, "id", message.id);
  (void)read(fields, "chunk_seq", message.chunk);
  message.text = text(fields, "text");
  return read(fields, "severity", message.severity);
}

bool read(const json& fields, AdsbReport& report) {
  report.latitude_deg = number(fields, "lat") / kDegreesE7;
  report.longitude_deg = number(fields, "lon") / kDegreesE7;
  report.altitude_m = number(fields, "altitude") / kPerMetre_mm;
  report.heading_deg = number(fields, "heading") / kDegreesE2;
  report.horizontal_velocity = number(fields, "hor_velocity") / kPerMetre_cm;
  report.vertical_velocity = number(fields, "ver_velocity") / kPerMetre_cm;
  report.since_contact = number(fields, "tslc");
  return read(fields, "ICAO_address", report.icao_address) && read(fields, "flags", report.flags) &&
         read(fields, "altitude_type", report.altitude_type) && read(fields, "emitter_type", report.emitter_type);
}

template <typename T>
std::optional<Message> decode_as(const json& fields) {
  T message;
  if (!read(fields, message)) return std::nullopt;
  return message;
}

using Decoder = std::optional<Message> (*)(const json& fields);
constexpr std::array<std::pair<std::string_view, Decoder>, std::variant_size_v<Message>> kDecoders{{
    {"HEARTBEAT", decode_as<Heartbeat>},
    {"CURRENT_MODE", decode_as<CurrentMode>},
    {"LOCAL_POSITION_NED", decode_as<LocalPosition>},
    {"ATTITUDE", decode_as<Attitude>},
    {"ODOMETRY", decode_as<Odometry>},
    {"SYS_STATUS", decode_as<SysStatus>},
    {"EXTENDED_SYS_STATE", decode_as<ExtendedSysState>},
    {"ESTIMATOR_STATUS", decode_as<EstimatorStatus>},
    {"BATTERY_STATUS", decode_as<BatteryStatus>},
    {"GPS_GLOBAL_ORIGIN", decode_as<Origin>},
    {"HOME_POSITION", decode_as<Home>},
    {"COMMAND_ACK", decode_as<CommandAck>},
    {"AUTOPILOT_VERSION", decode_as<AutopilotVersion>},
    {"PING", decode_as<Ping>},
    {"PARAM_VALUE", decode_as<ParamValue>},
    {"MISSION_COUNT", decode_as<MissionCount>},
    {"MISSION_ITEM_INT", decode_as<MissionItem>},
    {"STATUSTEXT", decode_as<StatusText>},
    {"ADSB_VEHICLE", decode_as<AdsbReport>},
}};

}  // namespace

std::optional<Message> decode(std::string_view name, std::string_view json_text) {
  const auto* found = std::find_if(kDecoders.begin(), kDecoders.end(), [&](const auto& d) { return d.first == name; });
  if (found == kDecoders.end()) return std::nullopt;
  const json fields = json::parse(json_text, nullptr, /*allow_exceptions=*/false);
  if (!fields.is_object()) return std::nullopt;
  return found->second(fields);
}

}  // namespace jink::bridge::mavlink
