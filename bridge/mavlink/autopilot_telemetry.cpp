// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavlink/autopilot_telemetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "bridge/frames/conversions.hpp"

namespace jink::bridge::mavlink {

namespace {

constexpr std::uint32_t kRcReceiver = 0x10000;          // MAV_SYS_STATUS_SENSOR_RC_RECEIVER
constexpr double kHalfTurn = 1.001 * std::numbers::pi;  // rad, the most that a pitch or a roll is, and rounding

struct FailsafeParameter {
  const char* name;
  std::optional<double> vehicle::FailsafeParameters::*member;
};
constexpr std::array<FailsafeParameter, 3> kFailsafeParameters{{
    {"COM_OBL_RC_ACT", &vehicle::FailsafeParameters::offboard_loss},
    {"GF_ACTION", &vehicle::FailsafeParameters::fence_breach},
    {"RTL_RETURN_ALT", &vehicle::FailsafeParameters::return_height},
}};

}  // namespace

void AutopilotTelemetry::notice(std::string name, std::string detail) {
  if (notices_.size() == kNotices) notices_.pop_front();
  notices_.push_back({std::move(name), std::move(detail)});
}

std::optional<LinkNotice> AutopilotTelemetry::next_notice() {
  if (notices_.empty()) return std::nullopt;
  LinkNotice oldest = std::move(notices_.front());
  notices_.pop_front();
  return oldest;
}

void AutopilotTelemetry::restarted() {
  ++state_.reboots;
  notice("autopilot_rebooted", "its time began anew; its local origin may be another");
  resets_.restart();
  position_boot_ms_.reset();
  state_.origin.reset();
  state_.home_height.reset();
  state_.failsafe_parameters = {};
  parameter_requests_ = 0;
  state_.armable = false;
  state_.landed_state_known = false;
  sys_status_heard_ = false;
  failed_health_.clear();
  batteries_.clear();
  remaining_ = vehicle::BatteryState::kUnknown;
  info_.version.reset();
  info_.battery_percent.reset();
}

// The autopilot's time, by which a reboot shows.
void AutopilotTelemetry::boot_time(std::uint32_t boot_ms) {
  if (boot_ms_) {
    // The counter wraps after 49 days, and so does this difference.
    const auto later_ms = static_cast<std::int32_t>(boot_ms - *boot_ms_);
    if (later_ms < -static_cast<std::int32_t>(kReboot_s * 1e3)) {
      restarted();
    } else if (later_ms <= 0) {
      return;
    } else if (boot_ms < *boot_ms_) {
      resets_.restart();
    }
  }
  boot_ms_ = boot_ms;
}

bool AutopilotTelemetry::on(double now, const Heartbeat& message) {
  if (message.autopilot == vehicle::px4::kAutopilotInvalid) {
    malformed();
    return false;
  }
  ++counts_.heartbeats;
  state_.heartbeat_stamp = now;
  state_.armed = (message.base_mode & vehicle::px4::kArmedFlag) != 0U;
  if (now - mode_at_ > kModeMaxAge_s)
    state_.mode = vehicle::px4::flight_mode(static_cast<std::uint8_t>(message.autopilot), message.custom_mode);
  state_.failsafe = message.system_status >= vehicle::px4::kStateCritical;
  info_.autopilot = message.autopilot;
  return true;
}

// By the heartbeat alone it is known whose numbers these are. A message bears no time: one that goes back to what was
// left a moment ago was overtaken, or the next one says so too.
void AutopilotTelemetry::on(double now, const CurrentMode& message) {
  if (!info_.autopilot) return;
  if (current_mode_ != message) {
    if (mode_before_ == message && now - mode_changed_at_ < kOvertaken_s) return;
    mode_before_ = std::exchange(current_mode_, message);
    mode_changed_at_ = now;
  }
  const auto autopilot = static_cast<std::uint8_t>(*info_.autopilot);
  state_.mode = vehicle::px4::flight_mode(autopilot, message.custom_mode);
  state_.intended_mode = message.intended_custom_mode == 0
                             ? vehicle::FlightMode::kUnknown
                             : vehicle::px4::flight_mode(autopilot, message.intended_custom_mode);
  mode_at_ = now;
}

bool AutopilotTelemetry::on(double now, const LocalPosition& message) {
  boot_time(message.boot_ms);
  if (position_boot_ms_ && static_cast<std::int32_t>(message.boot_ms - *position_boot_ms_) < 0) {
    ++counts_.late;
    return false;
  }
  position_boot_ms_ = message.boot_ms;
  ++counts_.positions;
  // By its own clock it may be older than what else has come; boot_time() lets it be no more than kReboot_s older.
  const double behind = 1e-3 * static_cast<std::int32_t>(*boot_ms_ - message.boot_ms);
  state_.motion = {{message.position, message.velocity}, now - delay_.one_way() - behind, now};
  resets_.on_position({message.boot_ms * 1e-3, message.position, message.velocity});
  return true;
}

void AutopilotTelemetry::on(double now, const Ping& message) {
  delay_.answered(static_cast<double>(message.time_us) * 1e-6, now);
  info_.round_trip_s = delay_.round_trip();
  state_.link_delay = delay_.one_way();
}

void AutopilotTelemetry::on(double now, const Attitude& message) {
  boot_time(message.boot_ms);
  ++counts_.attitudes;
  state_.yaw = message.yaw;
  if (!(std::abs(message.pitch) <= kHalfTurn && std::abs(message.roll) <= kHalfTurn)) return;
  const double behind = 1e-3 * static_cast<std::int32_t>(*boot_ms_ - message.boot_ms);
  state_.attitude = frames::attitude_enu(message.yaw, message.pitch, message.roll);
  state_.attitude_stamp = now - delay_.one_way() - behind;
}

void AutopilotTelemetry::on(const Odometry& message) {
  if (!message.local_frame) return;  // its counter is not this position's
  ++counts_.odometries;
  resets_.on_odometry({message.time, message.position, message.velocity}, message.reset_counter);
}

void AutopilotTelemetry::on(const SysStatus& message) {
  sys_status_heard_ = true;
  failed_health_ = vehicle::px4::failed_health(message.present, message.enabled, message.health);
  state_.armable = (message.health & vehicle::px4::kPrearmCheck) != 0U;
  state_.gps_lost = (message.present & message.enabled & ~message.health & vehicle::px4::kGps) != 0U;
  remaining_ = vehicle::px4::battery_state_from_remaining(message.battery_remaining_percent);
  info_.battery_percent.reset();
  if (remaining_ != vehicle::BatteryState::kUnknown) info_.battery_percent = message.battery_remaining_percent;
  state_.remote_control = (message.present & message.enabled & message.health & kRcReceiver) != 0U;
}

void AutopilotTelemetry::on(const ExtendedSysState& message) {
  state_.in_air = vehicle::px4::in_air(static_cast<int>(message.landed_state));
  state_.landed_state_known = true;
}

void AutopilotTelemetry::on(const EstimatorStatus& message) {
  estimator_ok_ = vehicle::px4::estimator_has_local_position(message.flags);
  info_.estimator = message.flags;
  state_.position_sigma = vehicle::px4::position_sigma(message.horizontal_accuracy, message.vertical_accuracy);
}

void AutopilotTelemetry::on(const BatteryStatus& message) {
  batteries_[message.id] = vehicle::px4::battery_state(message.charge_state);
}

void AutopilotTelemetry::on(const Origin& message) {
  state_.origin = message.place;
}

void AutopilotTelemetry::on(const Home& message) {
  state_.home_height = message.height;
}

void AutopilotTelemetry::on(const AutopilotVersion& message) {
  info_.version = vehicle::px4::version(message.flight_sw_version);
}

void AutopilotTelemetry::on(const StatusText& message) {
  for (std::string& line : texts_.add(message.severity, message.id, message.chunk, message.text)) {
    notice("autopilot_text", std::move(line));
  }
}

void AutopilotTelemetry::on(const vehicle::px4::Parameter& parameter) {
  for (const auto& [name, member] : kFailsafeParameters) {
    if (parameter.name == name && std::isfinite(parameter.value)) state_.failsafe_parameters.*member = parameter.value;
  }
}

std::vector<std::string> AutopilotTelemetry::parameters_to_ask() {
  std::vector<std::string> names;
  if (++parameter_requests_ > kParameterRequests) return names;
  for (const auto& [name, member] : kFailsafeParameters) {
    if (!(state_.failsafe_parameters.*member)) names.emplace_back(name);
  }
  return names;
}

vehicle::VehicleState AutopilotTelemetry::state(double now) const {
  vehicle::VehicleState state = state_;
  const bool fresh = state.motion.silence(now) <= kPositionMaxAge_s;
  state.local_position_ok = fresh && estimator_ok_;
  state.health = sys_status_heard_ ? failed_health_ : "no SYS_STATUS yet";
  if (!state.local_position_ok) state.health += state.health.empty() ? "local position" : ", local position";
  if (now - mode_at_ > kModeMaxAge_s) state.intended_mode = vehicle::FlightMode::kUnknown;
  state.estimate_resets = resets_.count();
  state.estimate_shift = resets_.shift();
  for (const auto& [id, battery] : batteries_) state.battery = std::max(state.battery, battery);
  if (state.battery == vehicle::BatteryState::kUnknown) state.battery = remaining_;
  return state;
}

}  // namespace jink::bridge::mavlink
