// SPDX-License-Identifier: BSD-3-Clause
// The state machine as a table of situations: what it asks for, what it streams, and how it ends.
#include "bridge/supervisor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace jink::bridge {
namespace {

using Motion = Decision::Motion;

constexpr double kTurn = 0.02;  // s, of the loop

config::Mission mission() {
  config::Mission m;
  m.connection = "udpin://127.0.0.1:14540";
  m.vehicle_name = "ardrone2";
  m.waypoints = {{20, 0, 1.5}};
  m.arrival = config::Arrival::kHold;
  m.time_limit = 100.0;
  return m;
}

/// A supervisor and an autopilot's telemetry that is always fresh, but for what a test freezes.
struct Flight {
  explicit Flight(const config::Mission& m = mission(), const SupervisorSettings& s = {}) : supervisor(m, s) {
    state.mode = FlightMode::kHold;
    state.armable = true;
    state.local_position_ok = true;
  }

  /// One turn; what was frozen keeps its stamp.
  Decision turn() {
    if (heartbeats) state.heartbeat_stamp = now;
    if (positions) state.position_stamp = now;
    if (tracks) picture.newest_tracks = now;
    if (plans) picture.newest_plan = now;
    const Decision decision = supervisor.update(now, state, picture);
    picture.report.reset();
    if (decision.request) requests.push_back(*decision.request);
    now += kTurn;
    return decision;
  }
  /// Turns for so long, or until it is done. The last decision.
  Decision run(double seconds) {
    Decision last;
    for (const double end = now + seconds; now < end && !supervisor.done();) last = turn();
    return last;
  }
  void refuse(Command command, const std::string& detail) { picture.report = CommandReport{command, false, detail}; }
  [[nodiscard]] int asked(Command command) const {
    return static_cast<int>(std::count(requests.begin(), requests.end(), command));
  }

  // To the phases, as an obliging autopilot lets it get there.
  Flight& engage() {
    turn();
    return *this;
  }
  Flight& climb() {
    engage().turn();
    state.mode = FlightMode::kOffboard;
    turn();
    state.armed = true;
    turn();
    return *this;
  }
  Flight& fly() {
    climb();
    state.in_air = true;
    picture.at_takeoff_height = true;
    turn();
    return *this;
  }
  Flight& stop() {
    fly();
    supervisor.stop(now, Outcome::kAborted, "interrupted");
    return *this;
  }

  Supervisor supervisor;
  VehicleState state;
  FlightPicture picture;
  std::vector<Command> requests;
  double now = 10.0;
  bool heartbeats = true, positions = true, tracks = true, plans = true;
};

// ---- waiting

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
      {"old tracks", [](Flight& f) { f.tracks = false, f.picture.newest_tracks = f.now - 1.1; }, "obstacle tracks",
       30.0, MissingPeer::kTracks},
      {"position", [](Flight& f) { f.positions = false; }, "local position", 60.0, MissingPeer::kNone},
      {"old position", [](Flight& f) { f.positions = false, f.state.position_stamp = f.now - 0.6; }, "local position",
       60.0, MissingPeer::kNone},
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
  config::Mission m = mission();
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
  EXPECT_EQ(second.request, Command::kOffboard);
  flight.state.mode = FlightMode::kOffboard;
  EXPECT_EQ(flight.turn().request, Command::kArm);
  flight.state.armed = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
  EXPECT_EQ(flight.turn().motion, Motion::kTakeoffPoint);
}

TEST(Supervisor, AnAcknowledgementIsNoProof) {
  Flight flight;
  flight.engage().turn();
  flight.picture.report = CommandReport{Command::kOffboard, true, ""};
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
  EXPECT_EQ(flight.asked(Command::kArm), 0);
}

