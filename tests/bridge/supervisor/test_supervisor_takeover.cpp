// SPDX-License-Identifier: BSD-3-Clause
// Whoever else takes the vehicle: a pilot, and the autopilot's failsafe.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using Motion = Decision::Motion;
using testing::Flight;

// ---- somebody else

TEST(Supervisor, AModeChangeEndsTheStreamAtOnceAndForGoodInEveryPhase) {
  const std::vector<std::pair<const char*, std::function<void(Flight&)>>> phases{
      {"engaging, nothing confirmed", [](Flight& f) { f.engage().turn(); }},
      {"engaging, OFFBOARD confirmed",
       [](Flight& f) {
         f.engage().turn();
         f.state.mode = vehicle::FlightMode::kOffboard;
         f.turn();
       }},
      {"climbing", [](Flight& f) { f.climb(); }},
      {"flying", [](Flight& f) { f.fly(); }},
      {"braking",
       [](Flight& f) {
         f.fly().tracks = false;
         f.run(1.5);
       }},
      {"stopping", [](Flight& f) { f.stop().turn(); }},
      {"handing over",
       [](Flight& f) {
         f.stop().context.at_rest = true;
         f.run(0.5);
       }},
  };
  for (const auto& [name, get_there] : phases) {
    for (const vehicle::FlightMode mode :
         {vehicle::FlightMode::kPosition, vehicle::FlightMode::kReturn, vehicle::FlightMode::kManual}) {
      SCOPED_TRACE(std::string(name) + ", " + std::string(vehicle::to_string(mode)));
      Flight flight;
      get_there(flight);
      ASSERT_FALSE(flight.supervisor.done());
      flight.requests.clear();
      flight.state.mode = mode;
      const Decision decision = flight.turn();
      EXPECT_EQ(decision.motion, Motion::kNone);
      EXPECT_FALSE(decision.request);
      EXPECT_TRUE(flight.supervisor.done());
      EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
      EXPECT_FALSE(flight.supervisor.reason().empty());
      flight.state.mode = vehicle::FlightMode::kOffboard;  // and back
      EXPECT_EQ(flight.run(3.0).motion, Motion::kNone);
      EXPECT_TRUE(flight.requests.empty());
    }
  }
}

TEST(Supervisor, ATakeoverNamesTheMode) {
  Flight flight;
  flight.fly().state.mode = vehicle::FlightMode::kPosition;
  flight.turn();
  EXPECT_EQ(flight.supervisor.reason(), "the mode was changed to position by pilot or autopilot");
}

TEST(Supervisor, ATakeoverWhileStoppingKeepsTheOutcomeAndSaysBoth) {
  Flight flight;
  flight.fly();
  flight.supervisor.stop(flight.now, Outcome::kTimeout, "too late");
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kTimeout);
  EXPECT_EQ(flight.supervisor.reason(), "too late; then the mode was changed to position by pilot or autopilot");
}

TEST(Supervisor, DisarmingInFlightEndsTheFlight) {
  for (const bool climbing : {true, false}) {
    Flight flight;
    climbing ? flight.climb() : flight.fly();
    flight.state.armed = false;
    EXPECT_EQ(flight.turn().motion, Motion::kNone);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.reason(), "the autopilot disarmed in flight");
  }
}

// ---- failsafes of the autopilot

TEST(Supervisor, AFailsafeThatPassesIsAHazardAndNoTakeover) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kBrake);  // the stream goes on, which brings OFFBOARD back
  EXPECT_NE(flight.supervisor.hazard().find("failsafe"), std::string::npos);
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.state.failsafe = false;
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  // The next one has its time again.
  flight.run(1.0);
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

