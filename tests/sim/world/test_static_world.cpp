// SPDX-License-Identifier: BSD-3-Clause
// A world with a map: its solids are hit, and are not sensed.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "planner/base/random.hpp"
#include "sim/world/known_world.hpp"
#include "sim/world/sensing.hpp"
#include "sim/world/world.hpp"
#include "tests/sim/examples.hpp"

namespace jink::sim::world {
namespace {

using planner::base::RandomStream;

Vec3 anywhere(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

std::vector<config::Obstacle> solids(int count, RandomStream& random) {
  std::vector<config::Obstacle> all;
  for (int i = 0; i < count; ++i) {
    const Vec3 edges = anywhere(random, 2).cwiseAbs().array() + 0.1;
    all.push_back({config::BoxShape{edges}, config::LinearMotion{anywhere(random, 20)}});
    config::Obstacle& solid = all.back();
    if (i % 3 == 0) solid.shape = config::SphereShape{edges.x()};
    if (i % 3 == 1) solid.orientation = anywhere(random, 1);
  }
  return all;
}

TEST(StaticWorld, TheMapIsKnownAndNotSensed) {
  config::Scenario scenario;
  scenario.obstacles = {ball(0.5, {3, 0, 0})};
  scenario.map = {ball(1.0, {5, 0, 0}), {config::BoxShape{{1, 1, 1}}, config::LinearMotion{{9, 0, 0}}}};
  const World world(scenario);
  EXPECT_EQ(world.obstacle_count(), 1);
  EXPECT_EQ(measure(world, {}, 1, 0, 0.0, Vec3::Zero()).size(), 1U);
  ASSERT_EQ(world.map()->tracks().size(), 2U);
  EXPECT_EQ(world.map()->tracks()[1].id, planner::geometry::StaticMap::kFirstId + 1);
  EXPECT_EQ(world.name(0), "obstacle 1");
  EXPECT_EQ(world.name(2), "map solid 2");
  const KnownWorld known(scenario);
  EXPECT_EQ(known.tracks.size(), 1U);
  EXPECT_EQ(known.open_loop.map->tracks().size(), 2U);
}

TEST(StaticWorld, TheJudgeSeesWhatItWouldSeeOfObstaclesThatStandThere) {
  RandomStream random(2);
  config::Scenario mapped;
  mapped.obstacles = {ball(0.5, {3, -9, 0}, {0, 3, 0})};
  mapped.map = solids(200, random);
  config::Scenario sensed = mapped;
  sensed.obstacles.insert(sensed.obstacles.end(), mapped.map.begin(), mapped.map.end());
  sensed.map.clear();
  const World world(mapped);
  const World other(sensed);
  int hits = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3 from = anywhere(random, 22);
    const Vec3 to = from + anywhere(random, 3);
    const double t = random.uniform(0, 5);
    EXPECT_EQ(world.clearance(from, t), other.clearance(from, t));
    const SweepResult here = world.sweep(from, t, to, t + 0.5);
    const SweepResult there = other.sweep(from, t, to, t + 0.5);
    EXPECT_NEAR(here.min_clearance, there.min_clearance, World::kSweepTolerance);
    if (here.min_clearance < 0.0) ++hits;
  }
  EXPECT_GT(hits, 20);
}

}  // namespace
}  // namespace jink::sim::world
