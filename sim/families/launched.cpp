// SPDX-License-Identifier: BSD-3-Clause
// Others' worlds as their programs launch them: SANDO's and PANTHER's trefoils, FAPP's columns, CERLAB's corridor. What
// is taken from them are figures, each with where it stands; what differs is said at each.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "sim/families/builders.hpp"
#include "sim/families/places.hpp"
#include "sim/world/obstacle_models.hpp"

namespace jink::sim::families {
namespace {

constexpr double kLaunchedCube = 0.8;  // m, edge of the cubes that move, SANDO's and PANTHER's

/// x = sx/6 (sin τ + 2 sin 2τ), y = sy/5 (cos τ - 2 cos 2τ), z = -sz/2 sin 3τ about the centre, τ = t/slower + offset.
/// differs: as both write the formula out, the offset is not multiplied with the rest, as in sin(2 t/slower + offset).
/// Those are other curves of the same kind and size: with scales alike, turned about the vertical and shifted in
/// height.
config::Obstacle launched_trefoil(const Vec3& center, const Vec3& scale, double slower, double offset) {
  const Vec3 divided = scale.cwiseQuotient(Vec3(6.0, 5.0, 2.0));
  return {config::BoxShape{Vec3::Constant(kLaunchedCube)}, config::TrefoilMotion{center, divided, slower, offset}};
}

config::Obstacle standing_box(const Vec3& center, const Vec3& edges) {
  return {config::BoxShape{edges}, config::LinearMotion{center}};
}

}  // namespace

void set_limits(config::Scenario& scenario, const OthersLimits& limits) {
  scenario.vehicle_name = "inline";
  planner::base::VehicleLimits& vehicle = scenario.vehicle;
  vehicle.radius = limits.radius;
  vehicle.length = 2.0 * limits.radius;
  vehicle.max_speed = vehicle.cruise_speed = limits.speed;
  vehicle.max_climb = limits.climb;
  vehicle.max_acceleration = limits.acceleration;
  vehicle.max_jerk = limits.jerk;
}

namespace {

void begin_as_sando(config::Scenario& scenario) {
  set_limits(scenario, {0.1 * std::numbers::sqrt3, 5.0, 5.0, 20.0, 100.0});
  scenario.start = {0, 0, 2};
  scenario.world = planner::base::Box{{-200, -200, 0.5}, {200, 200, 6}};
}

}  // namespace

// SANDO (MIT-ACL, github.com/mit-acl/sando, 93b2eed): launch/dyn_obstacles.launch.py for the obstacles,
// config/sando.yaml for the vehicle's limits, its box of 0.2 m and heights of 0.5 to 6 m, run_all_dynamic_benchmarks.sh
// for start, goal and time limit, 65 % that move as in run_sim.py. differs: the vehicle is the sphere around that box;
// standing ones are told as tracks, as there they are trajectories.
void build_sando_launched(config::Scenario& scenario, RandomStream& random, int count) {
  constexpr double kMoving = 0.65;  // share of all
  constexpr double kPoles = 0.35;   // share of those that stand
  const planner::base::Box centers{{5, -6, 0.5}, {100, 6, 4.5}};
  begin_as_sando(scenario);
  scenario.target = {105, 0, 2};
  scenario.time_limit = 100.0;
  const int moving = static_cast<int>(kMoving * count);
  for (int i = 0; i < count; ++i) {
    const Vec3 center = random_point(random, centers);
    if (i < moving) {
      const Vec3 scale = random_point(random, {Vec3::Constant(2.0), Vec3::Constant(4.0)});
      const double offset = random.uniform(0.0, 3.0);
      scenario.obstacles.push_back(launched_trefoil(center, scale, random.uniform(4.0, 6.0), offset));
    } else if (i - moving < kPoles * (count - moving)) {
      scenario.obstacles.push_back(standing_box({center.x(), center.y(), 2.0}, {0.4, 0.4, 4.0}));
    } else {
      scenario.obstacles.push_back(standing_box(center, {0.4, 4.0, 0.4}));
    }
  }
}

namespace {

/// It stays where it starts for a minute.
void hover_as_sando(config::Scenario& scenario) {
  begin_as_sando(scenario);
  scenario.target = scenario.start;
  scenario.hold_time = 60.0;
  scenario.time_limit = 90.0;
}

}  // namespace

// SANDO's hover test, generate_hover_test_yaml() in run_sim.py: three trefoils about the vehicle, 120 degrees apart.
// differs: theirs goes on until somebody ends it, ours for a minute, and the seed turns the three about the vehicle.
void build_sando_hover(config::Scenario& scenario, RandomStream& random) {
  constexpr int kCount = 3;
  constexpr double kAway = 5.0;  // m, their centres
  hover_as_sando(scenario);
  const double turn = random.uniform(0.0, kTwoPi);
  for (int i = 0; i < kCount; ++i) {
    const double phase = kTwoPi * i / kCount;
    const Vec3 center = scenario.start + kAway * Vec3(std::cos(turn + phase), std::sin(turn + phase), 0.0);
    scenario.obstacles.push_back(launched_trefoil(center, {4, 4, 2}, 2.0, phase));
  }
}

// SANDO's adversarial test, generate_adversarial_test_yaml() in run_sim.py: another vehicle, of the same size, at 1 m/s
// for where this one is, twice a second. differs: theirs has a planner, tells what it plans and comes from x = 8 m;
// ours goes straight, is seen alone, and comes from 8 m at the same height, from where the seed says. It never leaves
// the vehicle alone, so the flight ends at the time limit.
void build_sando_chaser(config::Scenario& scenario, RandomStream& random) {
  constexpr double kAway = 8.0;   // m
  constexpr double kSpeed = 1.0;  // m/s
  hover_as_sando(scenario);
  const double from = random.uniform(0.0, kTwoPi);
  const Vec3 place = scenario.start + kAway * Vec3(std::cos(from), std::sin(from), 0.0);
  scenario.obstacles.push_back({config::SphereShape{scenario.vehicle.radius}, config::ChaseMotion{place, kSpeed}});
}

// PANTHER (J. Tordesillas, J. P. How, IEEE Access 10, 2022; github.com/mit-acl/panther, 50be45b): dynamic_corridor.py
// for the obstacles, with `slower` as either of its two values, run_many_sims.py for five of them and the goal,
// panther.yaml for the limits and the radius of 0.1 m.
// differs: the limits hold there along each axis; there is no camera whose field of view is to be kept on them.
void build_panther(config::Scenario& scenario, RandomStream& random, double slower) {
  constexpr int kCount = 5;
  constexpr double kFirst = 4.0;  // m, x of the first
  constexpr double kApart = 7.2;  // m, along x
  set_limits(scenario, {0.1, 2.6, 2.6, 15.5, 50.0});
  scenario.start = {0, 0, 1};
  scenario.target = {40, 0, 1};
  for (int i = 0; i < kCount; ++i) {
    const Vec3 center(kFirst + kApart * i, random.uniform(-1.0, 1.0), 1.0);
    const double offset = random.uniform(-kTwoPi, kTwoPi);
    scenario.obstacles.push_back(launched_trefoil(center, {2, 2, 3}, slower, offset));
  }
}

namespace {

constexpr double kFappTime = 60.0;  // s, of a flight
constexpr double kFappHalf = 17.5;  // m, half the square's side
constexpr double kFappHeight = 3.0;

/// A level drift at A (sin ωt + 1.1) along each axis, summed up in steps as there; where it is out of the square and
/// on its way farther out, it turns round on both axes. Every fifth step is kept, and those at which it turns.
config::WaypointsMotion drift(RandomStream& random, const Vec3& begin) {
  constexpr double kStep = 0.02;  // s
  constexpr int kKept = 5;
  std::array<double, 2> amplitude{random.uniform(0.2, 2.0), random.uniform(0.2, 2.0)};
  const std::array<double, 2> omega{random.uniform(0.0, 2.0), random.uniform(0.0, 2.0)};
  config::WaypointsMotion motion{{0.0}, {begin}};
  Vec3 place = begin;
  for (int k = 1; k * kStep <= kFappTime; ++k) {
    bool turns = false;
    for (int axis = 0; axis < 2; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      place[axis] += kStep * amplitude[a] * (std::sin(omega[a] * (k - 1) * kStep) + 1.1);
      turns = turns || (std::abs(place[axis]) > kFappHalf && place[axis] * amplitude[a] > 0.0);
    }
    if (turns) amplitude = {-amplitude[0], -amplitude[1]};
    if (!turns && k % kKept != 0) continue;
    motion.times.push_back(k * kStep);
    motion.points.push_back(place);
  }
  return motion;
}

/// From floor to ceiling, somewhere in the square.
config::Obstacle column(RandomStream& random) {
  const double x = random.uniform(-kFappHalf, kFappHalf);
  const double y = random.uniform(-kFappHalf, kFappHalf);
  const double width = random.uniform(0.6, 1.4);
  return post(x, y, 0.5 * width * random.uniform(0.5, 1.5), kFappHeight);
}

bool stands_near(const config::Obstacle& column, const std::vector<config::Obstacle>& others) {
  constexpr double kApart = 0.8;  // m, between axes
  const auto place = [](const config::Obstacle& one) { return std::get<config::LinearMotion>(one.motion).position; };
  return std::any_of(others.begin(), others.end(),
                     [&](const config::Obstacle& other) { return (place(column) - place(other)).norm() < kApart; });
}

}  // namespace

// FAPP (M. Lu et al., IEEE T-RO 2024; github.com/arclab-hku/FAPP, dbd8173): random_forest_sensing.cpp for motion and
// columns, simulator_example.launch for their number, sizes and the square of 35 m, 3 m high, simulator.xml for the
// sensing's range of 8 m, run_in_test.xml for the limits.
// differs: there the goal is clicked and the start is in the middle; here the way leads from side to side, from and to
// where nobody comes. There whoever is outside turns, also on the way in, so that some tremble at the edge. The vehicle
// has the AR.Drone's size.
void build_fapp(config::Scenario& scenario, RandomStream& random) {
  constexpr int kMoving = 50;
  constexpr std::size_t kStanding = 20;
  set_limits(scenario, {scenario.vehicle.radius, 3.5, 3.5, 10.0, 20.0});
  scenario.start = {-20, 0, 1.5};
  scenario.target = {20, 0, 1.5};
  scenario.time_limit = kFappTime;
  scenario.world = planner::base::Box{{-25, -25, 0}, {25, 25, kFappHeight}};
  scenario.sensing.range = 8.0;
  while (scenario.obstacles.size() < kStanding) {
    const config::Obstacle one = column(random);
    if (!stands_near(one, scenario.obstacles)) scenario.obstacles.push_back(one);
  }
  for (int i = 0; i < kMoving; ++i) {
    config::Obstacle one = column(random);
    one.motion = drift(random, std::get<config::LinearMotion>(one.motion).position);
    scenario.obstacles.push_back(one);
  }
}

namespace {

struct Walk {
  double x0 = 0.0, y0 = 0.0;
  double x1 = 0.0, y1 = 0.0;
};
constexpr std::array kWalks = {Walk{1, 1, 3, 1},          Walk{7, 1, 10, 1},           Walk{13, 1, 13, -1},
                               Walk{20.5, 0, 20.5, -1.5}, Walk{18.5, -1.5, 18.5, 1.5}, Walk{24, -1.5, 27, -1.5},
                               Walk{32, 1.5, 32, -1.5},   Walk{34, -1.5, 34, 1.5},     Walk{36, -1.5, 39, -1.5}};
constexpr double kWalking = 0.5;                     // m/s
constexpr double kTurning = std::numbers::pi / 0.8;  // s, half a turn at 0.8 rad/s
constexpr double kPerson = 1.8;                      // m, high; 0.5 m wide

/// There and back until kBusy, with time to turn round at the ends; at t = 0 somewhere on the way.
config::WaypointsMotion walk(RandomStream& random, const Walk& way) {
  const Vec3 from(way.x0, way.y0, 0.5 * kPerson);
  const Vec3 to(way.x1, way.y1, 0.5 * kPerson);
  const double leg = (to - from).norm() / kWalking;
  const double round = 2.0 * (leg + kTurning);
  config::WaypointsMotion endless;
  for (double t = -random.uniform(0.0, round); t < kBusy; t += round) {
    endless.times.insert(endless.times.end(), {t, t + leg, t + leg + kTurning, t + round - kTurning});
    endless.points.insert(endless.points.end(), {from, to, to, from});
  }
  config::WaypointsMotion motion{{0.0}, {world::state_at(endless, 0.0).position}};
  for (std::size_t i = 0; i < endless.times.size(); ++i) {
    if (endless.times[i] <= 0.0) continue;
    motion.times.push_back(endless.times[i]);
    motion.points.push_back(endless.points[i]);
  }
  return motion;
}

/// A box of the corridor, 1 m long in y and 2 m high.
struct Crate {
  double x = 0.0, y = 0.0;
  double width = 1.01;
};
constexpr std::array kCrates = {Crate{3.32, -1.21}, Crate{5.19, 1.03},   Crate{9.60, -0.99, 1.8},
                                Crate{16.65, 0.04}, Crate{22.53, -1.29}, Crate{22.58, 1.86},
                                Crate{26.50, 0.75}, Crate{30.28, 0.06},  Crate{36.09, 0.92, 1.8}};

}  // namespace

// CERLAB (Carnegie Mellon, github.com/Zhefan-Xu/uav_simulator, 80d7a4a): corridor_dynamic_9.world, 41 m long and 4.85 m
// wide, with nine people and nine boxes.
// differs: there it has no ceiling; here one at its walls' height. The people set out together there; here each is
// somewhere on its way, by the seed, and stands while it turns round. From end to end, 0.5 m and 1 m off where the
// vehicle begins there, so that it begins clear. The vehicle is the AR.Drone.
void build_cerlab_corridor(config::Scenario& scenario, RandomStream& random) {
  scenario.start = {0.5, -1, 1};
  scenario.target = {39, 0, 1};
  scenario.world = planner::base::Box{{-0.425, -2.425, 0}, {40.425, 2.425, 2.5}};
  add_shell(scenario);
  for (const Crate& crate : kCrates) {
    const double half = 0.5 * crate.width;
    scenario.map.push_back(block({crate.x - half, crate.y - 0.5, 0.0}, {crate.x + half, crate.y + 0.5, 2.0}));
  }
  for (const Walk& way : kWalks)
    scenario.obstacles.push_back({config::CylinderShape{0.25, kPerson}, walk(random, way)});
}

}  // namespace jink::sim::families
