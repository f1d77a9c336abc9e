// SPDX-License-Identifier: BSD-3-Clause
// A supervisor in flight, for the tests of its situations: what it asks for, what it streams, and how it ends.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "bridge/supervisor/supervisor.hpp"

namespace jink::bridge::testing {

/// A supervisor and an autopilot's telemetry that is always fresh, but for what a test freezes.
struct Flight {
  static constexpr double kTurn = 0.02;  // s, of the loop

  static config::Mission mission() {
    config::Mission m;
    m.connection = "udpin://127.0.0.1:14540";
    m.system_id = 1;
    m.vehicle_name = "ardrone2";
    m.waypoints = {{20, 0, 1.5}};
    m.arrival = config::Arrival::kHold;
    m.time_limit = 100.0;
    return m;
  }
  static config::Mission landing_mission() {
    config::Mission m = mission();
    m.arrival = config::Arrival::kLand;
    return m;
  }

  explicit Flight(const config::Mission& m = mission(), const supervisor::SupervisorSettings& s = {})
      : supervisor(m, s) {
    state.mode = vehicle::FlightMode::kHold;
    state.armable = true;
    state.local_position_ok = true;
    state.failsafe_parameters = {0.0, 2.0, 30.0};
  }

  /// One turn; what was frozen keeps its stamp.
  supervisor::Decision turn() {
    if (heartbeats) state.heartbeat_stamp = now;
    if (positions) state.motion.stamp = state.motion.received = now;
    if (tracks) context.newest_tracks = now;
    if (plans) context.newest_plan = now;
    const supervisor::Decision decision = supervisor.update(now, state, context);
    context.report.reset();
    if (decision.request) requests.push_back(*decision.request);
    now += kTurn;
    return decision;
  }
  /// Turns for so long, or until it is done. The last decision.
  supervisor::Decision run(double seconds) {
    supervisor::Decision last;
    for (const double end = now + seconds; now < end && !supervisor.done();) last = turn();
    return last;
  }
  void refuse(vehicle::Command command, const std::string& detail) {
    context.report = vehicle::CommandReport{command, false, detail};
  }
  [[nodiscard]] int asked(vehicle::Command command) const {
    return static_cast<int>(std::count(requests.begin(), requests.end(), command));
  }

  // To the phases, as an obliging autopilot lets it get there.
  Flight& engage() {
    turn();
    return *this;
  }
  Flight& climb() {
    engage().turn();
    state.mode = vehicle::FlightMode::kOffboard;
    turn();
    state.armed = true;
    turn();
    return *this;
  }
  Flight& fly() {
    climb();
    state.in_air = true;
    context.at_takeoff_height = true;
    turn();
    return *this;
  }
  Flight& stop() {
    fly();
    supervisor.stop(now, supervisor::Outcome::kAborted, "interrupted");
    return *this;
  }

  supervisor::Supervisor supervisor;
  vehicle::VehicleState state;
  supervisor::FlightContext context;
  std::vector<vehicle::Command> requests;
  double now = 10.0;
  bool heartbeats = true, positions = true, tracks = true, plans = true;
};

}  // namespace jink::bridge::testing
