// SPDX-License-Identifier: BSD-3-Clause
// What is made of the messages one after the other.
#include <gtest/gtest.h>

#include "bridge/mavlink/autopilot_telemetry.hpp"

namespace jink::bridge::mavlink {
namespace {

using vehicle::FlightMode;

constexpr std::uint32_t kHold = 0x03040000;  // PX4's
constexpr std::uint32_t kOffboard = 0x00060000;
constexpr std::uint32_t kReturn = 0x05040000;

struct Heard {
  Heard() { heartbeat(kOffboard); }
  void heartbeat(std::uint32_t mode) { telemetry.on(now, Heartbeat{vehicle::px4::kAutopilotPx4, 0x80, mode, 4}); }
  void mode(std::uint32_t flies, std::uint32_t intended) { telemetry.on(now, CurrentMode{flies, intended}); }
  [[nodiscard]] vehicle::VehicleState state() const { return telemetry.state(now); }

  AutopilotTelemetry telemetry;
  double now = 10.0;
};

TEST(AutopilotTelemetry, WhatFliesAndWhatWasAskedForAreTold) {
  Heard heard;
  EXPECT_EQ(heard.state().intended_mode, FlightMode::kUnknown);
  heard.mode(kReturn, kOffboard);
  EXPECT_EQ(heard.state().mode, FlightMode::kReturn);
  EXPECT_EQ(heard.state().intended_mode, FlightMode::kOffboard);
}

TEST(AutopilotTelemetry, AModeThatWasJustLeftWasOvertakenUnlessItIsToldOn) {
  Heard heard;
  heard.mode(kHold, kHold);
  heard.now += 1.0;
  heard.mode(kOffboard, kOffboard);
  heard.now += 0.3;
  heard.mode(kHold, kHold);
  EXPECT_EQ(heard.state().mode, FlightMode::kOffboard);
  heard.now += 0.5;
  heard.mode(kHold, kHold);
  EXPECT_EQ(heard.state().mode, FlightMode::kHold);
  EXPECT_EQ(heard.state().intended_mode, FlightMode::kHold);
}

TEST(AutopilotTelemetry, TheHeartbeatsModeCountsWhereNothingNewerIsTold) {
  Heard heard;
  heard.mode(kOffboard, kOffboard);
  heard.heartbeat(kHold);  // of before
  EXPECT_EQ(heard.state().mode, FlightMode::kOffboard);
  heard.now += 1.3;
  EXPECT_EQ(heard.state().intended_mode, FlightMode::kUnknown);
  heard.heartbeat(kHold);
  EXPECT_EQ(heard.state().mode, FlightMode::kHold);
}

TEST(AutopilotTelemetry, APositionIsAsOldAsTheAutopilotsClockSays) {
  Heard heard;
  heard.telemetry.on(heard.now, LocalPosition{10'000, {1, 2, 3}, {}});
  EXPECT_EQ(heard.state().motion.delay(), 0.0);
  heard.now += 0.02;
  heard.telemetry.on(10.0, Attitude{10'720, 0.0});
  heard.telemetry.on(heard.now, LocalPosition{10'020, {1, 2, 3}, {}});
  EXPECT_NEAR(heard.state().motion.delay(), 0.7, 1e-9);
  EXPECT_EQ(heard.state().motion.received, heard.now);
}

TEST(AutopilotTelemetry, APositionIsGoodWhileItIsYoungAndTheEstimatorHoldsIt) {
  AutopilotTelemetry telemetry;
  EXPECT_EQ(telemetry.state(5.0).health, "no SYS_STATUS yet, local position");
  EXPECT_TRUE(telemetry.on(10.0, LocalPosition{1000, Vec3(1, 2, 3), Vec3::Zero()}));
  telemetry.on(SysStatus{0, 0, vehicle::px4::kPrearmCheck, 80.0});
  EXPECT_TRUE(telemetry.state(10.9).local_position_ok);
  EXPECT_FALSE(telemetry.state(11.1).local_position_ok);
  EXPECT_EQ(telemetry.state(11.1).health, "local position");
  telemetry.on(EstimatorStatus{0});
  EXPECT_FALSE(telemetry.state(10.9).local_position_ok);
}

TEST(AutopilotTelemetry, AnOlderPositionIsLeftOutAndTimeThatBeganAnewIsAReboot) {
  AutopilotTelemetry telemetry;
  EXPECT_TRUE(telemetry.on(10.0, LocalPosition{60000, Vec3(1, 0, 0), Vec3::Zero()}));
  telemetry.on(Origin{{47.0, 8.0, 400.0}});
  EXPECT_FALSE(telemetry.on(10.1, LocalPosition{59900, Vec3(9, 0, 0), Vec3::Zero()}));
  EXPECT_EQ(telemetry.state(10.1).motion.value.position, Vec3(1, 0, 0));
  EXPECT_EQ(telemetry.counts().late, 1U);
  EXPECT_TRUE(telemetry.on(10.2, LocalPosition{500, Vec3(0, 0, 0), Vec3::Zero()}));
  EXPECT_EQ(telemetry.state(10.2).reboots, 1U);
  EXPECT_FALSE(telemetry.origin_known());
  const auto notice = telemetry.next_notice();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->name, "autopilot_rebooted");
}

TEST(AutopilotTelemetry, HomeIsKnownUntilTheFrameMayBeAnother) {
  AutopilotTelemetry telemetry;
  EXPECT_FALSE(telemetry.state(1.0).home_height);
  telemetry.on(Home{3.0});
  EXPECT_TRUE(telemetry.on(10.0, LocalPosition{60000, Vec3(1, 0, 0), Vec3::Zero()}));
  EXPECT_EQ(telemetry.state(10.0).home_height, 3.0);
  EXPECT_TRUE(telemetry.on(10.2, LocalPosition{500, Vec3(0, 0, 0), Vec3::Zero()}));
  EXPECT_FALSE(telemetry.state(10.2).home_height);
}

TEST(AutopilotTelemetry, AComponentThatIsNoAutopilotSaysNothing) {
  AutopilotTelemetry telemetry;
  EXPECT_FALSE(telemetry.on(1.0, Heartbeat{vehicle::px4::kAutopilotInvalid, vehicle::px4::kArmedFlag, 0, 0}));
  EXPECT_FALSE(telemetry.state(1.0).armed);
  EXPECT_LT(telemetry.heartbeat_stamp(), 0.0);
  EXPECT_EQ(telemetry.counts().malformed, 1U);
}

}  // namespace
}  // namespace jink::bridge::mavlink
