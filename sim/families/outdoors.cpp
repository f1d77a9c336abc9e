// SPDX-License-Identifier: BSD-3-Clause
// Known places under the sky: a street, a forest, a road with trucks, a field with wires.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/families/places.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

constexpr double kFloor = 0.3;  // m, the flight volume's: the vehicle's radius

/// What drives on a lane along an axis, in one direction at one speed, so that nobody runs into anybody.
struct Lane {
  Vec3 forward;  ///< a unit vector along an axis
  Vec3 at;       ///< a place on it
  double speed = 0.0;
};

/// Adds a vehicle with that length, width and height whose middle passes the lane's place at time `t`.
void add_vehicle(config::Scenario& scenario, const Lane& lane, const Vec3& size, double t) {
  const bool along_y = lane.forward.y() != 0.0;
  const Vec3 edges = along_y ? Vec3(size.y(), size.x(), size.z()) : size;
  const Vec3 position = lane.at - t * lane.speed * lane.forward + 0.5 * size.z() * Vec3::UnitZ();
  scenario.obstacles.push_back({config::BoxShape{edges}, config::LinearMotion{position, lane.speed * lane.forward}});
}

/// Length, width and height: three cars in four, else a van.
Vec3 random_car(RandomStream& random) {
  if (random.below(4) == 0) return {random.uniform(4.8, 5.6), random.uniform(1.9, 2.0), random.uniform(2.0, 2.6)};
  return {random.uniform(3.9, 4.7), random.uniform(1.7, 1.85), random.uniform(1.4, 1.6)};
}

Vec3 random_truck(RandomStream& random) {
  return {random.uniform(7.0, 9.0), random.uniform(2.4, 2.6), random.uniform(2.8, 3.4)};
}

// The street: two lanes, a strip for parking and a sidewalk on either side, then houses.
constexpr double kLaneWidth = 3.0;  // m
constexpr double kParking = 5.0;    // m, from the middle to the kerb

void add_houses(config::Scenario& scenario, RandomStream& random, double length, double front) {
  for (const double side : {-1.0, 1.0}) {
    for (double x = -6.0; x < length + 6.0;) {
      const double wide = random.uniform(6, 12);
      const double back = front + random.uniform(5, 8);
      const double y0 = side < 0.0 ? -back : front;
      const double y1 = side < 0.0 ? -front : back;
      scenario.map.push_back(block({x, y0, 0.0}, {x + wide, y1, random.uniform(5, 11)}));
      x += wide;
      if (random.below(3) == 0) x += random.uniform(1.5, 4);
    }
  }
}

/// Trees and lamps at the kerbs, and cars that are parked beside them.
void add_kerbs(config::Scenario& scenario, RandomStream& random, double length) {
  for (const double side : {-1.0, 1.0}) {
    const double kerb = side * (kParking + 0.3);
    for (double x = random.uniform(-2, 4); x < length + 2.0; x += random.uniform(6, 11)) {
      if (random.below(2) == 0) {
        const double height = random.uniform(4, 6);
        scenario.map.push_back(post(x, kerb, random.uniform(0.06, 0.1), height));
        continue;
      }
      const double crown = random.uniform(1.0, 1.6);
      scenario.map.push_back(post(x, kerb, random.uniform(0.1, 0.2), 3.2));
      scenario.map.push_back({config::SphereShape{crown}, config::LinearMotion{{x, kerb, 3.0 + 0.8 * crown}}});
    }
    for (double x = random.uniform(-4, 6); x < length; x += random.uniform(6, 16)) {
      const Vec3 half = 0.5 * random_car(random);
      const double y = side * (kParking - 1.0);
      scenario.map.push_back(block({x - half.x(), y - half.y(), 0.0}, {x + half.x(), y + half.y(), 2.0 * half.z()}));
    }
  }
}

void add_traffic(config::Scenario& scenario, RandomStream& random, double length) {
  for (const double side : {-1.0, 1.0}) {
    const double speed = random.uniform(4.0, 8.9);
    const Lane lane{-side * Vec3::UnitX(), {side < 0.0 ? 0.0 : length, 0.5 * side * kLaneWidth, 0.0}, speed};
    const int count = random_count(random, 2, 6);
    double t = random.uniform(-length / speed, 3.0);
    for (int i = 0; i < count; ++i) {
      add_vehicle(scenario, lane, random_car(random), t);
      t += random.uniform(9, 40) / speed;
    }
  }
}

