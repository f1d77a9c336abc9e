// SPDX-License-Identifier: BSD-3-Clause
// The vehicle link over MAVLink, by MAVSDK. Every message is sent and read as it stands on the wire (MAVSDK's
// mavlink_direct), for two reasons: its offboard plugin repeats the last setpoint at 20 Hz for ever, which would hide a
// dead companion from the autopilot; and its action plugin takes the first answer to DO_SET_MODE for the truth.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/mavlink/adsb_tracks.hpp"
#include "bridge/mavlink/autopilot_telemetry.hpp"
#include "bridge/mavlink/messages.hpp"
#include "bridge/vehicle/px4.hpp"
#include "bridge/vehicle/status_text.hpp"
#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::mavsdk {

/// How a stream of messages came since restart_rates().
struct StreamRate {
  const char* message = "";    ///< MAVLink's name
  double expected_hz = 0.0;    ///< PX4's for HEARTBEAT and CURRENT_MODE, what is asked for of the others
  double measured_hz = 0.0;    ///< 0 where fewer than two came
  double largest_gap_s = 0.0;  ///< the present silence included
  std::uint64_t count = 0;
};

/// A companion computer (MAVLink component of the vehicle's own system, with its own heartbeat) and the first autopilot
/// that it hears, which stays its own: what other systems say changes nothing but LinkCounts::other_autopilots and the
/// aircraft of next_adsb(). All functions are safe from any thread; only wait_for_autopilot(), read_parameters() and
/// read_fence() block.
///
/// state(): `heartbeat_stamp`, `armed`, `mode` and `failsafe` come from the HEARTBEAT of that autopilot alone, which
/// PX4 sends once a second and not on change. `local_position_ok` needs a position younger than kPositionMaxAge_s and,
/// where the autopilot sends ESTIMATOR_STATUS, an estimator that holds it. `estimate_resets`: see EstimateResets.
/// `battery`: the worst of the batteries' BATTERY_STATUS.charge_state; where that says nothing, SYS_STATUS's remaining
/// charge by PX4's default thresholds. `origin` is GPS_GLOBAL_ORIGIN's, `home_height` HOME_POSITION's, asked for with
/// each heartbeat until they are told; so, five times, are `failsafe_parameters`. `reboots`: the autopilot's time went
/// back by more than kReboot_s; then origin, health and battery are unknown anew. LOCAL_POSITION_NED and ATTITUDE are
/// asked for at kTelemetryHz, ODOMETRY at kOdometryHz, CURRENT_MODE at kModeHz, and again after each heartbeat interval
/// in which they came slower. A position that is older than one that came before is left out. PING is sent every
/// LinkDelay::kPeriod: `motion` is stamped as long before it came as its answers tell, which is `link_delay` too.
///
/// A silence of any length ends by itself: nothing has to be opened again. Over UDP, though, MAVSDK sends nothing to a
/// peer that was silent for 10 s, until it speaks.
///
/// request(): see CommandTracker for what a report means. A command is sent once; repeating it is the caller's.
class MavsdkLink final : public vehicle::VehicleLink {
 public:
  static constexpr double kTelemetryHz = 50.0;
  static constexpr double kOdometryHz = 30.0;  ///< what PX4 sends a companion unasked
  static constexpr double kModeHz = 10.0;      ///< of CURRENT_MODE, at most: of a change it is told so soon
  static constexpr double kPositionMaxAge_s = mavlink::AutopilotTelemetry::kPositionMaxAge_s;
  static constexpr double kReboot_s = mavlink::AutopilotTelemetry::kReboot_s;

  /// Opens `connection_url` (udpin://HOST:PORT, udpout://HOST:PORT, tcpout://HOST:PORT, serial:///dev/NAME:BAUD, ...)
  /// and waits for nobody. `clock` must outlive the link. `wanted_system`: the autopilot's, MAVLink; 0: the first.
  /// @throws std::runtime_error, one line with the URL and the reason, when it is malformed or cannot be opened. A TCP
  /// peer that does not answer yet is no error: it is tried again in the background.
  MavsdkLink(const std::string& connection_url, const base::Clock& clock, std::uint32_t wanted_system = 0);
  ~MavsdkLink() override;
  MavsdkLink(const MavsdkLink&) = delete;
  MavsdkLink& operator=(const MavsdkLink&) = delete;

  /// Blocks until an autopilot's heartbeat has come, `timeout_s` has passed or `stop` is requested (looked at every
  /// 0.1 s). True when there is an autopilot; at once when it was found before. Until then state() is empty, send()
  /// returns false and requests are reported as failed.
  [[nodiscard]] bool wait_for_autopilot(double timeout_s, const std::stop_token& stop = {});

  [[nodiscard]] vehicle::VehicleState state() override;
  /// SET_POSITION_TARGET_LOCAL_NED in the local NED frame with position, velocity, acceleration and yaw. False without
  /// an autopilot, for values that are not finite or beyond 1e6, and when MAVSDK refuses the message. A lost UDP packet
  /// is nothing it can know, and to a UDP peer that was silent for 10 s nothing goes out though MAVSDK says so.
  [[nodiscard]] bool send(const vehicle::Setpoint& setpoint) override;
  void request(vehicle::Command command) override;
  [[nodiscard]] std::optional<vehicle::CommandReport> next_report() override;

  /// A text for ground stations, as STATUSTEXT of this component in the vehicle's system; PX4 passes it on to its other
  /// links where forwarding is on for both. False as for send().
  [[nodiscard]] bool tell(const vehicle::StatusText& text);

  /// The oldest notice not yet taken, if any; at most 64 wait.
  [[nodiscard]] std::optional<mavlink::LinkNotice> next_notice();
  /// Takes the oldest ADSB_VEHICLE of any sender on the connection; false when there is none. At most 1024 wait.
  [[nodiscard]] bool next_adsb(mavlink::AdsbReport& report);

  /// Asks for parameters by name, three times within `timeout_s`, and blocks until all came or `timeout_s` or `stop`.
  /// One result for each name, in order; nothing for a name that got no answer, as unknown ones do.
  [[nodiscard]] std::vector<std::optional<vehicle::px4::Parameter>> read_parameters(std::span<const std::string> names,
                                                                                    double timeout_s,
                                                                                    const std::stop_token& stop = {});

  /// Asks for the geofence that the autopilot keeps, as a list of mission items, and blocks until it is whole, or
  /// `timeout_s` or `stop`: nothing then. Empty: it keeps none.
  [[nodiscard]] std::optional<std::vector<mavlink::MissionItem>> read_fence(double timeout_s,
                                                                            const std::stop_token& stop = {});

  /// Begins to measure how HEARTBEAT, LOCAL_POSITION_NED, ATTITUDE, ODOMETRY and CURRENT_MODE come.
  void restart_rates();
  [[nodiscard]] std::vector<StreamRate> rates() const;

  [[nodiscard]] mavlink::LinkCounts counts() const;
  [[nodiscard]] mavlink::LinkInfo info() const;
  /// MAVLink system id of the autopilot; 0 before it is found.
  [[nodiscard]] std::uint32_t autopilot_system_id() const;
  /// The newest warning or error in MAVSDK's own log, for diagnostics; of all links of this process. MAVSDK's log is
  /// kept off the terminal.
  [[nodiscard]] static std::string last_warning();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::mavsdk
