// SPDX-License-Identifier: BSD-3-Clause
// Several vehicles of a scenario flown in virtual time, and how their flight is judged.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/flight/closed_loop.hpp"
#include "sim/flight/closed_loop_judge.hpp"

namespace jink::sim::flight {
namespace {

config::Settings team_settings() {
  config::Settings settings;
  settings.horizon.generations = 8;
  return settings;
}

/// Two that swap places, 12 m apart.
config::Scenario swapping() {
  config::Scenario scenario;
  scenario.name = "swapping";
  scenario.start = {0, 0, 3};
  scenario.target = {12, 0, 3};
  scenario.time_limit = 30;
  scenario.estimate.px4 = false;
  scenario.vehicles = {{scenario.target, scenario.start, "ardrone2", {}}};
  return scenario;
}

/// What the observers are told.
class Watch final : public bridge::companion::FlightObserver, public world::TruthObserver {
 public:
  void on_state(double, const bridge::vehicle::VehicleState& state) override {
    states.push_back(state.motion.value.position);
  }
  void on_event(double, std::string_view name, const std::string& detail) override {
    events.push_back(std::string(name) + ": " + detail);
  }
  void on_truth(double, std::span<const world::VehicleTruth> vehicles, const world::World&) override {
    truths.emplace_back(vehicles.begin(), vehicles.end());
  }
  [[nodiscard]] bool said(const std::string& beginning) const {
    for (const std::string& event : events) {
      if (event.starts_with(beginning)) return true;
    }
    return false;
  }

  std::vector<Vec3> states;
  std::vector<std::string> events;
  std::vector<std::vector<world::VehicleTruth>> truths;
};

ClosedLoopResult fly(const config::Scenario& scenario, Watch& watch, int threads = 1) {
  ClosedLoopOptions options;
  options.threads = threads;
  options.flight_observers = {&watch};
  options.truth_observers = {&watch};
  return fly_closed_loop(scenario, team_settings(), options);
}

TEST(ClosedLoopTeam, TwoSwapPlacesAndAreJudgedTogether) {
  Watch watch;
  const ClosedLoopResult result = fly(swapping(), watch);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_EQ(result.flight.reason, "target reached");
  ASSERT_EQ(result.vehicles.size(), 2U);
  for (const VehicleReport& vehicle : result.vehicles) {
    EXPECT_EQ(vehicle.flight.outcome, bridge::supervisor::Outcome::kReached);
    EXPECT_EQ(vehicle.flight.straight_length, 12.0);
    EXPECT_GT(vehicle.flight.path_length, 11.0);
    EXPECT_GT(vehicle.flight.plans, 10U);
    EXPECT_GT(vehicle.min_clearance, 0.2);
    EXPECT_LT(vehicle.min_clearance, 3.0);  // they passed each other
  }
  EXPECT_EQ(result.min_clearance, std::min(result.vehicles[0].min_clearance, result.vehicles[1].min_clearance));
  EXPECT_EQ(result.flight.path_length, result.vehicles[0].flight.path_length);
  EXPECT_TRUE(watch.said("team_vehicle: "));
}

TEST(ClosedLoopTeam, ObserversSeeTheFirstVehiclesFlightAndTheTruthOfAll) {
  Watch watch;
  const config::Scenario scenario = swapping();
  fly(scenario, watch);
  ASSERT_FALSE(watch.states.empty());
  EXPECT_LT((watch.states.front() - scenario.start).norm(), 0.1);
  EXPECT_LT((watch.states.back() - scenario.target).norm(), 0.6);
  ASSERT_FALSE(watch.truths.empty());
  ASSERT_EQ(watch.truths.front().size(), 2U);
  EXPECT_EQ(watch.truths.front()[1].position, scenario.vehicles[0].start);
  EXPECT_LT((watch.truths.back()[1].position - scenario.vehicles[0].target).norm(), 0.6);
}

TEST(ClosedLoopTeam, RepeatsBitByBitAtAnyThreadCount) {
  config::Scenario scenario = swapping();
  scenario.time_limit = 3.0;
  Watch one;
  Watch two;
  const ClosedLoopResult once = fly(scenario, one, 1);
  const ClosedLoopResult again = fly(scenario, two, 3);
  EXPECT_EQ(once.min_clearance, again.min_clearance);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(once.vehicles[k].flight.path_length, again.vehicles[k].flight.path_length);
  EXPECT_EQ(one.states, two.states);
}

TEST(ClosedLoopTeam, OneThatDoesNotReachSpoilsIt) {
  config::Scenario scenario = swapping();
  scenario.vehicles = {{{0, 5, 3}, {60, 5, 3}, "ardrone2", {}}};
  scenario.time_limit = 10;
  Watch watch;
  const ClosedLoopResult result = fly(scenario, watch);
  EXPECT_EQ(result.vehicles[0].flight.outcome, bridge::supervisor::Outcome::kReached);
  EXPECT_EQ(result.vehicles[1].flight.outcome, bridge::supervisor::Outcome::kTimeout);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kTimeout);
  EXPECT_TRUE(result.flight.reason.starts_with("vehicle 1: ")) << result.flight.reason;
  EXPECT_LT(result.vehicles[0].flight.flight_time, 8.0);  // counts no longer once it is there
  EXPECT_GT(result.vehicles[1].flight.flight_time, 9.0);
}

TEST(ClosedLoopTeam, AFaultBefallsTheVehicleThatItNames) {
  config::Scenario scenario = swapping();
  scenario.vehicles = {{{0, 5, 3}, {12, 5, 3}, "ardrone2", {}}};
  config::Fault pilot;
  pilot.kind = config::FaultKind::kPilotMode;
  pilot.mode = config::PilotMode::kPosition;
  pilot.at = 1.0;
  pilot.vehicle = 1;
  scenario.faults = {pilot};
  Watch watch;
  const ClosedLoopResult result = fly(scenario, watch);
  EXPECT_EQ(result.vehicles[0].flight.outcome, bridge::supervisor::Outcome::kReached);
  EXPECT_NE(result.vehicles[1].flight.outcome, bridge::supervisor::Outcome::kReached);
  EXPECT_TRUE(watch.said("fault: pilot_mode"));
}

TEST(ClosedLoopTeam, StartsThatOverlapAreBlocked) {
  config::Scenario scenario = swapping();
  scenario.vehicles[0].start = {0.5, 0, 3};
  Watch watch;
  const ClosedLoopResult result = fly(scenario, watch);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kStartBlocked);
  EXPECT_EQ(result.flight.reason, "vehicle 0: the start is inside vehicle 1; vehicle 1: the start is inside vehicle 0");
  EXPECT_NEAR(result.min_clearance, -0.1, 1e-12);
}

