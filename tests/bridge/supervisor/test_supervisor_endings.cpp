// SPDX-License-Identifier: BSD-3-Clause
// The end: arrival, landing, interruption, the hand-over to HOLD.
#include <gtest/gtest.h>

#include <string>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using Motion = Decision::Motion;
using testing::Flight;

// ---- the end

TEST(Supervisor, InterruptInTheLandingEndsInHold) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly();
  flight.context.at_target = flight.context.at_end = true;
  flight.turn();
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.run(1.0);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  EXPECT_EQ(flight.turn().motion, Motion::kNone);  // no setpoints, which are not flown in LAND
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

TEST(Supervisor, TheTimeLimitEndsInHold) {
  Flight flight;
  flight.fly().run(99.5);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kStopping);
  flight.context.at_rest = true;
  flight.run(1.0);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kTimeout);
  EXPECT_NE(flight.supervisor.reason().find("time limit"), std::string::npos);
}

TEST(Supervisor, ArrivalInHoldStreamsUntilHoldIsConfirmed) {
  Flight flight;
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_EQ(flight.run(1.0).motion, Motion::kFollow);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 1);
  flight.state.mode = vehicle::FlightMode::kHold;
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
}

TEST(Supervisor, ItStaysAtTheTargetForTheHoldTime) {
  config::Mission mission = Flight::mission();
  mission.hold_time = 5.0;
  Flight flight(mission);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_TRUE(flight.supervisor.arrived());
  flight.context.at_target = flight.context.at_end = false;  // out of the way of something
  EXPECT_EQ(flight.run(3.0).motion, Motion::kFollow);
  flight.context.at_target = flight.context.at_end = true;
  EXPECT_EQ(flight.run(1.5).motion, Motion::kFollow);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
  flight.run(1.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 1);
  EXPECT_EQ(flight.supervisor.reason(), "target reached");
}

TEST(Supervisor, ATimeLimitInTheHoldTimeSaysSo) {
  config::Mission mission = Flight::mission();
  mission.hold_time = mission.time_limit;  // it begins on the way
  Flight flight(mission);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(mission.time_limit + 1.0);
  flight.context.at_rest = true;
  flight.run(1.0);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
  EXPECT_NE(flight.supervisor.reason().find("before its hold_time"), std::string::npos) << flight.supervisor.reason();
}

// What comes there would hit a vehicle in HOLD: it goes on following plans, which hold clear.
TEST(Supervisor, ATargetThatDoesNotStayFreeIsNotHeldIn) {
  Flight flight;
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.context.leaves_end = true;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kFollow);
  EXPECT_TRUE(flight.supervisor.arrived());
  flight.context.at_target = flight.context.at_end = false;
  flight.run(5.0);
  flight.context.leaves_end = false;  // as seen from beside it
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
  EXPECT_TRUE(flight.supervisor.arrived());
  flight.context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  EXPECT_TRUE(flight.supervisor.reason().starts_with("target reached, free after 7.")) << flight.supervisor.reason();
}

TEST(Supervisor, ATargetThatNeverStaysFreeIsReachedAllTheSame) {
  Flight flight;
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.context.leaves_end = true;
  flight.turn();
  flight.context.at_target = flight.context.at_end = false;
  flight.run(100.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kStopping);
  flight.context.at_rest = true;
  flight.run(1.0);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
  EXPECT_NE(flight.supervisor.reason().find("did not stay free"), std::string::npos);
}

