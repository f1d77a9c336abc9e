// SPDX-License-Identifier: BSD-3-Clause
// Things as they are: worlds of houses, doors, trunks and wires, which nobody passes who takes them for balls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "tests/worlds/way_through.hpp"

namespace jink::worlds {
namespace {

config::Scenario street(std::string name, std::vector<config::Obstacle> obstacles) {
  config::Scenario scenario;
  scenario.name = std::move(name);
  scenario.start = {0, 0, 1.5};
  scenario.target = {20, 0, 1.5};
  scenario.world = planner::base::Box{{-2, -12, 0.3}, {22, 12, 8}};
  scenario.time_limit = 30;
  scenario.estimate.px4 = false;
  scenario.obstacles = std::move(obstacles);
  return scenario;
}

/// Trunks of 0.3 to 0.8 m, 2.4 m apart at least, higher than the world.
std::vector<config::Obstacle> trunks() {
  planner::base::RandomStream random(3);
  std::vector<config::Obstacle> forest;
  std::vector<Vec3> places;
  for (int n = 0; n < 2000; ++n) {
    const double x = random.uniform(2.5, 17.5);
    const Vec3 place(x, random.uniform(-11, 11), 4);
    bool apart = true;
    for (const Vec3& other : places) apart = apart && (other - place).norm() > 2.8;
    if (!apart) continue;
    places.push_back(place);
    forest.push_back({config::CylinderShape{random.uniform(0.15, 0.4), 10}, config::LinearMotion{place}});
  }
  return forest;
}

struct SolidWorld {
  config::Scenario scenario;

  friend std::ostream& operator<<(std::ostream& out, const SolidWorld& world) { return out << world.scenario.name; }
};

std::vector<SolidWorld> solid_worlds() {
  std::vector<SolidWorld> worlds;
  // A house across the street, whose ball would be from wall to wall of the world.
  worlds.push_back({street("house", {{config::BoxShape{{6, 10, 12}}, config::LinearMotion{{10, 1, 4}}}})});
  // Turned, so that its walls are along nothing.
  worlds.push_back(
      {street("turned_house", {{config::BoxShape{{9, 6, 12}}, config::LinearMotion{{10, -1, 4}}, {0.6, 0, 0}}})});
  // A truck of 8 m crosses at 5 m/s.
  worlds.push_back(
      {street("truck", {{config::BoxShape{{2.5, 8, 3.5}}, config::LinearMotion{{10, -15, 1.75}, {0, 5, 0}}}})});
  worlds.push_back({street("forest", trunks())});
  // A wall with a gate of 2 m, whose halves' balls overlap.
  worlds.push_back({street("gate", {{config::BoxShape{{0.3, 11, 10}}, config::LinearMotion{{10, -6.5, 4}}},
                                    {config::BoxShape{{0.3, 11, 10}}, config::LinearMotion{{10, 6.5, 4}}}})});
  // Three wires across, one above the other, 2 m apart.
  std::vector<config::Obstacle> wires;
  for (const double z : {1.5, 3.5, 5.5})
    wires.push_back({config::CapsuleShape{0.01, {0, -12, 0}, {0, 12, 0}}, config::LinearMotion{{9, 0, z}}});
  worlds.push_back({street("wires", std::move(wires))});
  // A revolving door: a plank of 5 m that turns in a corridor.
  config::Obstacle plank{config::BoxShape{{5, 0.2, 10}}, config::LinearMotion{{10, 0, 4}}};
  plank.yaw_rate = 0.7;
  SolidWorld turning{street("plank", {plank})};
  turning.scenario.world = planner::base::Box{{-2, -5, 0.3}, {22, 5, 4}};
  worlds.push_back(turning);
  // A tent.
  worlds.push_back(
      {street("tent", {{config::VertexShape{{{-3, -6, 0}, {3, -6, 0}, {3, 6, 0}, {-3, 6, 0}, {0, -6, 5}, {0, 6, 5}}},
                        config::LinearMotion{{10, 0, 0}}}})});
  return worlds;
}

class SolidWorlds : public testing::TestWithParam<SolidWorld> {};

TEST_P(SolidWorlds, AreFlownThrough) {
  (void)expect_flown_through(GetParam().scenario);
}

TEST_P(SolidWorlds, ArePlannedThrough) {
  expect_planned_through(GetParam().scenario, 2e-6);
}

INSTANTIATE_TEST_SUITE_P(Worlds, SolidWorlds, testing::ValuesIn(solid_worlds()),
                         [](const auto& tested) { return tested.param.scenario.name; });

}  // namespace
}  // namespace jink::worlds
