// SPDX-License-Identifier: BSD-3-Clause
// What a flight that ends says of itself: all that befell it, and nothing that is not known.
#include <gtest/gtest.h>

#include <string>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using testing::Flight;
using vehicle::Command;
using vehicle::FlightMode;

// HOLD is asked for at the target.
Flight& hand_over(Flight& flight) {
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  EXPECT_EQ(flight.asked(Command::kHold), 1);
  return flight;
}

// At the target, LAND flies.
Flight& land(Flight& flight) {
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kLanding);
  flight.state.mode = FlightMode::kLand;
  return flight;
}

TEST(SupervisorWords, AFailsafeInsteadOfHoldIsSaidAndIsNoArrival) {
  for (const bool remote_control : {false, true}) {
    Flight flight;
    hand_over(flight).state.remote_control = remote_control;
    flight.state.failsafe = true;
    flight.state.intended_mode = FlightMode::kOffboard;
    flight.state.mode = remote_control ? FlightMode::kPosition : FlightMode::kLand;
    flight.run(1.0);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.reason(),
              remote_control
                  ? "target reached; then the autopilot's failsafe took over, mode position, and left to the pilot"
                  : "target reached; then the autopilot's failsafe took over, mode land");
  }
}

TEST(SupervisorWords, APilotsModeInsteadOfHoldIsSaid) {
  Flight flight;
  hand_over(flight).state.remote_control = true;
  flight.state.mode = flight.state.intended_mode = FlightMode::kPosition;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
  EXPECT_EQ(flight.supervisor.reason(), "target reached; then the mode was changed to position by pilot or autopilot");
}

TEST(SupervisorWords, AFailsafeInALandingIsNoTakeover) {
  Flight flight(Flight::landing_mission());
  land(flight).state.intended_mode = FlightMode::kOffboard;
  flight.state.mode = FlightMode::kPosition;
  flight.turn();
  EXPECT_EQ(flight.supervisor.reason(), "target reached, but the autopilot's failsafe took over, mode position");
}

TEST(SupervisorWords, OfAVehicleThatFallsTheTargetIsNotReached) {
  Flight flight;
  hand_over(flight).state.armed = false;
  flight.state.in_air = false;  // so PX4 says of whatever is disarmed
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "target reached; then the autopilot disarmed in flight");
}

TEST(SupervisorWords, AnAutopilotThatBeginsAnewIsSaidInEachPhase) {
  const std::string anew = "the autopilot began anew: its local frame may be another";
  Flight flying;
  flying.fly().supervisor.began_anew(flying.now);
  EXPECT_EQ(flying.supervisor.phase(), Phase::kStopping);
  EXPECT_EQ(flying.supervisor.reason(), anew);
  Flight stopping;
  stopping.stop().supervisor.began_anew(stopping.now);
  EXPECT_EQ(stopping.supervisor.reason(), "interrupted; then " + anew);
  Flight handover;
  hand_over(handover).supervisor.began_anew(handover.now);
  handover.state.mode = FlightMode::kHold;
  handover.turn();
  EXPECT_EQ(handover.supervisor.reason(), "target reached; then " + anew);
  EXPECT_EQ(handover.supervisor.outcome(), Outcome::kAborted);
  Flight landing(Flight::landing_mission());
  land(landing).supervisor.began_anew(landing.now);
  landing.state.armed = landing.state.in_air = false;
  landing.turn();
  EXPECT_EQ(landing.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(landing.supervisor.reason(), "target reached; then " + anew);
}

TEST(SupervisorWords, WhetherASilentAutopilotLandedIsNotKnown) {
  Flight flight(Flight::landing_mission());
  land(flight).run(1.0);
  flight.heartbeats = flight.positions = false;
  flight.run(95.0);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(),
            "target reached, but the autopilot fell silent: whether it landed is not known");
}

// Its last heartbeat came after the request; none comes to ask again on.
TEST(SupervisorWords, WhetherASilentAutopilotLandsIsNotWaitedForForEver) {
  Flight flight(Flight::landing_mission());
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.5);
  ASSERT_EQ(flight.asked(Command::kLand), 1);
  flight.heartbeats = flight.positions = false;
  flight.run(10.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "target reached, but the autopilot fell silent: whether it lands is not known");
}

TEST(SupervisorWords, WhatASilentAutopilotWasNeverAskedForItDidNotRefuse) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = FlightMode::kOffboard;
  flight.heartbeats = false;
  flight.run(9.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  EXPECT_EQ(flight.supervisor.reason(), "the autopilot fell silent before it granted: arm");
}

// Whoever ends a flight: what does not wait decides what it ends in, and is said.
TEST(SupervisorWords, WhatDoesNotWaitDecidesHowAStoppedFlightEnds) {
  for (const bool battery : {false, true}) {
    Flight flight;
    flight.stop().context.at_rest = true;
    if (battery) flight.state.battery = vehicle::BatteryState::kCritical;
    flight.context.aircraft_comes = !battery;
    flight.run(1.0);
    EXPECT_EQ(flight.requests.back(), Command::kLand);
    EXPECT_EQ(flight.asked(Command::kHold), 0);
    EXPECT_EQ(flight.supervisor.reason(), battery ? "interrupted; then the battery is critical"
                                                  : "interrupted; then a crewed aircraft comes too near");
  }
}

}  // namespace
}  // namespace jink::bridge::supervisor