TEST(Supervisor, ArrivalIsNotBelievedFromAStalePosition) {
  Flight flight;
  flight.fly().positions = false;
  flight.run(0.6);
  flight.context.at_target = flight.context.at_end = true;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

// ---- by the mission's choice

// A flight whose tracks have been stale for long enough, at rest.
Flight& lose_tracks(Flight& flight) {
  flight.fly().tracks = false;
  flight.context.at_rest = true;
  flight.run(5.0);
  return flight;
}

TEST(Supervisor, TheMissionChoosesHowAFlightWithoutTracksEnds) {
  using vehicle::Command;
  const std::pair<config::EndsIn, Command> choices[] = {{config::EndsIn::kHold, Command::kHold},
                                                        {config::EndsIn::kLand, Command::kLand},
                                                        {config::EndsIn::kReturn, Command::kReturn}};
  for (const auto& [ending, command] : choices) {
    config::Mission m = Flight::mission();
    m.endings.tracks = ending;
    Flight flight(m);
    lose_tracks(flight);
    for (const auto& [other, asked] : choices) EXPECT_EQ(flight.asked(asked) > 0, asked == command);
    EXPECT_EQ(flight.turn().motion, Motion::kBrake);  // until the heartbeat says so
    flight.state.mode = ending == config::EndsIn::kHold   ? vehicle::FlightMode::kHold
                        : ending == config::EndsIn::kLand ? vehicle::FlightMode::kLand
                                                          : vehicle::FlightMode::kReturn;
    flight.turn();
    EXPECT_EQ(flight.turn().motion, Motion::kNone);
    EXPECT_EQ(flight.supervisor.reason(), "the obstacle tracks are stale");
  }
}

TEST(Supervisor, AReturnThatIsRefusedEndsInHold) {
  config::Mission m = Flight::mission();
  m.endings.tracks = config::EndsIn::kReturn;
  Flight flight(m);
  lose_tracks(flight);
  flight.refuse(vehicle::Command::kReturn, "denied");
  flight.run(10.0);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(),
            "the obstacle tracks are stale; RETURN was not to be had (return refused: denied)");
}

TEST(Supervisor, ABatteryThatEndsBringsTheVehicleHomeWhereTheMissionSaysSo) {
  config::Mission m = Flight::mission();
  m.endings.battery = config::EndsIn::kReturn;
  Flight flight(m);
  flight.fly().context.at_rest = true;
  flight.state.battery = vehicle::BatteryState::kCritical;
  flight.run(1.0);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kReturn);
  EXPECT_EQ(flight.asked(vehicle::Command::kLand), 0);
}

// Without a position RETURN cannot be flown; and a landing that is decided stays one.
TEST(Supervisor, ReturnWithoutAPositionAndAnotherEndingAfterALandingAreLandings) {
  config::Mission m = Flight::mission();
  m.endings.planner = config::EndsIn::kReturn;
  m.endings.battery = config::EndsIn::kReturn;
  m.endings.tracks = config::EndsIn::kLand;
  Flight blind(m);
  blind.fly().context.at_rest = true;
  blind.supervisor.stop(blind.now, Outcome::kAborted, "the planner failed", m.endings.planner);
  blind.state.gps_lost = true;
  blind.run(1.0);
  EXPECT_EQ(blind.requests.back(), vehicle::Command::kLand);
  Flight landing(m);
  landing.fly().supervisor.stop(landing.now, Outcome::kAborted, "stale", m.endings.tracks);
  landing.state.battery = vehicle::BatteryState::kCritical;
  landing.context.at_rest = true;
  landing.run(1.0);
  EXPECT_EQ(landing.requests.back(), vehicle::Command::kLand);
}

TEST(Supervisor, ATargetIsNotHeldInWhereACrewedAircraftComes) {
  Flight flight;
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.context.aircraft_comes = true;
  flight.context.at_rest = true;
  flight.run(5.0);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kLand);
}

// Asked for before the autopilot has told that it is in the air, and lost.
TEST(Supervisor, ALandingThatWasNotHeardIsAskedForAgain) {
  config::Mission m = Flight::mission();
  m.endings.traffic = config::EndsIn::kLand;
  Flight flight(m);
  flight.climb().context.aircraft_comes = true;
  flight.run(7.0);
  EXPECT_GE(flight.asked(vehicle::Command::kLand), 2);
}

