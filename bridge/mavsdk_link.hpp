// SPDX-License-Identifier: BSD-3-Clause
// The vehicle link over MAVLink, by MAVSDK. Every message is sent and read as it stands on the wire (MAVSDK's
// mavlink_direct), for two reasons: its offboard plugin repeats the last setpoint at 20 Hz for ever, which would hide a
// dead companion from the autopilot; and its action plugin takes the first answer to DO_SET_MODE for the truth.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "bridge/clock.hpp"
#include "bridge/vehicle_link.hpp"

namespace jink::bridge {

/// What has come from the autopilot since it was found; for `doctor` and summaries.
struct LinkCounts {
  std::uint64_t heartbeats = 0;
  std::uint64_t positions = 0;  ///< LOCAL_POSITION_NED
  std::uint64_t attitudes = 0;
  std::uint64_t setpoints_sent = 0;
  std::uint64_t malformed = 0;  ///< messages left out: missing or non-finite fields
};

/// A companion computer (MAVLink component of the vehicle's own system, with its own heartbeat) and the first autopilot
/// that it hears. All functions are safe from any thread; state(), send(), request() and next_report() never block.
///
/// state(): `heartbeat_stamp`, `armed` and `mode` come from the HEARTBEAT of that autopilot alone, which PX4 sends once
/// a second and not on change. `local_position_ok` needs a position younger than kPositionMaxAge_s and, where the
/// autopilot sends ESTIMATOR_STATUS, an estimator that holds it. LOCAL_POSITION_NED and ATTITUDE are asked for at
/// kTelemetryHz, and again after each heartbeat interval in which they came slower.
///
/// request(): see CommandTracker for what a report means. A command is sent once; repeating it is the caller's.
class MavsdkLink final : public VehicleLink {
 public:
  static constexpr double kTelemetryHz = 50.0;
  static constexpr double kPositionMaxAge_s = 1.0;

  /// Opens `connection_url` (udpin://HOST:PORT, udpout://HOST:PORT, tcpout://HOST:PORT, serial:///dev/NAME:BAUD, ...)
  /// and waits for nobody. `clock` must outlive the link.
  /// @throws std::runtime_error, one line with the URL and the reason, when it is malformed or cannot be opened. A TCP
  /// peer that does not answer yet is no error: it is tried again in the background.
  MavsdkLink(const std::string& connection_url, const Clock& clock);
  ~MavsdkLink() override;
  MavsdkLink(const MavsdkLink&) = delete;
  MavsdkLink& operator=(const MavsdkLink&) = delete;

  /// Blocks until an autopilot's heartbeat has come, `timeout_s` has passed or `stop` is requested (looked at every
  /// 0.1 s). True when there is an autopilot; at once when it was found before. Until then state() is empty, send()
  /// returns false and requests are reported as failed.
  [[nodiscard]] bool wait_for_autopilot(double timeout_s, const std::stop_token& stop = {});

  [[nodiscard]] VehicleState state() override;
  /// SET_POSITION_TARGET_LOCAL_NED in the local NED frame with position, velocity, acceleration and yaw. False without
  /// an autopilot, for values that are not finite or beyond 1e6, and when MAVSDK refuses the message. A lost UDP packet
  /// is nothing it can know.
  [[nodiscard]] bool send(const Setpoint& setpoint) override;
  void request(Command command) override;
  [[nodiscard]] std::optional<CommandReport> next_report() override;

  [[nodiscard]] LinkCounts counts() const;
  /// MAVLink system id of the autopilot; 0 before it is found.
  [[nodiscard]] std::uint32_t autopilot_system_id() const;
  /// The newest warning or error in MAVSDK's own log, for diagnostics; of all links of this process. MAVSDK's log is
  /// kept off the terminal.
  [[nodiscard]] static std::string last_warning();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge
