// SPDX-License-Identifier: BSD-3-Clause
#include "config/scenario.hpp"

#include <array>

#include "config/fault_reader.hpp"
#include "config/vehicle_reader.hpp"
#include "planner/geometry/enclosing_sphere.hpp"

namespace jink::config {
namespace {

// Bounds that no sane scenario meets. They keep every later computation far from overflow and catch wrong units.
constexpr Range kSpeed = within(1e3);
constexpr Range kAcceleration = within(1e3);
constexpr Range kSize = above(0, 1e3);
constexpr Range kAngle = within(1e6);
constexpr Range kTurn = within(1e3);      // rad
constexpr Range kTurnRate = within(100);  // rad/s
constexpr std::size_t kMostObstacles = 10000;
constexpr std::size_t kMostPoints = 10000;
constexpr std::array<std::string_view, 2> kEstimates = {"px4", "none"};
constexpr std::size_t kMostFurtherVehicles = 9;  // PX4's instances are 0 to 9

Vec3 read_edges(const Value& value) {
  const std::vector<Value> items = value.list(3, 3);
  return {items[0].number(kSize), items[1].number(kSize), items[2].number(kSize)};
}

Shape read_shape(const Map& obstacle) {
  const std::array<std::string_view, 5> kinds = {"radius", "box", "cylinder", "capsule", "vertices"};
  std::vector<std::string_view> given;
  for (const std::string_view kind : kinds) {
    if (obstacle.has(kind)) given.push_back(kind);
  }
  if (given.size() != 1) {
    obstacle.value().fail("has " + (given.empty() ? "no shape" : "the shapes " + join(given)) +
                          "; expected exactly one of " + join(kinds));
  }
  if (const auto radius = obstacle.find("radius")) return SphereShape{radius->number(kSize)};
  if (const auto box = obstacle.find("box")) return BoxShape{read_edges(*box)};
  if (const auto cylinder = obstacle.find("cylinder")) {
    const Map map(*cylinder, {"radius", "height"});
    return CylinderShape{map.number("radius", kSize), map.number("height", kSize)};
  }
  if (const auto capsule = obstacle.find("capsule")) {
    const Map map(*capsule, {"radius", "a", "b"});
    return CapsuleShape{map.number("radius", kSize), map.vec3("a", within(1e3)), map.vec3("b", within(1e3))};
  }
  VertexShape shape;
  const Value vertices = obstacle.at("vertices", "");
  for (const Value& vertex : vertices.list(1, kMostPoints)) shape.vertices.push_back(vertex.vec3(within(1e3)));
  // As a radius has to be: the bridge takes a track without size, or of a giant, for a mistake and leaves it out.
  const double radius = planner::geometry::smallest_enclosing_sphere(shape.vertices).radius;
  if (!kSize.contains(radius))
    vertices.fail("has an enclosing sphere of radius " + number_text(radius) + "; expected one in " + kSize.text());
  return shape;
}

TrefoilMotion read_trefoil(const Value& value) {
  const Map map(value, {"type", "center", "scale", "slower", "offset"});
  TrefoilMotion motion;
  motion.center = map.vec3("center", kCoordinate);
  motion.scale = map.vec3("scale", kCoordinate);
  motion.slower = map.number("slower", closed(1e-3, 1e6));
  motion.offset = map.number("offset", kAngle);
  return motion;
}

SineMotion read_sine(const Value& value) {
  const Map map(value, {"type", "center", "amplitude", "frequency_hz", "phase"});
  SineMotion motion;
  motion.center = map.vec3("center", kCoordinate);
  motion.amplitude = map.vec3("amplitude", kCoordinate);
  motion.frequency_hz = map.vec3("frequency_hz", closed(0, 1e3));
  motion.phase = map.vec3("phase", kAngle);
  return motion;
}

// The box may be flat along an axis if nothing moves along it.
BounceMotion read_bounce(const Value& value) {
  const Map map(value, {"type", "position", "velocity", "min", "max"});
  BounceMotion motion;
  motion.position = map.vec3("position", kCoordinate);
  motion.velocity = map.vec3("velocity", kSpeed);
  motion.min = map.vec3("min", kCoordinate);
  motion.max = map.vec3("max", kCoordinate);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double min = motion.min[axis];
    const double max = motion.max[axis];
    const bool still = motion.velocity[axis] == 0.0;
    if (!(still ? min <= max : min < max)) {
      const Range range{min, kCoordinate.max, !still, false};
      map.at("max", "").list(3, 3)[i].fail("is not above min; expected a number in " + range.text());
    }
    // Checked by itself and not by number(): the range depends on two other keys.
    if (!closed(min, max).contains(motion.position[axis])) {
      map.at("position", "").list(3, 3)[i].fail("is not between min and max, in " + closed(min, max).text());
    }
  }
  return motion;
}

WaypointsMotion read_waypoints(const Value& value) {
  const Map map(value, {"type", "times", "points"});
  WaypointsMotion motion;
  for (const Value& time : map.at("times", "a list of increasing times").list(1, kMostPoints)) {
    const double t = time.number(closed(0, 1e6));
    if (!motion.times.empty() && t <= motion.times.back()) {
      time.fail("is not later than the time before; expected a number in " + above(motion.times.back(), 1e6).text());
    }
    motion.times.push_back(t);
  }
  const Value points = map.at("points", "a list of [x, y, z], one for each time");
  for (const Value& point : points.list(motion.times.size(), motion.times.size())) {
    motion.points.push_back(point.vec3(kCoordinate));
  }
  return motion;
}

Motion read_moving(const Value& value) {
  // Two passes: the keys of any motion first, to find a misspelled `type`; then those of the type alone.
  const Map any(value, {"type", "center", "scale", "slower", "offset", "amplitude", "frequency_hz", "phase", "position",
                        "velocity", "min", "max", "times", "points"});
  static constexpr std::array<std::string_view, 4> kTypes = {"trefoil", "sine", "bounce", "waypoints"};
  switch (any.at("type", "one of " + join(kTypes)).choice(kTypes)) {
    case 0:
      return read_trefoil(value);
    case 1:
      return read_sine(value);
    case 2:
      return read_bounce(value);
    default:
      return read_waypoints(value);
  }
}

Motion read_motion(const Map& obstacle) {
  if (const auto motion = obstacle.find("motion")) {
    for (const std::string_view key : {"position", "velocity", "acceleration"}) {
      if (const auto linear = obstacle.find(key)) linear->fail("stands beside motion; expected one or the other");
    }
    return read_moving(*motion);
  }
  LinearMotion motion;
  motion.position = obstacle.at("position", "[x, y, z], or motion in its place").vec3(kCoordinate);
  motion.velocity = obstacle.vec3_or("velocity", kSpeed, Vec3::Zero());
  motion.acceleration = obstacle.vec3_or("acceleration", kAcceleration, Vec3::Zero());
  return motion;
}

void read_turn(const Map& map, Obstacle& obstacle) {
  for (const std::string_view key : {"orientation", "yaw_rate"}) {
    if (const auto given = map.find(key); given && std::holds_alternative<SphereShape>(obstacle.shape))
      given->fail("stands beside radius; a sphere is the same however it is turned");
  }
  obstacle.orientation = map.vec3_or("orientation", kTurn, obstacle.orientation);
  obstacle.yaw_rate = map.number_or("yaw_rate", kTurnRate, obstacle.yaw_rate);
}

Sensing read_sensing(const Value& value) {
  const Map map(value, {"range", "rate", "delay", "position_noise", "velocity_noise", "dropout", "sensed_from"});
  Sensing sensing;
  sensing.range = map.number_or("range", above(0, 1e6), sensing.range);
  sensing.rate = map.number_or("rate", above(0, 1000), sensing.rate);
  sensing.delay = map.number_or("delay", closed(0, 10), sensing.delay);
  sensing.position_noise = map.number_or("position_noise", closed(0, 1000), sensing.position_noise);
  sensing.velocity_noise = map.number_or("velocity_noise", closed(0, 1000), sensing.velocity_noise);
  sensing.dropout = map.number_or("dropout", below(0, 1), sensing.dropout);
  if (const auto from = map.find("sensed_from"))
    sensing.sensed_from = static_cast<SensedFrom>(from->choice(kSensedFrom));
  return sensing;
}

Wind read_wind(const Value& value) {
  const Map map(value, {"mean", "gust", "gust_time"});
  Wind wind;
  wind.mean = map.vec3_or("mean", within(100), wind.mean);
  wind.gust = map.number_or("gust", closed(0, 100), wind.gust);
  wind.gust_time = map.number_or("gust_time", above(0, 1e4), wind.gust_time);
  return wind;
}

EstimateErrors read_estimate(const Value& value) {
  EstimateErrors errors;
  if (!value.is_map()) {
    errors.px4 = value.choice(kEstimates) == 0;
    return errors;
  }
  const Map map(value, {"position_noise", "velocity_noise", "drift", "drift_time"});
  errors.px4 = false;
  errors.position_noise = map.number_or("position_noise", closed(0, 100), errors.position_noise);
  errors.velocity_noise = map.number_or("velocity_noise", closed(0, 100), errors.velocity_noise);
  errors.drift = map.number_or("drift", closed(0, 1000), errors.drift);
  errors.drift_time = map.number_or("drift_time", above(0, 1e6), errors.drift_time);
  return errors;
}

Vec3 read_point_in_world(const Map& map, std::string_view key, const std::optional<planner::base::Box>& world) {
  Vec3 point = map.vec3(key, kCoordinate);
  for (std::size_t i = 0; world && i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Range range = closed(world->min[axis], world->max[axis]);
    if (!range.contains(point[axis]))
      map.at(key, "").list(3, 3)[i].fail("is outside the world; not in " + range.text());
  }
  return point;
}

/// They take off from the ground below their starts, where they must not touch.
void check_clear(const Map& map, const ScenarioVehicle& vehicle, const std::vector<ScenarioVehicle>& others) {
  for (std::size_t k = 0; k < others.size(); ++k) {
    const double apart = (vehicle.start - others[k].start).head<2>().norm();
    const double needed = vehicle.vehicle.radius + others[k].vehicle.radius;
    if (apart > needed) continue;
    map.at("start", "")
        .fail("is " + number_text(apart) + " m from vehicle " + std::to_string(k) +
              " on the ground; expected more than " + number_text(needed) + " m, both radii");
  }
}

std::vector<ScenarioVehicle> read_further(const Value& value, const Scenario& scenario,
                                          const std::filesystem::path& file, const std::filesystem::path& vehicles) {
  std::vector<ScenarioVehicle> all = all_vehicles(scenario);
  for (const Value& item : value.list(0, kMostFurtherVehicles)) {
    const Map map(item, {"start", "target", "vehicle"});
    ScenarioVehicle further = all.front();
    further.start = read_point_in_world(map, "start", scenario.world);
    further.target = read_point_in_world(map, "target", scenario.world);
    if (const auto own = map.find("vehicle")) {
      NamedVehicle named = read_vehicle(*own, file, vehicles);
      further.vehicle_name = std::move(named.name);
      further.vehicle = named.limits;
    }
    check_clear(map, further, all);
    all.push_back(std::move(further));
  }
  all.erase(all.begin());
  return all;
}

// The contract's default: ten times as long as the straight flight, and half a minute to get going.
double default_time_limit(const Scenario& scenario) {
  return 10.0 * (scenario.target - scenario.start).norm() / scenario.vehicle.max_speed + 30.0;
}

}  // namespace

