// SPDX-License-Identifier: BSD-3-Clause
// The link over loopback UDP against tests/bridge/mavsdk/px4_peer.py, which shares no code with it (pymavlink) and
// answers as PX4 does.
#include "bridge/mavsdk/link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "bridge/doctor/vehicle_checks.hpp"
#include "bridge/vehicle/command_tracker.hpp"
#include "bridge/vehicle/px4.hpp"
#include "tests/bridge/mavsdk/link_test.hpp"

namespace {

namespace px4 = jink::bridge::vehicle::px4;
namespace doctor = jink::bridge::doctor;
using jink::Vec3;
using jink::bridge::base::SteadyClock;
using jink::bridge::mavsdk::MavsdkLink;
using jink::bridge::testing::eventually;
using jink::bridge::testing::free_udp_port;
using jink::bridge::testing::MavsdkLinkTest;
using jink::bridge::vehicle::Command;
using jink::bridge::vehicle::CommandReport;
using jink::bridge::vehicle::CommandTracker;
using jink::bridge::vehicle::FlightMode;
using jink::bridge::vehicle::Setpoint;
using jink::bridge::vehicle::VehicleState;
using nlohmann::json;

TEST_F(MavsdkLinkTest, StateArrivesInEnu) {
  connect();
  ASSERT_TRUE(state_becomes([](const VehicleState& s) {
    return s.motion.stamp >= 0 && s.heartbeat_stamp >= 0 && s.yaw != 0.0 && s.armable;
  }));
  const VehicleState s = link_->state();
  EXPECT_EQ(s.motion.value.position, Vec3(2.0, 1.0, 3.0));       // NED 1, 2, -3
  EXPECT_EQ(s.motion.value.velocity, Vec3(-0.25, 0.5, -0.125));  // NED 0.5, -0.25, 0.125
  EXPECT_NEAR(s.yaw, std::numbers::pi / 2 - 0.3, 1e-6);          // 0.3 east of north
  EXPECT_EQ(s.mode, FlightMode::kHold);
  EXPECT_FALSE(s.armed);
  EXPECT_FALSE(s.in_air);
  EXPECT_TRUE(s.local_position_ok);
  EXPECT_EQ(s.health, "");
  EXPECT_LE(s.motion.stamp, clock_.now());
  EXPECT_EQ(link_->autopilot_system_id(), 1U);
  EXPECT_EQ(link_->counts().malformed, 0U);
}

TEST_F(MavsdkLinkTest, AsksForTelemetryAtItsRate) {
  connect();
  for (const int message : {30, 32}) {
    EXPECT_TRUE(eventually([&] {
      const auto commands = heard("command");
      return std::any_of(commands.begin(), commands.end(), [&](const json& c) {
        return c["command"] == jink::bridge::vehicle::px4::kSetMessageInterval && c["params"][0] == message &&
               c["params"][1] == 20000.0;
      });
    })) << message;
  }
  const auto start = link_->counts();
  const double since = clock_.now();
  ASSERT_TRUE(eventually([&] { return link_->counts().positions >= start.positions + 100; }));
  const double rate = 100.0 / (clock_.now() - since);
  RecordProperty("position_rate_hz", std::to_string(rate));
  EXPECT_GT(rate, 35.0);  // 30 is what comes unasked
}

TEST_F(MavsdkLinkTest, AsksAgainWhenTheAnswerToTheRateWasNo) {
  connect({"--refuse", "511", "--heartbeat-hz", "4"});
  EXPECT_TRUE(eventually([&] {
    const auto commands = heard("command");
    return std::count_if(commands.begin(), commands.end(), [](const json& c) {
             return c["command"] == jink::bridge::vehicle::px4::kSetMessageInterval;
           }) >= 6;
  }));
}

TEST_F(MavsdkLinkTest, HeartbeatStampFollowsHeartbeatsAlone) {
  connect();
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.heartbeat_stamp >= 0 && s.motion.stamp >= 0; }));
  const double first = link_->state().heartbeat_stamp;
  ASSERT_TRUE(state_becomes([&](const VehicleState& s) { return s.heartbeat_stamp > first; }));
  EXPECT_NEAR(link_->state().heartbeat_stamp - first, 1.0, 0.5);
  EXPECT_GT(link_->counts().positions, 10 * link_->counts().heartbeats);
}

