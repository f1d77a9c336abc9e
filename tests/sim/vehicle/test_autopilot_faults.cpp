// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/sim/vehicle/autopilot_flight.hpp"

namespace jink::sim::vehicle {
namespace {

/// In the air, and in OFFBOARD there for 2 s.
class OffboardFlight : public Flight {
 public:
  explicit OffboardFlight(const Vec3& at = Vec3(0, 0, 10), const AutopilotOptions* options = nullptr)
      : Flight(options != nullptr ? *options : airborne_options(at)), here(position_setpoint(at)) {
    run(0.1, &here);
    EXPECT_EQ(autopilot.set_mode(6), Result::kAccepted);
    run(2.0, &here);
  }
  Setpoint here;
};

// Satellite navigation.

TEST(GpsFault, FiveSecondsLaterOffboardFallsToAltitudeSinksAndDrifts) {
  AutopilotOptions options = airborne_options({0, 0, 10});
  options.wind.mean = {1.5, 0, 0};
  OffboardFlight flight({0, 0, 10}, &options);
  flight.run(5.0, &flight.here);
  flight.autopilot.set_gps(false);
  EXPECT_NEAR(flight.run_until([&] { return flight.autopilot.in_failsafe(); }, 20.0, &flight.here), 5.0, 0.1);
  expect_heartbeat(flight.autopilot, 0xd1, 0x00020000, 5);
  EXPECT_FALSE(flight.autopilot.position_valid());
  EXPECT_FALSE(flight.autopilot.prearm_ok());
  const double x = flight.autopilot.true_motion().position.x();
  flight.run(4.0, &flight.here);
  EXPECT_NEAR(flight.autopilot.true_motion().velocity.z(), -0.7, 0.05);
  EXPECT_GT(flight.autopilot.true_motion().position.x() - x, 2.0);
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.hold(), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.land(), Result::kTemporarilyRejected);
  EXPECT_LT(flight.run_until([&] { return !flight.autopilot.armed(); }, 40.0, &flight.here), 30.0);
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
}

TEST(GpsFault, WhenItComesBackSoDoesOffboardAndOnlyALongCutIsAFailsafeWithAReset) {
  for (const bool is_long : {false, true}) {
    SCOPED_TRACE(is_long);
    OffboardFlight flight;
    const auto resets = flight.autopilot.estimator().reset_counter();
    flight.autopilot.set_gps(false);
    flight.run(is_long ? 7.0 : 4.0, &flight.here);
    ASSERT_EQ(flight.autopilot.mode(), is_long ? FlightMode::kAltitude : FlightMode::kOffboard);
    flight.autopilot.set_gps(true);
    flight.run(0.1, &flight.here);
    EXPECT_TRUE(flight.autopilot.offboard_active());
    EXPECT_EQ(flight.autopilot.estimator().reset_counter(), resets + (is_long ? 1 : 0));
    flight.run(10.0, &flight.here);
    EXPECT_EQ(flight.said("Failsafe activated"), is_long);
    EXPECT_LT((flight.autopilot.true_motion().position - flight.here.position).norm(), 0.2);
  }
}

TEST(GpsFault, HoldCannotHoldAndDescends) {
  Flight flight(airborne_options({0, 0, 4}));
  flight.autopilot.set_gps(false);
  flight.run(5.2);
  expect_heartbeat(flight.autopilot, 0x9d, 0x06040000, 5);
  EXPECT_LT(flight.run_until([&] { return !flight.autopilot.armed(); }, 40.0), 30.0);
}

// Jumps of the estimate.

TEST(JumpFault, AnOffboardPositionIsFollowedInTheNewEstimate) {
  OffboardFlight flight;
  flight.run(8.0, &flight.here);
  const Vec3 truth = flight.autopilot.true_motion().position;
  flight.autopilot.jump_estimate({1.5, 0, 0.5});
  EXPECT_EQ(flight.autopilot.true_motion().position, truth);
  EXPECT_LT((flight.autopilot.estimated_motion().position - truth - Vec3(1.5, 0, 0.5)).norm(), 1e-12);
  EXPECT_EQ(flight.autopilot.estimator().reset_counter(), 1);
  flight.run(10.0, &flight.here);
  EXPECT_LT((flight.autopilot.true_motion().position - truth - Vec3(-1.5, 0, -0.5)).norm(), 0.15);
  EXPECT_LT((flight.autopilot.estimated_motion().position - flight.here.position).norm(), 0.15);
}

TEST(JumpFault, HoldTakesItsPlaceAlong) {
  Flight flight(airborne_options({0, 0, 5}));
  flight.run(5.0);
  flight.autopilot.jump_estimate({2, -1, 0.5});
  double furthest = 0;
  flight.run_until(
      [&] {
        furthest = std::max(furthest, (flight.autopilot.true_motion().position - Vec3(0, 0, 5)).norm());
        return false;
      },
      8.0);
  EXPECT_LT(furthest, 0.01);
}

// The battery.

TEST(BatteryFault, LevelsArePx4sDefaults) {
  Flight flight(airborne_options());
  const auto level = [&](double remaining) {
    flight.autopilot.set_battery(remaining);
    return flight.autopilot.battery_level();
  };
  EXPECT_EQ(flight.autopilot.battery_level(), BatteryLevel::kOk);
  EXPECT_EQ(level(0.15), BatteryLevel::kOk);
  EXPECT_EQ(level(0.14), BatteryLevel::kLow);
  EXPECT_EQ(level(0.069), BatteryLevel::kCritical);
  EXPECT_EQ(level(0.049), BatteryLevel::kEmergency);
  EXPECT_EQ(level(-3.0), BatteryLevel::kEmergency);
  EXPECT_EQ(level(7.0), BatteryLevel::kOk);
  EXPECT_EQ(level(kNan), BatteryLevel::kUnknown);
}

TEST(BatteryFault, ByDefaultItOnlyWarns) {
  OffboardFlight flight;
  for (const double remaining : {0.14, 0.06, 0.01}) {
    flight.autopilot.set_battery(remaining);
    flight.run(8.0, &flight.here);
    EXPECT_TRUE(flight.autopilot.offboard_active()) << remaining;
    EXPECT_EQ(flight.autopilot.heartbeat().system_status, 4);
  }
  EXPECT_TRUE(flight.said("Low battery"));
  EXPECT_TRUE(flight.said("Critical battery"));
  EXPECT_TRUE(flight.said("Emergency battery"));
}

TEST(BatteryFault, OneThatIsNotKnownAndThenFullIsNoWarning) {
  Flight flight(instant_options());
  flight.autopilot.set_battery(kNan);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  flight.run(1.0);
  flight.autopilot.set_battery(1.0);
  flight.run(1.0);
  EXPECT_FALSE(flight.said("battery"));
}

struct BatteryCase {
  int action;
  double remaining;
  FlightMode mode;
};

TEST(BatteryFault, ActsByItsParameterAfterATimeInHold) {
  for (const BatteryCase& c : {BatteryCase{2, 0.14, FlightMode::kOffboard}, BatteryCase{2, 0.06, FlightMode::kLand},
                               BatteryCase{3, 0.06, FlightMode::kReturn}, BatteryCase{3, 0.04, FlightMode::kLand}}) {
    SCOPED_TRACE(testing::Message() << "COM_LOW_BAT_ACT " << c.action << ", " << c.remaining);
    OffboardFlight flight;
    ASSERT_TRUE(flight.autopilot.parameters().set("COM_LOW_BAT_ACT", std::int32_t{c.action}));
    flight.autopilot.set_battery(c.remaining);
    flight.run(1.0, &flight.here);
    const bool acts = c.mode != FlightMode::kOffboard;
    EXPECT_EQ(flight.autopilot.mode(), acts ? FlightMode::kHold : FlightMode::kOffboard);
    EXPECT_EQ(flight.autopilot.heartbeat().system_status, acts ? 5 : 4);
    flight.run(4.5, &flight.here);
    EXPECT_EQ(flight.autopilot.mode(), c.mode);
    EXPECT_EQ(flight.autopilot.in_failsafe(), acts);
    EXPECT_EQ(flight.autopilot.intended_mode(), FlightMode::kOffboard);
  }
}

TEST(BatteryFault, ReturnAtCriticalBecomesLandInAnEmergency) {
  OffboardFlight flight;
  ASSERT_TRUE(flight.autopilot.parameters().set("COM_LOW_BAT_ACT", std::int32_t{3}));
  flight.autopilot.set_battery(0.06);
  flight.run(8.0, &flight.here);
  ASSERT_EQ(flight.autopilot.mode(), FlightMode::kReturn);
  flight.autopilot.set_battery(0.03);
  flight.run(0.1, &flight.here);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kLand);
}

