// SPDX-License-Identifier: BSD-3-Clause
// What PX4's numbers mean and which of its answers count, by hand-worked cases.
#include "bridge/vehicle/px4.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridge/vehicle/command_tracker.hpp"

namespace jink::bridge::vehicle {
namespace {

namespace px4 = px4;

// The custom_mode values of the heartbeat table in PX4 SITL recordings.
TEST(Px4, NamesTheModesOfAHeartbeat) {
  EXPECT_EQ(px4::flight_mode(12, 0x03040000), FlightMode::kHold);
  EXPECT_EQ(px4::flight_mode(12, 0x02040000), FlightMode::kTakeoff);
  EXPECT_EQ(px4::flight_mode(12, 0x04040000), FlightMode::kMission);
  EXPECT_EQ(px4::flight_mode(12, 0x05040000), FlightMode::kReturn);
  EXPECT_EQ(px4::flight_mode(12, 0x06040000), FlightMode::kLand);
  EXPECT_EQ(px4::flight_mode(12, 0x09040000), FlightMode::kOther);  // precision landing
  EXPECT_EQ(px4::flight_mode(12, 0x00060000), FlightMode::kOffboard);
  EXPECT_EQ(px4::flight_mode(12, 0x00030000), FlightMode::kPosition);
  EXPECT_EQ(px4::flight_mode(12, 0x00020000), FlightMode::kAltitude);
  EXPECT_EQ(px4::flight_mode(12, 0x00010000), FlightMode::kManual);
  EXPECT_EQ(px4::flight_mode(3, 0x00060000),
            FlightMode::kOther);  // another autopilot's numbers mean other things
}

TEST(Px4, NamesWhatHealthLacks) {
  // Ready to arm, and in OFFBOARD without a stream: from recordings of PX4 SITL.
  EXPECT_EQ(px4::failed_health(0x300402f, 0x301402f, 0x1320c83f), "");
  EXPECT_EQ(px4::failed_health(0x300402f, 0x301402f, 0x320c83f), "pre-arm check");
  EXPECT_EQ(px4::failed_health(0x300402f, 0x301402f, 0x1320c81b), "magnetometer, GPS");
  EXPECT_EQ(px4::failed_health(0x24, 0x4, 0x10000000),
            "magnetometer");  // a GPS that is not enabled is not missed
}

TEST(Px4, KnowsAnEstimatorThatHoldsAPosition) {
  EXPECT_TRUE(px4::estimator_has_local_position(1023));  // from recordings: on the ground, in flight, sinking
  EXPECT_TRUE(px4::estimator_has_local_position(895));
  EXPECT_TRUE(px4::estimator_has_local_position(831));
  EXPECT_TRUE(px4::estimator_has_local_position(2 | 4 | 8 | 32));  // relative, as without GPS
  EXPECT_FALSE(px4::estimator_has_local_position(2 | 4 | 32));
  EXPECT_FALSE(px4::estimator_has_local_position(831 & ~32));
  EXPECT_FALSE(px4::estimator_has_local_position(831 & ~2));
  EXPECT_FALSE(px4::estimator_has_local_position(0));
}

TEST(Px4, KnowsTheStateOfABattery) {
  const std::vector<BatteryState> expected{BatteryState::kUnknown,  BatteryState::kOk,       BatteryState::kLow,
                                           BatteryState::kCritical, BatteryState::kCritical, BatteryState::kCritical,
                                           BatteryState::kCritical, BatteryState::kOk,       BatteryState::kUnknown};
  for (std::uint32_t state = 0; state < expected.size(); ++state) {
    EXPECT_EQ(px4::battery_state(state), expected[state]) << state;
  }
  EXPECT_EQ(px4::battery_state_from_remaining(16.0), BatteryState::kOk);
  EXPECT_EQ(px4::battery_state_from_remaining(15.0), BatteryState::kLow);
  EXPECT_EQ(px4::battery_state_from_remaining(8.0), BatteryState::kLow);
  EXPECT_EQ(px4::battery_state_from_remaining(7.0), BatteryState::kCritical);
  EXPECT_EQ(px4::battery_state_from_remaining(-1.0), BatteryState::kUnknown);
  EXPECT_EQ(px4::battery_state_from_remaining(std::nan("")), BatteryState::kUnknown);
}

TEST(Px4, ReadsVersionsAndParameters) {
  EXPECT_EQ(px4::to_string(px4::version(0x01110040)), "1.17.0 alpha");
  EXPECT_EQ(px4::to_string(px4::version(0x010F04FF)), "1.15.4");
  EXPECT_EQ(px4::to_string(px4::version(0x010F0400)), "1.15.4 development");
  EXPECT_EQ(px4::to_string(px4::version(0x010F0480)), "1.15.4 beta");
  EXPECT_EQ(px4::to_string(px4::version(0x010F04C0)), "1.15.4 candidate");
  const double five = 7.006492321624085e-45;  // the bytes of 5, read as a float
  EXPECT_EQ(px4::parameter("A", 6, five, true).value, 5.0);
  EXPECT_TRUE(px4::parameter("A", 6, five, true).integer);
  EXPECT_EQ(px4::parameter("A", 6, 5.0, false).value, 5.0);
  EXPECT_EQ(px4::parameter("A", 9, 0.5, true).value, 0.5);
  EXPECT_FALSE(px4::parameter("A", 9, 0.5, true).integer);
  EXPECT_TRUE(std::isnan(px4::parameter("A", 6, std::nan(""), true).value));  // -1 as a float is no number
}

TEST(Px4, SaysWhatTheEstimatorLacks) {
  EXPECT_EQ(px4::estimator_complaints(895), "");
  EXPECT_EQ(px4::estimator_complaints(895 & ~24U), "no horizontal position");
  EXPECT_EQ(px4::estimator_complaints(895 | 1024U), "GPS glitch");
  EXPECT_EQ(px4::estimator_complaints(0),
            "no attitude, no horizontal velocity, no vertical velocity, no height, no horizontal position");
}

std::string text(const std::optional<CommandReport>& report) {
  if (!report) return "-";
  return std::string(to_string(report->command)) + (report->accepted ? " yes" : " no: " + report->detail);
}

TEST(CommandTracker, ReportsTheOneAnswer) {
  CommandTracker tracker;
  tracker.start(Command::kArm, px4::kArmDisarm, 10.0);
  EXPECT_EQ(text(tracker.next(10.5)), "-");
  tracker.acknowledge(px4::kNavLand, 0, 10.5);  // another command's
  EXPECT_EQ(text(tracker.next(10.5)), "-");
  tracker.acknowledge(px4::kArmDisarm, 1, 10.6);
  EXPECT_EQ(text(tracker.next(10.6)), "arm no: temporarily rejected");
  tracker.acknowledge(px4::kArmDisarm, 0, 10.7);  // nothing open any more
  EXPECT_EQ(text(tracker.next(99.0)), "-");
}

TEST(CommandTracker, TakesTheSecondAnswerToASetModeForTheTruth) {
  CommandTracker tracker;
  tracker.start(Command::kOffboard, px4::kDoSetMode, 0.0);
  tracker.acknowledge(px4::kDoSetMode, 0, 0.005);
  EXPECT_EQ(text(tracker.next(0.005)), "-");
  tracker.acknowledge(px4::kDoSetMode, 1, 0.017);
  EXPECT_EQ(text(tracker.next(0.017)), "offboard no: temporarily rejected");

  tracker.start(Command::kHold, px4::kDoSetMode, 1.0);
  tracker.acknowledge(px4::kDoSetMode, 0, 1.0);
  tracker.acknowledge(px4::kDoSetMode, 0, 1.01);
  EXPECT_EQ(text(tracker.next(1.01)), "hold yes");

  tracker.start(Command::kHold, px4::kDoSetMode, 2.0);
  tracker.acknowledge(px4::kDoSetMode, 2, 2.0);
  EXPECT_EQ(text(tracker.next(2.0)), "hold no: denied");
}

TEST(CommandTracker, ContentsItselfWithOneAnswerToASetModeInTheEnd) {
  CommandTracker tracker;
  tracker.start(Command::kHold, px4::kDoSetMode, 0.0);
  tracker.acknowledge(px4::kDoSetMode, 0, 0.1);
  EXPECT_EQ(text(tracker.next(0.1 + 0.9 * CommandTracker::kSecondAnswer_s)), "-");
  EXPECT_EQ(text(tracker.next(0.1 + 1.1 * CommandTracker::kSecondAnswer_s)), "hold yes");
  EXPECT_EQ(text(tracker.next(9.0)), "-");
}

TEST(CommandTracker, ReportsSilence) {
  CommandTracker tracker;
  tracker.start(Command::kLand, px4::kNavLand, 5.0);
  EXPECT_EQ(text(tracker.next(5.99)), "-");
  EXPECT_EQ(text(tracker.next(6.0)), "land no: no answer");
}

TEST(CommandTracker, WaitsOnWhileInProgress) {
  CommandTracker tracker;
  tracker.start(Command::kArm, px4::kArmDisarm, 0.0);
  tracker.acknowledge(px4::kArmDisarm, px4::kResultInProgress, 0.9);
  EXPECT_EQ(text(tracker.next(1.5)), "-");
  tracker.acknowledge(px4::kArmDisarm, 0, 1.6);
  EXPECT_EQ(text(tracker.next(1.6)), "arm yes");
}

TEST(CommandTracker, SaysThatANewerRequestTookTheAnswer) {
  CommandTracker tracker;
  tracker.start(Command::kOffboard, px4::kDoSetMode, 0.0);
  tracker.start(Command::kArm, px4::kArmDisarm, 0.0);
  tracker.start(Command::kHold, px4::kDoSetMode, 0.0);
  EXPECT_EQ(text(tracker.next(0.0)), "offboard no: superseded by hold");
  tracker.acknowledge(px4::kDoSetMode, 0, 0.1);
  tracker.acknowledge(px4::kDoSetMode, 0, 0.1);
  tracker.acknowledge(px4::kArmDisarm, 0, 0.1);
  EXPECT_EQ(text(tracker.next(0.1)), "hold yes");
  EXPECT_EQ(text(tracker.next(0.1)), "arm yes");
}

}  // namespace
}  // namespace jink::bridge::vehicle
