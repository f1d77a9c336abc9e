// SPDX-License-Identifier: BSD-3-Clause
// Who flies, by the mode; and what becomes of a command that shows no effect.
#include <gtest/gtest.h>

#include <string>

#include "bridge/supervisor/command_request.hpp"
#include "bridge/supervisor/mode_changes.hpp"

namespace jink::bridge::supervisor {
namespace {

struct Judged {
  Judged() {
    state.mode = vehicle::FlightMode::kHold;
    changes.engage(state);
    state.mode = vehicle::FlightMode::kOffboard;
    state.armed = true;
    EXPECT_EQ(judge(Phase::kEngaging), ModeChange::kNone);
  }
  ModeChange judge(Phase phase) { return changes.judge(now, phase, phase != Phase::kEngaging, state); }

  ModeChanges changes;
  vehicle::VehicleState state;
  double now = 10.0;
};

TEST(ModeChanges, AnotherModeIsATakeoverWhereverTheVehicleIsOurs) {
  for (const Phase phase : {Phase::kEngaging, Phase::kClimbing, Phase::kFlying, Phase::kStopping}) {
    Judged flight;
    EXPECT_EQ(flight.judge(phase), ModeChange::kNone);
    flight.state.mode = vehicle::FlightMode::kPosition;
    EXPECT_EQ(flight.judge(phase), ModeChange::kTakeover) << to_string(phase);
  }
  // Not in the hand-over, which asks for another mode, nor before and after.
  for (const Phase phase : {Phase::kWaiting, Phase::kHandover, Phase::kLanding, Phase::kDone}) {
    Judged flight;
    flight.state.mode = vehicle::FlightMode::kPosition;
    EXPECT_EQ(flight.judge(phase), ModeChange::kNone) << to_string(phase);
  }
}

// PX4 before 1.15 says CRITICAL for a low battery too.
TEST(ModeChanges, ATakeoverIsOneThoughAWarningWasCriticalBefore) {
  Judged flight;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kNone);
  EXPECT_FALSE(flight.changes.failsafe());
  flight.state.mode = vehicle::FlightMode::kPosition;
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kTakeover);

  Judged recovered;
  recovered.state.failsafe = true;
  EXPECT_EQ(recovered.judge(Phase::kFlying), ModeChange::kNone);
  recovered.state.failsafe = false;
  EXPECT_EQ(recovered.judge(Phase::kFlying), ModeChange::kNone);
  recovered.state.failsafe = true;
  recovered.state.mode = vehicle::FlightMode::kPosition;
  EXPECT_EQ(recovered.judge(Phase::kFlying), ModeChange::kFailsafePasses);
}

// Whatever the heartbeat says of failsafes: who asked for another mode is a pilot.
TEST(ModeChanges, WhatWasAskedForTellsAPilotFromAFailsafe) {
  for (const bool critical : {false, true}) {
    for (const Phase phase : {Phase::kEngaging, Phase::kClimbing, Phase::kFlying, Phase::kStopping}) {
      SCOPED_TRACE(std::string(to_string(phase)) + (critical ? ", critical" : ""));
      Judged pilot;
      pilot.state.failsafe = critical;
      pilot.state.mode = pilot.state.intended_mode = vehicle::FlightMode::kPosition;
      EXPECT_EQ(pilot.judge(phase), ModeChange::kTakeover);
      Judged failsafe;
      failsafe.state.failsafe = critical;
      failsafe.state.mode = vehicle::FlightMode::kReturn;
      failsafe.state.intended_mode = vehicle::FlightMode::kOffboard;
      const bool may_pass = phase == Phase::kClimbing || phase == Phase::kFlying;
      EXPECT_EQ(failsafe.judge(phase), may_pass ? ModeChange::kFailsafePasses : ModeChange::kFailsafe);
    }
  }
}

// OFFBOARD is not asked for again where the autopilot brings the vehicle home.
TEST(ModeChanges, AFailsafeWhileEngagingIsLeftToItselfWhereItKnowsWhereTo) {
  for (const vehicle::FlightMode intended : {vehicle::FlightMode::kHold, vehicle::FlightMode::kUnknown}) {
    ModeChanges changes;
    vehicle::VehicleState state;
    state.mode = vehicle::FlightMode::kHold;
    state.intended_mode = intended;
    changes.engage(state);
    EXPECT_EQ(changes.judge(1.0, Phase::kEngaging, false, state), ModeChange::kNone);
    state.mode = vehicle::FlightMode::kReturn;
    state.failsafe = true;
    EXPECT_EQ(changes.judge(1.1, Phase::kEngaging, false, state), ModeChange::kFailsafe);
  }
}