TEST(BatteryFault, AModeCommandTakesTheFlightOver) {
  OffboardFlight flight;
  ASSERT_TRUE(flight.autopilot.parameters().set("COM_LOW_BAT_ACT", std::int32_t{2}));
  flight.autopilot.set_battery(0.06);
  flight.run(6.0, &flight.here);
  ASSERT_EQ(flight.autopilot.mode(), FlightMode::kLand);
  EXPECT_EQ(flight.autopilot.hold(), Result::kAccepted);
  flight.run(3.0, &flight.here);
  expect_heartbeat(flight.autopilot, 0x9d, 0x03040000, 4);
}

TEST(BatteryFault, ALevelKnownWhenArmedIsNotActedUpon) {
  Flight flight(instant_options());
  ASSERT_TRUE(flight.autopilot.parameters().set("COM_LOW_BAT_ACT", std::int32_t{2}));
  flight.autopilot.set_battery(0.06);
  ASSERT_EQ(flight.autopilot.takeoff(), Result::kAccepted);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  flight.run(20.0);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  EXPECT_FALSE(flight.autopilot.in_failsafe());
}

// Reboots.

TEST(RebootFault, InTheAirItFallsAndComesUpAgain) {
  AutopilotOptions options;
  options.airborne = true;
  options.position = {3, -2, 6};
  Flight flight(options);
  ASSERT_TRUE(flight.autopilot.parameters().set("COM_OBL_RC_ACT", std::int32_t{5}));
  flight.run(10.0);
  flight.autopilot.reboot();
  EXPECT_FALSE(flight.autopilot.armed());
  EXPECT_EQ(flight.autopilot.boot_time(), 0.0);
  EXPECT_EQ(flight.autopilot.reboots(), 1);
  expect_heartbeat(flight.autopilot, 0x1d, 0x03040000, 0);
  EXPECT_EQ(flight.autopilot.landed_state(), LandedState::kInAir);
  flight.run(0.5);
  EXPECT_LT(flight.autopilot.true_motion().velocity.z(), -3.0);
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
  flight.run(8.0);
  EXPECT_EQ(flight.autopilot.true_motion().position, Vec3(3, -2, 0));
  EXPECT_TRUE(flight.autopilot.landed());
  EXPECT_TRUE(flight.autopilot.ready());
  EXPECT_NEAR(flight.autopilot.boot_time(), 8.5, 0.01);
  // Its local frame begins where it is now.
  EXPECT_LT(flight.autopilot.estimated_motion().position.norm(), 1e-9);
  EXPECT_EQ(flight.autopilot.estimator().origin(), Vec3(3, -2, 0));
  EXPECT_EQ(flight.autopilot.parameters().integer("COM_OBL_RC_ACT"), 5);
  EXPECT_EQ(flight.autopilot.arm(), Result::kAccepted);
}