// PX4's usual fallback is POSITION, in which the pilot has the sticks.
TEST(Supervisor, AFailsafeIsLeftToThePilotWhoHasARemoteControl) {
  Flight flight;
  flight.state.remote_control = true;
  flight.fly().run(1.0);
  flight.requests.clear();
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(10.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_TRUE(flight.requests.empty());
  EXPECT_EQ(flight.supervisor.reason(), "the autopilot's failsafe took over, mode position, and left to the pilot");
}

TEST(Supervisor, WhoAskedForAnotherModeWhileHoldIsAskedForHasTheVehicle) {
  Flight flight;
  flight.stop().context.at_rest = true;
  flight.run(0.5);
  ASSERT_EQ(flight.supervisor.phase(), Phase::kHandover);
  flight.requests.clear();
  flight.state.mode = flight.state.intended_mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;  // before 1.15 a mere warning
  flight.run(10.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_TRUE(flight.requests.empty());
}

// CURRENT_MODE comes up to a second before the heartbeat that says CRITICAL.
TEST(Supervisor, OutOfAFailsafeThatTheModesTellFirstItAsksForHoldToo) {
  Flight flight;
  flight.fly().run(1.0);
  flight.stop();
  flight.requests.clear();
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.intended_mode = vehicle::FlightMode::kOffboard;
  flight.run(0.1);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  EXPECT_EQ(flight.requests, std::vector{vehicle::Command::kHold});
}

TEST(Supervisor, OutOfAFailsafeThatSinksItAsksForHoldWithoutSetpoints) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(2.0);
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 1);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.state.failsafe = false;
  flight.turn();
  ASSERT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "the autopilot's failsafe took over, mode position");
}

// The link was lost in the moment of arrival: HOLD never came through.
TEST(Supervisor, AFailsafeInTheHandOverIsNoArrival) {
  Flight flight;
  flight.fly();
  flight.context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(2.0);
  EXPECT_FALSE(flight.supervisor.done());
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_GE(flight.asked(vehicle::Command::kHold), 2);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.state.failsafe = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("failsafe took over"), std::string::npos);
}

TEST(Supervisor, AFailsafeIsNoPlaceToArriveIn) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.turn();
  flight.context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, AFailsafeThatHoldIsRefusedToKeepsTheVehicle) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = vehicle::FlightMode::kAltitude;
  flight.state.failsafe = true;
  flight.run(1.6);
  flight.refuse(vehicle::Command::kHold, "temporarily rejected");
  flight.run(10.0);
  ASSERT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 5);
  EXPECT_NE(flight.supervisor.reason().find("HOLD was not to be had"), std::string::npos);
}

TEST(Supervisor, AFailsafeWithoutPositionIsLeftAlone) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = vehicle::FlightMode::kAltitude;
  flight.state.failsafe = true;
  flight.state.local_position_ok = false;
  flight.run(2.0);
  ASSERT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
  EXPECT_NE(flight.supervisor.reason().find("without a position"), std::string::npos);
}

TEST(Supervisor, AFailsafeThatLandsReturnsOrHoldsIsNotInterfered) {
  for (const vehicle::FlightMode mode :
       {vehicle::FlightMode::kLand, vehicle::FlightMode::kReturn, vehicle::FlightMode::kHold}) {
    Flight flight;
    flight.fly().run(1.0);
    flight.state.mode = mode;
    flight.state.failsafe = true;
    flight.run(2.0);
    ASSERT_TRUE(flight.supervisor.done()) << vehicle::to_string(mode);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_TRUE(flight.asked(vehicle::Command::kHold) == 0 && flight.asked(vehicle::Command::kLand) == 0);
  }
}

TEST(Supervisor, TakesOverFromAFailsafeOfACompanionBeforeIt) {
  Flight flight;
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.turn();  // engaging, with a heartbeat from before the failsafe
  flight.turn();
  flight.state.in_air = flight.state.armed = true;
  flight.state.motion.value.position.z() = 2.0;
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.turn().motion, Motion::kStay);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kOffboard);
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.state.failsafe = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

}  // namespace
}  // namespace jink::bridge::supervisor
