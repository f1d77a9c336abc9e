// SPDX-License-Identifier: BSD-3-Clause
// The link when things go wrong on the wire or in the autopilot's estimate, and what it reads beside the state.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "bridge/mavlink/adsb_tracks.hpp"
#include "bridge/vehicle/px4.hpp"
#include "tests/bridge/mavsdk/link_test.hpp"

namespace {

namespace px4 = jink::bridge::vehicle::px4;
using jink::Vec3;
using jink::bridge::frames::Geodetic;
using jink::bridge::mavlink::AdsbTracks;
using jink::bridge::mavlink::LinkNotice;
using jink::bridge::mavsdk::MavsdkLink;
using jink::bridge::testing::eventually;
using jink::bridge::tracking::TrackMessage;
using jink::bridge::vehicle::BatteryState;
using jink::bridge::vehicle::Command;
using jink::bridge::vehicle::FlightMode;
using jink::bridge::vehicle::Setpoint;
using jink::bridge::vehicle::VehicleState;
using nlohmann::json;

class MavsdkFaultTest : public jink::bridge::testing::MavsdkLinkTest {
 protected:
  // Connected, with a position and odometry flowing.
  void fly(const std::vector<std::string>& peer_options = {}) {
    connect(peer_options);
    ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.motion.stamp >= 0 && s.armable; }));
    const bool odometry = std::find(peer_options.begin(), peer_options.end(), "--no-odometry") == peer_options.end();
    ASSERT_TRUE(eventually([&] { return link_->counts().odometries >= (odometry ? 2U : 0U); }));
  }
  // The number of resets becomes `count` and stays so for a while, with the shift `enu`.
  void expect_shift(std::uint32_t count, const Vec3& enu) {
    EXPECT_TRUE(state_becomes([&](const VehicleState& s) { return s.estimate_resets == count; }));
    const auto positions = link_->counts().positions;
    EXPECT_TRUE(eventually([&] { return link_->counts().positions >= positions + 30; }));
    EXPECT_EQ(link_->state().estimate_resets, count);
    EXPECT_NEAR((link_->state().estimate_shift - enu).norm(), 0.0, 1e-5) << link_->state().estimate_shift.transpose();
  }
  bool notice_comes(const std::string& name, const std::string& detail) {
    return eventually([&] {
      const std::optional<LinkNotice> notice = link_->next_notice();
      return notice && notice->name == name && notice->detail.find(detail) != std::string::npos;
    });
  }
};

TEST_F(MavsdkFaultTest, EstimateResetsAreCountedAndMeasured) {
  fly({"--still"});
  EXPECT_EQ(link_->state().estimate_resets, 0U);
  peer_->order("jump 3 0 0");  // counter 254 -> 255
  expect_shift(1, {0.0, 3.0, 0.0});
  EXPECT_EQ(link_->state().motion.value.position, Vec3(2.0, 4.0, 3.0));
  peer_->order("jump 0 0.4 -0.2");  // 255 -> 0; too little to be seen without the counter
  expect_shift(2, {0.4, 3.0, 0.2});
  peer_->order("jump -2 0 0 2");
  expect_shift(4, {0.4, 1.0, 0.2});
}

TEST_F(MavsdkFaultTest, WithoutOdometryAJumpOfThePositionCounts) {
  fly({"--still", "--no-odometry"});
  peer_->order("jump 0 -3 0");
  expect_shift(1, {-3.0, 0.0, 0.0});
  EXPECT_EQ(link_->counts().odometries, 0U);
}

