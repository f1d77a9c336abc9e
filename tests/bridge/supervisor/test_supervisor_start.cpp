// SPDX-License-Identifier: BSD-3-Clause
// Until the vehicle flies: what is waited for, and how OFFBOARD and arming are asked for.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using Motion = Decision::Motion;
using testing::Flight;

// ---- waiting

// PX4's heartbeats are a second apart: who is alone is known after that.
TEST(Supervisor, WithoutASystemIdItListensForOtherAutopilotsFirst) {
  config::Mission m = Flight::mission();
  m.system_id = 0;
  Flight flight(m);
  flight.run(1.4);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
  EXPECT_NE(flight.supervisor.waiting_for().find("other autopilots"), std::string::npos);
  flight.run(0.2);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
  Flight airborne(m);  // taken over at once, as it is in nobody's hands
  airborne.state.in_air = airborne.state.armed = true;
  airborne.turn();
  EXPECT_EQ(airborne.supervisor.phase(), Phase::kEngaging);
}

TEST(Supervisor, OfTwoAutopilotsNoneIsArmedThatIsNotNamed) {
  for (const double comes : {0.0, 1.0, 1.7}) {  // or taken over
    for (const bool in_air : {false, true}) {
      SCOPED_TRACE(comes);
      config::Mission m = Flight::mission();
      m.system_id = 0;
      Flight flight(m);
      flight.state.in_air = flight.state.armed = in_air && comes == 0.0;
      flight.run(comes);
      flight.state.system_id = 1;
      flight.state.other_system_id = 9;
      flight.run(12.0);
      EXPECT_EQ(flight.asked(vehicle::Command::kArm), 0);
      EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
      EXPECT_NE(flight.supervisor.reason().find("systems 1 and 9 are autopilots on udpin://127.0.0.1:14540"),
                std::string::npos)
          << flight.supervisor.reason();
    }
  }
  Flight named;
  named.state.system_id = 1;
  named.state.other_system_id = 9;
  named.turn();
  EXPECT_EQ(named.supervisor.phase(), Phase::kEngaging);
}

struct Missing {
  const char* what;
  std::function<void(Flight&)> take_away;
  const char* waiting_for;
  double timeout;
  MissingPeer peer;
};

const std::vector<Missing>& missing_things() {
  static const std::vector<Missing> all{
      {"heartbeat", [](Flight& f) { f.heartbeats = false; }, "heartbeat", 30.0, MissingPeer::kAutopilot},
      {"old heartbeat", [](Flight& f) { f.heartbeats = false, f.state.heartbeat_stamp = f.now - 3.1; }, "heartbeat",
       30.0, MissingPeer::kAutopilot},
      {"tracks", [](Flight& f) { f.tracks = false; }, "obstacle tracks on DDS domain 0", 30.0, MissingPeer::kTracks},
      {"old tracks", [](Flight& f) { f.tracks = false, f.context.newest_tracks = f.now - 1.1; }, "obstacle tracks",
       30.0, MissingPeer::kTracks},
      {"position", [](Flight& f) { f.positions = false; }, "local position", 60.0, MissingPeer::kNone},
      {"old position",
       [](Flight& f) { f.positions = false, f.state.motion.stamp = f.state.motion.received = f.now - 0.6; },
       "local position", 60.0, MissingPeer::kNone},
      {"estimator", [](Flight& f) { f.state.local_position_ok = false; }, "local position", 60.0, MissingPeer::kNone},
      {"health", [](Flight& f) { f.state.armable = false, f.state.health = "gyro, compass"; }, "gyro, compass", 60.0,
       MissingPeer::kNone}};
  return all;
}

