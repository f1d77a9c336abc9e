// SPDX-License-Identifier: BSD-3-Clause
// An autopilot flown in virtual time, shared by its tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kSetpointInterval = 0.02;

inline Setpoint position_setpoint(const Vec3& position) {
  Setpoint setpoint;
  setpoint.position = position;
  return setpoint;
}

inline Setpoint velocity_setpoint(const Vec3& velocity) {
  Setpoint setpoint;
  setpoint.velocity = velocity;
  return setpoint;
}

inline AutopilotOptions instant_options() {
  AutopilotOptions options;
  options.ready_delay = 0.0;
  return options;
}

inline AutopilotOptions airborne_options(const Vec3& position = Vec3(0, 0, 3)) {
  AutopilotOptions options = instant_options();
  options.airborne = true;
  options.position = position;
  return options;
}

/// Drives the autopilot in virtual time and watches the landed states and texts that pass.
class Flight {
 public:
  explicit Flight(const AutopilotOptions& options) : autopilot(options) {}

  /// Runs for `duration`, with a setpoint every 20 ms when one is given.
  void run(double duration, const Setpoint* stream = nullptr) {
    run_until([] { return false; }, duration, stream);
  }

  /// Runs until `done`; returns how long that took, infinity when it never was within `limit`.
  double run_until(const std::function<bool()>& done, double limit, const Setpoint* stream = nullptr) {
    const double start = autopilot.time();
    double next_setpoint = start;
    while (autopilot.time() - start < limit - VehicleModel::kStep / 2) {
      if (stream != nullptr && autopilot.time() >= next_setpoint - 1e-9) {
        EXPECT_EQ(autopilot.offboard_setpoint(*stream), Result::kAccepted);
        next_setpoint += kSetpointInterval;
      }
      autopilot.step();
      if (landed_states.empty() || landed_states.back() != autopilot.landed_state()) {
        landed_states.push_back(autopilot.landed_state());
      }
      for (const StatusText& text : autopilot.take_status_texts()) texts.push_back(text.text);
      if (done()) return autopilot.time() - start;
    }
    return planner::base::kInfinity;
  }

  /// Off the ground in OFFBOARD at `position`.
  void fly_offboard(const Vec3& position) {
    const Setpoint setpoint = position_setpoint(position);
    run(0.5, &setpoint);
    ASSERT_EQ(autopilot.set_mode(6), Result::kAccepted);
    ASSERT_EQ(autopilot.arm(), Result::kAccepted);
    run(18.0, &setpoint);
    ASSERT_TRUE(autopilot.offboard_active());
    ASSERT_LT((autopilot.true_motion().position - position).norm(), 0.3);
  }

  [[nodiscard]] bool said(const std::string& text) const {
    return std::any_of(texts.begin(), texts.end(),
                       [&](const std::string& t) { return t.find(text) != std::string::npos; });
  }

  Autopilot autopilot;
  std::vector<LandedState> landed_states;
  std::vector<std::string> texts;
};

inline void expect_heartbeat(const Autopilot& autopilot, unsigned base_mode, std::uint32_t custom_mode,
                             unsigned status) {
  const Heartbeat heartbeat = autopilot.heartbeat();
  EXPECT_EQ(heartbeat.base_mode, base_mode);
  EXPECT_EQ(heartbeat.custom_mode, custom_mode);
  EXPECT_EQ(heartbeat.system_status, status);
}

}  // namespace jink::sim::vehicle