/// Somebody's way along a sidewalk, across the street and on along the other sidewalk.
std::vector<Stop> random_walk(RandomStream& random, double length, double walk) {
  const double side = random.below(2) == 0 ? 1.0 : -1.0;
  const double from = random.uniform(-2, length + 2);
  const double across = std::clamp(from + random.uniform(-10, 10), -2.0, length + 2.0);
  const double to = std::clamp(across + random.uniform(-10, 10), -2.0, length + 2.0);
  const double here = side * (kParking + 0.7 + random.uniform(0.0, walk - 1.2));
  const double there = -side * (kParking + 0.7 + random.uniform(0.0, walk - 1.2));
  const double waits = random.uniform(0, 5);
  return {{{from, here, 0.0}, waits},
          {{across, here, 0.0}, random.uniform(0, 2)},
          {{across, there, 0.0}, 0.0},
          {{to, there, 0.0}, random.uniform(0, 5)}};
}

}  // namespace

// From one sidewalk over to the other in two worlds of three, else along the same.
void build_street(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(24, 40);
  const double walk = random.uniform(2.2, 3.0);
  const double front = kParking + walk;
  const double side = random.below(2) == 0 ? 1.0 : -1.0;
  const double other = random.below(3) == 0 ? side : -side;
  const double middle = kParking + 0.5 * walk + 0.2;
  scenario.start = {random.uniform(0, 3), side * middle, random.uniform(1.2, 2.4)};
  scenario.target = {random.uniform(19, length - 3), other * middle, random.uniform(1.2, 2.4)};
  scenario.world = planner::base::Box{{-3, -front - 2.0, kFloor}, {length + 3.0, front + 2.0, random.uniform(4, 9)}};
  add_houses(scenario, random, length, front);
  add_kerbs(scenario, random, length);
  add_traffic(scenario, random, length);
  add_walkers(scenario, random, random_count(random, 2, 6), [&] { return random_walk(random, length, walk); });
  turn_quarters(scenario, random);
}

namespace {

constexpr double kTrunksApart = 2.4;  // m, from middle to middle

/// A trunk of 0.3 to 0.8 m that leans a little.
config::Obstacle trunk(RandomStream& random, const Vec3& foot) {
  const double radius = random.uniform(0.15, 0.4);
  const double height = random.uniform(8, 14);
  const double yaw = random.uniform(0.0, kTwoPi);
  const double lean = random.uniform(0.0, 3.0 * kDegree);
  const Vec3 up(std::sin(lean) * std::cos(yaw), std::sin(lean) * std::sin(yaw), std::cos(lean));
  config::Obstacle result{config::CylinderShape{radius, height}, config::LinearMotion{foot + 0.5 * height * up}};
  result.orientation = {yaw, lean, 0.0};
  return result;
}

void add_trunks(config::Scenario& scenario, RandomStream& random, const planner::base::Box& area, int tries) {
  constexpr double kFree = 1.5;  // m, about start and target
  std::vector<Vec3> feet;
  for (int i = 0; i < tries; ++i) {
    const double x = random.uniform(area.min.x(), area.max.x());
    const Vec3 foot(x, random.uniform(area.min.y(), area.max.y()), 0.0);
    const auto near = [&](const Vec3& place, double apart) { return (place - foot).head<2>().norm() < apart; };
    if (near(scenario.start, kFree) || near(scenario.target, kFree)) continue;
    if (std::any_of(feet.begin(), feet.end(), [&](const Vec3& other) { return near(other, kTrunksApart); })) continue;
    feet.push_back(foot);
    scenario.map.push_back(trunk(random, foot));
  }
}

/// Trunks that have fallen, and bushes.
void add_undergrowth(config::Scenario& scenario, RandomStream& random, const planner::base::Box& area) {
  const auto random_place = [&](double up) {
    const double x = random.uniform(area.min.x(), area.max.x());
    return Vec3(x, random.uniform(area.min.y(), area.max.y()), up);
  };
  for (int count = random_count(random, 1, 4); count > 0; --count) {
    const double radius = random.uniform(0.15, 0.3);
    const double angle = random.uniform(0.0, kTwoPi);
    const Vec3 half = random.uniform(1.5, 3.5) * Vec3(std::cos(angle), std::sin(angle), 0.0);
    scenario.map.push_back({config::CapsuleShape{radius, -half, half}, config::LinearMotion{random_place(radius)}});
  }
  for (int count = random_count(random, 2, 8); count > 0; --count) {
    const double radius = random.uniform(0.3, 0.6);
    scenario.map.push_back({config::SphereShape{radius}, config::LinearMotion{random_place(0.5 * radius)}});
  }
}

/// A way between the trunks, leg after leg in any direction that is free.
std::vector<Stop> way_in_the_woods(const world::World& world, RandomStream& random, const planner::base::Box& area) {
  constexpr double kRoom = 0.5;  // m, about the middle of who walks there
  constexpr int kLegs = 4;
  constexpr int kTries = 200;
  const double x = random.uniform(area.min.x(), area.max.x());
  std::vector<Stop> stops{{{x, random.uniform(area.min.y(), area.max.y()), 0.9}, random.uniform(0, 4)}};
  for (int i = 0; i < kTries && stops.size() <= kLegs; ++i) {
    const double angle = random.uniform(0.0, kTwoPi);
    const Vec3 from = stops.back().place;
    const Vec3 to = from + random.uniform(3, 8) * Vec3(std::cos(angle), std::sin(angle), 0.0);
    if (!area.contains({to.x(), to.y(), area.min.z()}) || world.sweep(from, 0.0, to, 0.0, kRoom).min_clearance < 0.0)
      continue;
    stops.push_back({to, random.below(3) == 0 ? random.uniform(1, 6) : 0.0});
  }
  return stops;
}

}  // namespace

