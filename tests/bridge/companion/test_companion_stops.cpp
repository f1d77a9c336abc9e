// SPDX-License-Identifier: BSD-3-Clause
// What a vehicle that does not fly on, not yet or no more, does about what comes: stops, hand-overs, take-off, landing.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

planner::base::Track ball(const Vec3& position, const Vec3& velocity) {
  planner::base::Track track;
  track.id = 1;
  track.position = position;
  track.velocity = velocity;
  track.radius = 0.5;
  return track;
}

/// With a ball that flies on evenly, told as long as there are tracks.
struct Crossed : Loop {
  using Loop::Loop;
  void meet(double seconds, const Vec3& place, const Vec3& velocity) {
    mover = ball(place - seconds * velocity, velocity);
    mover_at = now;
  }
  void fly_on(double seconds) {
    for (const double end = now + seconds; now < end - 1e-9;) {
      const Vec3 place = mover.position + (now - mover_at) * mover.velocity;
      seen = {ball(place, mover.velocity)};
      const bool on = turn();
      clearance = std::min(clearance, (link.telemetry.motion.value.position - place).norm() - 0.5 - 0.3);
      if (!on) return;
    }
  }
  planner::base::Track mover;
  double mover_at = 0.0;
  double clearance = planner::base::kInfinity;
};

// At 2 m/s it stops within 1 m.
TEST(CompanionStops, WithoutAPlannerItGetsOutOfTheWayOfWhatComes) {
  for (const Vec3& velocity : {Vec3(-2, 0, 0), Vec3(0, 2, 0), Vec3(0, -1, 0), Vec3(-1, 1, 0)}) {
    SCOPED_TRACE(velocity.transpose());
    Crossed loop;
    loop.airborne().fly();
    loop.run(1.0);
    loop.planner.silent = true;
    loop.meet(3.0, loop.last().position + Vec3(1.8, 0, 0), velocity);
    loop.fly_on(3.2);
    EXPECT_EQ(loop.companion.supervisor().hazard(), "the planner is late");
    EXPECT_GE(loop.clearance, 0.3);
    EXPECT_GE(loop.recorder.count("evades"), 1);
  }
}

TEST(CompanionStops, WhatTurnsUpWhileItStandsIsEvadedToo) {
  Crossed loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.planner.silent = true;
  loop.run(2.0);
  EXPECT_EQ(loop.recorder.count("evades"), 0);
  loop.meet(1.5, loop.last().position, {0, 2, 0});
  loop.fly_on(2.5);
  EXPECT_EQ(loop.recorder.count("evades"), 1);
  EXPECT_GE(loop.clearance, 0.3);
}

// What it was told last goes on, as far as anybody knows.
TEST(CompanionStops, WithoutTracksItEvadesWhatItSawLast) {
  Crossed loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.planner.silent = true;
  loop.meet(3.5, loop.last().position + Vec3(1.8, 0, 0), {0, 1.5, 0});
  loop.fly_on(0.2);
  loop.tracks = false;
  loop.fly_on(4.0);
  EXPECT_GE(loop.clearance, 0.3);
}

TEST(CompanionStops, PlansToWhereItStopsAreFlownWhileTheHazardLasts) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.tracks = false;
  loop.run(1.5);
  ASSERT_EQ(loop.companion.supervisor().hazard(), "the obstacle tracks are stale");
  const Vec3 stop = loop.planner.jobs.back().request.target;
  EXPECT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kStop);
  EXPECT_FALSE(loop.planner.jobs.back().request.visit);
  EXPECT_TRUE(loop.planner.jobs.back().request.holds);
  EXPECT_LT(stop.x(), 8.0);
  loop.run(1.0);
  EXPECT_LT((loop.last().position - stop).norm(), 0.05);
  EXPECT_EQ(loop.planner.jobs.back().request.target, stop);
  loop.tracks = true;
  loop.run(0.3);
  EXPECT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kWaypoint);
  EXPECT_GT(loop.last().velocity.x(), 1.0);
}

TEST(CompanionStops, APlanForSomethingElseIsNotFlown) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.planner.takes = 0.2;
  while (!loop.planner.busy()) loop.turn();
  loop.companion.interrupt(loop.now);
  const double x = loop.last().position.x();
  loop.run(2.0);
  EXPECT_LT(loop.last().position.x(), x + 1.3);  // the plan to the waypoint came 0.2 s later
  EXPECT_LT(loop.last().velocity.norm(), 0.5);   // at rest, and handed over
  EXPECT_TRUE(loop.companion.supervisor().done());
}

TEST(CompanionStops, PlansGoOnUntilHoldIsThere) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.obeys = false;
  loop.companion.interrupt(loop.now);
  loop.run(2.5);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kHandover);
  const std::size_t plans = loop.planner.jobs.size();
  loop.run(0.5);
  EXPECT_GE(loop.planner.jobs.size(), plans + 4);
  EXPECT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kStop);
}

// A link that was silent while the vehicle flew on, to where nobody wanted it.
TEST(CompanionStops, AfterASilenceItStopsWhereItIs) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.positions = loop.heartbeats = loop.obeys = loop.follows = false;
  loop.run(2.8);
  ASSERT_EQ(loop.companion.supervisor().hazard(), "the vehicle's position is stale");
  vehicle::VehicleState& state = loop.link.telemetry;
  state.motion.value.position = loop.last().position + Vec3(9, 0, 0);
  state.motion.value.velocity = {1, 0, 0};
  loop.positions = true;
  for (int i = 0; i < 10; ++i) {
    loop.turn();
    EXPECT_NEAR(loop.last().position.x(), state.motion.value.position.x(), 0.5) << i;
  }
  loop.companion.interrupt(loop.now);
  loop.run(1.0);
  EXPECT_NEAR(loop.last().position.x(), state.motion.value.position.x(), 0.5);
}

