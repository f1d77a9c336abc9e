// SPDX-License-Identifier: BSD-3-Clause
// The companion's loop with an autopilot, tracks and a planner that do as they are told.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/bridge_fakes.hpp"

namespace jink::bridge::testing {

/// The loop at 50 Hz around an autopilot that obeys and follows its setpoints exactly.
struct Loop {
  static constexpr double kTurn = 0.02;  // s

  static config::Mission mission() {
    config::Mission m;
    m.connection = "udpin://127.0.0.1:14540";
    m.system_id = 1;
    m.takeoff_height = 2.0;
    m.min_height = 1.0;
    m.waypoints = {{20, 0, 2}};
    m.arrival = config::Arrival::kHold;
    m.geofence = {{-5, -10, 0}, {30, 10, 12}};
    return m;
  }

  explicit Loop(const config::Mission& m = mission(), const config::Settings& settings = {})
      : companion(m, settings, {link, source, planner, {&recorder}}) {
    link.telemetry.mode = vehicle::FlightMode::kHold;
    link.telemetry.armable = link.telemetry.local_position_ok = true;
    link.telemetry.failsafe_parameters.offboard_loss = 0.0;
  }

  bool turn() {
    vehicle::VehicleState& state = link.telemetry;
    if (heartbeats) state.heartbeat_stamp = now;
    if (positions) state.motion.stamp = state.motion.received = now;
    if (tracks) source.messages.push_back({{1, now, 0.0}, seen, 0});
    const bool on = companion.step(now);
    if (obeys) obey();
    const bool flies = state.armed && state.mode == vehicle::FlightMode::kOffboard && !link.sent.empty() && follows;
    if (flies) {
      beside += kTurn * drift;
      state.motion.value.position = link.sent.back().position + beside;
      state.motion.value.velocity = link.sent.back().velocity + drift;
      state.in_air = state.in_air || state.motion.value.position.z() > 0.2;
    }
    now += kTurn;
    return on;
  }
  void obey() {
    for (; obeyed < link.requests.size(); ++obeyed) {
      const vehicle::Command command = link.requests[obeyed];
      if (command == vehicle::Command::kOffboard) link.telemetry.mode = vehicle::FlightMode::kOffboard;
      if (command == vehicle::Command::kArm) link.telemetry.armed = true;
      if (command == vehicle::Command::kHold) link.telemetry.mode = vehicle::FlightMode::kHold;
      if (command == vehicle::Command::kLand) link.telemetry.mode = vehicle::FlightMode::kLand;
      if (command == vehicle::Command::kHold || command == vehicle::Command::kLand)
        link.telemetry.motion.value.velocity.setZero();
    }
  }
  void run(double seconds) {
    for (const double end = now + seconds; now < end - 1e-9 && turn();) {
    }
  }
  Loop& airborne(const Vec3& position = {0, 0, 2}) {
    link.telemetry.in_air = link.telemetry.armed = true;
    link.telemetry.home_height = 0.0;
    link.telemetry.motion.value.position = position;
    return *this;
  }
  /// Until plans are flown.
  Loop& fly() {
    while (recorder.plans == 0 && now < 20.0) turn();
    run(0.5);
    EXPECT_EQ(companion.supervisor().phase(), supervisor::Phase::kFlying);
    return *this;
  }
  [[nodiscard]] const vehicle::Setpoint& last() const { return link.sent.back(); }

  FakeLink link;
  FakeTracks source;
  FakePlanner planner;
  Recorder recorder;
  companion::Companion companion;
  std::vector<planner::base::Track> seen;
  Vec3 beside = Vec3::Zero();  // what the vehicle is off its setpoint
  Vec3 drift = Vec3::Zero();   // m/s, and by what that grows
  double now = 0.0;
  bool heartbeats = true, positions = true, tracks = true, obeys = true, follows = true;
  std::size_t obeyed = 0;
};

}  // namespace jink::bridge::testing