TEST(ModeChanges, BeforeOffboardTheModeOfBeforeIsTheOneToStay) {
  ModeChanges changes;
  vehicle::VehicleState state;
  state.mode = vehicle::FlightMode::kPosition;
  changes.engage(state);
  EXPECT_EQ(changes.judge(1.0, Phase::kEngaging, false, state), ModeChange::kNone);
  EXPECT_FALSE(changes.offboard_seen());
  state.mode = vehicle::FlightMode::kHold;
  EXPECT_EQ(changes.judge(1.0, Phase::kEngaging, false, state), ModeChange::kTakeover);
}

TEST(ModeChanges, AFailsafeMayPassForAWhileAndOnlyInFlight) {
  Judged flight;
  flight.state.mode = vehicle::FlightMode::kAltitude;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kFailsafePasses);
  EXPECT_TRUE(flight.changes.failsafe());
  EXPECT_EQ(flight.judge(Phase::kStopping), ModeChange::kFailsafe);
  flight.now += 1.6;
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kFailsafe);
  flight.state.mode = vehicle::FlightMode::kOffboard;
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kNone);
  EXPECT_FALSE(flight.changes.failsafe());
}

TEST(ModeChanges, DisarmedCountsOnceFlightHasBegun) {
  Judged flight;
  flight.state.armed = false;
  EXPECT_EQ(flight.judge(Phase::kEngaging), ModeChange::kNone);
  EXPECT_EQ(flight.judge(Phase::kFlying), ModeChange::kDisarmed);
  EXPECT_EQ(flight.judge(Phase::kHandover), ModeChange::kNone);
}

TEST(CommandRequest, AsksAgainOnNewHeartbeatsOnlyAndNotForEver) {
  CommandRequest request;
  vehicle::VehicleState state;
  double now = 10.0;
  state.heartbeat_stamp = now;
  EXPECT_FALSE(request.exhausted(now, state));
  EXPECT_EQ(request.ask(vehicle::Command::kHold, now, state), vehicle::Command::kHold);
  EXPECT_FALSE(request.ask(vehicle::Command::kHold, now + 2.0, state));  // no heartbeat since
  int asked = 1;
  while (!request.exhausted(now, state) && now < 60.0) {
    now += 0.1;
    state.heartbeat_stamp = now;
    if (!request.exhausted(now, state)) asked += request.ask(vehicle::Command::kHold, now, state) ? 1 : 0;
  }
  EXPECT_EQ(asked, 5);
  EXPECT_EQ(request.ask(vehicle::Command::kLand, now, state),
            vehicle::Command::kLand);  // another one has its own tries
  EXPECT_FALSE(request.exhausted(now, state));
}

TEST(CommandRequest, OnAnOldHeartbeatNothingIsAsked) {
  CommandRequest request;
  vehicle::VehicleState state;
  state.heartbeat_stamp = 10.0;
  EXPECT_FALSE(request.ask(vehicle::Command::kLand, 14.9, state));
  EXPECT_FALSE(request.asked());
  EXPECT_FALSE(request.exhausted(22.0, state));
  EXPECT_TRUE(request.exhausted(22.5, state));  // nor will be
  state.heartbeat_stamp = 22.6;
  EXPECT_EQ(request.ask(vehicle::Command::kLand, 22.7, state), vehicle::Command::kLand);
  EXPECT_TRUE(request.asked());
}

// Its effect was not there yet by the last heartbeat, and no other came to ask again on.
TEST(CommandRequest, IsExhaustedWhereTheHeartbeatsEndAfterIt) {
  CommandRequest request;
  vehicle::VehicleState state;
  state.heartbeat_stamp = 10.0;
  ASSERT_TRUE(request.ask(vehicle::Command::kHold, 10.1, state));
  state.heartbeat_stamp = 11.0;
  for (double now = 11.1; now < 18.4; now += 0.1) {
    EXPECT_FALSE(now > 12.6 && request.ask(vehicle::Command::kHold, now, state)) << now;
    EXPECT_FALSE(request.exhausted(now, state)) << now;
  }
  EXPECT_TRUE(request.exhausted(18.6, state));
}

TEST(CommandRequest, KeepsTheRefusalOfThisCommand) {
  CommandRequest request;
  vehicle::VehicleState state;
  state.heartbeat_stamp = 1.0;
  request.answer({vehicle::Command::kHold, false, "denied"});
  EXPECT_EQ(request.refusal(), "");
  request.ask(vehicle::Command::kHold, 1.0, state);
  request.answer({vehicle::Command::kHold, false, "denied"});
  EXPECT_EQ(request.refusal(), "hold refused: denied");
  request.ask(vehicle::Command::kLand, 1.1, state);
  EXPECT_EQ(request.refusal(), "");
}

}  // namespace
}  // namespace jink::bridge::supervisor