TEST(Supervisor, AsksAgainAFewTimesThenAbortsWithTheRefusal) {
  for (const bool offboard : {false, true}) {
    SCOPED_TRACE(offboard ? "arming refused" : "OFFBOARD refused");
    const Command command = offboard ? Command::kArm : Command::kOffboard;
    Flight flight;
    flight.engage().turn();
    if (offboard) flight.state.mode = FlightMode::kOffboard;
    while (!flight.supervisor.done() && flight.now < 60.0) {
      flight.refuse(command, "temporarily rejected");
      flight.turn();
    }
    EXPECT_EQ(flight.asked(command), 5);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_EQ(flight.supervisor.reason(), std::string(to_string(command)) + " refused: temporarily rejected");
    EXPECT_LT(flight.now, 10.0 + 5 * 1.5 + 1.0);
  }
}

// A request that is followed after the supervisor has turned away leaves an armed vehicle without a stream.
TEST(Supervisor, TheLastTryHasItsTimeToo) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = FlightMode::kOffboard;
  while (flight.asked(Command::kArm) < 5) flight.turn();
  flight.run(1.2);
  flight.state.armed = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
}

// A pilot who goes back to the mode that he came from before a heartbeat has shown OFFBOARD.
TEST(Supervisor, OffboardThatWasGrantedAndTakenBackIsNotAskedForAgain) {
  Flight flight;
  flight.state.mode = FlightMode::kPosition;
  flight.state.in_air = flight.state.armed = true;
  flight.turn();
  flight.turn();
  EXPECT_EQ(flight.asked(Command::kOffboard), 1);
  flight.picture.report = CommandReport{Command::kOffboard, true, ""};
  flight.run(5.0);
  EXPECT_EQ(flight.asked(Command::kOffboard), 1);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "OFFBOARD was granted and taken back: mode position");
}

// On a heartbeat from before the request the vehicle may be a pilot's by now.
TEST(Supervisor, DoesNotRepeatARequestOnAnOldHeartbeat) {
  Flight flight;
  flight.stop();
  flight.picture.at_rest = true;
  while (flight.asked(Command::kHold) == 0) flight.turn();
  flight.heartbeats = false;
  flight.run(4.0);
  EXPECT_EQ(flight.asked(Command::kHold), 1);
  flight.heartbeats = true;
  flight.turn();
  EXPECT_EQ(flight.asked(Command::kHold), 2);
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
  flight.refuse(Command::kOffboard, "temporarily rejected");
  flight.turn();
  flight.state.mode = FlightMode::kOffboard;
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
    flight.state.mode = FlightMode::kOffboard;
    missing.take_away(flight);
    if (!flight.positions) flight.state.position_stamp = flight.now - 0.6;
    if (!flight.tracks) flight.picture.newest_tracks = flight.now - 1.1;
    flight.run(9.0);
    EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
    EXPECT_NE(flight.supervisor.waiting_for().find(missing.waiting_for), std::string::npos);
    flight.run(3.0);
    EXPECT_EQ(flight.asked(Command::kArm), 0);
    EXPECT_TRUE(flight.supervisor.done());
    EXPECT_NE(flight.supervisor.reason().find(missing.waiting_for), std::string::npos) << flight.supervisor.reason();
  }
}