/// Both go straight from their starts at these velocities.
bool watched(ClosedLoopJudge& judge, const config::Scenario& scenario, const Vec3& v0, const Vec3& v1, double until) {
  for (int step = 0; 0.1 * step <= until + 1e-9; ++step) {
    const double t = 0.1 * step;
    const world::VehicleTruth now[] = {{scenario.start + t * v0, v0}, {scenario.vehicles[0].start + t * v1, v1}};
    if (judge.watch(t, now)) return true;
  }
  return false;
}

// 12 m apart, 0.6 m together in radii, closing at 4 m/s: at 2.85 s.
TEST(ClosedLoopJudge, VehiclesThatMeetHaveBothHit) {
  const world::World world(swapping());
  ClosedLoopJudge judge(world);
  EXPECT_TRUE(watched(judge, world.scenario(), {2, 0, 0}, {-2, 0, 0}, 5.0));
  EXPECT_TRUE(judge.ended());
  const ClosedLoopResult result = judge.result({{}, {}});
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kCollision);
  EXPECT_TRUE(result.vehicles[0].flight.reason.starts_with("hit vehicle 1 at t = 2.9")) << result.flight.reason;
  EXPECT_TRUE(result.vehicles[1].flight.reason.starts_with("hit vehicle 0 at t = 2.9"));
  EXPECT_LT(result.min_clearance, 0.0);
}

TEST(ClosedLoopJudge, PassingAtAMetreIsNotedButNotAHit) {
  config::Scenario scenario = swapping();
  scenario.vehicles[0].start.y() = 1.6;
  const world::World world(scenario);
  ClosedLoopJudge judge(world);
  EXPECT_FALSE(watched(judge, scenario, {2, 0, 0}, {-2, 0, 0}, 5.0));
  EXPECT_NEAR(judge.result({{}, {}}).min_clearance, 1.0, 1e-9);
}

TEST(ClosedLoopJudge, WhoIsDoneCanStillBeHit) {
  const world::World world(swapping());
  ClosedLoopJudge judge(world);
  judge.close(0);
  EXPECT_TRUE(watched(judge, world.scenario(), Vec3::Zero(), {-2, 0, 0}, 8.0));
  const ClosedLoopResult result = judge.result({{}, {}});
  EXPECT_EQ(result.vehicles[0].flight.flight_time, 0.0);
  EXPECT_EQ(result.vehicles[0].flight.outcome, bridge::supervisor::Outcome::kCollision);
  EXPECT_NEAR(result.vehicles[1].flight.path_length, 11.4, 0.21);  // to the contact, and a step at most
}

TEST(ClosedLoopJudge, OneThatLeavesTheWorldEndsIt) {
  config::Scenario scenario = swapping();
  scenario.world = planner::base::Box{{-1, -1, 0}, {13, 1, 5}};
  const world::World world(scenario);
  ClosedLoopJudge judge(world);
  EXPECT_TRUE(watched(judge, scenario, Vec3::Zero(), {0, 1, 0}, 5.0));
  const ClosedLoopResult result = judge.result({{}, {}});
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kLeftWorld);
  EXPECT_EQ(result.flight.reason, "vehicle 1: left the world at t = 1.100000 s");
}

}  // namespace
}  // namespace jink::sim::flight