TEST_F(MavsdkFaultTest, ResetsAreFoundInALossyDelayedLink) {
  fly({"--still", "--loss", "0.2", "--delay", "0.2", "--heartbeat-hz", "5"});
  peer_->order("jump 3 0 0");
  expect_shift(1, {0.0, 3.0, 0.0});
  peer_->order("jump 0 0 0.5");
  expect_shift(2, {0.0, 3.0, -0.5});
  const VehicleState s = link_->state();
  EXPECT_TRUE(s.local_position_ok);
  EXPECT_EQ(s.reboots, 0U);
  EXPECT_EQ(link_->counts().malformed, 0U);
  // A command that is lost is reported as unanswered; repeating it is the caller's, and gets through.
  EXPECT_TRUE(eventually([&] {
    link_->request(Command::kArm);
    return next_report().accepted;
  }));
  EXPECT_TRUE(state_becomes([](const VehicleState& state) { return state.armed; }));
}

TEST_F(MavsdkFaultTest, FailsafeAndBatteryAreTold) {
  fly({"--heartbeat-hz", "5"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kOk; }));
  EXPECT_FALSE(link_->state().failsafe);
  peer_->order("status 5");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.failsafe; }));
  peer_->order("status 4");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return !s.failsafe; }));
  peer_->order("battery 2 80");  // its own word stands above the percentage
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kLow; }));
  peer_->order("battery 3 80");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kCritical; }));
  peer_->order("battery 0 12");  // no word: the percentage
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kLow; }));
  peer_->order("battery 0 6");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kCritical; }));
  peer_->order("battery 0 -1");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.battery == BatteryState::kUnknown; }));
}

// Ten times a second, whatever the heartbeat's rate is.
TEST_F(MavsdkFaultTest, WhatFliesAndWhatWasAskedForAreTold) {
  fly();
  ASSERT_TRUE(state_becomes(
      [](const VehicleState& s) { return s.mode == FlightMode::kHold && s.intended_mode == FlightMode::kHold; }));
  link_->restart_rates();
  EXPECT_TRUE(eventually([&] { return link_->rates().back().count >= 10; }));
  EXPECT_GT(link_->rates().back().measured_hz, 5.0);
  peer_->order("failsafe 84148224");  // PX4's RETURN
  EXPECT_TRUE(state_becomes(
      [](const VehicleState& s) { return s.mode == FlightMode::kReturn && s.intended_mode == FlightMode::kHold; }));
  peer_->order("stop CURRENT_MODE");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.intended_mode == FlightMode::kUnknown; }));
}

TEST_F(MavsdkFaultTest, OriginAndVersionAreAskedForUntilTheyCome) {
  fly({"--heartbeat-hz", "5", "--deaf", "3"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.origin.has_value(); }));
  const Geodetic origin = *link_->state().origin;
  EXPECT_DOUBLE_EQ(origin.latitude_deg, 47.3977418);
  EXPECT_DOUBLE_EQ(origin.longitude_deg, 8.5455939);
  EXPECT_DOUBLE_EQ(origin.altitude_m, 488.0);
  EXPECT_TRUE(eventually([&] { return link_->info().version.has_value(); }));
  EXPECT_EQ(jink::bridge::vehicle::px4::to_string(*link_->info().version), "1.15.4");
  EXPECT_EQ(link_->info().autopilot, jink::bridge::vehicle::px4::kAutopilotPx4);
  EXPECT_TRUE(eventually([&] { return link_->info().round_trip_s.has_value(); }));
  EXPECT_EQ(link_->state().system_id, 1U);
}

// By the round trip; what is slower one way than the other cannot be told.
TEST_F(MavsdkFaultTest, WhatComesLateIsStampedWithWhenItWasTrue) {
  fly({"--delay", "0.2"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.link_delay > 0.0; }));
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.motion.delay() == s.link_delay; }));
  const VehicleState s = link_->state();
  EXPECT_GE(s.link_delay, 0.1);
  EXPECT_LE(s.motion.stamp, clock_.now() - 0.1);
  EXPECT_NEAR(*link_->info().round_trip_s, 2.0 * s.link_delay, 0.2);
}