TEST(Supervisor, EngagesInTheAirWithoutTakeoffAndWithoutArming) {
  Flight flight;
  flight.state.in_air = flight.state.armed = true;
  flight.state.armable = false;  // what flies need not be
  flight.engage();
  const Decision decision = flight.turn();
  EXPECT_EQ(decision.motion, Motion::kStay);
  EXPECT_EQ(decision.request, Command::kOffboard);
  flight.state.mode = FlightMode::kOffboard;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  EXPECT_EQ(flight.requests, std::vector<Command>{Command::kOffboard});
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
  EXPECT_EQ(flight.turn().request, Command::kOffboard);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.picture.at_rest = true;
  EXPECT_EQ(flight.run(0.9).motion, Motion::kBrake);
  ASSERT_FALSE(flight.supervisor.done());
  flight.heartbeats = true;
  flight.state.mode = FlightMode::kOffboard;
  flight.run(0.1);
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = FlightMode::kHold;
  flight.run(0.1);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

TEST(Supervisor, InterruptWhileArmingIsAskedForEndsInHold) {
  Flight flight;
  flight.engage().turn();
  flight.state.mode = FlightMode::kOffboard;
  EXPECT_EQ(flight.turn().request, Command::kArm);
  flight.heartbeats = false;
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.run(0.9);
  ASSERT_FALSE(flight.supervisor.done());
  flight.heartbeats = true;
  flight.state.armed = true;
  flight.run(0.1);
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  flight.state.mode = FlightMode::kHold;
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

// ---- somebody else

TEST(Supervisor, AModeChangeEndsTheStreamAtOnceAndForGoodInEveryPhase) {
  const std::vector<std::pair<const char*, std::function<void(Flight&)>>> phases{
      {"engaging, nothing confirmed", [](Flight& f) { f.engage().turn(); }},
      {"engaging, OFFBOARD confirmed",
       [](Flight& f) {
         f.engage().turn();
         f.state.mode = FlightMode::kOffboard;
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
         f.stop().picture.at_rest = true;
         f.run(0.5);
       }},
  };
  for (const auto& [name, get_there] : phases) {
    for (const FlightMode mode : {FlightMode::kPosition, FlightMode::kReturn, FlightMode::kManual}) {
      SCOPED_TRACE(std::string(name) + ", " + std::string(to_string(mode)));
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
      flight.state.mode = FlightMode::kOffboard;  // and back
      EXPECT_EQ(flight.run(3.0).motion, Motion::kNone);
      EXPECT_TRUE(flight.requests.empty());
    }
  }
}

TEST(Supervisor, ATakeoverNamesTheMode) {
  Flight flight;
  flight.fly().state.mode = FlightMode::kPosition;
  flight.turn();
  EXPECT_EQ(flight.supervisor.reason(), "the mode was changed to position by pilot or autopilot");
}

TEST(Supervisor, ATakeoverWhileStoppingKeepsTheOutcomeAndSaysBoth) {
  Flight flight;
  flight.fly();
  flight.supervisor.stop(flight.now, Outcome::kTimeout, "too late");
  flight.turn();
  flight.state.mode = FlightMode::kPosition;
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

// ---- climbing

TEST(Supervisor, ClimbEndsAtTheHeightOnlyWhenTheAutopilotIsInTheAir) {
  Flight flight;
  flight.climb().picture.at_takeoff_height = true;
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kClimbing);
  flight.state.in_air = true;
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, AClimbThatDoesNotEndIsStoppedInHold) {
  Flight flight;
  flight.climb().state.in_air = true;
  flight.run(31.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kStopping);
  flight.run(5.0);
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  flight.state.mode = FlightMode::kHold;
  flight.run(0.1);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "the take-off height was not reached");
}

TEST(Supervisor, InterruptInTheClimbBrakesAndHolds) {
  Flight flight;
  flight.climb().state.in_air = true;
  flight.run(1.0);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  flight.picture.at_rest = true;
  EXPECT_EQ(flight.run(0.5).motion, Motion::kBrake);
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  flight.state.mode = FlightMode::kHold;
  EXPECT_EQ(flight.run(0.1).motion, Motion::kNone);
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

// ---- hazards

struct Hazard {
  const char* what;
  std::function<void(Flight&)> begin;
  std::function<void(Flight&)> end;
  double age;  // at which it is one
  const char* text;
  bool in_climb;
};

const std::vector<Hazard>& hazards() {
  static const std::vector<Hazard> all{
      {"state", [](Flight& f) { f.positions = false; }, [](Flight& f) { f.positions = true; }, 0.2, "position is stale",
       true},
      {"heartbeat", [](Flight& f) { f.heartbeats = false; }, [](Flight& f) { f.heartbeats = true; }, 3.0,
       "heartbeat is missing", true},
      {"tracks", [](Flight& f) { f.tracks = false; }, [](Flight& f) { f.tracks = true; }, 1.0, "tracks are stale",
       true},
      {"plan", [](Flight& f) { f.plans = false; }, [](Flight& f) { f.plans = true; }, 0.3, "planner is late", false},
      {"GPS", [](Flight& f) { f.state.gps_lost = true; }, [](Flight& f) { f.state.gps_lost = false; }, 0.0,
       "lost its GPS", true},
      {"estimator", [](Flight& f) { f.state.local_position_ok = false; },
       [](Flight& f) { f.state.local_position_ok = true; }, 0.0, "lost its position", true}};
  return all;
}

TEST(Supervisor, BrakesAtOnceOnEachHazardAndFollowsAgainWhenItPasses) {
  for (const Hazard& hazard : hazards()) {
    for (const bool climbing : {false, true}) {
      if (climbing && !hazard.in_climb) continue;
      SCOPED_TRACE(std::string(hazard.what) + (climbing ? ", climbing" : ", flying"));
      Flight flight;
      climbing ? flight.climb() : flight.fly();
      const Motion normal = climbing ? Motion::kTakeoffPoint : Motion::kFollow;
      flight.run(2.0);
      hazard.begin(flight);
      if (hazard.age > 0.0) {
        EXPECT_EQ(flight.run(hazard.age - 2 * kTurn).motion, normal);
      }
      EXPECT_EQ(flight.run(4 * kTurn).motion, Motion::kBrake);
      EXPECT_NE(flight.supervisor.hazard().find(hazard.text), std::string::npos) << flight.supervisor.hazard();
      flight.run(2.0);
      EXPECT_FALSE(flight.supervisor.done());
      hazard.end(flight);
      EXPECT_EQ(flight.turn().motion, normal);
      EXPECT_EQ(flight.supervisor.hazard(), "");
      // And once more for as long: what was before does not count.
      hazard.begin(flight);
      flight.run(hazard.age + 2.5);
      EXPECT_EQ(flight.supervisor.phase(), climbing ? Phase::kClimbing : Phase::kFlying);
    }
  }
}

TEST(Supervisor, AHazardThatLastsEndsInHoldWithItsReason) {
  for (const Hazard& hazard : hazards()) {
    for (const bool climbing : {false, true}) {
      if (climbing && !hazard.in_climb) continue;
      SCOPED_TRACE(std::string(hazard.what) + (climbing ? ", climbing" : ", flying"));
      Flight flight;
      climbing ? flight.climb() : flight.fly();
      flight.state.in_air = true;
      hazard.begin(flight);
      for (const double end = flight.now + hazard.age + 4.0;
           flight.asked(Command::kHold) == 0 && flight.now < end + 5.0;) {
        ASSERT_NE(flight.turn().motion, Motion::kNone);
      }
      ASSERT_EQ(flight.asked(Command::kHold), 1);
      flight.heartbeats = true;
      flight.state.mode = FlightMode::kHold;
      flight.run(0.1);
      ASSERT_TRUE(flight.supervisor.done());
      EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
      EXPECT_NE(flight.supervisor.reason().find(hazard.text), std::string::npos) << flight.supervisor.reason();
    }
  }
}

TEST(Supervisor, TheFirstPlanHasItsTime) {
  Flight flight;
  flight.plans = false;
  flight.fly();
  EXPECT_EQ(flight.run(0.25).motion, Motion::kFollow);
  EXPECT_EQ(flight.run(0.1).motion, Motion::kBrake);
}

TEST(Supervisor, AWriterThatFellSilentAndSetpointsThatCannotBeSentAreHazards) {
  Flight flight;
  flight.fly().run(1.0);
  flight.picture.lost_writers = 1;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  EXPECT_EQ(flight.supervisor.hazard(), "a writer of obstacle tracks has fallen silent");
  flight.picture.lost_writers = 0;
  flight.picture.unsent_for = 0.1;
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  flight.picture.unsent_for = 0.3;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  EXPECT_EQ(flight.supervisor.hazard(), "setpoints cannot be sent");
}

TEST(Supervisor, AHazardThatComesAgainAndAgainEndsTheFlight) {
  Flight flight;
  flight.fly();
  int times = 0;
  for (; times < 20 && flight.supervisor.phase() == Phase::kFlying; ++times) {
    flight.state.local_position_ok = false;
    flight.run(1.0);
    flight.state.local_position_ok = true;
    flight.run(0.2);
  }
  EXPECT_EQ(times, 7);  // 1 s each, of which the pauses forget a fifteenth: more than 6 s in the seventh
  EXPECT_NE(flight.supervisor.reason().find("again and again"), std::string::npos) << flight.supervisor.reason();
}

// ---- failsafes of the autopilot

TEST(Supervisor, AFailsafeThatPassesIsAHazardAndNoTakeover) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kBrake);  // the stream goes on, which brings OFFBOARD back
  EXPECT_NE(flight.supervisor.hazard().find("failsafe"), std::string::npos);
  flight.state.mode = FlightMode::kOffboard;
  flight.state.failsafe = false;
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  // The next one has its time again.
  flight.run(1.0);
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(1.0);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, OutOfAFailsafeThatSinksItAsksForHoldWithoutSetpoints) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(2.0);
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.asked(Command::kHold), 1);
  flight.state.mode = FlightMode::kHold;
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
  flight.picture.at_target = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kHandover);
  flight.turn();
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.run(2.0);
  EXPECT_FALSE(flight.supervisor.done());
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_GE(flight.asked(Command::kHold), 2);
  flight.state.mode = FlightMode::kHold;
  flight.state.failsafe = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("failsafe took over"), std::string::npos);
}