TEST(Supervisor, WaitsSilentlyForEachMissingThingAndGivesUpInTime) {
  for (const Missing& missing : missing_things()) {
    SCOPED_TRACE(missing.what);
    Flight flight;
    missing.take_away(flight);
    while (!flight.supervisor.done() && flight.now < 10.0 + missing.timeout - 0.1) {
      const Decision decision = flight.turn();
      ASSERT_EQ(decision.motion, Motion::kNone);
      ASSERT_EQ(flight.supervisor.phase(), Phase::kWaiting);
      ASSERT_NE(flight.supervisor.waiting_for().find(missing.waiting_for), std::string::npos)
          << flight.supervisor.waiting_for();
    }
    flight.run(0.5);
    ASSERT_TRUE(flight.supervisor.done());
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.missing_peer(), missing.peer);
    EXPECT_NE(flight.supervisor.reason().find(missing.waiting_for), std::string::npos) << flight.supervisor.reason();
    EXPECT_TRUE(flight.requests.empty());
  }
}

TEST(Supervisor, GoesOnWhenWhatWasMissingComes) {
  for (const Missing& missing : missing_things()) {
    SCOPED_TRACE(missing.what);
    Flight flight;
    missing.take_away(flight);
    flight.run(5.0);
    flight.heartbeats = flight.positions = flight.tracks = true;
    flight.state.local_position_ok = flight.state.armable = true;
    EXPECT_EQ(flight.turn().motion, Motion::kStay);
    EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
    EXPECT_EQ(flight.supervisor.waiting_for(), "");
  }
}

TEST(Supervisor, FliesWithoutTracksWhereTheMissionDoesNotRequireThem) {
  config::Mission m = Flight::mission();
  m.tracks.required = false;
  Flight flight(m);
  flight.tracks = false;
  flight.fly();
  EXPECT_EQ(flight.run(5.0).motion, Motion::kFollow);
  EXPECT_EQ(flight.supervisor.hazard(), "");
}

TEST(Supervisor, InterruptWhileWaitingEndsWithoutAnyRequest) {
  Flight flight;
  flight.tracks = false;
  flight.run(1.0);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_TRUE(flight.requests.empty());
}

// ---- engaging

TEST(Supervisor, StreamsBeforeItAsksForOffboardAndArmsAfterIt) {
  Flight flight;
  const Decision first = flight.turn();
  EXPECT_NE(first.motion, Motion::kNone);
  EXPECT_FALSE(first.request);
  const Decision second = flight.turn();
  EXPECT_EQ(second.motion, Motion::kTakeoffPoint);
  EXPECT_EQ(second.request, vehicle::Command::kOffboard);
  flight.state.mode = vehicle::FlightMode::kOffboard;
  EXPECT_EQ(flight.turn().request, vehicle::Command::kArm);
  flight.state.armed = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
  EXPECT_EQ(flight.turn().motion, Motion::kTakeoffPoint);
}

TEST(Supervisor, AnAcknowledgementIsNoProof) {
  Flight flight;
  flight.engage().turn();
  flight.context.report = vehicle::CommandReport{vehicle::Command::kOffboard, true, ""};
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
  EXPECT_EQ(flight.asked(vehicle::Command::kArm), 0);
}

TEST(Supervisor, AsksAgainAFewTimesThenAbortsWithTheRefusal) {
  for (const bool offboard : {false, true}) {
    SCOPED_TRACE(offboard ? "arming refused" : "OFFBOARD refused");
    const vehicle::Command command = offboard ? vehicle::Command::kArm : vehicle::Command::kOffboard;
    Flight flight;
    flight.engage().turn();
    if (offboard) flight.state.mode = vehicle::FlightMode::kOffboard;
    while (!flight.supervisor.done() && flight.now < 60.0) {
      flight.refuse(command, "temporarily rejected");
      flight.turn();
    }
    EXPECT_EQ(flight.asked(command), 5);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.reason(), std::string(vehicle::to_string(command)) + " refused: temporarily rejected");
    EXPECT_LT(flight.now, 10.0 + 5 * 1.5 + 1.0);
  }
}

// A request that is followed after the supervisor has turned away leaves an armed vehicle without a stream.
TEST(Supervisor, TheLastTryHasItsTimeToo) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = vehicle::FlightMode::kOffboard;
  while (flight.asked(vehicle::Command::kArm) < 5) flight.turn();
  flight.run(1.2);
  flight.state.armed = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
}