TEST(Supervisor, AnAutopilotThatTellsNoParametersIsWaitedForAWhile) {
  Flight flight;
  flight.state.failsafe_parameters.offboard_loss.reset();
  flight.run(2.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
  EXPECT_NE(flight.supervisor.waiting_for().find("parameters"), std::string::npos);
  flight.run(1.5);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
}

// ---- landing

// With its motors PX4 leaves LAND for the mode before, and CURRENT_MODE says so up to a second before the heartbeat.
TEST(Supervisor, TheModeOfBeforeALandingIsNoReasonToLandAgain) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.run(3.0);
  ASSERT_EQ(flight.asked(vehicle::Command::kLand), 1);
  flight.state.in_air = false;
  flight.state.mode = vehicle::FlightMode::kOffboard;
  EXPECT_EQ(flight.run(0.8).motion, Motion::kNone);
  EXPECT_EQ(flight.asked(vehicle::Command::kLand), 1);
  flight.state.armed = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
}

TEST(Supervisor, ArrivalByLandingIsReachedOnTheGroundDisarmed) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.turn();
  EXPECT_EQ(flight.turn().request, vehicle::Command::kLand);
  flight.state.mode = vehicle::FlightMode::kLand;
  EXPECT_EQ(flight.run(3.0).motion, Motion::kNone);  // the autopilot's now
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.in_air = false;
  flight.run(1.0);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.armed = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
  EXPECT_EQ(flight.asked(vehicle::Command::kLand), 1);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
}

TEST(Supervisor, ALandingTakenOverIsNoArrival) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.run(1.0);
  flight.state.mode = vehicle::FlightMode::kPosition;
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("taken over: mode position"), std::string::npos);
}

TEST(Supervisor, ALandingThatDoesNotEndIsReported) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.run(0.1);
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.run(95.0);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("did not end"), std::string::npos);
}

TEST(Supervisor, ALandingThatIsRefusedEndsInHold) {
  config::Mission m = Flight::mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().context.at_target = flight.context.at_end = true;
  flight.turn();
  while (flight.asked(vehicle::Command::kHold) == 0 && flight.now < 60.0) {
    flight.refuse(vehicle::Command::kLand, "denied");
    ASSERT_NE(flight.turn().motion, Motion::kNone);
  }
  EXPECT_EQ(flight.asked(vehicle::Command::kLand), 5);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "target reached, but the autopilot does not land: land refused: denied");
}

TEST(Supervisor, HoldNeverConfirmedIsAskedForAgainAndThenSaid) {
  for (const bool arrived : {true, false}) {
    SCOPED_TRACE(arrived);
    Flight flight;
    flight.fly().context.at_rest = true;
    if (arrived) {
      flight.context.at_target = flight.context.at_end = true;
    } else {
      flight.supervisor.stop(flight.now, Outcome::kTimeout, "too late");
    }
    while (!flight.supervisor.done() && flight.now < 60.0) {
      flight.turn();
      if (!flight.supervisor.done()) {
        EXPECT_NE(flight.supervisor.phase(), Phase::kDone);
      }
    }
    EXPECT_EQ(flight.asked(vehicle::Command::kHold), 5);
    EXPECT_EQ(flight.supervisor.outcome(), arrived ? Outcome::kAborted : Outcome::kTimeout);
    EXPECT_NE(flight.supervisor.reason().find("HOLD was never confirmed"), std::string::npos);
  }
}

TEST(Supervisor, StoppingWaitsForRestButNotForEver) {
  Flight flight;
  flight.stop().run(3.5);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kStopping);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
  flight.run(1.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 1);
  Flight rests;
  rests.stop().context.at_rest = true;
  rests.run(0.25);
  EXPECT_EQ(rests.asked(vehicle::Command::kHold), 0);
  rests.run(0.2);
  EXPECT_EQ(rests.asked(vehicle::Command::kHold), 1);
}

TEST(Supervisor, TheFirstReasonToStopStands) {
  Flight flight;
  flight.stop().turn();
  flight.supervisor.stop(flight.now, Outcome::kTimeout, "later");
  flight.context.at_rest = true;
  flight.run(0.5);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

}  // namespace
}  // namespace jink::bridge::supervisor
