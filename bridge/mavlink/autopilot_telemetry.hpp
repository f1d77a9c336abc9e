// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot has told over MAVLink, message by message, as one state. No transport, no clock, no lock: the
// time comes in, and whoever owns it guards it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bridge/mavlink/messages.hpp"
#include "bridge/vehicle/estimate_resets.hpp"
#include "bridge/vehicle/link_delay.hpp"
#include "bridge/vehicle/px4.hpp"
#include "bridge/vehicle/status_text.hpp"
#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::mavlink {

/// What has come from the autopilot since it was found; for `doctor` and summaries.
struct LinkCounts {
  std::uint64_t heartbeats = 0;
  std::uint64_t positions = 0;  ///< LOCAL_POSITION_NED
  std::uint64_t attitudes = 0;
  std::uint64_t odometries = 0;  ///< usable ones
  std::uint64_t setpoints_sent = 0;
  std::uint64_t malformed = 0;         ///< messages left out: fields that are missing, not finite or absurd
  std::uint64_t late = 0;              ///< positions left out: older than one that had come before
  std::uint32_t other_autopilots = 0;  ///< systems beside ours whose component 1 calls itself an autopilot
  std::uint64_t dropped_adsb = 0;      ///< reports thrown away because nobody took them
  std::uint64_t answers = 0;           ///< to anything that was asked: commands, parameters, PING
};

/// What the autopilot has told of itself, beside VehicleState.
struct LinkInfo {
  std::optional<std::uint32_t> autopilot;        ///< MAV_AUTOPILOT; px4::kAutopilotPx4
  std::optional<vehicle::px4::Version> version;  ///< AUTOPILOT_VERSION, asked for until it comes
  std::optional<std::uint32_t> estimator;        ///< ESTIMATOR_STATUS.flags
  std::optional<double> battery_percent;         ///< SYS_STATUS.battery_remaining
  std::optional<double> round_trip_s;            ///< of PING, the shortest lately
  std::vector<std::uint32_t> other_systems;      ///< system ids of LinkCounts::other_autopilots
};

/// Something that a person should read: "second_autopilot", "autopilot_rebooted", "autopilot_text" (STATUSTEXT, which
/// PX4 sends only to a link on which a ground station's heartbeat arrives too).
struct LinkNotice {
  std::string name;
  std::string detail;
};

/// See MavsdkLink for what state() says. on() takes one message, come at `now` (any clock that does not go back); one
/// that says whether it was taken is left out where it says nothing new. Not thread-safe.
class AutopilotTelemetry {
 public:
  static constexpr double kPositionMaxAge_s = 1.0;
  static constexpr double kReboot_s = 2.0;
  static constexpr double kModeMaxAge_s = 1.2;  ///< of CURRENT_MODE: then the heartbeat's mode counts
  static constexpr double kOvertaken_s = 0.4;   ///< by no more; PX4 tells the mode twice a second
  static constexpr std::size_t kNotices = 64;
  static constexpr int kParameterRequests = 5;  ///< an autopilot may not know them

  AutopilotTelemetry() { state_.landed_state_known = false; }

  /// False for a component that says it is no autopilot: malformed.
  bool on(double now, const Heartbeat& message);
  void on(double now, const CurrentMode& message);
  /// False where it is older than one that came before.
  bool on(double now, const LocalPosition& message);
  /// An answer to our own PING.
  void on(double now, const Ping& message);
  void on(double now, const Attitude& message);
  void on(const Odometry& message);
  void on(const SysStatus& message);
  void on(const ExtendedSysState& message);
  void on(const EstimatorStatus& message);
  void on(const BatteryStatus& message);
  void on(const Origin& message);
  void on(const Home& message);
  void on(const AutopilotVersion& message);
  void on(const StatusText& message);
  void on(const vehicle::px4::Parameter& parameter);
  /// A message that could not be decoded.
  void malformed() { ++counts_.malformed; }

  /// `system_id` is the link's to fill in.
  [[nodiscard]] vehicle::VehicleState state(double now) const;
  /// `setpoints_sent`, `other_autopilots`, `dropped_adsb` and `answers` are the link's.
  [[nodiscard]] const LinkCounts& counts() const { return counts_; }
  /// `other_systems` are the link's.
  [[nodiscard]] const LinkInfo& info() const { return info_; }
  /// Of the newest heartbeat; negative: none.
  [[nodiscard]] double heartbeat_stamp() const { return state_.heartbeat_stamp; }
  [[nodiscard]] bool origin_known() const { return state_.origin.has_value(); }
  [[nodiscard]] bool home_known() const { return state_.home_height.has_value(); }
  /// Those of VehicleState::failsafe_parameters that are to be asked for now: what is not told, kParameterRequests
  /// times.
  [[nodiscard]] std::vector<std::string> parameters_to_ask();

  /// At most kNotices wait; the oldest go.
  void notice(std::string name, std::string detail);
  [[nodiscard]] std::optional<LinkNotice> next_notice();

 private:
  void boot_time(std::uint32_t boot_ms);
  void restarted();

  vehicle::VehicleState state_;
  LinkInfo info_;
  LinkCounts counts_;
  std::optional<CurrentMode> current_mode_;
  std::optional<CurrentMode> mode_before_;
  double mode_changed_at_ = base::kNever;
  double mode_at_ = base::kNever;  // when it was told
  int parameter_requests_ = 0;
  vehicle::EstimateResets resets_;
  vehicle::LinkDelay delay_;
  std::optional<std::uint32_t> boot_ms_;  // newest of LOCAL_POSITION_NED and ATTITUDE
  std::optional<std::uint32_t> position_boot_ms_;
  bool sys_status_heard_ = false;
  std::string failed_health_;
  bool estimator_ok_ = true;  // until it says otherwise
  std::map<std::uint32_t, vehicle::BatteryState> batteries_;
  vehicle::BatteryState remaining_ = vehicle::BatteryState::kUnknown;  // by SYS_STATUS
  vehicle::StatusTexts texts_;
  std::deque<LinkNotice> notices_;
};

}  // namespace jink::bridge::mavlink
