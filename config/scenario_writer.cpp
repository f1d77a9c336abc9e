// SPDX-License-Identifier: BSD-3-Clause
#include "config/scenario_writer.hpp"

#include <string_view>
#include <variant>
#include <vector>

#include "config/fault_reader.hpp"
#include "config/settings.hpp"
#include "config/text.hpp"
#include "config/vehicle_reader.hpp"

namespace jink::config {
namespace {

/// In double quotes, so that no text is taken for a number, a map or a comment.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string list_of(const std::vector<Vec3>& points) {
  std::string out;
  for (const Vec3& point : points) out += (out.empty() ? "" : ", ") + vector_text(point);
  return "[" + out + "]";
}

/// {key: value, ...}
class FlowMap {
 public:
  FlowMap& add(std::string_view key, const std::string& text) {
    if (!out_.empty()) out_ += ", ";
    out_.append(key).append(": ").append(text);
    return *this;
  }
  FlowMap& add(std::string_view key, double number) { return add(key, number_text(number)); }
  FlowMap& add(std::string_view key, const Vec3& vector) { return add(key, vector_text(vector)); }
  /// Nothing where it is the default. Minus zero is not zero here, so that it too reads back bit for bit.
  FlowMap& add_unless(double fallback, std::string_view key, double value) {
    const std::string text = number_text(value);
    return text == number_text(fallback) ? *this : add(key, text);
  }
  FlowMap& add_unless(const Vec3& fallback, std::string_view key, const Vec3& value) {
    const std::string text = vector_text(value);
    return text == vector_text(fallback) ? *this : add(key, text);
  }
  [[nodiscard]] std::string text() const { return "{" + out_ + "}"; }

 private:
  std::string out_;
};

struct AddShape {
  FlowMap& map;
  void operator()(const SphereShape& sphere) const { map.add("radius", sphere.radius); }
  void operator()(const BoxShape& box) const { map.add("box", box.edges); }
  void operator()(const CylinderShape& c) const {
    map.add("cylinder", FlowMap().add("radius", c.radius).add("height", c.height).text());
  }
  void operator()(const CapsuleShape& c) const {
    map.add("capsule", FlowMap().add("radius", c.radius).add("a", c.a).add("b", c.b).text());
  }
  void operator()(const VertexShape& hull) const { map.add("vertices", list_of(hull.vertices)); }
};

struct AddMotion {
  FlowMap& map;
  void operator()(const LinearMotion& m) const {
    map.add("position", m.position);
    map.add_unless(Vec3::Zero(), "velocity", m.velocity);
    map.add_unless(Vec3::Zero(), "acceleration", m.acceleration);
  }
  void operator()(const TrefoilMotion& m) const {
    FlowMap motion;
    motion.add("type", "trefoil").add("center", m.center).add("scale", m.scale);
    map.add("motion", motion.add("slower", m.slower).add("offset", m.offset).text());
  }
  void operator()(const SineMotion& m) const {
    FlowMap motion;
    motion.add("type", "sine").add("center", m.center).add("amplitude", m.amplitude);
    map.add("motion", motion.add("frequency_hz", m.frequency_hz).add("phase", m.phase).text());
  }
  void operator()(const BounceMotion& m) const {
    FlowMap motion;
    motion.add("type", "bounce").add("position", m.position).add("velocity", m.velocity);
    map.add("motion", motion.add("min", m.min).add("max", m.max).text());
  }
  void operator()(const WaypointsMotion& m) const {
    std::string times;
    for (const double t : m.times) times += (times.empty() ? "" : ", ") + number_text(t);
    FlowMap motion;
    motion.add("type", "waypoints").add("times", "[" + times + "]");
    map.add("motion", motion.add("points", list_of(m.points)).text());
  }
  void operator()(const ChaseMotion& m) const {
    FlowMap motion;
    map.add("motion", motion.add("type", "chase").add("position", m.position).add("speed", m.speed).text());
  }
};

std::string obstacle_text(const Obstacle& obstacle) {
  FlowMap map;
  std::visit(AddShape{map}, obstacle.shape);
  map.add_unless(Vec3::Zero(), "orientation", obstacle.orientation).add_unless(0.0, "yaw_rate", obstacle.yaw_rate);
  std::visit(AddMotion{map}, obstacle.motion);
  return map.text();
}

std::string vehicle_text(const std::string& name, const planner::base::VehicleLimits& limits) {
  if (is_project_vehicle(name, limits)) return in_quotes(name);
  FlowMap map;
  map.add("radius", limits.radius).add("length", limits.length).add("mass", limits.mass);
  map.add("max_speed", limits.max_speed).add("cruise_speed", limits.cruise_speed);
  map.add("max_acceleration", limits.max_acceleration).add("max_jerk", limits.max_jerk);
  map.add("max_climb", limits.max_climb);
  return map.add_unless(0.0, "drag", limits.drag).add_unless(0.0, "damping", limits.damping).text();
}

std::string scan_text(const Scan& scan) {
  const Scan defaults = depth_camera();
  FlowMap map;
  map.add("kind", std::string("camera")).add_unless(defaults.horizontal_deg, "horizontal_deg", scan.horizontal_deg);
  map.add_unless(defaults.vertical_deg, "vertical_deg", scan.vertical_deg);
  map.add_unless(defaults.columns, "columns", scan.columns).add_unless(defaults.rows, "rows", scan.rows);
  map.add_unless(defaults.range, "range", scan.range).add_unless(defaults.rate, "rate", scan.rate);
  map.add_unless(defaults.noise, "noise", scan.noise);
  if (scan.unknown != defaults.unknown)
    map.add("unknown", std::string(kUnknown[static_cast<std::size_t>(scan.unknown)]));
  return map.text();
}

std::string sensing_text(const Sensing& sensing) {
  const Sensing defaults;
  FlowMap map;
  map.add_unless(defaults.range, "range", sensing.range).add_unless(defaults.rate, "rate", sensing.rate);
  map.add_unless(defaults.delay, "delay", sensing.delay);
  map.add_unless(defaults.position_noise, "position_noise", sensing.position_noise);
  map.add_unless(defaults.velocity_noise, "velocity_noise", sensing.velocity_noise);
  map.add_unless(defaults.dropout, "dropout", sensing.dropout);
  if (sensing.sensed_from != defaults.sensed_from) map.add("sensed_from", std::string("vehicle"));
  if (sensing.scan) map.add("scan", scan_text(*sensing.scan));
  return map.text();
}

std::string wind_text(const Wind& wind) {
  const Wind defaults;
  FlowMap map;
  map.add_unless(defaults.mean, "mean", wind.mean).add_unless(defaults.gust, "gust", wind.gust);
  return map.add_unless(defaults.gust_time, "gust_time", wind.gust_time).text();
}

std::string estimate_text(const EstimateErrors& errors) {
  const EstimateErrors defaults;
  if (errors.px4) return "px4";
  FlowMap map;
  map.add_unless(defaults.position_noise, "position_noise", errors.position_noise);
  map.add_unless(defaults.velocity_noise, "velocity_noise", errors.velocity_noise);
  map.add_unless(defaults.drift, "drift", errors.drift);
  return map.add_unless(defaults.drift_time, "drift_time", errors.drift_time).text();
}

}  // namespace