TEST(CompanionStops, ATakeOffWaitsForFreeAir) {
  Crossed loop;
  loop.follows = false;
  loop.mover = ball({0, 0, 3}, Vec3::Zero());
  loop.fly_on(5.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kWaiting);
  EXPECT_EQ(loop.companion.supervisor().waiting_for(), "the air above the vehicle to be free of obstacles");
  EXPECT_TRUE(loop.link.requests.empty());
  loop.meet(3.0, {0, 0, 1}, {2, 0, 0});  // passes
  loop.fly_on(2.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kWaiting);
  loop.fly_on(3.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
}

// It asked for OFFBOARD on free air; what comes since then is waited for as well.
TEST(CompanionStops, WhatComesBeforeArmingIsWaitedFor) {
  Crossed loop;
  loop.follows = loop.obeys = false;
  loop.mover = ball({20, 0, 2}, Vec3::Zero());
  loop.fly_on(1.0);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kEngaging);
  loop.mover = ball({0.5, 0, 1.5}, Vec3::Zero());
  loop.fly_on(0.5);
  loop.obeys = true;
  loop.fly_on(1.0);
  EXPECT_EQ(loop.link.telemetry.mode, vehicle::FlightMode::kOffboard);
  EXPECT_FALSE(loop.link.telemetry.armed);
  loop.mover = ball({20, 0, 2}, Vec3::Zero());
  loop.fly_on(1.0);
  EXPECT_TRUE(loop.link.telemetry.armed);
}

// A tracker sees the vehicle where it stands, which is no reason to stay there.
TEST(CompanionStops, ItsOwnTrackKeepsNoTakeOff) {
  Crossed loop;
  loop.mover = ball({0.1, 0, 0.1}, Vec3::Zero());
  loop.mover.radius = 0.3;
  loop.fly_on(1.0);
  EXPECT_TRUE(loop.link.telemetry.armed);
}

// It is armed, and a setpoint above it would lift it.
TEST(CompanionStops, OnTheGroundNothingIsEvaded) {
  Crossed loop;
  loop.follows = false;
  loop.mover = ball({20, 0, 2}, Vec3::Zero());
  loop.fly_on(0.5);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  loop.meet(1.0, {0, 0, 0.2}, {2, 0, 0});
  loop.obeys = false;
  loop.companion.interrupt(loop.now);
  const std::size_t sent = loop.link.sent.size();
  loop.fly_on(2.0);
  ASSERT_GT(loop.link.sent.size(), sent + 20);
  for (std::size_t i = sent; i < loop.link.sent.size(); ++i)
    EXPECT_LT(loop.link.sent[i].position.norm(), 0.01) << loop.link.sent[i].position.transpose();
}

// The autopilot's landing looks at no obstacles: as much of the way down as can be is flown by plans.
TEST(CompanionStops, LandingComesDownByPlansFirst) {
  config::Mission mission = Loop::mission();
  mission.waypoints = {{4, 0, 6}};
  mission.arrival = config::Arrival::kLand;
  Loop loop(mission);
  loop.airborne({0, 0, 6}).fly();
  while (loop.link.requests.back() != vehicle::Command::kLand && loop.now < 20.0) loop.turn();
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
  EXPECT_NEAR(loop.link.telemetry.motion.value.position.z(), 1.0, 0.31);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(4, 0, 1));
  EXPECT_EQ(loop.recorder.last("arrived"), "going down as far as plans lead, to land where it stays free");
  EXPECT_EQ(loop.companion.supervisor().reason(), "target reached");
  EXPECT_LT(loop.companion.summary().flight_time, 3.0);  // to the target; not the way down
}

// It sinks from where it is at once, though the plan that ends there has seconds to go.
TEST(CompanionStops, LandsBehindWhatPassesBelowBeforeThePlanEnds) {
  config::Mission mission = Loop::mission();
  mission.waypoints = {{3, 0, 2}};
  mission.min_height = 2.0;  // no plan leads further down
  mission.arrival = config::Arrival::kLand;
  Crossed loop(mission);
  loop.planner.speed = 0.5;
  loop.planner.stays = 5.5;
  loop.meet(8.5, {3, 0, 0.8}, {0, 1.5, 0});
  loop.airborne();
  loop.fly_on(8.0);
  EXPECT_NEAR(loop.link.telemetry.motion.value.position.x(), 3.0, 0.3);
  EXPECT_NE(loop.link.requests.back(), vehicle::Command::kLand);
  loop.fly_on(4.0);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
}

TEST(CompanionStops, AWaypointLowEnoughIsLandedFromAtOnce) {
  config::Mission mission = Loop::mission();
  mission.waypoints = {{4, 0, 1}};
  mission.arrival = config::Arrival::kLand;
  Loop loop(mission);
  loop.airborne({0, 0, 1}).fly();
  while (loop.link.requests.back() != vehicle::Command::kLand && loop.now < 20.0) loop.turn();
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
  EXPECT_EQ(loop.recorder.count("arrived"), 0);
}

}  // namespace
}  // namespace jink::bridge::companion
