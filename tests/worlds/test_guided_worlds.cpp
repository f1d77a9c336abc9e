// SPDX-License-Identifier: BSD-3-Clause
// Ways through what stands that no straight line with a few offsets is: dead ends, chicanes, doors, a spiral.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "sim/families/families.hpp"
#include "tests/worlds/way_through.hpp"

namespace jink::worlds {
namespace {

using Obstacles = std::vector<config::Obstacle>;

config::Obstacle box(const Vec3& center, const Vec3& edges) {
  return {config::BoxShape{edges}, config::LinearMotion{center}};
}

/// A wall across the world at x, with a hole that wide and high about y, from the ground on.
void add_wall(Obstacles& obstacles, double x, double y, double width, double height) {
  constexpr double kSide = 12.0;
  constexpr double kTop = 8.0;
  const double left = kSide - (y + 0.5 * width);
  const double right = kSide + (y - 0.5 * width);
  obstacles.push_back(box({x, kSide - 0.5 * left, 0.5 * kTop}, {0.2, left, kTop}));
  obstacles.push_back(box({x, -kSide + 0.5 * right, 0.5 * kTop}, {0.2, right, kTop}));
  if (height < kTop) obstacles.push_back(box({x, y, 0.5 * (kTop + height)}, {0.2, width, kTop - height}));
}

struct GuidedWorld {
  config::Scenario scenario;

  friend std::ostream& operator<<(std::ostream& out, const GuidedWorld& world) { return out << world.scenario.name; }
};

GuidedWorld world(std::string name, Obstacles obstacles, const Vec3& target = {20, 0, 1.5}) {
  config::Scenario scenario;
  scenario.name = std::move(name);
  scenario.start = {0, 0, 1.5};
  scenario.target = target;
  scenario.world = planner::base::Box{{-4, -12, 0.3}, {24, 12, 8}};
  scenario.time_limit = 60;
  scenario.estimate.px4 = false;
  scenario.obstacles = std::move(obstacles);
  return {scenario};
}

/// Two turns of a wall of spheres, 2.4 m from one to the next, round the target.
Obstacles spiral() {
  Obstacles obstacles;
  double way = 0.0;
  for (double angle = 0.0; angle < 4.0 * std::numbers::pi; angle += 0.01) {
    const double radius = 1.8 + 2.4 * angle / (2.0 * std::numbers::pi);
    way += 0.01 * radius;
    if (way < 0.8 && angle > 0.0) continue;
    way = 0.0;
    for (double z = 0.4; z < 4.0; z += 0.8)
      obstacles.push_back({config::SphereShape{0.5},
                           config::LinearMotion{{10 + radius * std::cos(angle), radius * std::sin(angle), z}}});
  }
  return obstacles;
}

std::vector<GuidedWorld> guided_worlds() {
  std::vector<GuidedWorld> worlds;
  worlds.push_back(
      world("dead_end", {box({14, 0, 4}, {0.3, 8, 8}), box({9, 4, 4}, {10, 0.3, 8}), box({9, -4, 4}, {10, 0.3, 8})}));
  Obstacles chicane;
  add_wall(chicane, 9, 4, 2.4, 8);
  add_wall(chicane, 12, -4, 2.4, 8);
  worlds.push_back(world("chicane", std::move(chicane)));
  Obstacles door;
  add_wall(door, 10, 0, 1.3, 2.1);
  worlds.push_back(world("door", std::move(door)));
  Obstacles office;
  add_wall(office, 6, -3, 1.3, 2.1);
  add_wall(office, 11, 3.5, 1.3, 2.1);
  add_wall(office, 16, -2, 1.3, 2.1);
  worlds.push_back(world("office", std::move(office)));
  worlds.push_back(world("block", {box({8, -5, 4}, {8, 14, 8}), box({15, 5, 4}, {3, 14, 8})}));
  worlds.push_back(world("spiral", spiral(), {10, 0, 1.5}));
  worlds.back().scenario.world->max.z() = 4;
  worlds.back().scenario.world->min.y() = -14;
  // Plans that look farther than the bend, which is hardly wider than the vehicle with its margin, find nothing better
  // than to stay.
  worlds.back().scenario.time_limit = 30;
  // What comes fills the corridor: into the recess before it is there, until it is past.
  worlds.push_back(world("piston", {box({10, -1.65, 4}, {28, 0.3, 8}), box({-0.6, 1.65, 4}, {6.8, 0.3, 8}),
                                    box({14.6, 1.65, 4}, {18.8, 0.3, 8}), box({4, 4.15, 4}, {3, 0.3, 8}),
                                    box({2.65, 2.9, 4}, {0.3, 2.6, 8}), box({5.35, 2.9, 4}, {0.3, 2.6, 8})}));
  worlds.back().scenario.world->max.z() = 3.3;
  worlds.back().scenario.obstacles.push_back(
      {config::BoxShape{{1, 2.9, 2.9}}, config::LinearMotion{{12, 0, 1.8}, {-1, 0, 0}, Vec3::Zero()}});
  return worlds;
}

// What swings in the door straight on never rests and never leaves it: the way is through the other one.
TEST(GuidedWorlds, WhereSomethingThatMovesIsInTheWayAnotherIsTaken) {
  Obstacles walls{box({10, -6.325, 4}, {0.2, 11.35, 8}), box({10, 3, 4}, {0.2, 4.7, 8}),
                  box({10, 9.325, 4}, {0.2, 5.35, 8})};
  GuidedWorld doors = world("two_doors", {});
  doors.scenario.map = std::move(walls);
  config::SineMotion swings;
  swings.center = {10, 0, 1.5};
  swings.amplitude = {0, 0.3, 0};
  swings.frequency_hz = {0, 0.15, 0};
  doors.scenario.obstacles.push_back({config::CylinderShape{0.4, 8.0}, swings});
  const auto flight = expect_flown_through(doors.scenario);
  EXPECT_LT(flight.flight.flight_time, 30.0);
}

// Out of a lift through a door of 1.34 m: with the margin's full width no way leads there in time, and who waits for
// one waits in the lift while the door opens five times.
TEST(GuidedWorlds, WhoWaitsForNoWayInTimeGoesOnAsSoonAsAPlanDoes) {
  constexpr std::uint64_t kSeed = 1605956742;
  config::Scenario scenario = sim::families::make_world("lift_door", kSeed);
  sim::families::set_tier(scenario, sim::families::Tier::kRealistic, kSeed);
  const auto flight = expect_flown_through(scenario, kSeed);
  EXPECT_LT(flight.flight.flight_time, 50.0);
}

class GuidedWorlds : public testing::TestWithParam<GuidedWorld> {};

TEST_P(GuidedWorlds, AreFlownThrough) {
  (void)expect_flown_through(GetParam().scenario);
}

TEST_P(GuidedWorlds, ArePlannedThrough) {
  expect_planned_through(GetParam().scenario, 2e-6);
}

INSTANTIATE_TEST_SUITE_P(Worlds, GuidedWorlds, testing::ValuesIn(guided_worlds()),
                         [](const auto& tested) { return tested.param.scenario.name; });

}  // namespace
}  // namespace jink::worlds