TEST(Supervisor, AFailsafeIsNoPlaceToArriveIn) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  flight.turn();
  flight.picture.at_target = true;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, AFailsafeThatHoldIsRefusedToKeepsTheVehicle) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = FlightMode::kAltitude;
  flight.state.failsafe = true;
  flight.run(1.6);
  flight.refuse(Command::kHold, "temporarily rejected");
  flight.run(10.0);
  ASSERT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.asked(Command::kHold), 5);
  EXPECT_NE(flight.supervisor.reason().find("HOLD was not to be had"), std::string::npos);
}

TEST(Supervisor, AFailsafeWithoutPositionIsLeftAlone) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.mode = FlightMode::kAltitude;
  flight.state.failsafe = true;
  flight.state.local_position_ok = false;
  flight.run(2.0);
  ASSERT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.asked(Command::kHold), 0);
  EXPECT_NE(flight.supervisor.reason().find("without a position"), std::string::npos);
}

TEST(Supervisor, AFailsafeThatLandsReturnsOrHoldsIsNotInterfered) {
  for (const FlightMode mode : {FlightMode::kLand, FlightMode::kReturn, FlightMode::kHold}) {
    Flight flight;
    flight.fly().run(1.0);
    flight.state.mode = mode;
    flight.state.failsafe = true;
    flight.run(2.0);
    ASSERT_TRUE(flight.supervisor.done()) << to_string(mode);
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_TRUE(flight.asked(Command::kHold) == 0 && flight.asked(Command::kLand) == 0);
  }
}

