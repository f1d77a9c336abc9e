// SPDX-License-Identifier: BSD-3-Clause
#include "config/obstacle_reader.hpp"

#include <array>
#include <utility>

#include "planner/geometry/enclosing_sphere.hpp"

namespace jink::config {
namespace {

// Bounds that no sane file meets. They keep every later computation far from overflow and catch wrong units.
constexpr Range kSpeed = within(1e3);
constexpr Range kAcceleration = within(1e3);
constexpr Range kSize = above(0, 1e3);
constexpr Range kAngle = within(1e6);
constexpr Range kTurn = within(1e3);      // rad
constexpr Range kTurnRate = within(100);  // rad/s
constexpr std::size_t kMostPoints = 10000;

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

ChaseMotion read_chase(const Value& value) {
  const Map map(value, {"type", "position", "speed"});
  return {map.vec3("position", kCoordinate), map.number("speed", closed(0, kSpeed.max))};
}

Motion read_moving(const Value& value) {
  // Two passes: the keys of any motion first, to find a misspelled `type`; then those of the type alone.
  const Map any(value, {"type", "center", "scale", "slower", "offset", "amplitude", "frequency_hz", "phase", "position",
                        "velocity", "min", "max", "times", "points", "speed"});
  static constexpr std::array<std::string_view, 5> kTypes = {"trefoil", "sine", "bounce", "waypoints", "chase"};
  switch (any.at("type", "one of " + join(kTypes)).choice(kTypes)) {
    case 0:
      return read_trefoil(value);
    case 1:
      return read_sine(value);
    case 2:
      return read_bounce(value);
    case 3:
      return read_waypoints(value);
    default:
      return read_chase(value);
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

}  // namespace

Obstacle read_obstacle(const Value& value) {
  const Map map(value, {"radius", "box", "cylinder", "capsule", "vertices", "orientation", "yaw_rate", "position",
                        "velocity", "acceleration", "motion"});
  Shape shape = read_shape(map);
  Obstacle obstacle{std::move(shape), read_motion(map)};
  read_turn(map, obstacle);
  return obstacle;
}

Obstacle read_solid_at_rest(const Value& value) {
  const Map map(value, {"radius", "box", "cylinder", "capsule", "vertices", "orientation", "position", "motion",
                        "velocity", "acceleration", "yaw_rate"});
  for (const std::string_view key : {"motion", "velocity", "acceleration", "yaw_rate"}) {
    if (const auto moving = map.find(key)) moving->fail("is of what moves; a map holds what is at rest");
  }
  return read_obstacle(value);
}

}  // namespace jink::config