TEST(RebootFault, OnTheGroundItIsReadyAfterItsStartAndFlies) {
  Flight flight{AutopilotOptions{}};
  flight.run(6.0);
  ASSERT_TRUE(flight.autopilot.prearm_ok());
  flight.autopilot.reboot();
  flight.run(4.2);
  EXPECT_FALSE(flight.autopilot.prearm_ok());
  flight.run(0.2);
  EXPECT_TRUE(flight.autopilot.prearm_ok());
  flight.fly_offboard({2, 1, 3});
}

// A pilot.

TEST(Pilot, FliesByHandTheStreamDoesNotTakeItBackAndWithHimALostOneHolds) {
  OffboardFlight flight;
  EXPECT_EQ(flight.autopilot.set_mode(3), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.pilot_mode(FlightMode::kPosition), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0xd1, 0x00030000, 4);
  flight.run(5.0, &flight.here);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kPosition);
  EXPECT_LT((flight.autopilot.true_motion().position - Vec3(0, 0, 10)).norm(), 0.1);
  EXPECT_EQ(flight.autopilot.pilot_mode(FlightMode::kOffboard), Result::kAccepted);
  EXPECT_TRUE(flight.autopilot.offboard_active());
  flight.run(2.0, &flight.here);
  flight.run(5.0);  // without a remote control it would sink
  expect_heartbeat(flight.autopilot, 0xd1, 0x00030000, 5);
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 10.0, 0.1);
}

TEST(Pilot, WhoseRemoteControlIsThereFromTheStartHasTheSticksInAFailsafe) {
  AutopilotOptions options = airborne_options({0, 0, 10});
  options.remote_control = true;
  Flight flight(options);
  const Setpoint here = position_setpoint({0, 0, 10});
  flight.run(0.5, &here);
  EXPECT_TRUE(flight.autopilot.remote_control());
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  flight.run(1.0, &here);
  flight.run(5.0);
  expect_heartbeat(flight.autopilot, 0xd1, 0x00030000, 5);
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 10.0, 0.1);
}

TEST(Pilot, OffboardNeedsAStreamForHimToo) {
  Flight flight(airborne_options());
  EXPECT_EQ(flight.autopilot.pilot_mode(FlightMode::kOffboard), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.pilot_mode(FlightMode::kLand), Result::kAccepted);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kLand);
}

TEST(Pilot, InTheWindPositionHoldsAndAltitudeDrifts) {
  AutopilotOptions options = airborne_options({0, 0, 10});
  options.wind.mean = {2, 0, 0};
  OffboardFlight flight({0, 0, 10}, &options);
  ASSERT_EQ(flight.autopilot.pilot_mode(FlightMode::kPosition), Result::kAccepted);
  flight.run(15.0);
  EXPECT_LT(std::abs(flight.autopilot.true_motion().velocity.x()), 0.05);
  const Vec3 place = flight.autopilot.true_motion().position;
  ASSERT_EQ(flight.autopilot.pilot_mode(FlightMode::kAltitude), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0xd1, 0x00020000, 4);
  flight.run(10.0);
  EXPECT_NEAR(flight.autopilot.true_motion().velocity.x(), 2.0, 0.1);
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), place.z(), 0.1);
  EXPECT_GT(flight.autopilot.true_motion().position.x(), place.x() + 10.0);
}

// Refusals.

TEST(Refusals, ArmingIsRefusedAndTheHealthBitSaysSo) {
  Flight flight(instant_options());
  flight.autopilot.refuse_arming(true);
  EXPECT_FALSE(flight.autopilot.prearm_ok());
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.arm(true), Result::kTemporarilyRejected);
  flight.run(0.1);
  EXPECT_TRUE(flight.said("Arming denied"));
  flight.autopilot.refuse_arming(false);
  EXPECT_EQ(flight.autopilot.arm(), Result::kAccepted);
}

TEST(Refusals, OffboardIsRefusedInTheAirAndCannotArmOnTheGround) {
  Flight flight(airborne_options());
  const Setpoint here = position_setpoint({0, 0, 3});
  flight.autopilot.refuse_offboard(true);
  flight.run(1.0, &here);
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  flight.autopilot.refuse_offboard(false);
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);

  Flight grounded(instant_options());
  grounded.autopilot.refuse_offboard(true);
  grounded.run(0.5, &here);
  EXPECT_EQ(grounded.autopilot.set_mode(6), Result::kAccepted);
  EXPECT_EQ(grounded.autopilot.arm(), Result::kTemporarilyRejected);
}

TEST(Refusals, AnOffboardThatFliesGoesOnButDoesNotComeBack) {
  OffboardFlight flight;
  ASSERT_TRUE(flight.autopilot.parameters().set("COM_OBL_RC_ACT", std::int32_t{5}));
  flight.autopilot.refuse_offboard(true);
  flight.run(3.0, &flight.here);
  EXPECT_TRUE(flight.autopilot.offboard_active());
  flight.run(2.0);
  ASSERT_TRUE(flight.autopilot.in_failsafe());
  flight.run(3.0, &flight.here);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  flight.autopilot.refuse_offboard(false);
  flight.run(0.1, &flight.here);
  EXPECT_TRUE(flight.autopilot.offboard_active());
}

TEST(Px4Releases, DifferInParametersAndInWhatIsCritical) {
  struct Case {
    Px4Version version;
    bool critical;
    bool sticks_by_speed;
  };
  for (const Case& c : {Case{Px4Version::k1_14, true, false}, Case{Px4Version::k1_16, false, false},
                        Case{Px4Version::k1_17, false, false}, Case{Px4Version::k1_18, false, true}}) {
    AutopilotOptions options = airborne_options({0, 0, 10});
    options.version = c.version;
    OffboardFlight flight({0, 0, 10}, &options);
    flight.autopilot.set_battery(0.12);
    flight.run(0.1, &flight.here);
    expect_heartbeat(flight.autopilot, 0x91, 0x00060000, c.critical ? 5 : 4);
    EXPECT_FALSE(flight.autopilot.in_failsafe());
    const Parameters& parameters = flight.autopilot.parameters();
    EXPECT_EQ(parameters.find("MAN_OVERRIDE_SPD").has_value(), c.sticks_by_speed);
    for (const char* gone : {"COM_RC_OVERRIDE", "COM_RC_STICK_OV", "COM_OBC_LOSS_T"})
      EXPECT_EQ(parameters.find(gone).has_value(), !c.sticks_by_speed) << gone;
  }
}

TEST(Home, FollowsTheVehicleWhileItIsDisarmedUnlessItWasSet) {
  Flight flight(instant_options());
  flight.fly_offboard({4, 0, 2});
  EXPECT_LT(flight.autopilot.home().norm(), 1e-9);
  ASSERT_EQ(flight.autopilot.land(), Result::kAccepted);
  flight.run(30.0);
  ASSERT_FALSE(flight.autopilot.armed());
  EXPECT_NEAR(flight.autopilot.home().x(), 4.0, 0.3);
  ASSERT_EQ(flight.autopilot.set_home({1, 1, 0}), Result::kAccepted);
  flight.run(1.0);
  EXPECT_EQ(flight.autopilot.home(), Vec3(1, 1, 0));
}

}  // namespace
}  // namespace jink::sim::vehicle