// A pilot who goes back to the mode that he came from before a heartbeat has shown OFFBOARD.
TEST(Supervisor, OffboardThatWasGrantedAndTakenBackIsNotAskedForAgain) {
  Flight flight;
  flight.state.mode = vehicle::FlightMode::kPosition;
  flight.state.in_air = flight.state.armed = true;
  flight.turn();
  flight.turn();
  EXPECT_EQ(flight.asked(vehicle::Command::kOffboard), 1);
  flight.context.report = vehicle::CommandReport{vehicle::Command::kOffboard, true, ""};
  flight.run(5.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kOffboard), 1);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "OFFBOARD was granted and taken back: mode position");
}

// On a heartbeat from before the request the vehicle may be a pilot's by now.
TEST(Supervisor, DoesNotRepeatARequestOnAnOldHeartbeat) {
  Flight flight;
  flight.stop();
  flight.context.at_rest = true;
  while (flight.asked(vehicle::Command::kHold) == 0) flight.turn();
  flight.heartbeats = false;
  flight.run(4.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 1);
  flight.heartbeats = true;
  flight.turn();
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 2);
}

TEST(Supervisor, WaitsForALandedStateBeforeItBegins) {
  Flight flight;
  flight.state.armed = true;
  flight.state.landed_state_known = false;
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
  EXPECT_NE(flight.supervisor.waiting_for().find("landed state"), std::string::npos);
  flight.state.landed_state_known = flight.state.in_air = true;
  EXPECT_EQ(flight.turn().motion, Motion::kStay);
}

TEST(Supervisor, ATimeOutCountsFromWhenSomebodyWasLastThere) {
  Flight flight;
  flight.state.armable = false;
  flight.run(50.0);
  flight.tracks = false;
  flight.run(5.0);
  flight.tracks = true;
  flight.run(1.0);
  EXPECT_FALSE(flight.supervisor.done());
}

TEST(Supervisor, RefusalOfAnotherRequestIsNotTheReason) {
  Flight flight;
  flight.engage().turn();
  flight.refuse(vehicle::Command::kOffboard, "temporarily rejected");
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.run(30.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "the autopilot did not follow the request: arm");
}

TEST(Supervisor, NeverArmsWhenTheAutopilotOrTheTracksAreNoLongerReady) {
  for (const Missing& missing : missing_things()) {
    if (std::string(missing.what).find("heartbeat") != std::string::npos) continue;  // then the mode is old too
    SCOPED_TRACE(missing.what);
    Flight flight;
    flight.engage().turn();
    flight.state.mode = vehicle::FlightMode::kOffboard;
    missing.take_away(flight);
    if (!flight.positions) flight.state.motion.stamp = flight.state.motion.received = flight.now - 0.6;
    if (!flight.tracks) flight.context.newest_tracks = flight.now - 1.1;
    flight.run(9.0);
    EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
    EXPECT_NE(flight.supervisor.waiting_for().find(missing.waiting_for), std::string::npos);
    flight.run(3.0);
    EXPECT_EQ(flight.asked(vehicle::Command::kArm), 0);
    EXPECT_TRUE(flight.supervisor.done());
    EXPECT_NE(flight.supervisor.reason().find(missing.waiting_for), std::string::npos) << flight.supervisor.reason();
  }
}

TEST(Supervisor, EngagesInTheAirWithoutTakeoffAndWithoutArming) {
  Flight flight;
  flight.state.in_air = flight.state.armed = true;
  flight.state.armable = false;  // what flies need not be
  flight.state.motion.value.position.z() = 2.0;
  flight.engage();
  const Decision decision = flight.turn();
  EXPECT_EQ(decision.motion, Motion::kStay);
  EXPECT_EQ(decision.request, vehicle::Command::kOffboard);
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  EXPECT_EQ(flight.requests, std::vector<vehicle::Command>{vehicle::Command::kOffboard});
}