void build_forest(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(18, 36);
  scenario.start = {0.0, random.uniform(-3, 3), random.uniform(1.2, 3)};
  scenario.target = {length, random.uniform(-3, 3), random.uniform(1.2, 3)};
  scenario.world = planner::base::Box{{-4, -11, kFloor}, {length + 4.0, 11, random.uniform(4, 8)}};
  const planner::base::Box area{{-3, -11, 0}, {length + 3.0, 11, 0}};
  add_trunks(scenario, random, area, random_count(random, 300, 1500));
  add_undergrowth(scenario, random, area);
  const world::World standing(scenario);
  add_walkers(scenario, random, random_count(random, 1, 3), [&] { return way_in_the_woods(standing, random, area); });
  turn_quarters(scenario, random);
}

// Out of an alley, across a road of two lanes and into another alley. The first truck is there when the straight flight
// is.
void build_truck(config::Scenario& scenario, RandomStream& random) {
  constexpr double kTruckLane = 3.5;  // m
  const double length = random.uniform(18, 34);
  const double road = random.uniform(7, length - 11);
  const double alley = 0.5 * random.uniform(3.0, 5.0);
  scenario.start = {0.0, random.uniform(-0.5, 0.5), random.uniform(1.2, 2.6)};
  scenario.target = {length, random.uniform(-0.5, 0.5), random.uniform(1.2, 2.6)};
  scenario.world = planner::base::Box{{-2, -12, kFloor}, {length + 2.0, 12, random.uniform(4.5, 9)}};
  for (const double side : {-1.0, 1.0}) {
    const double y0 = side < 0.0 ? -14.0 : alley;
    const double y1 = side < 0.0 ? -alley : 14.0;
    const double near = random.uniform(1.0, 2.0);
    scenario.map.push_back(block({-4, y0, 0}, {road - near, y1, random.uniform(4, 9)}));
    scenario.map.push_back(block({road + 2 * kTruckLane + near, y0, 0}, {length + 4, y1, random.uniform(4, 9)}));
  }
  const Mission mission = mission_of(scenario);
  const auto meets = static_cast<int>(random.below(2));
  for (int lane = 0; lane < 2; ++lane) {
    const double x = road + (0.5 + lane) * kTruckLane;
    const double speed = random.uniform(3, 8);
    const Vec3 forward = lane == 0 ? Vec3(-Vec3::UnitY()) : Vec3::UnitY();
    double t = mission.time_at(x) + (lane == meets ? random.uniform(-2.5, 2.5) / speed : random.uniform(-6, 12));
    for (int count = random_count(random, 1, 3); count > 0; --count) {
      add_vehicle(scenario, {forward, {x, 0, 0}, speed}, random_truck(random), t);
      t += random.uniform(14, 40) / speed;
    }
  }
  turn_quarters(scenario, random);
}

