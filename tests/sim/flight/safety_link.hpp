// SPDX-License-Identifier: BSD-3-Clause
// The companion's link in the flights of docs/safety.md: it tells at the rates at which PX4 tells, can fail in ways in
// which no wire fails by itself, and holds what goes out to what must never be sent.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"
#include "sim/flight/virtual_transport.hpp"

namespace jink::sim::flight::safety {

/// Between a companion and a VirtualLink, which outlives it. Of what has arrived there the companion is told what PX4's
/// messages carry when they are due: HEARTBEAT (armed, CRITICAL) once a second, CURRENT_MODE ten times, SYS_STATUS and
/// EXTENDED_SYS_STATE five times, ESTIMATOR_STATUS once; the position each time. What becomes of old news is as in
/// bridge/mavlink. Not thread-safe.
class Link final : public bridge::vehicle::VehicleLink {
 public:
  /// `mission` in the local frame, with the ground at 0.
  Link(VirtualLink& link, const config::Mission& mission) : link_(link), mission_(mission) {}

  /// Goes on to `now`, whether or not anybody asks.
  void listen(double now);
  /// A pilot has chosen that mode: what goes out once that is told is a fault.
  void pilot_chose(bridge::vehicle::FlightMode mode) { pilots_ = mode; }
  /// There is another companion, which does not know what the last one was told.
  void begin_anew() { told_of_pilot_ = false, pilots_.reset(); }

  bridge::vehicle::VehicleState state() override { return told_; }
  bool send(const bridge::vehicle::Setpoint& setpoint) override;
  void request(bridge::vehicle::Command command) override;
  std::optional<bridge::vehicle::CommandReport> next_report() override { return link_.next_report(); }

  [[nodiscard]] const bridge::vehicle::VehicleState& told() const { return told_; }
  /// All commands that were given, and when.
  [[nodiscard]] const std::vector<std::pair<double, bridge::vehicle::Command>>& requests() const { return requests_; }
  /// When the last setpoint was to go out; before the first one, and until OFFBOARD flies, now.
  [[nodiscard]] double last_sent() const { return last_sent_; }
  /// What must not have been sent, in words.
  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

  // What works.
  bool heartbeats = true, positions = true, sends = true, tells_modes = true, tells_gps = true, estimates = true;
  bool steers = true;  ///< the vehicle can go where it is asked to: else the geofence is not asked for

 private:
  /// Whether a message of that rate is due since the last one of its kind, by its number.
  [[nodiscard]] bool due(double rate, double& number) const;
  void hear_modes();
  void check(const bridge::vehicle::Setpoint& setpoint);
  void fault(const std::string& what);

  VirtualLink& link_;
  config::Mission mission_;
  bridge::vehicle::VehicleState told_, news_;
  double now_ = 0.0;
  double heartbeat_ = -1.0, mode_ = -1.0, status_ = -1.0, estimator_ = -1.0;  // numbers of the last messages
  double mode_at_ = bridge::base::kNever;                                     // when it was told
  bool estimator_ok_ = false;
  double fastest_ = 0.0;  // m/s, of the vehicle, lately
  std::optional<bridge::vehicle::FlightMode> pilots_;
  bool told_of_pilot_ = false;
  double last_sent_ = 0.0;
  std::vector<std::pair<double, bridge::vehicle::Command>> requests_;
  std::vector<std::string> faults_;
};

}  // namespace jink::sim::flight::safety