TEST(Supervisor, TakesOverFromAFailsafeOfACompanionBeforeIt) {
  Flight flight;
  flight.state.mode = FlightMode::kOffboard;
  flight.state.armed = false;
  flight.state.in_air = true;
  flight.turn();  // engaging, with a heartbeat from before the failsafe
  flight.turn();
  flight.state.armed = true;
  flight.state.mode = FlightMode::kPosition;
  flight.state.failsafe = true;
  EXPECT_EQ(flight.turn().motion, Motion::kStay);
  EXPECT_EQ(flight.requests.back(), Command::kOffboard);
  flight.state.mode = FlightMode::kOffboard;
  flight.state.failsafe = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

// ---- battery and fence

TEST(Supervisor, ACriticalBatteryEndsTheFlightByLanding) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.battery = BatteryState::kLow;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kFollow);
  flight.state.battery = BatteryState::kCritical;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  flight.picture.at_rest = true;
  flight.run(0.5);
  EXPECT_EQ(flight.requests.back(), Command::kLand);
  EXPECT_EQ(flight.asked(Command::kHold), 0);
  flight.state.mode = FlightMode::kLand;
  flight.run(1.0);
  // Ctrl-C must not keep it in the air.
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "the battery is critical; interrupted, the landing goes on");
  EXPECT_EQ(flight.asked(Command::kHold), 0);
}