TEST_F(MavsdkLinkTest, SilenceStopsTheStampsAndThePositionIsGoodNoMore) {
  connect();
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.local_position_ok && s.armable; }));
  peer_->order("freeze");
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return !s.local_position_ok; }));
  const VehicleState silent = link_->state();
  EXPECT_GT(clock_.now() - silent.motion.stamp, MavsdkLink::kPositionMaxAge_s);
  EXPECT_EQ(silent.health, "local position");
  EXPECT_EQ(silent.motion.value.position, Vec3(2.0, 1.0, 3.0));
  // Longer than MAVSDK's own time-out for a system (3 s): it must be found again by itself.
  std::this_thread::sleep_for(std::chrono::seconds(4));
  peer_->order("thaw");
  EXPECT_TRUE(state_becomes(
      [&](const VehicleState& s) { return s.local_position_ok && s.heartbeat_stamp > silent.motion.stamp + 4.0; }));
  EXPECT_TRUE(link_->send(Setpoint{}));
}

TEST_F(MavsdkLinkTest, NamesWhatHealthLacks) {
  connect({"--health", "0x320c83b", "--estimator", "0x007"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.health.find("magnetometer") != std::string::npos; }));
  EXPECT_TRUE(state_becomes([](const VehicleState& s) {
    return s.health == "magnetometer, pre-arm check, local position";
  })) << link_->state().health;
  EXPECT_FALSE(link_->state().armable);
  EXPECT_FALSE(link_->state().local_position_ok);
}

