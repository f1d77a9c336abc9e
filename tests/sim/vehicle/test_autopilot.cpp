// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/sim/vehicle/autopilot_flight.hpp"

namespace jink::sim::vehicle {
namespace {

constexpr auto kGround = LandedState::kOnGround;
constexpr auto kInAir = LandedState::kInAir;

TEST(Autopilot, CannotBeArmedBeforeItIsReady) {
  Flight flight{AutopilotOptions{}};
  expect_heartbeat(flight.autopilot, 0x1d, 0x03040000, 0);
  flight.run(4.2);
  EXPECT_FALSE(flight.autopilot.prearm_ok());
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
  flight.run(0.2);
  EXPECT_TRUE(flight.said("Resolve system health failures first"));
  EXPECT_TRUE(flight.autopilot.prearm_ok());
  expect_heartbeat(flight.autopilot, 0x1d, 0x03040000, 3);
  EXPECT_EQ(flight.autopilot.arm(), Result::kAccepted);
  EXPECT_EQ(flight.autopilot.arm(), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0x9d, 0x03040000, 4);
}

TEST(Autopilot, ArmedWithoutTakeoffItDisarmsAfterTenSeconds) {
  Flight flight(instant_options());
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  EXPECT_NEAR(flight.run_until([&] { return !flight.autopilot.armed(); }, 20.0), 10.0, 0.05);
  EXPECT_EQ(flight.autopilot.true_motion().position, Vec3::Zero());
}

TEST(Autopilot, OffboardWithoutAStreamIsAcceptedDisarmedButCannotArm) {
  Flight flight(instant_options());
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0x01, 0x00060000, 0);
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.offboard_setpoint(position_setpoint({0, 0, 3})), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0x11, 0x00060000, 3);
  EXPECT_EQ(flight.autopilot.arm(), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0x91, 0x00060000, 4);
}

TEST(Autopilot, OffboardWithoutAStreamIsRefusedArmed) {
  Flight flight(airborne_options());
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  EXPECT_EQ(flight.autopilot.offboard_setpoint(position_setpoint({0, 0, 3})), Result::kAccepted);
  EXPECT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  EXPECT_TRUE(flight.autopilot.offboard_active());
}

TEST(Autopilot, RefusesModesThatItCannotFly) {
  Flight flight(airborne_options());
  EXPECT_EQ(flight.autopilot.set_mode(3), Result::kTemporarilyRejected);     // POSCTL without manual control
  EXPECT_EQ(flight.autopilot.set_mode(4, 4), Result::kTemporarilyRejected);  // no mission
  EXPECT_EQ(flight.autopilot.set_mode(4, 77), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.set_mode(99), Result::kAccepted);  // and nothing happens
  EXPECT_EQ(flight.autopilot.set_mode(0xFFFFFFFFU), Result::kAccepted);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
}

TEST(Autopilot, DisarmingInTheAirNeedsForceAndThenItFalls) {
  Flight flight(airborne_options({1, 2, 8}));
  flight.run(1.0);
  EXPECT_EQ(flight.autopilot.disarm(), Result::kTemporarilyRejected);
  EXPECT_TRUE(flight.autopilot.armed());
  EXPECT_EQ(flight.autopilot.disarm(true), Result::kAccepted);
  EXPECT_FALSE(flight.autopilot.armed());
  EXPECT_EQ(flight.autopilot.landed_state(), kInAir);
  flight.run(0.5);
  EXPECT_LT(flight.autopilot.true_motion().velocity.z(), -3.0);
  EXPECT_EQ(flight.autopilot.landed_state(), kGround);  // PX4 takes what is disarmed for landed
  EXPECT_EQ(flight.autopilot.arm(true), Result::kTemporarilyRejected);
  flight.run(8.0);
  EXPECT_EQ(flight.autopilot.true_motion().position, Vec3(1, 2, 0));
  EXPECT_EQ(flight.autopilot.landed_state(), kGround);
  EXPECT_FALSE(flight.said("Landing detected"));  // which it says of what is armed alone
}

// Its thrust has come up where a take-off is not asked for any more, before anything has risen.
TEST(Autopilot, ATakeOffThatIsBrokenOffOnTheGroundEndsDisarmed) {
  Flight flight(instant_options());
  const Setpoint up = position_setpoint({0, 0, 3});
  flight.run(0.5, &up);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  flight.run(1.3, &up);
  ASSERT_EQ(flight.autopilot.model().motors(), Motors::kFlying);
  ASSERT_TRUE(flight.autopilot.landed());
  const Setpoint barely = position_setpoint({0, 0, 0.004});
  flight.run(4.0, &barely);
  ASSERT_EQ(flight.autopilot.land(), Result::kAccepted);
  flight.run(10.0);
  EXPECT_FALSE(flight.autopilot.armed());
}

TEST(Autopilot, OffboardTakeoffRisesAsSlowlyAsPx4s) {
  Flight flight(instant_options());
  const Setpoint setpoint = position_setpoint({0, 0, 3});
  flight.run(0.5, &setpoint);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  const std::vector<std::pair<double, double>> table{{2, 0.26}, {4, 1.04}, {6, 2.42}, {8, 2.9}};
  double t = 0;
  for (const auto& [time, height] : table) {
    flight.run(time - t, &setpoint);
    t = time;
    EXPECT_NEAR(flight.autopilot.true_motion().position.z(), height, 0.3) << "after " << time << " s";
    RecordProperty("height_" + std::to_string(static_cast<int>(time)) + "s",
                   std::to_string(flight.autopilot.true_motion().position.z()));
  }
}

TEST(Autopilot, OffboardFlightGoesThroughGroundAirGround) {
  Flight flight(instant_options());
  const Setpoint up = position_setpoint({0, 0, 3});
  flight.run(0.2, &up);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  const double rise = flight.run_until([&] { return flight.autopilot.landed_state() == kInAir; }, 10.0, &up);
  EXPECT_NEAR(rise, 2.0, 0.3);
  flight.run(8.0, &up);
  const Setpoint down = velocity_setpoint({0, 0, -0.7});
  EXPECT_LT(flight.run_until([&] { return flight.autopilot.landed(); }, 15.0, &down), 12.0);
  EXPECT_NEAR(flight.run_until([&] { return !flight.autopilot.armed(); }, 5.0, &down), 2.0, 0.05);
  EXPECT_EQ(flight.landed_states, (std::vector{kGround, kInAir, kGround}));
}

TEST(Autopilot, APositionSetpointBelowTheGroundNeverLands) {
  Flight flight(instant_options());
  flight.fly_offboard({0, 0, 2});
  const Setpoint below = position_setpoint({0, 0, -2});
  flight.run(30.0, &below);
  EXPECT_EQ(flight.autopilot.true_motion().position.z(), 0.0);
  EXPECT_EQ(flight.autopilot.landed_state(), kInAir);
  EXPECT_TRUE(flight.autopilot.armed());
}

TEST(Autopilot, TakeoffCommandClimbsHoldsAndLandDisarms) {
  Flight flight(instant_options());
  Autopilot& autopilot = flight.autopilot;
  EXPECT_EQ(autopilot.takeoff(), Result::kAccepted);
  EXPECT_EQ(autopilot.mode(), FlightMode::kTakeoff);
  EXPECT_FALSE(autopilot.armed());
  ASSERT_EQ(autopilot.arm(), Result::kAccepted);
  expect_heartbeat(autopilot, 0x9d, 0x02040000, 4);
  const double held = flight.run_until([&] { return autopilot.mode() == FlightMode::kHold; }, 20.0);
  EXPECT_NEAR(held, 7.0, 1.5);
  RecordProperty("hold_after_s", std::to_string(held));
  flight.run(5.0);
  EXPECT_NEAR(autopilot.true_motion().position.z(), 2.5, 0.1);
  EXPECT_EQ(autopilot.land(), Result::kAccepted);
  expect_heartbeat(autopilot, 0x9d, 0x06040000, 4);
  EXPECT_TRUE(autopilot.prearm_ok());
  EXPECT_LT(flight.run_until([&] { return autopilot.landed(); }, 30.0), 20.0);
  EXPECT_NEAR(flight.run_until([&] { return !autopilot.armed(); }, 5.0), 2.0, 0.05);
  EXPECT_EQ(flight.landed_states,
            (std::vector{kGround, LandedState::kTakeoff, kInAir, LandedState::kLanding, kGround}));
  EXPECT_EQ(autopilot.mode(), FlightMode::kHold);  // the mode before LAND, which forbids arming
  EXPECT_LT(autopilot.true_motion().position.head<2>().norm(), 0.2);
  for (const char* text : {"Armed by external command", "Takeoff detected", "Landing at current position",
                           "Landing detected", "Disarmed by landing"}) {
    EXPECT_TRUE(flight.said(text)) << text;
  }
}