TEST_F(MavsdkFaultTest, ParametersAreReadByName) {
  fly({"--deaf", "1"});
  const std::vector<std::string> names{"COM_OBL_RC_ACT", "NO_SUCH", "COM_OF_LOSS_T", "COM_NEGATIVE", "not a name\xff"};
  const auto values = link_->read_parameters(names, 3.0);
  ASSERT_EQ(values.size(), names.size());
  ASSERT_TRUE(values[0]);
  EXPECT_TRUE(values[0]->integer);
  EXPECT_EQ(values[0]->value, 5.0);
  EXPECT_FALSE(values[1]);
  ASSERT_TRUE(values[2]);
  EXPECT_FALSE(values[2]->integer);
  EXPECT_EQ(values[2]->value, 0.5);
  ASSERT_TRUE(values[3]);
  EXPECT_TRUE(std::isnan(values[3]->value));
  EXPECT_FALSE(values[4]);
}

TEST_F(MavsdkFaultTest, ASecondAutopilotChangesNothingAndIsSaid) {
  fly({"--heartbeat-hz", "5"});
  const VehicleState before = link_->state();
  peer_->order("other 7");
  EXPECT_TRUE(notice_comes("second_autopilot", "system 7"));
  EXPECT_EQ(link_->counts().other_autopilots, 1U);
  EXPECT_EQ(link_->info().other_systems, std::vector<std::uint32_t>{7});
  const auto heartbeats = link_->counts().heartbeats;
  ASSERT_TRUE(eventually([&] { return link_->counts().heartbeats >= heartbeats + 5; }));
  const VehicleState s = link_->state();
  EXPECT_EQ(s.motion.value.position,
            before.motion.value.position);  // the other one is elsewhere, armed, landing, in failsafe
  EXPECT_FALSE(s.armed);
  EXPECT_FALSE(s.failsafe);
  EXPECT_EQ(s.mode, FlightMode::kHold);
  EXPECT_EQ(s.system_id, 1U);
  EXPECT_EQ(s.other_system_id, 7U);
  EXPECT_EQ(s.estimate_resets, 0U);
  link_->request(Command::kArm);
  EXPECT_TRUE(next_report().accepted);
  EXPECT_EQ(heard_command(400)["target"], json({1, 1}));
  EXPECT_EQ(link_->counts().other_autopilots, 1U);
}

TEST_F(MavsdkFaultTest, TheNamedAutopilotIsWaitedForAndNoOtherTaken) {
  open({"--heartbeat-hz", "5"}, 7);
  EXPECT_FALSE(link_->wait_for_autopilot(2.0));
  peer_->order("other 7");
  ASSERT_TRUE(link_->wait_for_autopilot(30.0));
  EXPECT_TRUE(notice_comes("second_autopilot", "system 1"));
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.heartbeat_stamp >= 0.0; }));
  EXPECT_EQ(link_->state().system_id, 7U);
  EXPECT_EQ(link_->state().other_system_id, 1U);
}

TEST_F(MavsdkFaultTest, RandomBytesAreNothing) {
  fly();
  for (int i = 0; i < 3; ++i) peer_->order("noise");
  const auto positions = link_->counts().positions;
  ASSERT_TRUE(eventually([&] { return link_->counts().positions >= positions + 50; }));
  const VehicleState s = link_->state();
  EXPECT_EQ(s.motion.value.position, Vec3(2.0, 1.0, 3.0));
  EXPECT_EQ(s.estimate_resets, 0U);
  EXPECT_EQ(link_->counts().other_autopilots, 0U);
  EXPECT_TRUE(link_->send(Setpoint{}));
  EXPECT_TRUE(eventually([&] { return !heard("setpoint").empty(); }));
}

