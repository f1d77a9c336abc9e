// SPDX-License-Identifier: BSD-3-Clause
// Families of few obstacles at constant velocity: seen late, in odd geometry, and the encounters of aviation.
#include <array>
#include <cmath>
#include <numbers>

#include "sim/families/builders.hpp"

namespace jink::sim::families {
namespace {

constexpr double kLateRange = 7.0;  // m, of the sensing in `late`

/// A level unit vector at that azimuth.
Vec3 level(double azimuth) {
  return {std::cos(azimuth), std::sin(azimuth), 0.0};
}

/// Sets start and target: level, at any azimuth, above the ground.
void level_mission(config::Scenario& scenario, RandomStream& random, double min_length, double max_length) {
  const double x = random.uniform(-5, 5);
  const double y = random.uniform(-5, 5);
  scenario.start = {x, y, random.uniform(3, 6)};
  const Vec3 way = random_vector(random, {min_length, max_length, 0, 0});
  scenario.target = scenario.start + way;
}

/// `direction`, which is level, turned to the left by so much.
Vec3 turned(const Vec3& direction, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y(), 0.0};
}

/// What an encounter's intruder does: its track relative to the vehicle's, and its speed as a share of the vehicle's.
struct Encounter {
  double angle = 0.0;
  double speed_ratio = 1.0;
};

/// Adds an intruder that keeps its velocity and is at the vehicle's place in the closest approach of the two, but for
/// an offset in which it is still hit. In half of the draws it climbs or sinks on its way.
void add_intruder(config::Scenario& scenario, RandomStream& random, const Mission& mission,
                  const Encounter& encounter) {
  const double radius = random.uniform(0.3, 0.8);
  const double along = mission.random_place(random, 0.4, 0.9);
  const double climb = random.below(2) == 0 ? 0.0 : random.uniform(-0.8, 0.8);
  const Vec3 velocity =
      encounter.speed_ratio * mission.cruise() * turned(mission.forward(), encounter.angle) + climb * Vec3::UnitZ();
  add_meeting(scenario, mission, along, radius, velocity, random_offset(random, radius));
}

/// One intruder, two in one of four worlds.
template <typename Draw>
void add_intruders(config::Scenario& scenario, RandomStream& random, const Draw& draw) {
  level_mission(scenario, random, 25, 40);
  const Mission mission = mission_of(scenario);
  const int count = random.below(4) == 0 ? 2 : 1;
  for (int i = 0; i < count; ++i) add_intruder(scenario, random, mission, draw(random));
}

/// A pair that comes to the line from both sides at once, each the mirror image of the other.
void add_mirrored(config::Scenario& scenario, const Mission& mission, double along, double radius,
                  const Vec3& velocity) {
  add_meeting(scenario, mission, along, radius, velocity);
  add_meeting(scenario, mission, along, radius, -velocity);
}

}  // namespace

// A third stand in the way, a third come towards the vehicle and a third cross, none faster than the vehicle can still
// avoid once it is within sight.
void build_late(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 18, 35);
  scenario.sensing.range = kLateRange;
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 3, 10);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.3, 0.7);
    const double along = mission.random_place(random, 0.2, 0.95);
    const Vec3 offset = random_offset(random, radius);
    const double side = random.below(2) == 0 ? 1.0 : -1.0;
    const Vec3 across = side * (mission.left() + random.uniform(-0.5, 0.5) * mission.up()).normalized();
    const double speed = random.uniform(1.0, 3.0);
    const Vec3 velocities[] = {Vec3::Zero(), -speed * mission.forward(), speed * across};
    add_meeting(scenario, mission, along, radius, velocities[random.below(3)], offset);
  }
}

// What a planner that breaks ties by chance or divides by a difference stumbles over: every motion exactly along or
// across the line, centres exactly on it, mirror images, two obstacles in one place; along an axis or a diagonal, in
// one of three worlds kilometres from the origin.
void build_odd(config::Scenario& scenario, RandomStream& random) {
  const double quarter = 0.25 * std::numbers::pi;
  const double azimuth = quarter * static_cast<double>(random.below(8));
  const double far = random.below(3) == 0 ? 1000.0 * random_count(random, 2, 9) : 0.0;
  const Vec3 forward = level(azimuth).array().round().matrix().normalized();  // exactly: no 6e-17 in place of 0
  scenario.start = {far, -far, 0.5 * random_count(random, 6, 12)};
  scenario.target = scenario.start + random.uniform(16, 35) * forward;
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 1, 4);
  for (int i = 0; i < count; ++i) {
    const double radius = 0.1 * random_count(random, 3, 9);
    const double along = mission.random_place(random, (i + 0.2) / count, (i + 0.8) / count);
    const double speed = 0.5 * random_count(random, 1, 5);
    const Vec3 velocities[] = {Vec3::Zero(), -speed * mission.forward(), speed * mission.left(), speed * mission.up()};
    const auto kind = static_cast<std::size_t>(random.below(4));
    if (random.below(2) == 0) {
      add_meeting(scenario, mission, along, radius, velocities[kind]);
    } else {
      add_mirrored(scenario, mission, along, radius, velocities[kind]);
    }
  }
}

// The encounters that NASA's detect-and-avoid logic is shown with (C. Muñoz et al., "DAIDALUS: Detect and Avoid
// Alerting Logic for Unmanned Systems", DASC 2015; scenario files H* and C* of its reference implementation,
// github.com/nasa/ daidalus): both aircraft keep their velocities and meet at a closest point of approach, with a small
// miss distance. Scaled: the own speed is the cruise speed in place of 200 kn, the others' are shares of it (H1.daa:
// three times), and the closest approach is within the two spheres, not within a well-clear volume.

void build_daidalus_head_on(config::Scenario& scenario, RandomStream& random) {
  add_intruders(scenario, random, [](RandomStream& draw) {
    return Encounter{kDegree * (180.0 + draw.uniform(-15, 15)), draw.uniform(0.5, 3.0)};
  });
}

// Converging from 45, 90 and 135 degrees on either side.
void build_daidalus_crossing(config::Scenario& scenario, RandomStream& random) {
  add_intruders(scenario, random, [](RandomStream& draw) {
    const double side = draw.below(2) == 0 ? 1.0 : -1.0;
    return Encounter{side * kDegree * 45.0 * random_count(draw, 1, 3), draw.uniform(0.5, 3.0)};
  });
}

// Half overtake the vehicle, half are overtaken by it.
void build_daidalus_overtaking(config::Scenario& scenario, RandomStream& random) {
  add_intruders(scenario, random, [](RandomStream& draw) {
    const bool faster = draw.below(2) == 0;
    return Encounter{kDegree * draw.uniform(-15, 15), faster ? draw.uniform(1.4, 2.5) : draw.uniform(0.15, 0.6)};
  });
}

}  // namespace jink::sim::families
