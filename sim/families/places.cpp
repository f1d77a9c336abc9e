// SPDX-License-Identifier: BSD-3-Clause
#include "sim/families/places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "sim/world/obstacle_models.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

constexpr double kApart = 0.1;        // m, that people keep from everything
constexpr double kShell = 0.2;        // m, thickness of outer walls and ceilings
constexpr double kLookEvery = 0.1;    // s, between looks at where somebody is
constexpr double kAtTarget = 1.0;     // m, from the target, where nobody stays
constexpr double kLongestStay = 8.0;  // s

/// Whether a walk keeps clear of all that is in the world so far, and leaves its target in time.
bool is_free_walk(const world::World& world, const config::WaypointsMotion& walk, double radius, double height) {
  const Vec3 target = world.scenario().target;
  double at_target = 0.0;
  for (double t = 0.0; t < kBusy; t += kLookEvery) {
    const Vec3 place = world::state_at(walk, t).position;
    const double middle = world.clearance({place.x(), place.y(), 0.5 * height}, t, radius);
    if (middle < kApart) return false;
    for (const double up : {radius, height - radius}) {
      if (middle >= kApart + std::abs(up - 0.5 * height)) continue;  // so much at least is left there
      if (world.clearance({place.x(), place.y(), up}, t, radius) < kApart) return false;
    }
    const bool near = (place - target).head<2>().norm() < radius + world.scenario().vehicle.radius + kAtTarget;
    at_target = near ? at_target + kLookEvery : 0.0;
    if (at_target > kLongestStay) return false;
  }
  return true;
}

Vec3 quarter_turned(const Vec3& v) {
  return {0.0 - v.y(), v.x(), v.z()};  // of 0 it makes no -0
}

void turn_a_quarter(config::Obstacle& obstacle) {
  if (auto* linear = std::get_if<config::LinearMotion>(&obstacle.motion)) {
    linear->position = quarter_turned(linear->position);
    linear->velocity = quarter_turned(linear->velocity);
  } else if (auto* waypoints = std::get_if<config::WaypointsMotion>(&obstacle.motion)) {
    for (Vec3& point : waypoints->points) point = quarter_turned(point);
  }
  if (!obstacle.orientation.isZero(0.0)) {
    obstacle.orientation.x() += 0.5 * std::numbers::pi;
  } else if (auto* box = std::get_if<config::BoxShape>(&obstacle.shape)) {
    std::swap(box->edges.x(), box->edges.y());
  } else if (auto* capsule = std::get_if<config::CapsuleShape>(&obstacle.shape)) {
    capsule->a = quarter_turned(capsule->a);
    capsule->b = quarter_turned(capsule->b);
  }
}

}  // namespace

config::Obstacle block(const Vec3& low, const Vec3& high) {
  return {config::BoxShape{high - low}, config::LinearMotion{0.5 * (low + high)}};
}

config::Obstacle post(double x, double y, double radius, double height) {
  return {config::CylinderShape{radius, height}, config::LinearMotion{{x, y, 0.5 * height}}};
}

void add_wall_with(config::Scenario& scenario, const WallAcross& wall, const Opening& opening) {
  const double low = opening.middle - 0.5 * opening.width;
  const double high = opening.middle + 0.5 * opening.width;
  scenario.map.push_back(block({wall.x0, wall.low, 0.0}, {wall.x1, low, wall.height}));
  scenario.map.push_back(block({wall.x0, high, 0.0}, {wall.x1, wall.high, wall.height}));
  if (opening.height < wall.height)
    scenario.map.push_back(block({wall.x0, low, opening.height}, {wall.x1, high, wall.height}));
}

void add_shell(config::Scenario& scenario) {
  const Vec3 low = scenario.world->min;
  const Vec3 high = scenario.world->max;
  const double top = high.z() + kShell;
  scenario.map.push_back(block({low.x() - kShell, low.y(), 0.0}, {low.x(), high.y(), top}));
  scenario.map.push_back(block({high.x(), low.y(), 0.0}, {high.x() + kShell, high.y(), top}));
  scenario.map.push_back(block({low.x() - kShell, low.y() - kShell, 0.0}, {high.x() + kShell, low.y(), top}));
  scenario.map.push_back(block({low.x() - kShell, high.y(), 0.0}, {high.x() + kShell, high.y() + kShell, top}));
  scenario.map.push_back(block({low.x(), low.y(), high.z()}, {high.x(), high.y(), top}));
}

config::WaypointsMotion there_and_back(const std::vector<Stop>& stops, double speed, double begin) {
  config::WaypointsMotion motion{{begin}, {stops.front().place}};
  const auto go_to = [&](const Stop& stop) {
    const double way = (stop.place - motion.points.back()).norm();
    if (way > 0.0) {
      motion.times.push_back(motion.times.back() + way / speed);
      motion.points.push_back(stop.place);
    }
    if (stop.wait > 0.0) {
      motion.times.push_back(motion.times.back() + stop.wait);
      motion.points.push_back(stop.place);
    }
  };
  while (motion.times.back() < kBusy) {
    const std::size_t before = motion.times.size();
    for (std::size_t i = 1; i < stops.size(); ++i) go_to(stops[i]);
    for (std::size_t i = stops.size() - 1; i-- > 0;) go_to(stops[i]);
    if (motion.times.size() == before) break;  // who goes nowhere stays
  }
  return motion;
}

config::WaypointsMotion opens_and_shuts(const Vec3& shut, const Vec3& open, const DoorTimes& times) {
  config::WaypointsMotion motion;
  for (double t = times.first; t < kBusy; t += times.open + times.shut + 2.0 * times.moving) {
    const double opened = t + times.moving;
    const double shuts = opened + times.open;
    motion.times.insert(motion.times.end(), {t, opened, shuts, shuts + times.moving});
    motion.points.insert(motion.points.end(), {shut, open, open, shut});
  }
  return motion;
}

bool add_walker(config::Scenario& scenario, RandomStream& random, const std::vector<Stop>& stops) {
  const double radius = random.uniform(0.25, 0.32);
  const double height = random.uniform(1.6, 1.9);
  const double speed = random.uniform(0.8, 1.8);
  const double begin = random.uniform(0.0, 6.0);
  std::vector<Stop> on_feet = stops;
  for (Stop& stop : on_feet) stop.place.z() = 0.5 * height;
  const config::WaypointsMotion walk = there_and_back(on_feet, speed, begin);
  if (!is_free_walk(world::World(scenario), walk, radius, height)) return false;
  scenario.obstacles.push_back({config::CylinderShape{radius, height}, walk});
  return true;
}

void turn_quarters(config::Scenario& scenario, RandomStream& random) {
  for (std::uint64_t turns = random.below(4); turns > 0; --turns) {
    scenario.start = quarter_turned(scenario.start);
    scenario.target = quarter_turned(scenario.target);
    const planner::base::Box box = *scenario.world;
    scenario.world =
        planner::base::Box{{-box.max.y(), box.min.x(), box.min.z()}, {-box.min.y(), box.max.x(), box.max.z()}};
    for (config::Obstacle& solid : scenario.map) turn_a_quarter(solid);
    for (config::Obstacle& obstacle : scenario.obstacles) turn_a_quarter(obstacle);
  }
}

}  // namespace jink::sim::families
