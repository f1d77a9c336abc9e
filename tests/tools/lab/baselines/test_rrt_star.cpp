// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/rrt_star.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "tests/tools/lab/baselines/baseline_testing.hpp"

namespace jink::tools::lab::baselines {
namespace {

/// Spheres that close x = 6 from y = -2.4 to 2.4 and over all heights.
std::vector<planner::base::Track> wall() {
  std::vector<planner::base::Track> spheres;
  for (double y = -2.4; y <= 2.41; y += 0.8) {
    for (double z = 0.0; z <= 6.0; z += 0.8) spheres.push_back(ball(0.6, {6, y, z}));
  }
  return spheres;
}

bridge::companion::PlanJob behind_the_wall() {
  bridge::companion::PlanJob asked = job({0, 0, 2}, {11, 0, 2}, wall());
  asked.request.volume = {{-2, -7, 0.5}, {14, 7, 5}};
  return asked;
}

void expect_same(const std::vector<SpaceTime>& a, const std::vector<SpaceTime>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].t, b[i].t);
    EXPECT_EQ(a[i].position, b[i].position);
  }
}

SpaceTimeProblem search_problem(const std::vector<planner::base::Track>& spheres) {
  SpaceTimeProblem problem;
  problem.start = {0, 0, 2};
  problem.goal = {11, 0, 2};
  problem.region = {{-2, -7, 0.5}, {14, 7, 5}};
  problem.spheres = spheres;
  return problem;
}

std::vector<SpaceTime> search(std::uint64_t seed) {
  std::vector<planner::base::Track> spheres = wall();
  for (planner::base::Track& sphere : spheres) sphere.radius += 0.65;
  return search_space_time(search_problem(spheres), {}, {}, seed, 0);
}

TEST(SpaceTimeEdge, IsFreeOnlyForwardInTimeAndWithinTheLimits) {
  const SpaceTimeProblem problem = search_problem({});
  EXPECT_TRUE(is_free(problem, {0.0, {0, 0, 2}}, {1.0, {2.9, 0, 2}}));
  EXPECT_FALSE(is_free(problem, {0.0, {0, 0, 2}}, {1.0, {3.1, 0, 2}}));
  EXPECT_FALSE(is_free(problem, {0.0, {0, 0, 2}}, {1.0, {0, 0, 4.1}}));
  EXPECT_FALSE(is_free(problem, {1.0, {0, 0, 2}}, {0.0, {1, 0, 2}}));
  EXPECT_FALSE(is_free(problem, {0.0, {0, 0, 2}}, {9.0, {0, 9, 2}}));
}

// A sphere crosses x = 3 at t = 1: whoever is there then meets it, and a second later does not.
TEST(SpaceTimeEdge, MeetsASphereOnlyWhenItIsThere) {
  const std::vector<planner::base::Track> spheres{ball(0.5, {3, -2, 2}, {0, 2, 0})};
  const SpaceTimeProblem problem = search_problem(spheres);
  EXPECT_FALSE(is_free(problem, {0.5, {1.5, 0, 2}}, {1.5, {4.5, 0, 2}}));
  EXPECT_TRUE(is_free(problem, {1.5, {1.5, 0, 2}}, {2.5, {4.5, 0, 2}}));
}

TEST(SpaceTimeSearch, GoesRoundAWall) {
  std::vector<planner::base::Track> spheres = wall();
  for (planner::base::Track& sphere : spheres) sphere.radius += 0.65;
  const SpaceTimeProblem problem = search_problem(spheres);
  const std::vector<SpaceTime> way = search_space_time(problem, {}, {}, 1, 0);
  ASSERT_GE(way.size(), 3U);
  EXPECT_LE((way.back().position - problem.goal).norm(), problem.tolerance);
  for (std::size_t i = 1; i < way.size(); ++i) EXPECT_TRUE(is_free(problem, way[i - 1], way[i]));
}

TEST(SpaceTimeSearch, DependsOnTheSeedAlone) {
  expect_same(search(1), search(1));
  EXPECT_NE(search(1).at(1).position, search(2).at(1).position);
}

