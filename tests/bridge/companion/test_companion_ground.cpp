// SPDX-License-Identifier: BSD-3-Clause
// The loop near the ground: before it leaves it, and where it comes down again.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

// What it plans on the ground is not flown.
TEST(CompanionGround, ThePlannerShowsThatItPlansBeforeAnythingIsArmed) {
  Loop loop;
  loop.planner.silent = true;
  loop.run(3.0);
  EXPECT_EQ(loop.link.telemetry.mode, vehicle::FlightMode::kOffboard);
  EXPECT_FALSE(loop.link.telemetry.armed);
  EXPECT_EQ(loop.companion.supervisor().waiting_for(), "the planner to plan");
  ASSERT_EQ(loop.planner.jobs.size(), 1U);
  EXPECT_EQ(loop.planner.jobs[0].goal, Goal::Kind::kClimb);
  EXPECT_EQ(loop.planner.jobs[0].request.target, Vec3(0, 0, 2));
  for (const vehicle::Setpoint& sent : loop.link.sent) EXPECT_TRUE(sent.velocity.isZero());
  loop.planner.silent = false;
  loop.run(1.0);
  EXPECT_TRUE(loop.link.telemetry.armed);
}

TEST(CompanionGround, APlannerThatFailsBeforeArmingEndsTheFlightOnTheGround) {
  Loop loop;
  loop.planner.throws_at_start = true;
  loop.run(3.0);
  EXPECT_FALSE(loop.link.telemetry.armed);
  EXPECT_EQ(loop.companion.supervisor().reason(), "the planner failed: no memory");
}

// As high as the take-off is to lead: nobody looks at what comes meanwhile.
TEST(CompanionGround, APlannerThatFallsSilentInTheClimbStopsIt) {
  config::Mission mission = Loop::mission();
  mission.takeoff_height = 10.0;
  Loop loop(mission);
  loop.follows = false;
  loop.run(1.0);
  loop.link.telemetry.motion.value.position = {0, 0, 2};
  loop.link.telemetry.in_air = true;
  loop.run(0.5);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  EXPECT_EQ(loop.companion.supervisor().hazard(), "");
  loop.planner.silent = true;
  loop.run(0.5);
  EXPECT_EQ(loop.companion.supervisor().hazard(), "the planner is late");
}

// The reference is the end of the climb, and where the vehicle is nobody tells.
TEST(CompanionGround, AHazardBeforeTheTakeOffIsNoTakeOff) {
  Loop loop;
  loop.follows = false;
  loop.run(0.5);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  EXPECT_EQ(loop.last().position.z(), 2.0);
  loop.positions = false;
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().hazard(), "the vehicle's position is stale");
  EXPECT_LT(loop.last().position.norm(), 0.01) << loop.last().position.transpose();
}

// Or it hangs there with its motors on for as long as nobody comes.
TEST(CompanionGround, WhatStopsLowIsLandedAndWhatStopsHigherIsHeld) {
  for (const double height : {0.6, 1.2}) {
    SCOPED_TRACE(height);
    Loop loop;
    loop.follows = false;
    loop.run(0.5);
    loop.link.telemetry.motion.value.position = {0, 0, height};
    loop.link.telemetry.in_air = true;
    loop.turn();
    loop.companion.interrupt(loop.now);
    loop.run(1.0);
    EXPECT_EQ(loop.link.requests.back(), height < 1.0 ? vehicle::Command::kLand : vehicle::Command::kHold);
  }
}

// Under the ground by its own word it does not know where that is.
TEST(CompanionGround, WhatIsDeepUnderTheGroundIsHeld) {
  Loop loop;
  loop.airborne().fly();
  loop.follows = false;
  loop.link.telemetry.motion.value.position.z() = -1.2;
  loop.link.telemetry.motion.value.velocity.setZero();
  loop.companion.interrupt(loop.now);
  loop.run(5.0);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
}

TEST(CompanionGround, ToLandTakesNoPlanner) {
  config::Mission mission = Loop::mission();
  mission.waypoints = {{4, 0, 1}};
  mission.arrival = config::Arrival::kLand;
  Loop loop(mission);
  loop.airborne({0, 0, 1}).fly();
  while (loop.companion.supervisor().phase() != supervisor::Phase::kLanding && loop.now < 20.0) loop.turn();
  loop.planner.throws = true;
  loop.run(1.0);
  EXPECT_EQ(loop.recorder.count("planner_failed"), 1);
  EXPECT_EQ(loop.link.telemetry.mode, vehicle::FlightMode::kLand);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kLanding);
  EXPECT_EQ(loop.companion.supervisor().reason(), "target reached");
}

// Two sources; what one of them sees is not seen any more. It is told before the vehicle is armed, or soon after.
TEST(CompanionGround, AWriterThatFallsSilentBeforeTheFlightIsMissedToo) {
  for (const double last_word : {3.0, 4.95}) {
    SCOPED_TRACE(last_word);
    Loop loop;
    loop.tracks = false;
    loop.link.telemetry.armable = false;
    for (; loop.now < 9.0; loop.turn()) {
      for (const std::uint64_t writer : {1U, 2U}) {
        if (writer == 1 || loop.now < last_word) loop.source.messages.push_back({{writer, loop.now, 0.0}, {}, 0});
      }
      loop.link.telemetry.armable = loop.now > 5.0;
    }
    if (last_word < 4.0) {
      EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kWaiting);
      EXPECT_EQ(loop.companion.supervisor().waiting_for(),
                "this to pass: a writer of obstacle tracks has fallen silent");
      EXPECT_TRUE(loop.link.requests.empty());
    } else {
      EXPECT_EQ(loop.recorder.last("hazard"), "a writer of obstacle tracks has fallen silent");
    }
  }
}

}  // namespace
}  // namespace jink::bridge::companion
