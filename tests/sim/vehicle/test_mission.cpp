// SPDX-License-Identifier: BSD-3-Clause
// Missions flown in virtual time.
#include "sim/vehicle/mission.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/sim/vehicle/autopilot_flight.hpp"

namespace jink::sim::vehicle {
namespace {

using Kind = MissionItem::Kind;

constexpr unsigned kAuto = 4;
constexpr unsigned kAutoHold = 3;
constexpr unsigned kAutoMission = 4;

MissionItem item(Kind kind, const Vec3& position = Vec3::Zero(), double hold = 0.0) {
  MissionItem result;
  result.kind = kind;
  result.position = position;
  result.above_home = true;
  result.hold = hold;
  return result;
}

/// Flies and notes which items were reached, in order.
class MissionFlight : public Flight {
 public:
  explicit MissionFlight(const AutopilotOptions& options, std::vector<MissionItem> items) : Flight(options) {
    autopilot.set_mission(std::move(items));
  }

  double fly_until(const std::function<bool()>& done, double limit) {
    return run_until(
        [&] {
          const auto& now = autopilot.mission().reached();
          if (now != last_ && now) reached.push_back(*now);
          last_ = now;
          fastest = std::max(fastest, autopilot.true_motion().velocity.head<2>().norm());
          return done();
        },
        limit);
  }
  double fly_to_the_end(double limit = 120.0) {
    return fly_until([&] { return autopilot.mode() != FlightMode::kMission || !autopilot.armed(); }, limit);
  }
  [[nodiscard]] double distance(const Vec3& place) const { return (autopilot.true_motion().position - place).norm(); }

  std::vector<std::size_t> reached;
  double fastest = 0.0;

 private:
  std::optional<std::size_t> last_;
};

TEST(Mission, TakesOffFliesItsWaypointsAndHoldsAtTheEnd) {
  MissionFlight flight(instant_options(), {item(Kind::kTakeoff, {0, 0, 3}), item(Kind::kWaypoint, {10, 0, 3}, 2.0),
                                           item(Kind::kWaypoint, {10, 8, 5})});
  ASSERT_EQ(flight.autopilot.start_mission(0), Result::kAccepted);
  EXPECT_TRUE(flight.autopilot.armed());
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kMission);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  EXPECT_TRUE(flight.autopilot.mission().finished());
  flight.run(8.0);
  EXPECT_LT(flight.distance({10, 8, 5}), 0.2);
  EXPECT_TRUE(flight.said("Executing Mission"));
  EXPECT_TRUE(flight.said("Mission finished, loitering"));
  EXPECT_EQ(flight.landed_states, (std::vector{LandedState::kOnGround, LandedState::kTakeoff, LandedState::kInAir}));
}

TEST(Mission, ClimbsFirstWithoutATakeoffItem) {
  MissionFlight flight(instant_options(), {item(Kind::kWaypoint, {20, 0, 6})});
  ASSERT_EQ(flight.autopilot.start_mission(-1), Result::kAccepted);
  flight.fly_until([&] { return flight.autopilot.true_motion().position.z() > 5.0; }, 30.0);
  EXPECT_LT(flight.autopilot.true_motion().position.x(), 0.5);
  EXPECT_TRUE(flight.reached.empty());
  flight.fly_to_the_end();
  EXPECT_LT(flight.distance({20, 0, 6}), 2.5);
}

TEST(Mission, LandsWhereItsLandItemIsAndDisarms) {
  MissionFlight flight(instant_options(), {item(Kind::kTakeoff, {0, 0, 3}), item(Kind::kLand, {6, -3, 0})});
  ASSERT_EQ(flight.autopilot.start_mission(0), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_FALSE(flight.autopilot.armed());
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{0, 1}));
  EXPECT_LT(flight.distance({6, -3, 0}), 0.3);
  EXPECT_TRUE(flight.said("Mission finished, landed"));
  EXPECT_EQ(flight.landed_states.at(flight.landed_states.size() - 2), LandedState::kLanding);
  // Armed again it is flown again, from its first item.
  flight.reached.clear();
  ASSERT_EQ(flight.autopilot.start_mission(-1), Result::kAccepted);
  EXPECT_EQ(flight.autopilot.mission().current(), 0U);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{0, 1}));
}

TEST(Mission, EndsInReturnWithAReturnItem) {
  MissionFlight flight(instant_options(), {item(Kind::kTakeoff, {0, 0, 3}), item(Kind::kReturn)});
  ASSERT_EQ(flight.autopilot.start_mission(0), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kReturn);
}

TEST(Mission, StaysAtAWaypointAsLongAsItSays) {
  MissionFlight flight(airborne_options(), {item(Kind::kWaypoint, {5, 0, 3}, 6.0), item(Kind::kWaypoint, {0, 0, 3})});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  const double there = flight.fly_until([&] { return flight.distance({5, 0, 3}) < 1.9; }, 20.0);
  const double left = flight.fly_until([&] { return flight.autopilot.mission().current() == 1; }, 20.0);
  EXPECT_LT(there, 5.0);
  EXPECT_NEAR(left, 6.0, 0.3);
}

TEST(Mission, TakesTheRadiusAndTheHeadingOfAnItem) {
  MissionItem wide = item(Kind::kWaypoint, {10, 0, 3});
  wide.radius = 5.0;
  MissionItem turned = item(Kind::kWaypoint, {10, 0, 3});
  turned.yaw = 2.0;
  MissionFlight flight(airborne_options(), {wide, turned});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.fly_until([&] { return !flight.reached.empty(); }, 20.0);
  EXPECT_NEAR(flight.distance({10, 0, 3}), 5.0, 0.3);
  EXPECT_NEAR(flight.autopilot.true_motion().yaw, 0.0, 0.3);  // it looks ahead
  flight.fly_to_the_end();
  EXPECT_NEAR(flight.autopilot.true_motion().yaw, 2.0, 0.25);
}