std::vector<ScenarioVehicle> all_vehicles(const Scenario& scenario) {
  std::vector<ScenarioVehicle> all{{scenario.start, scenario.target, scenario.vehicle_name, scenario.vehicle}};
  all.insert(all.end(), scenario.vehicles.begin(), scenario.vehicles.end());
  return all;
}

Scenario load_scenario(const std::filesystem::path& file, const std::filesystem::path& vehicles) {
  const Map map(read_document(file),
                {"format", "name", "start", "target", "time_limit", "vehicle", "world", "sensing", "obstacles",
                 "vehicles", "wind", "estimate", "faults"},
                "jink-scenario/1");
  Scenario scenario;
  scenario.name = map.text("name");
  if (const auto world = map.find("world")) scenario.world = read_box(*world, kCoordinate);
  scenario.start = read_point_in_world(map, "start", scenario.world);
  scenario.target = read_point_in_world(map, "target", scenario.world);
  NamedVehicle vehicle = read_vehicle(map.at("vehicle", "the name of a vehicle or a map"), file, vehicles);
  scenario.vehicle_name = std::move(vehicle.name);
  scenario.vehicle = vehicle.limits;
  scenario.time_limit = map.number_or("time_limit", above(0, 1e6), default_time_limit(scenario));
  if (const auto sensing = map.find("sensing")) scenario.sensing = read_sensing(*sensing);
  for (const Value& item : map.at("obstacles", "a list, [] for none").list(0, kMostObstacles)) {
    const Map obstacle(item, {"radius", "box", "cylinder", "capsule", "vertices", "orientation", "yaw_rate", "position",
                              "velocity", "acceleration", "motion"});
    Shape shape = read_shape(obstacle);
    scenario.obstacles.push_back({std::move(shape), read_motion(obstacle)});
    read_turn(obstacle, scenario.obstacles.back());
  }
  if (const auto further = map.find("vehicles")) scenario.vehicles = read_further(*further, scenario, file, vehicles);
  if (!scenario.vehicles.empty() && scenario.sensing.sensed_from == SensedFrom::kVehicle)
    map.at("sensing", "").fail("has tracks sensed from one vehicle, and here are several; expected sensed_from: world");
  if (const auto wind = map.find("wind")) scenario.wind = read_wind(*wind);
  if (const auto estimate = map.find("estimate")) scenario.estimate = read_estimate(*estimate);
  if (const auto faults = map.find("faults"))
    scenario.faults = read_faults(*faults, 1 + static_cast<int>(scenario.vehicles.size()));
  return scenario;
}

}  // namespace jink::config
