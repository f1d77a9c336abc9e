// SPDX-License-Identifier: BSD-3-Clause
// The corridors of moving cubes that others publish, and teams that swap places.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/families/builders.hpp"
#include "sim/families/families.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

constexpr double kCube = 0.8;       // m, edge of the obstacles of both corridors
constexpr double kCurved = 0.65;    // share of the obstacles that fly trefoils, in both
constexpr double kTimeLimit = 100;  // s, SANDO's

/// What both corridors are flown with: SANDO's limits. The cruise speed is the limit, since travel times are judged
/// there against straight flight at the limit.
void fly_at_the_limit(config::Scenario& scenario) {
  scenario.vehicle_name = "inline";
  scenario.vehicle.max_speed = scenario.vehicle.cruise_speed = scenario.vehicle.max_climb = 5.0;
  scenario.vehicle.max_acceleration = 20.0;
  scenario.vehicle.max_jerk = 100.0;
}

/// Whether it never leaves the target by a metre for long enough that somebody could arrive and stay for a while. All
/// motions here have gone round once in that time, or to their farthest.
bool occupies_target(const world::World& world) {
  constexpr int kSamples = 300;
  constexpr double kPeriod = 0.25;  // s, between samples
  constexpr double kFree = 1.0;     // m
  constexpr double kStay = 10.0;    // s
  const Vec3& target = world.scenario().target;
  if (world.clearance(target, 0.0) > 15.0) return false;  // too far away ever to come
  double free = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    free = world.clearance(target, i * kPeriod) > kFree ? free + kPeriod : 0.0;
    if (free >= kStay) return false;
  }
  return true;
}

/// Adds cubes until there are `count`, drawn anew where one is near the start at t = 0 or keeps the target busy.
/// `draw(i)` is the i-th's motion.
template <typename Draw>
void add_cubes(config::Scenario& scenario, int count, const Draw& draw) {
  config::Scenario alone = scenario;
  for (int i = 0; i < count;) {
    alone.obstacles = {{config::BoxShape{Vec3::Constant(kCube)}, draw(i)}};
    const world::World world(alone);
    if (world.clearance(scenario.start, 0.0) < kStartClearance || occupies_target(world)) continue;
    scenario.obstacles.push_back(alone.obstacles.front());
    ++i;
  }
}

}  // namespace

// J. Tordesillas, J. P. How, "MADER: Trajectory Planner in Multiagent and Dynamic Environments", IEEE T-RO 38(1), 2022
// (online 2021); the figures are those of dynamic_corridor.py and run_many_sims_single_agent.py, github.com/mit-acl/
// mader: goal (75, 0, 1), centres x 2 to 75, y ±3, z 1 to 2, offsets ±2π.
// differs: there the 35 % that swing in z, by -sin(t + offset), are poles of 0.4 x 0.4 x 4 m and beams of 0.4 x 8 x 0.4
// m, whose enclosing spheres would close the corridor for whoever is told of spheres; here they are cubes like the
// others and keep the others' time. None is within kStartClearance of the start at first. None sweeps
// the goal, where nobody could stay (there, a flight is over when it passes x = 74 m). The vehicle's limits are
// SANDO's.
void build_mader(config::Scenario& scenario, RandomStream& random, int count) {
  constexpr double kSlower = 1.1;
  fly_at_the_limit(scenario);
  scenario.start = {0, 0, 1};
  scenario.target = {75, 0, 1};
  const planner::base::Box centers{{2, -3, 1}, {75, 3, 2}};
  const int curved = static_cast<int>(kCurved * count);
  add_cubes(scenario, count, [&](int i) -> config::Motion {
    const Vec3 center = random_point(random, centers);
    const double offset = random.uniform(-kTwoPi, kTwoPi);
    if (i < curved) return config::TrefoilMotion{center, Vec3::Ones(), kSlower, offset};
    const double frequency = 1.0 / (kTwoPi * kSlower);
    // -sin(τ) = sin(τ + π)
    return config::SineMotion{center, Vec3::UnitZ(), frequency * Vec3::UnitZ(),
                              (offset + std::numbers::pi) * Vec3::UnitZ()};
  });
}

// SANDO (MIT-ACL), the dynamic benchmark of its repository: run_all_dynamic_benchmarks.sh for start, goal and time
// limit, dyn_obstacles.launch.py for centres, scales, offsets 0 to 3, `slower`, and standing obstacles for the rest.
// differs: there the scales are divided by 6, 5 and 2 along x, y and z, so that these trefoils are wider and several
// times faster than those; and the standing 35 % are poles and beams as in MADER's, here cubes like the others.
void build_sando(config::Scenario& scenario, RandomStream& random, int count) {
  fly_at_the_limit(scenario);
  scenario.start = {0, 0, 2};
  scenario.target = {105, 0, 2};
  scenario.time_limit = kTimeLimit;
  const planner::base::Box centers{{5, -6, 0.5}, {100, 6, 4.5}};
  const int curved = static_cast<int>(kCurved * count);
  add_cubes(scenario, count, [&](int i) -> config::Motion {
    const Vec3 center = random_point(random, centers);
    if (i >= curved) return config::LinearMotion{center};
    const Vec3 scale = random_point(random, {Vec3::Constant(2.0), Vec3::Constant(4.0)});
    const double offset = random.uniform(0.0, 3.0);
    return config::TrefoilMotion{center, scale, random.uniform(10.0, 12.0), offset};
  });
}

namespace {

/// Where one vehicle starts, from the middle; it flies to the other side.
using Places = std::vector<Vec3>;

/// Evenly round a level circle.
Places round_a_circle(RandomStream& random, int count, double radius) {
  const double first = random.uniform(0.0, kTwoPi);
  Places places;
  for (int i = 0; i < count; ++i) {
    const double angle = first + kTwoPi * i / count;
    places.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  return places;
}

/// In pairs that face each other across a sphere, the last alone where the count is odd. No place is near any other,
/// nor above it, as the simulator's vehicles take off below their starts.
Places on_a_sphere(RandomStream& random, int count, double radius) {
  constexpr double kApart = 2.5;  // m, level
  Places places;
  while (static_cast<int>(places.size()) < count) {
    const Vec3 place = random_vector(random, {radius, radius, -30, 30});
    const auto near = [&](const Vec3& other) {
      return (place - other).head<2>().norm() < kApart || (place + other).head<2>().norm() < kApart;
    };
    if (std::any_of(places.begin(), places.end(), near)) continue;
    places.push_back(place);
    if (static_cast<int>(places.size()) < count) places.emplace_back(-place);
  }
  return places;
}

}  // namespace

// All would be in the middle at the same time.
void build_antipodal(config::Scenario& scenario, RandomStream& random) {
  const int count = random_count(random, 2, 6);
  const double radius = random.uniform(7.5, 12);
  const bool sphere = random.below(2) == 1;
  const Places places = sphere ? on_a_sphere(random, count, radius) : round_a_circle(random, count, radius);
  const Vec3 middle(0, 0, random.uniform(2, 5) + (sphere ? 0.5 * radius : 0.0));
  scenario.start = middle + places.front();
  scenario.target = middle - places.front();
  for (std::size_t i = 1; i < places.size(); ++i) {
    scenario.vehicles.push_back({middle + places[i], middle - places[i], scenario.vehicle_name, scenario.vehicle});
  }
}

}  // namespace jink::sim::families
