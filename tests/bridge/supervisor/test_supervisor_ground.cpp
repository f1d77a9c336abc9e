// SPDX-License-Identifier: BSD-3-Clause
// Near the ground: what keeps a vehicle from being armed and from leaving it, and what sets one down that is nearly
// there.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using Motion = Decision::Motion;
using testing::Flight;
using vehicle::Command;
using vehicle::FlightMode;

// It would be braked for as soon as it flies.
TEST(SupervisorGround, WhatWouldBrakeItInFlightIsWaitedFor) {
  struct Lack {
    std::function<void(Flight&, bool)> set;
    const char* waiting_for;
  };
  const std::vector<Lack> lacks = {
      {[](Flight& f, bool on) {
         f.positions = !on, f.state.motion = {{}, f.now - (on ? 0.6 : 0.0), f.now + 100.0};
       },
       "this to pass: the vehicle's position comes too late"},
      {[](Flight& f, bool on) { f.state.gps_lost = on; }, "this to pass: the autopilot has lost its GPS"},
      {[](Flight& f, bool on) { f.context.lost_writers = on ? 1 : 0; },
       "this to pass: a writer of obstacle tracks has fallen silent"}};
  for (const Lack& one : lacks) {
    SCOPED_TRACE(one.waiting_for);
    Flight flight;
    one.set(flight, true);
    flight.run(5.0);
    EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
    EXPECT_EQ(flight.supervisor.waiting_for(), one.waiting_for);
    EXPECT_TRUE(flight.requests.empty());
    one.set(flight, false);
    flight.turn();
    EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
    Flight airborne;  // what is in the air already is better off braked
    airborne.state.in_air = airborne.state.armed = true;
    one.set(airborne, true);
    airborne.turn();
    EXPECT_EQ(airborne.supervisor.phase(), Phase::kEngaging);
  }
}

TEST(SupervisorGround, ArmsOnlyWhereThePlannerPlans) {
  for (const double ends : {5.0, 20.0}) {
    Flight flight;
    flight.plans = false;
    flight.engage().turn();
    flight.state.mode = FlightMode::kOffboard;
    flight.run(ends);
    EXPECT_EQ(flight.asked(Command::kArm), 0);
    if (ends > 10.0) {
      EXPECT_EQ(flight.supervisor.reason(), "waited in vain for the planner to plan");
      continue;
    }
    EXPECT_EQ(flight.supervisor.waiting_for(), "the planner to plan");
    flight.plans = true;
    flight.turn();
    EXPECT_EQ(flight.asked(Command::kArm), 1);
  }
}

// Arming was asked for, and only a heartbeat tells whether it acted.
TEST(SupervisorGround, WhileSomethingIsMissingTheTakeOffIsNotAskedFor) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = FlightMode::kOffboard;
  EXPECT_EQ(flight.turn().motion, Motion::kTakeoffPoint);
  ASSERT_EQ(flight.asked(Command::kArm), 1);
  flight.heartbeats = flight.positions = false;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kStay);
  EXPECT_EQ(flight.run(5.0).motion, Motion::kStay);
}

TEST(SupervisorGround, SaysThatSetpointsCannotBeSentWhereNothingIsArmedForThat) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = FlightMode::kOffboard;
  flight.context.unsent_for = 0.3;
  flight.state.armable = false;
  flight.run(11.0);
  EXPECT_EQ(flight.supervisor.reason(), "waited in vain for setpoints to be sent");
}

// In HOLD its motors would run on for as long as nobody comes.
TEST(SupervisorGround, WhatStopsNearlyDownIsSetDown) {
  for (const config::EndsIn then : {config::EndsIn::kHold, config::EndsIn::kReturn}) {
    Flight flight;
    flight.climb().context.nearly_down = true;
    flight.context.at_rest = true;
    flight.state.in_air = true;
    flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted", then);
    flight.run(1.0);
    EXPECT_EQ(flight.requests.back(), Command::kLand);
    EXPECT_EQ(flight.asked(Command::kHold) + flight.asked(Command::kReturn), 0);
    flight.state.mode = FlightMode::kLand;
    flight.run(2.0);
    EXPECT_FALSE(flight.supervisor.done());
    flight.state.armed = flight.state.in_air = false;
    flight.turn();
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.reason(), "interrupted");
  }
}

// Nothing was taken over yet: whatever mode it is in stays.
TEST(SupervisorGround, WhatIsNotInOffboardIsNotSetDown) {
  Flight flight;
  flight.state.in_air = flight.state.armed = true;
  flight.engage().context.nearly_down = true;
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.context.at_rest = true;
  flight.run(5.0);
  EXPECT_EQ(flight.asked(Command::kLand), 0);
  EXPECT_TRUE(flight.supervisor.done());
}

TEST(SupervisorGround, TheLastOfALandingGoesOnWhoeverEndsTheFlight) {
  Flight flight(Flight::landing_mission());
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  flight.state.mode = FlightMode::kLand;
  flight.context.nearly_down = true;
  flight.run(1.0);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.asked(Command::kHold), 0);
  EXPECT_EQ(flight.supervisor.reason(), "target reached; interrupted, the landing goes on");
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);  // nobody watches whether it ends
}

// PX4's usual fallback without a remote control sinks, lands and disarms.
TEST(SupervisorGround, AFailsafeThatHasNearlyLandedTheVehicleIsLeftToIt) {
  Flight flight;
  flight.fly().run(1.0);
  flight.requests.clear();
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.context.nearly_down = true;
  flight.run(3.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_TRUE(flight.requests.empty());
  EXPECT_EQ(flight.supervisor.reason(),
            "the autopilot's failsafe took over, mode position; it is nearly down, the failsafe lands it");
}

}  // namespace
}  // namespace jink::bridge::supervisor