TEST(Autopilot, TakeoffTakesAHeightOrTheParameter) {
  for (const bool by_parameter : {false, true}) {
    Flight flight(instant_options());
    if (by_parameter) {
      ASSERT_TRUE(flight.autopilot.parameters().set("MIS_TAKEOFF_ALT", 4.0F));
    }
    ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
    EXPECT_EQ(by_parameter ? flight.autopilot.takeoff() : flight.autopilot.takeoff(4.0), Result::kAccepted);
    flight.run(15.0);
    EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 4.0, 0.15);
    EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  }
}

TEST(Autopilot, HoldBrakesAndKeepsItsPlace) {
  Flight flight(airborne_options());
  const Setpoint fast = velocity_setpoint({4, 0, 0});
  flight.run(0.1, &fast);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  flight.run(5.0, &fast);
  ASSERT_GT(flight.autopilot.true_motion().velocity.x(), 2.5);
  const double x = flight.autopilot.true_motion().position.x();
  ASSERT_EQ(flight.autopilot.hold(), Result::kAccepted);
  flight.run(10.0);
  const Vec3 place = flight.autopilot.true_motion().position;
  EXPECT_LT(place.x() - x, 4.5);
  EXPECT_NEAR(place.z(), 3.0, 0.05);
  flight.run(10.0);
  EXPECT_LT((flight.autopilot.true_motion().position - place).norm(), 0.2);
}

TEST(Autopilot, RepositionFliesToAPointAndIsHoldOnTheGround) {
  Flight flight(airborne_options());
  EXPECT_EQ(flight.autopilot.reposition({5, -4, 6}), Result::kAccepted);
  flight.run(15.0);
  EXPECT_LT((flight.autopilot.true_motion().position - Vec3(5, -4, 6)).norm(), 0.1);
  Flight grounded(instant_options());
  EXPECT_EQ(grounded.autopilot.reposition({5, -4, 6}), Result::kAccepted);
  grounded.run(5.0);
  EXPECT_TRUE(grounded.autopilot.landed());
}

TEST(Autopilot, AStreamThatStopsTriggersTheDefaultFailsafeAndItSinksAndLands) {
  Flight flight(instant_options());
  flight.fly_offboard({0, 0, 3});
  const double lost = flight.run_until([&] { return flight.autopilot.in_failsafe(); }, 5.0);
  EXPECT_GE(lost, 0.97);
  EXPECT_LE(lost, 1.06);
  expect_heartbeat(flight.autopilot, 0xd1, 0x00030000, 5);
  EXPECT_FALSE(flight.autopilot.prearm_ok());
  flight.run(1.5);
  EXPECT_NEAR(flight.autopilot.true_motion().velocity.z(), -0.7, 0.05);
  EXPECT_LT(flight.run_until([&] { return !flight.autopilot.armed(); }, 20.0), 12.0);
  EXPECT_EQ(flight.landed_states, (std::vector{kGround, kInAir, kGround}));
  expect_heartbeat(flight.autopilot, 0x11, 0x00060000, 0);  // as recorded: back in the mode asked for
  EXPECT_TRUE(flight.said("Failsafe activated"));
}

TEST(Autopilot, TheFailsafeActionFollowsItsParameter) {
  struct Row {
    int action;
    unsigned base_mode;
    std::uint32_t custom_mode;
  };
  for (const Row& row : {Row{0, 0xd1, 0x00030000}, Row{1, 0xd1, 0x00020000}, Row{3, 0x9d, 0x05040000},
                         Row{4, 0x9d, 0x06040000}, Row{5, 0x9d, 0x03040000}}) {
    Flight flight(airborne_options());
    ASSERT_TRUE(flight.autopilot.parameters().set("COM_OBL_RC_ACT", std::int32_t{row.action}));
    const Setpoint here = position_setpoint({0, 0, 3});
    flight.run(0.1, &here);
    ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    flight.run(2.0, &here);
    flight.run(1.1);
    SCOPED_TRACE(row.action);
    expect_heartbeat(flight.autopilot, row.base_mode, row.custom_mode, 5);
    EXPECT_EQ(flight.autopilot.intended_mode(), FlightMode::kOffboard);
    flight.run(3.0);
    EXPECT_EQ(flight.autopilot.true_motion().velocity.z() < -0.3, row.action <= 1 || row.action == 4);
    EXPECT_EQ(flight.autopilot.true_motion().velocity.z() > 0.5, row.action == 3);
  }
}

TEST(Autopilot, ReturnClimbsFliesHomeAndLands) {
  Flight flight(instant_options());
  flight.fly_offboard({20, 0, 3});
  ASSERT_EQ(flight.autopilot.return_home(), Result::kAccepted);
  double highest = 0;
  const double duration = flight.run_until(
      [&] {
        highest = std::max(highest, flight.autopilot.true_motion().position.z());
        return !flight.autopilot.armed();
      },
      200.0);
  EXPECT_LT(duration, 150.0);
  EXPECT_NEAR(highest, 30.0, 1.0);
  EXPECT_LT(flight.autopilot.true_motion().position.head<2>().norm(), 0.5);
}

TEST(Autopilot, ItReturnsToOffboardByItselfEvenFromLand) {
  for (const int action : {0, 3, 4, 5}) {
    Flight flight(airborne_options({0, 0, 10}));
    ASSERT_TRUE(flight.autopilot.parameters().set("COM_OBL_RC_ACT", std::int32_t{action}));
    const Setpoint here = position_setpoint({0, 0, 10});
    flight.run(0.1, &here);
    ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    flight.run(1.0, &here);
    flight.run(3.0);
    ASSERT_TRUE(flight.autopilot.in_failsafe());
    EXPECT_LE(flight.run_until([&] { return flight.autopilot.offboard_active(); }, 2.0, &here), 0.4);
    EXPECT_EQ(flight.autopilot.heartbeat().system_status, 4);
  }
}

TEST(Autopilot, AnExplicitModeCommandEndsThat) {
  Flight flight(airborne_options({0, 0, 10}));
  const Setpoint here = position_setpoint({0, 0, 10});
  flight.run(0.1, &here);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  flight.run(1.0, &here);
  flight.run(2.0);
  ASSERT_TRUE(flight.autopilot.in_failsafe());
  ASSERT_EQ(flight.autopilot.set_mode(4, 3), Result::kAccepted);
  expect_heartbeat(flight.autopilot, 0x9d, 0x03040000, 4);
  flight.run(3.0, &here);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
}

TEST(Autopilot, SlowStreamsPassUpToTheTimeout) {
  for (const auto& [rate_hz, passes] : {std::pair{1.25, true}, std::pair{0.9, false}}) {
    Flight flight(airborne_options());
    const Setpoint here = position_setpoint({0, 0, 3});
    ASSERT_EQ(flight.autopilot.offboard_setpoint(here), Result::kAccepted);
    ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    int entered = 0;
    bool before = false;
    for (int i = 0; i < 10; ++i) {
      ASSERT_EQ(flight.autopilot.offboard_setpoint(here), Result::kAccepted);
      flight.run_until(
          [&] {
            entered += flight.autopilot.in_failsafe() && !before ? 1 : 0;
            before = flight.autopilot.in_failsafe();
            return false;
          },
          1.0 / rate_hz);
    }
    EXPECT_EQ(entered, passes ? 0 : 10) << rate_hz;
  }
}

TEST(Autopilot, RejectsSetpointsThatSayTooLittleOrAreInfinite) {
  Flight flight(airborne_options());
  EXPECT_EQ(flight.autopilot.offboard_setpoint(Setpoint{}), Result::kDenied);
  Setpoint partial;
  partial.position.z() = 3.0;
  EXPECT_EQ(flight.autopilot.offboard_setpoint(partial), Result::kDenied);
  EXPECT_EQ(flight.autopilot.offboard_setpoint(velocity_setpoint({0, planner::base::kInfinity, 0})), Result::kDenied);
  EXPECT_FALSE(flight.autopilot.stream_live());
  partial.velocity.head<2>().setZero();  // a height, and speeds for the rest
  EXPECT_EQ(flight.autopilot.offboard_setpoint(partial), Result::kAccepted);
  EXPECT_TRUE(flight.autopilot.stream_live());
}

TEST(Autopilot, ACrashStopsItForGood) {
  Flight flight(airborne_options({0, 0, 6}));
  flight.run(0.5);
  flight.autopilot.crash();
  EXPECT_FALSE(flight.autopilot.armed());
  flight.run(5.0);
  EXPECT_EQ(flight.autopilot.true_motion().position.z(), 0.0);
  EXPECT_TRUE(flight.autopilot.landed());
  EXPECT_EQ(flight.autopilot.arm(), Result::kTemporarilyRejected);
  EXPECT_EQ(flight.autopilot.arm(true), Result::kTemporarilyRejected);
  EXPECT_TRUE(flight.said("Collision"));
  EXPECT_FALSE(flight.autopilot.prearm_ok());
}

TEST(Autopilot, SpeedParametersBoundTheFlight) {
  Flight flight(airborne_options());
  ASSERT_TRUE(flight.autopilot.parameters().set("MPC_XY_VEL_MAX", 1.5F));
  const Setpoint far = position_setpoint({50, 0, 3});
  flight.run(0.1, &far);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  flight.run(15.0, &far);
  EXPECT_GT(flight.autopilot.true_motion().velocity.x(), 1.3);
  EXPECT_LT(flight.autopilot.true_motion().velocity.x(), 1.6);
}

TEST(Autopilot, NegativeSpeedParametersStopItAndBreakNothing) {
  Flight flight(airborne_options());
  for (const char* name : {"MPC_XY_VEL_MAX", "MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN"}) {
    ASSERT_TRUE(flight.autopilot.parameters().set(name, -3.0F));
  }
  const Setpoint far = position_setpoint({50, 0, 9});
  flight.run(0.1, &far);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  flight.run(5.0, &far);
  EXPECT_LT((flight.autopilot.true_motion().position - Vec3(0, 0, 3)).norm(), 0.05);
}

TEST(Autopilot, TheSameCommandsGiveTheSameBits) {
  const auto fly = [] {
    Flight flight(airborne_options());
    const Setpoint setpoint = position_setpoint({7, -3, 5});
    flight.run(0.1, &setpoint);
    EXPECT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    flight.run(3.0, &setpoint);
    return flight.autopilot.true_motion().position;
  };
  EXPECT_EQ(fly(), fly());
}

TEST(Autopilot, RejectsAStartThatIsNotFinite) {
  AutopilotOptions options;
  options.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Autopilot{options}, std::invalid_argument);
}

TEST(Parameters, HoldsPx4sDefaults) {
  const Parameters parameters{planner::base::VehicleLimits{}};
  EXPECT_EQ(parameters.integer("COM_RC_IN_MODE"), 1);
  EXPECT_EQ(parameters.integer("NAV_DLL_ACT"), 0);
  EXPECT_EQ(parameters.integer("COM_RCL_EXCEPT"), 0);
  EXPECT_EQ(parameters.real("COM_OF_LOSS_T"), 1.0);
  EXPECT_EQ(parameters.integer("COM_OBL_RC_ACT"), 0);
  EXPECT_EQ(parameters.real("MPC_XY_VEL_MAX"), 5.0);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    EXPECT_LE(parameters.at(i).name.size(), 16U);
    EXPECT_EQ(parameters.find(parameters.at(i).name), i);
  }
}

TEST(Parameters, RefusesUnknownNamesWrongTypesAndNonFiniteValues) {
  Parameters parameters{planner::base::VehicleLimits{}};
  EXPECT_FALSE(parameters.set("NO_SUCH_PARAM", 1.0F));
  EXPECT_FALSE(parameters.set("COM_OF_LOSS_T", std::int32_t{2}));
  EXPECT_FALSE(parameters.set("COM_OBL_RC_ACT", 3.0F));
  EXPECT_FALSE(parameters.set("COM_OF_LOSS_T", std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(parameters.real("COM_OF_LOSS_T"), 1.0);
  EXPECT_TRUE(parameters.set("COM_OF_LOSS_T", 0.5F));
  EXPECT_EQ(parameters.real("COM_OF_LOSS_T"), 0.5);
  EXPECT_THROW(static_cast<void>(parameters.real("COM_OBL_RC_ACT")), std::out_of_range);
}

TEST(Parameters, IntegersTravelBytewise) {
  EXPECT_EQ(std::bit_cast<std::uint32_t>(encode_bytewise(std::int32_t{6620000})), 6620000U);
  EXPECT_EQ(encode_bytewise(2.5F), 2.5F);
  EXPECT_EQ(decode_bytewise(encode_bytewise(std::int32_t{-7})), -7);
}

}  // namespace
}  // namespace jink::sim::vehicle