TEST(Mission, KeepsToTheSpeedOfItsItems) {
  MissionItem slow = item(Kind::kSpeed);
  slow.speed = 1.5;
  MissionFlight flight(airborne_options(), {slow, item(Kind::kWaypoint, {12, 0, 3}), item(Kind::kSpeed)});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_NEAR(flight.fastest, 1.5, 0.15);
}

TEST(Mission, JumpsBackAsOftenAsItSays) {
  MissionItem back = item(Kind::kJump);
  back.repeats = 2;
  MissionFlight flight(airborne_options(), {item(Kind::kWaypoint, {5, 0, 3}), item(Kind::kWaypoint, {0, 0, 3}), back});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{0, 1, 0, 1, 0, 1}));
}

TEST(Mission, PassesOverAJumpToNowhere) {
  MissionItem nowhere = item(Kind::kJump);
  nowhere.jump_to = 9;
  nowhere.repeats = -1;
  MissionFlight flight(airborne_options(), {nowhere, item(Kind::kWaypoint, {5, 0, 3})});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{1}));
}

TEST(Mission, StaysAtAnItemThatDoesNotGoOn) {
  MissionItem last = item(Kind::kWaypoint, {5, 0, 3});
  last.autocontinue = false;
  MissionFlight flight(airborne_options(), {last, item(Kind::kWaypoint, {30, 0, 3})});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.run(15.0);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kMission);
  EXPECT_EQ(flight.autopilot.mission().reached(), 0U);
  EXPECT_LT(flight.distance({5, 0, 3}), 0.3);
}

TEST(Mission, IsPausedByHoldAndGoesOnWhereItWas) {
  MissionFlight flight(airborne_options(), {item(Kind::kWaypoint, {5, 0, 3}), item(Kind::kWaypoint, {30, 0, 3})});
  ASSERT_EQ(flight.autopilot.set_mode(kAuto, kAutoMission), Result::kAccepted);
  flight.fly_until([&] { return flight.autopilot.true_motion().position.x() > 10.0; }, 30.0);
  ASSERT_EQ(flight.autopilot.set_mode(kAuto, kAutoHold), Result::kAccepted);
  flight.run(10.0);
  EXPECT_LT(flight.autopilot.true_motion().position.x(), 20.0);
  EXPECT_EQ(flight.autopilot.mission().current(), 1U);
  ASSERT_EQ(flight.autopilot.set_mode(kAuto, kAutoMission), Result::kAccepted);
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{0, 1}));
  EXPECT_LT(flight.distance({30, 0, 3}), 2.5);
}

TEST(Mission, IsNeededToFlyOne) {
  Flight grounded(instant_options());
  EXPECT_EQ(grounded.autopilot.set_mode(kAuto, kAutoMission), Result::kAccepted);  // disarmed it changes
  EXPECT_EQ(grounded.autopilot.mode(), FlightMode::kMission);
  EXPECT_FALSE(grounded.autopilot.prearm_ok());
  EXPECT_EQ(grounded.autopilot.arm(), Result::kTemporarilyRejected);
  EXPECT_EQ(grounded.autopilot.start_mission(0), Result::kDenied);
  grounded.autopilot.set_mission({item(Kind::kTakeoff, {0, 0, 3})});
  EXPECT_EQ(grounded.autopilot.start_mission(1), Result::kDenied);
  EXPECT_EQ(grounded.autopilot.arm(), Result::kAccepted);
  Flight flying(airborne_options());
  EXPECT_EQ(flying.autopilot.set_mode(kAuto, kAutoMission), Result::kTemporarilyRejected);
  EXPECT_EQ(flying.autopilot.mode(), FlightMode::kHold);
}

TEST(Mission, ThatIsClearedInFlightEndsInHold) {
  MissionFlight flight(airborne_options(), {item(Kind::kWaypoint, {30, 0, 3})});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.run(2.0);
  flight.autopilot.set_mission({});
  flight.run(0.1);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  EXPECT_TRUE(flight.said("No valid mission available, loitering"));
}

TEST(Mission, GoesToAnotherItemOnRequest) {
  MissionFlight flight(airborne_options(), {item(Kind::kWaypoint, {30, 0, 3}), item(Kind::kWaypoint, {0, 6, 3})});
  ASSERT_EQ(flight.autopilot.fly_mission(), Result::kAccepted);
  flight.run(1.0);
  EXPECT_TRUE(flight.autopilot.set_mission_current(1));
  EXPECT_FALSE(flight.autopilot.set_mission_current(2));
  flight.fly_to_the_end();
  EXPECT_EQ(flight.reached, (std::vector<std::size_t>{1}));
}

TEST(Mission, IsCountedFromHomeOrFromTheSea) {
  AutopilotOptions options = instant_options();
  options.ground_height = 10.0;
  MissionItem absolute = item(Kind::kWaypoint, {0, 0, 16});
  absolute.above_home = false;
  MissionFlight flight(options, {item(Kind::kTakeoff, {0, 0, 3}), absolute});
  ASSERT_EQ(flight.autopilot.start_mission(0), Result::kAccepted);
  flight.fly_until([&] { return flight.reached.size() == 1; }, 30.0);
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 13.0, 1.0);
  flight.fly_to_the_end();
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 16.0, 0.9);
}

}  // namespace
}  // namespace jink::sim::vehicle