TEST_F(MavsdkLinkTest, CommandsReachTheVehicleAndReportsComeBack) {
  connect({"--heartbeat-hz", "10"});
  const auto run = [&](Command command) {
    const double asked = clock_.now();
    link_->request(command);
    const CommandReport report = next_report();
    EXPECT_EQ(report.command, command);
    EXPECT_TRUE(report.accepted) << jink::bridge::vehicle::to_string(command) << ": " << report.detail;
    RecordProperty(std::string(jink::bridge::vehicle::to_string(command)) + "_s", std::to_string(clock_.now() - asked));
  };
  run(Command::kOffboard);
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.mode == FlightMode::kOffboard && !s.armed; }));
  EXPECT_EQ(heard_command(176)["params"], json({1.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(heard_command(176)["target"], json({1, 1}));

  run(Command::kArm);
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.armed && s.in_air; }));
  EXPECT_EQ(heard_command(400)["params"], json({1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));

  run(Command::kHold);
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.mode == FlightMode::kHold && s.armed; }));
  EXPECT_EQ(heard_command(176)["params"], json({1.0, 4.0, 3.0, 0.0, 0.0, 0.0, 0.0}));

  run(Command::kLand);
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return s.mode == FlightMode::kLand && s.in_air; }));
  EXPECT_EQ(heard_command(21)["params"], json({0.0, 0.0, 0.0, nullptr, nullptr, nullptr, nullptr}));

  run(Command::kDisarm);
  EXPECT_TRUE(state_becomes([](const VehicleState& s) { return !s.armed && !s.in_air; }));
  EXPECT_EQ(heard_command(400)["params"], json({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_FALSE(link_->next_report().has_value());
}

TEST_F(MavsdkLinkTest, TheSecondAnswerToASetModeIsTheReport) {
  connect({"--refuse", "176"});
  link_->request(Command::kOffboard);
  const CommandReport report = next_report();
  EXPECT_EQ(report.command, Command::kOffboard);
  EXPECT_FALSE(report.accepted);
  EXPECT_EQ(report.detail, "temporarily rejected");
}

TEST_F(MavsdkLinkTest, ACommandWithoutAnAnswerIsReported) {
  connect({"--mute", "400", "--refuse", "21"});
  const double asked = clock_.now();
  link_->request(Command::kArm);
  link_->request(Command::kLand);
  const CommandReport land = next_report();
  EXPECT_EQ(land.command, Command::kLand);
  EXPECT_EQ(land.detail, "temporarily rejected");
  const CommandReport arm = next_report();
  EXPECT_EQ(arm.command, Command::kArm);
  EXPECT_FALSE(arm.accepted);
  EXPECT_EQ(arm.detail, "no answer");
  EXPECT_GE(clock_.now() - asked, CommandTracker::kAnswer_s);
}

// PX4 1.18 with a key: what it says is signed, which MAVSDK takes, and what is not signed it does not take.
TEST_F(MavsdkLinkTest, AnAutopilotThatTakesSignedMessagesAloneIsKnownByItsSilence) {
  connect({"--keyed"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.motion.heard(); }));
  link_->request(Command::kHold);
  const CommandReport report = next_report();
  EXPECT_FALSE(report.accepted);
  EXPECT_EQ(report.detail, "no answer, as to all else: does the autopilot take signed messages alone (jink doctor)?");
  EXPECT_EQ(link_->counts().answers, 0U);
  const doctor::LinkFindings heard = doctor::listen(*link_, clock_, 1.0, {});
  std::string found;
  for (const doctor::Check& check : doctor::inspect_link({}, heard)) {
    if (check.name == "answers") found = std::string(doctor::to_string(check.level)) + ": " + check.remedy;
  }
  EXPECT_TRUE(found.starts_with("fault: with MAVLink signing")) << found;
}

TEST_F(MavsdkLinkTest, SetpointsArriveInNed) {
  connect();
  Setpoint setpoint;
  setpoint.position = {12.25, -3.5, 4.75};
  setpoint.velocity = {1.5, 2.5, -0.5};
  setpoint.acceleration = {0.25, -0.75, 0.125};
  setpoint.yaw = std::numbers::pi;  // west
  ASSERT_TRUE(link_->send(setpoint));
  ASSERT_TRUE(eventually([&] { return !heard("setpoint").empty(); }));
  const json m = heard("setpoint").front();
  EXPECT_EQ(m["position"], json({-3.5, 12.25, -4.75}));
  EXPECT_EQ(m["velocity"], json({2.5, 1.5, 0.5}));
  EXPECT_EQ(m["acceleration"], json({-0.75, 0.25, -0.125}));
  EXPECT_NEAR(m["yaw"].get<double>(), -std::numbers::pi / 2, 1e-6);
  EXPECT_EQ(m["mask"], 0x800);  // all but the yaw rate
  EXPECT_EQ(m["frame"], 1);     // MAV_FRAME_LOCAL_NED
  EXPECT_EQ(m["target"], json({1, 1}));
}

TEST_F(MavsdkLinkTest, NothingAbsurdIsSent) {
  connect();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Setpoint& bad :
       {Setpoint{{nan, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0.0}, Setpoint{{0, 0, 0}, {0, nan, 0}, {0, 0, 0}, 0.0},
        Setpoint{{0, 0, 0}, {0, 0, 0}, {0, 0, nan}, 0.0}, Setpoint{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, nan},
        Setpoint{{1e300, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0.0}}) {
    EXPECT_FALSE(link_->send(bad));
  }
  Setpoint good;
  good.position.z() = 42.0;
  ASSERT_TRUE(link_->send(good));
  ASSERT_TRUE(eventually([&] { return !heard("setpoint").empty(); }));
  EXPECT_EQ(heard("setpoint").front()["position"][2], -42.0);
  EXPECT_EQ(link_->counts().setpoints_sent, 1U);
}

// 2 s of a 50 Hz stream, then silence: as many setpoints arrive as were sent, in order, and none after that.
TEST_F(MavsdkLinkTest, TheStreamIsWhatWasSentAndStopsWithIt) {
  connect();
  constexpr int kSent = 100;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kSent; ++i) {
    Setpoint setpoint;
    setpoint.position.x() = i;
    ASSERT_TRUE(link_->send(setpoint));
    std::this_thread::sleep_until(start + std::chrono::milliseconds(20 * (i + 1)));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const auto got = heard("setpoint");
  ASSERT_EQ(got.size(), static_cast<std::size_t>(kSent));
  double longest = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i]["position"][1], static_cast<double>(i));
    if (i > 0) longest = std::max(longest, got[i]["t"].get<double>() - got[i - 1]["t"].get<double>());
  }
  const double span = got.back()["t"].get<double>() - got.front()["t"].get<double>();
  RecordProperty("setpoint_rate_hz", std::to_string((kSent - 1) / span));
  RecordProperty("longest_gap_ms", std::to_string(1e3 * longest));
}