std::string to_yaml(const Scenario& scenario) {
  std::string out = "format: jink-scenario/1\n";
  const auto line = [&out](std::string_view key, const std::string& text) {
    out.append(key).append(": ").append(text).append("\n");
  };
  line("name", in_quotes(scenario.name));
  line("start", vector_text(scenario.start));
  line("target", vector_text(scenario.target));
  if (scenario.acceptance_radius > 0.0) line("acceptance_radius", number_text(scenario.acceptance_radius));
  if (scenario.hold_time > 0.0) line("hold_time", number_text(scenario.hold_time));
  line("time_limit", number_text(scenario.time_limit));
  line("vehicle", vehicle_text(scenario.vehicle_name, scenario.vehicle));
  if (scenario.world) line("world", FlowMap().add("min", scenario.world->min).add("max", scenario.world->max).text());
  const auto section = [&line](std::string_view key, const std::string& text) {
    if (text != "{}") line(key, text);
  };
  section("sensing", sensing_text(scenario.sensing));
  section("wind", wind_text(scenario.wind));
  const std::string estimate = estimate_text(scenario.estimate);
  line("estimate", estimate == "{}" ? "none" : estimate);
  out += scenario.obstacles.empty() ? "obstacles: []\n" : "obstacles:\n";
  for (const Obstacle& obstacle : scenario.obstacles) out += "- " + obstacle_text(obstacle) + "\n";
  if (!scenario.map.empty()) out += "map:\n";
  for (const Obstacle& solid : scenario.map) out += "- " + obstacle_text(solid) + "\n";
  if (!scenario.vehicles.empty()) out += "vehicles:\n";
  for (const ScenarioVehicle& further : scenario.vehicles) {
    FlowMap map;
    map.add("start", further.start).add("target", further.target);
    out += "- " + map.add("vehicle", vehicle_text(further.vehicle_name, further.vehicle)).text() + "\n";
  }
  if (!scenario.faults.empty()) out += "faults:\n";
  for (const Fault& fault : scenario.faults) out += "- " + fault_text(fault) + "\n";
  return out;
}

}  // namespace jink::config