// Pressed while it brakes, and again in every turn: LAND is asked for first.
TEST(Supervisor, CtrlCDoesNotKeepACriticalBatteryFromLanding) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.battery = BatteryState::kCritical;
  flight.picture.at_rest = true;
  for (int i = 0; i < 60; ++i) {
    flight.turn();
    flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  }
  EXPECT_EQ(flight.asked(Command::kLand), 1);
  EXPECT_EQ(flight.asked(Command::kHold), 0);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = FlightMode::kLand;
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
}

TEST(Supervisor, ABatteryThatEndsWhileItStopsLandsToo) {
  Flight flight;
  flight.stop();
  flight.state.battery = BatteryState::kCritical;
  flight.picture.at_rest = true;
  flight.run(1.0);
  EXPECT_EQ(flight.requests.back(), Command::kLand);
}

TEST(Supervisor, DoesNotBeginWithALowBattery) {
  Flight flight;
  flight.state.battery = BatteryState::kLow;
  flight.run(61.0);
  EXPECT_TRUE(flight.requests.empty());
  EXPECT_NE(flight.supervisor.reason().find("charged battery: it is low"), std::string::npos);
}

TEST(Supervisor, DoesNotBeginOutsideTheGeofence) {
  config::Mission m = mission();
  m.geofence = {{-5, -5, 0}, {30, 5, 10}};
  for (const bool outside : {false, true}) {
    Flight flight(m);
    flight.state.position = {outside ? -6.0 : -4.0, 0, 0};
    flight.turn();
    EXPECT_EQ(flight.supervisor.done(), outside);
    if (!outside) continue;
    EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
    EXPECT_NE(flight.supervisor.reason().find("outside the geofence, at east -6.0 m"), std::string::npos);
  }
}

// ---- the end

TEST(Supervisor, InterruptInTheLandingEndsInHold) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly();
  flight.picture.at_target = true;
  flight.turn();
  flight.turn();
  flight.state.mode = FlightMode::kLand;
  flight.run(1.0);
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  EXPECT_EQ(flight.turn().motion, Motion::kNone);  // no setpoints, which are not flown in LAND
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = FlightMode::kHold;
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
  flight.picture.at_rest = true;
  flight.run(1.0);
  EXPECT_EQ(flight.requests.back(), Command::kHold);
  flight.state.mode = FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kTimeout);
  EXPECT_NE(flight.supervisor.reason().find("time limit"), std::string::npos);
}

TEST(Supervisor, ArrivalInHoldStreamsUntilHoldIsConfirmed) {
  Flight flight;
  flight.fly().picture.at_target = true;
  flight.turn();
  EXPECT_EQ(flight.run(1.0).motion, Motion::kFollow);
  EXPECT_EQ(flight.asked(Command::kHold), 1);
  flight.state.mode = FlightMode::kHold;
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
}

