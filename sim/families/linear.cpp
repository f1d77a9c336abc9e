// SPDX-License-Identifier: BSD-3-Clause
// The families in which every obstacle keeps a constant velocity for ever.
#include <cmath>
#include <numbers>

#include "sim/families/builders.hpp"

namespace jink::sim::families {
namespace {

/// At right angles to the mission, at any angle about it.
Vec3 random_across(RandomStream& random, const Mission& mission) {
  const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
  return std::cos(angle) * mission.left() + std::sin(angle) * mission.up();
}

/// Movers that cross the straight flight when it is there, from any side, some a little with it or against it.
void add_crossing(config::Scenario& scenario, RandomStream& random, const Mission& mission, int count,
                  double max_speed) {
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.3, 0.9);
    const double along = mission.random_place(random, 0.1, 1.0);
    const Vec3 across = random_across(random, mission);
    const Vec3 direction = (across + random.uniform(-0.7, 0.7) * mission.forward()).normalized();
    const Vec3 offset = random_offset(random, radius);
    const double wait = random_wait(random, i);
    add_meeting(scenario, mission, along, radius, random.uniform(0.4, max_speed) * direction, offset, wait);
  }
}

}  // namespace

void build_crossing(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 15, 30);
  maybe_enclose(scenario, random);
  const int count = random_count(random, 4, 20);
  add_crossing(scenario, random, mission_of(scenario), count, 3.5);
}

// The first comes down the line itself; the others fly beside it, near enough to narrow the way out.
void build_head_on(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 18, 40);
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 2, 10);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.3, 1.0);
    const double along = mission.random_place(random, 0.1, 0.9);
    const Vec3 drift = 0.1 * random_across(random, mission);
    const Vec3 velocity = random.uniform(0.5, 4.0) * (drift - mission.forward()).normalized();
    const double aside = i == 0 ? random.uniform(0.0, 0.3) : random.uniform(0.3, 2.5);
    add_meeting(scenario, mission, along, radius, velocity, aside * random_across(random, mission));
  }
}

void build_overtaking(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 20, 40);
  const Mission mission = mission_of(scenario);
  const int slower = random_count(random, 1, 5);
  const int faster = random_count(random, 1, 5);
  for (int i = 0; i < slower + faster; ++i) {
    const double radius = random.uniform(0.3, 0.9);
    const double speed = i < slower ? random.uniform(0.4, 2.0) : random.uniform(3.8, 6.5);
    const double along = mission.random_place(random, 0.3, 0.9);
    const Vec3 drift = 0.08 * random_across(random, mission);
    const Vec3 velocity = speed * (mission.forward() + drift).normalized();
    add_meeting(scenario, mission, along, radius, velocity, random_offset(random, radius));
  }
}

void build_falling(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 15, 35);
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 6, 28);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.25, 0.8);
    const double along = mission.random_place(random, 0.05, 1.0);
    const Vec3 drift = random_vector(random, {0.0, 0.8, 0, 0});
    const Vec3 velocity = drift - random.uniform(0.8, 6.0) * Vec3::UnitZ();
    const Vec3 offset = random_offset(random, radius);
    add_meeting(scenario, mission, along, radius, velocity, offset, random_wait(random, i));
  }
}

// The middle of the gap is on the straight flight when that is there, so both spheres are touched.
void build_gates(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 18, 35);
  maybe_enclose(scenario, random);
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 2, 6);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.4, 1.0);
    const double gap = random.uniform(0.05, 2.0 * scenario.vehicle.radius - 0.25);
    const Vec3 axis = random_across(random, mission);
    const double along = mission.random_place(random, (i + 0.3) / count, (i + 0.9) / count);
    Vec3 velocity = Vec3::Zero();
    if (random.below(3) != 0) {
      const double speed = random.uniform(0.3, 2.5);
      velocity = speed * random_across(random, mission);
    }
    const Vec3 offset = (radius + 0.5 * gap) * axis;
    add_meeting(scenario, mission, along, radius, velocity, offset);
    add_meeting(scenario, mission, along, radius, velocity, -offset);
  }
}

void build_darts(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 18, 40);
  maybe_enclose(scenario, random);
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 6, 28);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.2, 0.6);
    const double along = mission.random_place(random, 0.15, 1.0);
    const Vec3 velocity = random_vector(random, {4.0, 9.0, -40, 40});
    const Vec3 offset = random_offset(random, radius);
    add_meeting(scenario, mission, along, radius, velocity, offset, random_wait(random, i));
  }
}

// Straight up or down in one of three worlds, steep in the others.
void build_vertical(config::Scenario& scenario, RandomStream& random) {
  const bool straight_up = random.below(3) == 0;
  const Vec3 way = random_vector(random, {15, 25, straight_up ? 90.0 : 55.0, straight_up ? 90.0 : 85.0});
  scenario.start = {random.uniform(-5, 5), random.uniform(-5, 5), 2.0};
  scenario.target = scenario.start + way;
  if (random.below(3) == 0) std::swap(scenario.start, scenario.target);
  const int count = random_count(random, 4, 16);
  add_crossing(scenario, random, mission_of(scenario), count, 2.5);
}

// Half the worlds straight along -x, the others at the same x, to either side.
void build_backward(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(15, 35);
  scenario.start = {random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(1.5, 5)};
  Vec3 way = -Vec3::UnitX();
  if (random.below(2) == 0) way = random.below(2) == 0 ? Vec3::UnitY() : Vec3(-Vec3::UnitY());
  scenario.target = scenario.start + length * way;
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 2, 10);
  add_crossing(scenario, random, mission, count, 3.0);
  const double radius = random.uniform(0.3, 0.8);
  const double along = mission.random_place(random, 0.3, 0.8);
  const Vec3 velocity = -random.uniform(0.5, 3.0) * mission.forward();
  add_meeting(scenario, mission, along, radius, velocity, random_offset(random, radius));
}

}  // namespace jink::sim::families