// OMPL's own generators take their seeds from one that all threads share.
TEST(SpaceTimeSearch, GivesTheSameBitsBesideOthers) {
  constexpr std::uint64_t kSeeds = 8;
  std::vector<std::vector<SpaceTime>> alone;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) alone.push_back(search(seed));
  std::vector<std::vector<SpaceTime>> together(kSeeds);
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
      threads.emplace_back([&, seed] { together[seed] = search(seed); });
  }
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) expect_same(alone[seed], together[seed]);
}

TEST(Shorten, CutsCornersAndLeavesWaitsOut) {
  const SpaceTimeProblem problem = search_problem({});
  std::vector<SpaceTime> way{{0.0, {0, 0, 2}}, {2.0, {3, 2, 2}}, {4.0, {3, 2, 2}}, {8.0, {9, 0, 2}}};
  shorten(problem, way);
  ASSERT_EQ(way.size(), 2U);
  EXPECT_NEAR(way.back().t, 3.0, 1e-6);
}

TEST(Shorten, WaitsForWhatCrosses) {
  const std::vector<planner::base::Track> spheres{ball(1.5, {6, -4, 2}, {0, 2, 0})};
  const SpaceTimeProblem problem = search_problem(spheres);
  std::vector<SpaceTime> way{{0.0, {0, 0, 2}}, {4.0, {2, 0, 2}}, {7.0, {11, 0, 2}}};
  ASSERT_FALSE(is_free(problem, way[0], {11.0 / 3.0, {11, 0, 2}}));
  shorten(problem, way);
  for (std::size_t i = 1; i < way.size(); ++i) EXPECT_TRUE(is_free(problem, way[i - 1], way[i]));
}

TEST(RrtPilot, FliesRoundAWallOfSpheres) {
  RrtPilot pilot({});
  const bridge::companion::PlanJob asked = behind_the_wall();
  const planner::verify::Plan made = plan(pilot, asked);
  EXPECT_EQ(made.status, planner::verify::PlanStatus::kReaches);
  EXPECT_LT((made.path.back().position - asked.request.target).norm(), 1e-9);
  const planner::verify::Verification kept =
      planner::verify::verify({made.path, asked.tracks, 0.0, asked.request.vehicle.radius, asked.request.volume});
  EXPECT_TRUE(kept.free());
  EXPECT_GE(kept.min_clearance, asked.request.margin);
  const planner::base::VehicleLimits limits;
  for (std::size_t i = 1; i < made.path.size(); ++i) {
    const double dt = made.path[i].t - made.path[i - 1].t;
    EXPECT_LE((made.path[i].position - made.path[i - 1].position).norm() / dt, limits.max_speed + 1e-6);
    EXPECT_LE((made.path[i].velocity - made.path[i - 1].velocity).norm() / dt, limits.max_acceleration + 1e-6);
  }
}

TEST(RrtPilot, KeepsThePlanThatIsFree) {
  RrtPilot pilot({});
  bridge::companion::PlanJob asked = behind_the_wall();
  asked.previous = plan(pilot, asked).path;
  asked.number = 1;
  const planner::verify::Plan made = plan(pilot, asked);
  EXPECT_TRUE(made.status == planner::verify::PlanStatus::kReaches);
  EXPECT_LE(made.path.back().t, 1.05 * asked.previous.back().t);
}

TEST(RrtPilot, StopsHardWhereThereIsNoWay) {
  RrtPilot pilot({});
  // A closed wall 2.5 m ahead, and flying at 3 m/s.
  std::vector<planner::base::Track> spheres;
  for (double y = -3.0; y <= 3.01; y += 0.6) {
    for (double z = 0.0; z <= 5.0; z += 0.6) spheres.push_back(ball(0.6, {3.4, y, z}));
  }
  bridge::companion::PlanJob asked = job({0, 0, 2}, {11, 0, 2}, spheres, {3, 0, 0});
  asked.request.volume = {{-2, -3, 0.5}, {14, 3, 4}};
  const planner::verify::Plan made = plan(pilot, asked);
  EXPECT_TRUE(made.verification.free());
  EXPECT_LT(made.path.back().position.x(), 2.8);
}

}  // namespace
}  // namespace jink::tools::lab::baselines
