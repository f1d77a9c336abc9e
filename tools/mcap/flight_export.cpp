// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mcap/flight_export.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <variant>

#include "planner/geometry/obstacle_motion.hpp"
#include "sim/world/shapes.hpp"
#include "tools/base/atomic_file.hpp"
#include "tools/mcap/foxglove.hpp"
#include "tools/mcap/writer.hpp"
#include "tools/report/event_severity.hpp"
#include "tools/report/report_data.hpp"
#include "tools/report/shape_corners.hpp"

namespace jink::tools::mcap {
namespace {

using foxglove::Color;
using foxglove::Entity;

constexpr double kSceneInterval = 0.05;  // s, between scenes
constexpr double kAhead = 2.0;           // s, of a prediction
constexpr double kAheadStep = 0.25;      // s
constexpr std::string_view kMap = "map";
constexpr std::string_view kVehicle = "vehicle";

// Those of the report.
constexpr Color kFlown{0.0, 0.447, 0.698, 1.0}, kPlan{0.0, 0.62, 0.451, 1.0}, kBlocked{0.835, 0.369, 0.0, 1.0};
constexpr Color kObstacle{0.851, 0.643, 0.255, 0.9}, kTrack{0.659, 0.278, 0.541, 0.35},
    kAheadColor{0.659, 0.278, 0.541, 1.0};
constexpr Color kStanding{0.663, 0.671, 0.635, 0.6}, kSeen{0.498, 0.592, 0.671, 0.8};
constexpr Color kVolume{0.6, 0.65, 0.7, 0.8}, kOther{0.247, 0.608, 0.82, 1.0};

Vec3 vector(const report::Triple& v) {
  return {v[0], v[1], v[2]};
}

double norm(const report::Triple& v) {
  return std::hypot(v[0], v[1], v[2]);
}

/// A header's [x, y, z].
std::optional<Vec3> triple_in(const nlohmann::json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 v;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*found)[k].is_number()) return std::nullopt;
    v[static_cast<Eigen::Index>(k)] = (*found)[k].get<double>();
  }
  return v.allFinite() ? std::optional(v) : std::nullopt;
}

std::string scalar_schema(std::string_view title, std::initializer_list<std::pair<const char*, const char*>> fields) {
  nlohmann::ordered_json schema{{"title", title}, {"type", "object"}, {"properties", nlohmann::ordered_json::object()}};
  for (const auto& [key, type] : fields) schema["properties"][key] = {{"type", type}};
  return schema.dump();
}

/// One flight on its way into a recording: a function for each kind of topic.
class FlightExport {
 public:
  FlightExport(const report::FlightData& flight, McapWriter& writer)
      : flight_(flight), writer_(writer), epoch_(std::min(0.0, std::floor(flight.first))) {
    for (const char* name : {"foxglove.SceneUpdate", "foxglove.PoseInFrame", "foxglove.PosesInFrame",
                             "foxglove.FrameTransform", "foxglove.Log"})
      schemas_[name] = writer.add_schema(name, foxglove::schema(name));
    add_schema("jink.Speed", {{"speed", "number"}, {"height", "number"}});
    add_schema("jink.Clearance", {{"clearance", "number"}, {"from", "string"}});
    add_schema("jink.PlanTime", {{"ms", "number"}, {"status", "string"}, {"kept", "boolean"}, {"missed", "boolean"}});
  }

  void run() {
    write_metadata();
    write_flight_scene();
    write_motions();
    write_bodies();
    write_plans();
    write_clearance();
    write_events();
  }

 private:
  void add_schema(const char* name, std::initializer_list<std::pair<const char*, const char*>> fields) {
    schemas_[name] = writer_.add_schema(name, scalar_schema(name, fields));
  }

  [[nodiscard]] std::uint64_t ns(double t) const {
    return static_cast<std::uint64_t>(std::llround(std::max(0.0, t - epoch_) * 1e9));
  }