TEST_F(MavsdkFaultTest, ARebootIsSaidAndWhatWasKnownIsAskedAnew) {
  fly({"--heartbeat-hz", "5"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.origin.has_value(); }));
  std::this_thread::sleep_for(std::chrono::duration<double>(MavsdkLink::kReboot_s + 0.5));  // of the peer's time
  peer_->order("jump 0 0 -5");
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.estimate_resets == 1; }));
  peer_->order("reboot");
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.reboots == 1; }));
  EXPECT_TRUE(notice_comes("autopilot_rebooted", ""));
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.origin.has_value() && s.armable; }));
  const auto asked = [&] {
    const auto commands = heard("command");
    return std::count_if(commands.begin(), commands.end(), [](const json& c) {
      return c["command"] == jink::bridge::vehicle::px4::kRequestMessage && c["params"][0] == 49.0;
    });
  };
  EXPECT_TRUE(eventually([&] { return asked() >= 2; }));  // the peer tells what it heard after it answers
  EXPECT_EQ(link_->state().estimate_resets, 1U);          // the new origin is no jump
  EXPECT_EQ(link_->state().reboots, 1U);
}

// What MAVSDK does with a system that it holds for timed out (3 s): it delivers and sends as before.
TEST_F(MavsdkFaultTest, AfterFiveSilentSecondsMessagesComeAndGoWithoutAHeartbeat) {
  fly();
  peer_->order("freeze");
  std::this_thread::sleep_for(std::chrono::seconds(5));
  Setpoint setpoint;
  setpoint.position.z() = 5.0;
  EXPECT_TRUE(link_->send(setpoint));
  EXPECT_TRUE(eventually([&] { return !heard("setpoint").empty(); }));
  link_->request(Command::kHold);
  EXPECT_TRUE(next_report().accepted);
  peer_->order("stop HEARTBEAT");
  const VehicleState silent = link_->state();
  peer_->order("thaw");
  EXPECT_TRUE(state_becomes([&](const VehicleState& s) { return s.motion.stamp > silent.motion.stamp; }));
  EXPECT_TRUE(state_becomes([&](const VehicleState& s) { return s.local_position_ok; }));
  EXPECT_EQ(link_->state().heartbeat_stamp, silent.heartbeat_stamp);
  EXPECT_EQ(link_->state().estimate_resets, 0U);
}

TEST_F(MavsdkFaultTest, TextsOfTheAutopilotAreNotices) {
  fly();
  peer_->order("text 4 9 0 " + std::string(50, 'a'));
  peer_->order("text 4 9 1 tail");
  EXPECT_TRUE(notice_comes("autopilot_text", "warning: " + std::string(50, 'a') + "tail"));
}

// From a component of the vehicle's system, as PX4 forwards it, and from a system of its own.
TEST_F(MavsdkFaultTest, AircraftAreHeardFromAnySender) {
  fly({"--heartbeat-hz", "5"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.origin.has_value(); }));
  AdsbTracks tracks([this](auto& report) { return link_->next_adsb(report); }, [this] { return link_->state().origin; },
                    clock_);
  TrackMessage message;
  // A system that was never heard before has a listener within half a second: a receiver repeats its aircraft.
  EXPECT_TRUE(eventually([&] {
    peer_->order("adsb 1 156 11 143");
    peer_->order("adsb 44 156 22 143");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return tracks.poll(message) && message.tracks.size() == 2;
  }));
  ASSERT_EQ(message.tracks.size(), 2U);
  EXPECT_EQ(message.tracks[0].id, 11U);
  EXPECT_EQ(message.tracks[1].id, 22U);
  for (const auto& track : message.tracks) {
    const Vec3 at_report = track.position - track.age * track.velocity;
    EXPECT_NEAR((at_report - Vec3(0.0, 1000.0, 100.0)).norm(), 0.0, 2.0) << at_report.transpose();
    EXPECT_NEAR((track.velocity - Vec3(20.0, 0.0, 2.0)).norm(), 0.0, 1e-6);
  }
  EXPECT_EQ(tracks.status().writers, 2);
  EXPECT_EQ(link_->counts().other_autopilots, 0U);
}

}  // namespace