// As after a companion that was killed: PX4's failsafe sinks.
TEST(Supervisor, WhatIsTakenOverBelowTheLowestHeightClimbsFirst) {
  Flight flight;
  flight.state.in_air = flight.state.armed = true;
  flight.context.low = true;
  flight.engage();
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
  EXPECT_EQ(flight.turn().motion, Motion::kTakeoffPoint);
  flight.context.at_takeoff_height = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, InterruptOnTheGroundBeforeAnyRequestEndsAtOnce) {
  Flight flight;
  flight.engage();
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.run(0.2);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
  EXPECT_TRUE(flight.requests.empty());
}

// The heartbeat comes once a second: it does not show yet what was asked for before Ctrl-C.
TEST(Supervisor, InterruptWhileOffboardIsAskedForInTheAirEndsInHold) {
  Flight flight;
  flight.state.in_air = flight.state.armed = true;
  flight.engage();
  flight.heartbeats = false;
  EXPECT_EQ(flight.turn().request, vehicle::Command::kOffboard);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.context.at_rest = true;
  EXPECT_EQ(flight.run(0.9).motion, Motion::kBrake);
  ASSERT_FALSE(flight.supervisor.done());
  flight.heartbeats = true;
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.run(0.1);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.run(0.1);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

TEST(Supervisor, InterruptWhileArmingIsAskedForEndsInHold) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = vehicle::FlightMode::kOffboard;
  EXPECT_EQ(flight.turn().request, vehicle::Command::kArm);
  flight.heartbeats = false;
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.run(0.9);
  ASSERT_FALSE(flight.supervisor.done());
  flight.heartbeats = true;
  flight.state.armed = true;
  flight.run(0.1);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  flight.state.mode = vehicle::FlightMode::kHold;
  flight.run(0.1);
  EXPECT_TRUE(flight.supervisor.done());
}

TEST(Supervisor, InterruptWhileEngagingSaysSoWhenTheHeartbeatIsLost) {
  Flight flight;
  flight.engage().turn();
  flight.heartbeats = false;
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.run(5.0);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_NE(flight.supervisor.reason().find("heartbeat is missing"), std::string::npos) << flight.supervisor.reason();
}

// Found by tests/fuzz/fuzz_supervisor: one that says that it is in the air and disarmed was armed there.
TEST(Supervisor, WhatSaysThatItIsInTheAirAndDisarmedIsNotArmed) {
  Flight flight;
  flight.state.in_air = true;
  flight.run(5.0);
  EXPECT_TRUE(flight.requests.empty());
  EXPECT_EQ(flight.supervisor.waiting_for(), "the autopilot to be ready: disarmed in the air, it says");
  flight.state.in_air = false;
  flight.turn();
  flight.turn();
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.state.in_air = true;  // while it is asked for
  flight.run(5.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kArm), 0);
}

TEST(Supervisor, ADangerThatIsToldLateIsNotArmedWith) {
  Flight flight;
  flight.engage();
  flight.context.danger = "RETURN climbs";
  flight.state.mode = vehicle::FlightMode::kOffboard;
  flight.run(2.0);
  EXPECT_EQ(flight.asked(vehicle::Command::kArm), 0);
  EXPECT_EQ(flight.supervisor.reason(), "RETURN climbs");
}

TEST(Supervisor, AMissionThatReturnsWaitsForTheHeightOfThat) {
  config::Mission m = Flight::mission();
  m.endings.battery = config::EndsIn::kReturn;
  Flight flight(m);
  flight.state.failsafe_parameters.return_height.reset();
  flight.run(2.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
  flight.state.failsafe_parameters.return_height = 30.0;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
}

// A minute until it is there, and then it has to pass.
TEST(Supervisor, ACrewedAircraftIsWaitedForAsLongAsItTakes) {
  Flight flight;
  flight.context.aircraft_comes = true;
  flight.run(100.0);
  EXPECT_EQ(flight.supervisor.waiting_for(), "a crewed aircraft to pass");
  flight.context.aircraft_comes = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
}

}  // namespace
}  // namespace jink::bridge::supervisor