TEST(Supervisor, ArrivalIsNotBelievedFromAStalePosition) {
  Flight flight;
  flight.fly().positions = false;
  flight.run(0.6);
  flight.picture.at_target = true;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kFlying);
}

TEST(Supervisor, ArrivalByLandingIsReachedOnTheGroundDisarmed) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().picture.at_target = true;
  flight.turn();
  EXPECT_EQ(flight.turn().request, Command::kLand);
  flight.state.mode = FlightMode::kLand;
  EXPECT_EQ(flight.run(3.0).motion, Motion::kNone);  // the autopilot's now
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.in_air = false;
  flight.run(1.0);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.armed = false;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kReached);
  EXPECT_EQ(flight.asked(Command::kLand), 1);
  EXPECT_EQ(flight.asked(Command::kHold), 0);
}

TEST(Supervisor, ALandingTakenOverIsNoArrival) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().picture.at_target = true;
  flight.run(0.1);
  flight.state.mode = FlightMode::kLand;
  flight.run(1.0);
  flight.state.mode = FlightMode::kPosition;
  EXPECT_EQ(flight.turn().motion, Motion::kNone);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("taken over: mode position"), std::string::npos);
}

TEST(Supervisor, ALandingThatDoesNotEndIsReported) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().picture.at_target = true;
  flight.run(0.1);
  flight.state.mode = FlightMode::kLand;
  flight.run(95.0);
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_NE(flight.supervisor.reason().find("did not end"), std::string::npos);
}

TEST(Supervisor, ALandingThatIsRefusedEndsInHold) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  Flight flight(m);
  flight.fly().picture.at_target = true;
  flight.turn();
  while (flight.asked(Command::kHold) == 0 && flight.now < 60.0) {
    flight.refuse(Command::kLand, "denied");
    ASSERT_NE(flight.turn().motion, Motion::kNone);
  }
  EXPECT_EQ(flight.asked(Command::kLand), 5);
  flight.state.mode = FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "target reached, but the autopilot does not land: land refused: denied");
}

TEST(Supervisor, HoldNeverConfirmedIsAskedForAgainAndThenSaid) {
  for (const bool arrived : {true, false}) {
    SCOPED_TRACE(arrived);
    Flight flight;
    flight.fly().picture.at_rest = true;
    if (arrived) {
      flight.picture.at_target = true;
    } else {
      flight.supervisor.stop(flight.now, Outcome::kTimeout, "too late");
    }
    while (!flight.supervisor.done() && flight.now < 60.0) {
      flight.turn();
      if (!flight.supervisor.done()) {
        EXPECT_NE(flight.supervisor.phase(), Phase::kDone);
      }
    }
    EXPECT_EQ(flight.asked(Command::kHold), 5);
    EXPECT_EQ(flight.supervisor.outcome(), arrived ? Outcome::kAborted : Outcome::kTimeout);
    EXPECT_NE(flight.supervisor.reason().find("HOLD was never confirmed"), std::string::npos);
  }
}

TEST(Supervisor, StoppingWaitsForRestButNotForEver) {
  Flight flight;
  flight.stop().run(3.5);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kStopping);
  EXPECT_EQ(flight.asked(Command::kHold), 0);
  flight.run(1.0);
  EXPECT_EQ(flight.asked(Command::kHold), 1);
  Flight rests;
  rests.stop().picture.at_rest = true;
  rests.run(0.25);
  EXPECT_EQ(rests.asked(Command::kHold), 0);
  rests.run(0.2);
  EXPECT_EQ(rests.asked(Command::kHold), 1);
}

TEST(Supervisor, TheFirstReasonToStopStands) {
  Flight flight;
  flight.stop().turn();
  flight.supervisor.stop(flight.now, Outcome::kTimeout, "later");
  flight.picture.at_rest = true;
  flight.run(0.5);
  flight.state.mode = FlightMode::kHold;
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "interrupted");
}

}  // namespace
}  // namespace jink::bridge