namespace {

/// A wire between two places, which hangs through: three pieces.
void add_wire(config::Scenario& scenario, double radius, const Vec3& from, const Vec3& to, double sag) {
  const auto at = [&](double share) {
    return Vec3(from + share * (to - from) - Vec3(0, 0, share * (1 - share) * 4 * sag));
  };
  for (const auto& [a, b] : {std::pair{0.0, 1.0 / 3}, {1.0 / 3, 2.0 / 3}, {2.0 / 3, 1.0}}) {
    const Vec3 middle = 0.5 * (at(a) + at(b));
    const Vec3 half = 0.5 * (at(b) - at(a));
    scenario.map.push_back({config::CapsuleShape{radius, -half, half}, config::LinearMotion{middle}});
  }
}

/// A line on two masts with stays, across the way. One of its wires hangs at `height` in the middle.
void add_power_line(config::Scenario& scenario, RandomStream& random, double x, double height) {
  const double radius = random.uniform(0.006, 0.015);
  const double sag = random.uniform(0.1, 0.5);
  const double oblique = random.uniform(-2, 2);
  const double y = random.uniform(8, 11);
  const int wires = random_count(random, 1, 4);
  const double apart = random.uniform(0.6, 1.6);
  const auto below = static_cast<int>(random.below(static_cast<std::uint64_t>(wires)));
  double top = 5.0;
  for (int i = 0; i < wires; ++i) {
    const double z = height + (i - below) * apart + sag;
    if (z < 0.6 + sag) continue;
    top = std::max(top, z + 0.3);
    add_wire(scenario, radius, {x - oblique, -y, z}, {x + oblique, y, z}, sag);
  }
  for (const double side : {-1.0, 1.0}) {
    const Vec3 mast(x + side * oblique, side * y, 0.0);
    scenario.map.push_back(post(mast.x(), mast.y(), random.uniform(0.1, 0.18), top));
    add_wire(scenario, radius, mast + top * Vec3::UnitZ(), mast + Vec3(random.uniform(1.5, 4), 0, 0), 0.0);
  }
}

/// Posts and three wires, across the way.
void add_fence(config::Scenario& scenario, RandomStream& random, double x) {
  constexpr double kPostEvery = 3.0;  // m
  const double height = random.uniform(1.0, 1.4);
  for (double y = -12.0; y <= 12.0; y += kPostEvery) scenario.map.push_back(post(x, y, 0.05, height));
  for (const double share : {0.3, 0.6, 0.95})
    add_wire(scenario, 0.005, {x, -12, share * height}, {x, 12, share * height}, 0.0);
}

}  // namespace

// Somebody walks about there.
void build_wires(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(18, 36);
  scenario.start = {0.0, random.uniform(-3, 3), random.uniform(1.5, 4.5)};
  scenario.target = {length, random.uniform(-3, 3), random.uniform(1.5, 4.5)};
  scenario.world = planner::base::Box{{-3, -12, kFloor}, {length + 3.0, 12, random.uniform(7, 10)}};
  const int lines = random_count(random, 1, 3);
  for (int i = 0; i < lines; ++i) {
    const double x = length * (i + random.uniform(0.3, 0.7)) / lines;
    const double height = scenario.start.z() + x / length * (scenario.target.z() - scenario.start.z());
    add_power_line(scenario, random, x, height + (i == 0 ? random.uniform(-0.15, 0.15) : random.uniform(-1.0, 1.0)));
  }
  if (random.below(2) == 0) add_fence(scenario, random, random.uniform(4, length - 4));
  const auto about = [&] {
    const double wait = random.uniform(0, 4);
    return Stop{{random.uniform(0, length), random.uniform(-7, 7), 0.0}, wait};
  };
  add_walkers(scenario, random, random_count(random, 1, 3), [&] {
    return std::vector<Stop>{about(), about(), about()};
  });
  turn_quarters(scenario, random);
}

}  // namespace jink::sim::families