TEST_F(MavsdkLinkTest, HasACompanionsHeartbeat) {
  connect();
  ASSERT_TRUE(eventually([&] { return heard("heartbeat").size() >= 2; }));
  const json m = heard("heartbeat").front();
  EXPECT_EQ(m["vehicle_type"], 18);  // MAV_TYPE_ONBOARD_CONTROLLER
  EXPECT_EQ(m["source"][0], 1);      // of the vehicle's own system
  EXPECT_GE(m["source"][1], 191);    // MAV_COMP_ID_ONBOARD_COMPUTER and on
  EXPECT_LE(m["source"][1], 195);
}

TEST_F(MavsdkLinkTest, SpeaksToAnotherSystemId) {
  connect({"--system", "3"});
  ASSERT_TRUE(state_becomes([](const VehicleState& s) { return s.heartbeat_stamp >= 0; }));
  EXPECT_EQ(link_->autopilot_system_id(), 3U);
  link_->request(Command::kArm);
  EXPECT_TRUE(next_report().accepted);
  EXPECT_EQ(heard_command(400)["target"], json({3, 1}));
}

TEST_F(MavsdkLinkTest, WithoutAnAutopilotNothingBlocksAndNothingIsSent) {
  MavsdkLink link("udpin://127.0.0.1:" + std::to_string(free_udp_port()), clock_);
  EXPECT_FALSE(link.wait_for_autopilot(0.2));
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_FALSE(link.wait_for_autopilot(1e9, stopped.get_token()));
  EXPECT_LT(link.state().heartbeat_stamp, 0.0);
  EXPECT_EQ(link.state().mode, FlightMode::kUnknown);
  EXPECT_EQ(link.state().health, "no SYS_STATUS yet, local position");
  EXPECT_FALSE(link.send(Setpoint{}));
  link.request(Command::kArm);
  const auto report = link.next_report();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->command, Command::kArm);
  EXPECT_FALSE(report->accepted);
  EXPECT_EQ(report->detail, "no autopilot");
}

// MAVSDK aborts the process when its handles go in the wrong order; here with traffic going on.
TEST_F(MavsdkLinkTest, IsDestroyedCleanlyInFullTraffic) {
  for (int i = 0; i < 5; ++i) {
    connect();
    link_->request(Command::kArm);
    EXPECT_TRUE(link_->send(Setpoint{}));
    link_.reset();
    peer_.reset();
  }
}

TEST(MavsdkLinkConstruction, AUrlThatCannotBeOpenedIsSaidInOneLine) {
  const SteadyClock clock;
  const auto error = [&](const std::string& url) -> std::string {
    try {
      const MavsdkLink link(url, clock);
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    return "opened";
  };
  for (const char* malformed : {"", "foo", "udpin://", "udpin://127.0.0.1:99999", "serial://"}) {
    EXPECT_EQ(
        error(malformed).find("connection '" + std::string(malformed) + "' is malformed; allowed: udpin://HOST:PORT"),
        0U)
        << error(malformed);
  }
  EXPECT_EQ(error("serial:///dev/jink-none:57600"),
            "connection 'serial:///dev/jink-none:57600' cannot be opened: Call open failed: No such file or directory");
  // 203.0.113.0/24 is set apart for documentation, so no machine has the address.
  EXPECT_NE(error("udpin://203.0.113.1:14540").find("cannot be opened: "), std::string::npos);
}

}  // namespace
