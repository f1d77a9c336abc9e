// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/simulator_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "tests/sim/examples.hpp"

namespace jink::sim::flight {
namespace {

constexpr double kRadius = 0.3;

config::ScenarioVehicle vehicle(const Vec3& start, const Vec3& target) {
  config::ScenarioVehicle v{start, target, "inline", {}};
  v.vehicle.radius = kRadius;
  return v;
}

world::World world_with(std::vector<config::Obstacle> obstacles,
                        std::optional<planner::base::Box> volume = std::nullopt) {
  config::Scenario scenario;
  scenario.obstacles = std::move(obstacles);
  scenario.world = std::move(volume);
  return world::World(std::move(scenario));
}

JudgedVehicle at(const Vec3& position, bool offboard = true) {
  return {position, Vec3::Zero(), offboard};
}

TEST(SweepOfSpheres, FindsTheClosestApproachBetweenTwoSteps) {
  // They swap places within one step and are 1 m apart half way; at both ends they are 10 m apart.
  const world::SweepResult result = world::sweep({{0, 0, 0}, {10, 0, 0}, 0.3}, {{10, 1, 0}, {0, 1, 0}, 0.2}, 2.0, 4.0);
  EXPECT_NEAR(result.min_clearance, 0.5, 1e-12);
  EXPECT_NEAR(result.t_min, 3.0, 1e-12);
}

TEST(SweepOfSpheres, TakesTheEndsWhereTheyPartOrStand) {
  EXPECT_NEAR(world::sweep({{0, 0, 0}, {-1, 0, 0}, 0.1}, {{2, 0, 0}, {3, 0, 0}, 0.1}, 1, 2).min_clearance, 1.8, 1e-12);
  EXPECT_NEAR(world::sweep({{0, 0, 0}, {-1, 0, 0}, 0.1}, {{2, 0, 0}, {3, 0, 0}, 0.1}, 1, 2).t_min, 1.0, 1e-12);
  EXPECT_NEAR(world::sweep({{0, 0, 0}, {0, 0, 0}, 0.5}, {{0.4, 0, 0}, {0.4, 0, 0}, 0.5}, 1, 2).min_clearance, -0.6,
              1e-12);
}

TEST(SimulatorJudge, VehiclesThatMeetWithinAStepHaveHitEachOther) {
  const world::World world = world_with({});
  const std::vector<Vec3> begin{{0, 0, 1}, {10, 0, 1}, {0, 5, 1}};
  SimulatorJudge judge(world, {vehicle(begin[0], begin[1]), vehicle(begin[1], begin[0]), vehicle(begin[2], {9, 9, 9})},
                       begin);
  const std::vector<JudgedVehicle> now{at({10, 0, 1}), at({0, 0, 1}), at({0, 5, 1})};
  const std::vector<Verdict> verdicts = judge.watch(0.0, false, now);
  ASSERT_EQ(verdicts.size(), 2U);
  EXPECT_EQ(verdicts[0].vehicle, 0);
  EXPECT_EQ(verdicts[0].outcome, bridge::supervisor::Outcome::kCollision);
  EXPECT_EQ(verdicts[0].reason, "hit vehicle 1 at t = 0.00 s");
  EXPECT_EQ(verdicts[1].vehicle, 1);
  EXPECT_EQ(verdicts[1].reason, "hit vehicle 0 at t = 0.00 s");
  EXPECT_NEAR(judge.reports()[0].min_clearance, -2 * kRadius, 1e-12);
  EXPECT_NEAR(judge.reports()[2].min_clearance, 5.0 - 2 * kRadius, 1e-12);
  EXPECT_FALSE(judge.reports()[2].failed());
  EXPECT_EQ(worst(judge.reports()), bridge::supervisor::Outcome::kCollision);
  // Once is enough.
  EXPECT_TRUE(judge.watch(1.0, false, now).empty());
}

TEST(SimulatorJudge, AWreckCanStillBeHitByAnother) {
  const world::World world = world_with({ball(0.5, {0, 0, 0})});
  const std::vector<Vec3> begin{{2, 0, 0}, {2, 4, 0}};
  SimulatorJudge judge(world, {vehicle(begin[0], {9, 0, 0}), vehicle(begin[1], {9, 0, 0})}, begin);
  std::vector<JudgedVehicle> now{at({0.7, 0, 0}), at({2, 4, 0})};
  std::vector<Verdict> verdicts = judge.watch(0.1, true, now);
  ASSERT_EQ(verdicts.size(), 1U);
  EXPECT_EQ(verdicts[0].reason.find("hit obstacle 1 at t = "), 0U) << verdicts[0].reason;
  now[1] = at({0.7, 0.5, 0});
  verdicts = judge.watch(0.2, true, now);
  ASSERT_EQ(verdicts.size(), 1U);
  EXPECT_EQ(verdicts[0].vehicle, 1);
  EXPECT_EQ(verdicts[0].reason.find("hit vehicle 0"), 0U) << verdicts[0].reason;
}

TEST(SimulatorJudge, UsesEachVehiclesOwnRadius) {
  const world::World world = world_with({ball(0.5, {0, 0, 0})});
  config::ScenarioVehicle big = vehicle({1.2, 0, 0}, {9, 0, 0});
  big.vehicle.radius = 0.8;
  const std::vector<Vec3> begin{{0, 1.2, 0}, big.start};
  SimulatorJudge judge(world, {vehicle(begin[0], {9, 0, 0}), big}, begin);
  const std::vector<JudgedVehicle> now{at(begin[0]), at(begin[1])};
  const std::vector<Verdict> verdicts = judge.watch(0.0, false, now);
  ASSERT_EQ(verdicts.size(), 1U);
  EXPECT_EQ(verdicts[0].vehicle, 1);
  EXPECT_NEAR(judge.reports()[0].min_clearance, 0.4, 1e-9);
  EXPECT_NEAR(judge.reports()[1].min_clearance, -0.1, 1e-9);
}

TEST(SimulatorJudge, CountsProgressOnlyWhileTheClockRuns) {
  const world::World world = world_with({}, planner::base::Box{{-5, -5, 0}, {5, 5, 5}});
  const std::vector<Vec3> begin{{0, 0, 1}};
  SimulatorJudge judge(world, {vehicle(begin[0], {3, 0, 1})}, begin);
  EXPECT_TRUE(judge.watch(0.0, false, std::vector{at({3, 0, 1})}).empty());  // at the target, but too early
  EXPECT_TRUE(judge.watch(1.0, true, std::vector{at({1, 0, 1})}).empty());
  const std::vector<Verdict> verdicts = judge.watch(2.0, true, std::vector{at({2.6, 0, 1})});
  ASSERT_EQ(verdicts.size(), 1U);
  EXPECT_EQ(verdicts[0].outcome, bridge::supervisor::Outcome::kReached);
  EXPECT_NEAR(judge.reports()[0].flight.path_length, 3.6, 1e-12);
  EXPECT_EQ(judge.reports()[0].flight.flight_time, 2.0);
  EXPECT_EQ(judge.reports()[0].flight.straight_length, 3.0);
}

TEST(SimulatorJudge, LeavingTheWorldCountsInOffboardAlone) {
  const world::World world = world_with({}, planner::base::Box{{-5, -5, 0}, {5, 5, 5}});
  const std::vector<Vec3> begin{{0, 0, 1}, {0, 3, 1}};
  SimulatorJudge judge(world, {vehicle(begin[0], {3, 0, 1}), vehicle(begin[1], {3, 3, 1})}, begin);
  const std::vector<Verdict> verdicts = judge.watch(1.0, true, std::vector{at({0, 0, 6}, false), at({0, 3, 6})});
  ASSERT_EQ(verdicts.size(), 1U);
  EXPECT_EQ(verdicts[0].vehicle, 1);
  EXPECT_EQ(verdicts[0].outcome, bridge::supervisor::Outcome::kLeftWorld);
}

TEST(SimulatorJudge, TheWorstOutcomeIsTheTeams) {
  const auto of = [](std::initializer_list<bridge::supervisor::Outcome> outcomes) {
    std::vector<VehicleReport> reports;
    for (const bridge::supervisor::Outcome outcome : outcomes) reports.emplace_back().flight.outcome = outcome;
    return worst(reports);
  };
  using bridge::supervisor::Outcome;
  EXPECT_EQ(of({Outcome::kReached, Outcome::kReached}), Outcome::kReached);
  EXPECT_EQ(of({Outcome::kReached, Outcome::kAborted}), Outcome::kAborted);
  EXPECT_EQ(of({Outcome::kLeftWorld, Outcome::kAborted}), Outcome::kLeftWorld);
  EXPECT_EQ(of({Outcome::kLeftWorld, Outcome::kCollision, Outcome::kReached}), Outcome::kCollision);
}

}  // namespace
}  // namespace jink::sim::flight
