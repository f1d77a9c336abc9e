// SPDX-License-Identifier: BSD-3-Clause
// In flight: the climb, hazards that pass or do not, the battery, the fence.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/bridge/supervisor/supervisor_flight.hpp"

namespace jink::bridge::supervisor {
namespace {

using Motion = Decision::Motion;
using testing::Flight;

// ---- climbing

TEST(Supervisor, ClimbEndsAtTheHeightOnlyWhenTheAutopilotIsInTheAir) {
  Flight flight;
  flight.climb().context.at_takeoff_height = true;
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
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  flight.state.mode = vehicle::FlightMode::kHold;
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
  flight.context.at_rest = true;
  EXPECT_EQ(flight.run(0.5).motion, Motion::kBrake);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kHold);
  flight.state.mode = vehicle::FlightMode::kHold;
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
      {"heartbeat", [](Flight& f) { f.heartbeats = false; }, [](Flight& f) { f.heartbeats = true; }, 5.0,
       "heartbeat is missing", true},
      {"tracks", [](Flight& f) { f.tracks = false; }, [](Flight& f) { f.tracks = true; }, 1.0, "tracks are stale",
       true},
      {"plan", [](Flight& f) { f.plans = false; }, [](Flight& f) { f.plans = true; }, 0.3, "planner is late", true},
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
        EXPECT_EQ(flight.run(hazard.age - 2 * Flight::kTurn).motion, normal);
      }
      EXPECT_EQ(flight.run(4 * Flight::kTurn).motion, Motion::kBrake);
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
      const auto brakes_until_asked = [&] {
        for (const double end = flight.now + hazard.age + 9.0;
             flight.asked(vehicle::Command::kHold) == 0 && flight.now < end;) {
          ASSERT_NE(flight.turn().motion, Motion::kNone);
        }
      };
      brakes_until_asked();
      if (!flight.heartbeats) {  // on an old one nothing is asked for: the vehicle may be a pilot's by now
        EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
        flight.heartbeats = true;
        brakes_until_asked();
      }
      ASSERT_EQ(flight.asked(vehicle::Command::kHold), 1);
      flight.heartbeats = true;
      flight.state.mode = vehicle::FlightMode::kHold;
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
  flight.context.lost_writers = 1;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  EXPECT_EQ(flight.supervisor.hazard(), "a writer of obstacle tracks has fallen silent");
  flight.context.lost_writers = 0;
  flight.context.unsent_for = 0.1;
  EXPECT_EQ(flight.turn().motion, Motion::kFollow);
  flight.context.unsent_for = 0.3;
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

// ---- battery and fence

TEST(Supervisor, ACriticalBatteryEndsTheFlightByLanding) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.battery = vehicle::BatteryState::kLow;
  EXPECT_EQ(flight.run(1.0).motion, Motion::kFollow);
  flight.state.battery = vehicle::BatteryState::kCritical;
  EXPECT_EQ(flight.turn().motion, Motion::kBrake);
  flight.context.at_rest = true;
  flight.run(0.5);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kLand);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.run(1.0);
  // Ctrl-C must not keep it in the air.
  flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "the battery is critical; interrupted, the landing goes on");
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
}

// Pressed while it brakes, and again in every turn: LAND is asked for first.
TEST(Supervisor, CtrlCDoesNotKeepACriticalBatteryFromLanding) {
  Flight flight;
  flight.fly().run(1.0);
  flight.state.battery = vehicle::BatteryState::kCritical;
  flight.context.at_rest = true;
  for (int i = 0; i < 60; ++i) {
    flight.turn();
    flight.supervisor.stop(flight.now, Outcome::kAborted, "interrupted");
  }
  EXPECT_EQ(flight.asked(vehicle::Command::kLand), 1);
  EXPECT_EQ(flight.asked(vehicle::Command::kHold), 0);
  EXPECT_FALSE(flight.supervisor.done());
  flight.state.mode = vehicle::FlightMode::kLand;
  flight.turn();
  EXPECT_TRUE(flight.supervisor.done());
}

TEST(Supervisor, ABatteryThatEndsWhileItStopsLandsToo) {
  Flight flight;
  flight.stop();
  flight.state.battery = vehicle::BatteryState::kCritical;
  flight.context.at_rest = true;
  flight.run(1.0);
  EXPECT_EQ(flight.requests.back(), vehicle::Command::kLand);
}

TEST(Supervisor, DoesNotBeginWithALowBattery) {
  Flight flight;
  flight.state.battery = vehicle::BatteryState::kLow;
  flight.run(61.0);
  EXPECT_TRUE(flight.requests.empty());
  EXPECT_NE(flight.supervisor.reason().find("charged battery: it is low"), std::string::npos);
}

TEST(Supervisor, DoesNotBeginAMissionThatCannotBeFlownFromThere) {
  Flight flight;
  flight.context.misplaced = "a waypoint is under the ground";
  flight.turn();
  EXPECT_EQ(flight.supervisor.outcome(), Outcome::kAborted);
  EXPECT_EQ(flight.supervisor.reason(), "a waypoint is under the ground");
  EXPECT_TRUE(flight.requests.empty());
}

TEST(Supervisor, WaitsAMomentForTheHeightOfTheGround) {
  Flight flight;
  flight.context.ground_known = false;
  flight.run(2.9);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kWaiting);
  EXPECT_NE(flight.supervisor.waiting_for().find("home"), std::string::npos);
  flight.run(0.3);
  EXPECT_EQ(flight.supervisor.phase(), Phase::kEngaging);
}

}  // namespace
}  // namespace jink::bridge::supervisor