  McapWriter::Id channel(const char* schema, const std::string& topic) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) return known->second;
    return channels_[topic] = writer_.add_channel(schemas_.at(schema), topic);
  }

  void write(const char* schema, const std::string& topic, double t, const std::string& json) {
    writer_.write(channel(schema, topic), ns(t), json);
  }

  void write_scene(const std::string& topic, std::string_view frame, double t, const std::vector<Entity>& entities,
                   bool afresh) {
    write("foxglove.SceneUpdate", topic, t, foxglove::scene_update(ns(t), frame, entities, afresh));
  }

  void write_metadata() {
    std::map<std::string, std::string> values{{"epoch_s", std::to_string(epoch_)}, {"frame", "map: ENU, m"}};
    for (const char* key : {"scenario", "mission", "seed", "version"}) {
      if (const auto value = flight_.header.find(key); value != flight_.header.end())
        values[key] = value->is_string() ? value->get<std::string>() : value->dump();
    }
    writer_.add_metadata("jink", values);
  }

  void write_flight_scene() {
    Entity entity{.id = "flight"};
    const auto& motion = flight_.truth.empty() ? flight_.states : flight_.truth;
    add_way(entity, motion, kFlown);
    for (const report::OtherVehicle& other : flight_.others) add_way(entity, other.truth, kOther);
    if (const auto world = flight_.header.find("world"); world != flight_.header.end()) {
      const auto min = triple_in(*world, "min"), max = triple_in(*world, "max");
      if (min && max) entity.lines.push_back(volume_lines(*min, *max));
    }
    for (const char* key : {"start", "target"}) {
      if (const auto p = triple_in(flight_.header, key)) entity.texts.push_back({*p, key, kPlan});
    }
    write_scene("/scene/flight", kMap, flight_.first, {entity}, false);
    if (flight_.map != nullptr) write_map("/scene/map", flight_.first, *flight_.map, kStanding);
    for (const report::SeenRecord& seen : flight_.seen) write_map("/scene/seen", seen.t, *seen.map, kSeen);
    Entity vehicle{.id = "vehicle"};
    vehicle.spheres.push_back({Vec3::Zero(), report::vehicle_radius(flight_).value_or(0.05), kFlown});
    if (!motion.empty()) write_scene("/scene/vehicle", kVehicle, flight_.first, {vehicle}, false);
    for (const report::OtherVehicle& other : flight_.others) {
      const std::string number = std::to_string(other.number);
      Entity body{.id = "vehicle_" + number};
      body.spheres.push_back({Vec3::Zero(), report::vehicle_radius(flight_, other.number).value_or(0.05), kOther});
      write_scene("/scene/vehicle_" + number, body.id, flight_.first, {body}, false);
    }
  }

  void write_map(const std::string& topic, double t, const planner::geometry::StaticMap& map, const Color& color) {
    Entity entity{.id = "map"};
    for (const planner::base::Track& track : map.tracks()) {
      const Vec3 place = track.position + Vec3(0.0, 0.0, flight_.map_up);
      if (track.body.solid == nullptr) {
        entity.spheres.push_back({place, track.radius, color});
        continue;
      }
      std::vector<Vec3> corners = report::solid_corners(*track.body.solid);
      std::vector<report::Triangle> faces = report::convex_hull(corners);
      entity.triangles.push_back({place, std::move(corners), std::move(faces), color});
    }
    write_scene(topic, kMap, t, {entity}, false);
  }

  static void add_way(Entity& entity, const std::vector<report::MotionSample>& motion, const Color& color) {
    foxglove::Line way;
    way.color = color;
    double last = -planner::base::kInfinity;
    for (const report::MotionSample& sample : motion) {
      if (sample.t < last + kSceneInterval) continue;
      way.points.push_back(vector(sample.position));
      last = sample.t;
    }
    if (way.points.size() > 1) entity.lines.push_back(std::move(way));
  }

  static foxglove::Line volume_lines(const Vec3& min, const Vec3& max) {
    foxglove::Line lines;
    lines.pixels = 1.0;
    lines.color = kVolume;
    lines.pairs = true;
    const auto corner = [&](unsigned i) {
      return Vec3((i & 1U) != 0 ? max.x() : min.x(), (i & 2U) != 0 ? max.y() : min.y(),
                  (i & 4U) != 0 ? max.z() : min.z());
    };
    for (unsigned i = 0; i < 8; ++i) {
      for (const unsigned k : {1U, 2U, 4U}) {
        if ((i & k) != 0) continue;
        lines.points.push_back(corner(i));
        lines.points.push_back(corner(i | k));
      }
    }
    return lines;
  }

  void write_poses(const std::string& topic, const std::vector<report::MotionSample>& motion) {
    for (const report::MotionSample& sample : motion) {
      const std::string pose = foxglove::pose_in_frame(ns(sample.t), kMap, vector(sample.position), 0.0);
      write("foxglove.PoseInFrame", topic, sample.t, pose);
    }
  }

  void write_transforms(const std::string& child, const std::vector<report::MotionSample>& motion) {
    for (const report::MotionSample& sample : motion) {
      const std::string transform = foxglove::frame_transform(ns(sample.t), kMap, child, vector(sample.position));
      write("foxglove.FrameTransform", "/tf", sample.t, transform);
    }
  }

  void write_motions() {
    write_poses("/truth/pose", flight_.truth);
    write_poses("/state/pose", flight_.states);
    write_poses("/setpoint/pose", flight_.setpoints);
    const auto& motion = flight_.truth.empty() ? flight_.states : flight_.truth;
    write_transforms(std::string(kVehicle), motion);
    for (const report::MotionSample& sample : motion) {
      base::JsonWriter line;
      line.open('{').key("speed").number(norm(sample.velocity)).key("height").number(sample.position[2]).close('}');
      write("jink.Speed", "/speed", sample.t, line.str());
    }
    for (const report::OtherVehicle& other : flight_.others) {
      const std::string number = std::to_string(other.number);
      write_poses("/truth/pose_" + number, other.truth);
      write_transforms("vehicle_" + number, other.truth);
    }
  }

  /// The frames of a scene's rate.
  template <typename Make>
  void write_frames(const std::string& topic, const std::vector<report::BodyFrame>& frames, const Make& make) {
    std::vector<double> t;
    for (const report::BodyFrame& frame : frames) t.push_back(frame.t);
    for (const std::size_t i : report::thin(t, kSceneInterval)) {
      std::vector<Entity> entities;
      for (const report::Body& body : frames[i].bodies) entities.push_back(make(frames[i].t, body));
      write_scene(topic, kMap, frames[i].t, entities, true);
    }
  }

  void write_bodies() {
    for (const auto& [id, obstacle] : flight_.shapes)
      hulls_[id] = report::convex_hull(report::shape_corners(obstacle, 0.0));
    write_frames("/scene/obstacles", flight_.obstacles,
                 [this](double t, const report::Body& body) { return obstacle(t, body); });
    write_frames("/scene/tracks", flight_.tracks,
                 [this](double t, const report::Body& body) { return track(t, body); });
  }

  [[nodiscard]] Entity obstacle(double t, const report::Body& body) const {
    Entity entity{.id = "obstacle " + std::to_string(body.id)};
    const auto shape = flight_.shapes.find(body.id);
    if (shape == flight_.shapes.end()) {
      entity.spheres.push_back({vector(body.position), body.radius, kObstacle});
    } else if (const auto* box = std::get_if<config::BoxShape>(&shape->second.shape);
               box != nullptr && sim::world::axes_at(shape->second, t).isIdentity(0.0)) {
      entity.cubes.push_back({vector(body.position), box->edges, kObstacle});
    } else {
      entity.triangles.push_back(
          {vector(body.position), report::shape_corners(shape->second, t), hulls_.at(body.id), kObstacle});
    }
    return entity;
  }

  [[nodiscard]] Entity track(double t, const report::Body& body) const {
    Entity entity{.id = "track " + std::to_string(body.id)};
    entity.spheres.push_back({vector(body.position), body.radius, kTrack});
    foxglove::Line line;
    line.color = kAheadColor;
    const planner::base::Track now{.position = vector(body.position),
                                   .velocity = vector(body.velocity),
                                   .acceleration = vector(body.acceleration),
                                   .radius = body.radius,
                                   .age = body.age};
    for (double s = 0.0; s <= kAhead; s += kAheadStep)
      line.points.push_back(planner::geometry::predict_position(now, s, trust_at(t)));
    entity.lines.push_back(std::move(line));
    return entity;
  }

  /// For how long the newest plan believed the tracks' accelerations; before the first, not at all.
  [[nodiscard]] double trust_at(double t) const {
    const auto next = std::upper_bound(flight_.plans.begin(), flight_.plans.end(), t,
                                       [](double time, const report::PlanRecord& plan) { return time < plan.t; });
    return next == flight_.plans.begin() ? 0.0 : std::prev(next)->acceleration_trust;
  }

  void write_plans() {
    for (const report::PlanRecord& plan : flight_.plans) {
      std::vector<Vec3> points;
      for (const auto& [t, x, y, z] : plan.path) points.emplace_back(x, y, z);
      write("foxglove.PosesInFrame", "/plan", plan.t, foxglove::poses_in_frame(ns(plan.t), kMap, points));
      Entity entity{.id = "plan"};
      const bool blocked = plan.status != "reaches" && plan.status != "progresses";
      if (points.size() > 1) entity.lines.push_back({points, 3.0, blocked ? kBlocked : kPlan});
      if (!points.empty() && !plan.way.empty()) {
        foxglove::Line guide{{points.front()}, 1.0, kPlan};
        for (const report::Triple& place : plan.way) guide.points.push_back(vector(place));
        entity.lines.push_back(std::move(guide));
      }
      write_scene("/scene/plan", kMap, plan.t, {entity}, true);
      base::JsonWriter line;
      line.open('{').key("ms").number(plan.ms).key("status").text(plan.status).key("kept").flag(plan.kept);
      write("jink.PlanTime", "/plan/time", plan.t, line.key("missed").flag(plan.missed).close('}').str());
    }
  }

  void write_clearance() {
    std::vector<report::ClearanceSample> samples = report::true_clearance(flight_);
    const char* from = "true";
    if (samples.empty()) {
      samples = report::tracked_clearance(flight_);
      from = "tracks";
    }
    for (const report::ClearanceSample& sample : samples) {
      base::JsonWriter line;
      line.open('{').key("clearance").number(sample.distance).key("from").text(from).close('}');
      write("jink.Clearance", "/clearance", sample.t, line.str());
    }
  }

  void write_events() {
    for (const report::EventRecord& event : flight_.events) {
      const report::EventSeverity tone = report::event_severity(event.name, event.detail);
      const auto level = tone == report::EventSeverity::kBad    ? foxglove::LogLevel::kError
                         : tone == report::EventSeverity::kWarn ? foxglove::LogLevel::kWarning
                                                                : foxglove::LogLevel::kInfo;
      const std::string text = event.detail.empty() ? event.name : event.name + ": " + event.detail;
      write("foxglove.Log", "/events", event.t, foxglove::log(ns(event.t), level, text, "jink"));
    }
  }

  const report::FlightData& flight_;
  McapWriter& writer_;
  double epoch_;  // s
  std::map<std::string, McapWriter::Id> schemas_, channels_;
  std::map<std::uint64_t, std::vector<report::Triangle>> hulls_;
};

}  // namespace

ExportResult export_mcap(const std::filesystem::path& log, const std::filesystem::path& mcap) {
  const report::FlightData flight = report::read_flight(log);
  const std::filesystem::path part = base::unfinished_name(mcap, "." + std::to_string(::getpid()) + ".part");
  std::uint64_t messages = 0;
  try {
    McapWriter writer(part, "", "jink");
    FlightExport(flight, writer).run();
    writer.close();
    messages = writer.messages();
    if (part != mcap) std::filesystem::rename(part, mcap);
  } catch (const std::runtime_error& error) {  // filesystem_error is one
    std::error_code ignored;
    if (part != mcap) std::filesystem::remove(part, ignored);
    throw std::runtime_error(mcap.string() + ": cannot write the recording: " + error.what());
  }
  return {messages, flight.lines, flight.cut_off + flight.not_finite + flight.unknown};
}

}  // namespace jink::tools::mcap
