// SPDX-License-Identifier: BSD-3-Clause
// What may befall the autopilot: no satellites, an estimate that jumps, an empty battery, a reboot, a pilot.
#include <algorithm>
#include <cmath>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {

void Autopilot::set_gps(bool available) {
  const auto resets = estimator_.reset_counter();
  estimator_.set_gps(available);
  // Where the position is reset, so is what the autopilot holds on to.
  if (estimator_.reset_counter() != resets && armed_) enter_active_mode();
}

void Autopilot::jump_estimate(const Vec3& by) {
  estimator_.jump(by);
  hold_position_ += by;
  takeoff_height_ += by.z();
  mission_.shift(by);
  if (mode() != FlightMode::kOffboard) model_.shift_setpoints(by);
}

void Autopilot::set_battery(double remaining) {
  battery_ = std::isnan(remaining) ? remaining : std::clamp(remaining, 0.0, 1.0);
}

BatteryLevel Autopilot::battery_level() const {
  if (std::isnan(battery_)) return BatteryLevel::kUnknown;
  // A parameter is a float: 0.15 of it is not below its own threshold.
  const auto remaining = static_cast<double>(static_cast<float>(battery_));
  if (remaining < parameters_.real("BAT_EMERGEN_THR")) return BatteryLevel::kEmergency;
  if (remaining < parameters_.real("BAT_CRIT_THR")) return BatteryLevel::kCritical;
  return remaining < parameters_.real("BAT_LOW_THR") ? BatteryLevel::kLow : BatteryLevel::kOk;
}

bool Autopilot::warning_is_critical() const {
  return options_.version < Px4Version::k1_16 && battery_level() >= BatteryLevel::kLow;
}

void Autopilot::reboot() {
  disarm_now();
  texts_.clear();
  events_.clear();
  last_offboard_.reset();
  intended_mode_ = mode_after_disarm_ = guided_mode_ = FlightMode::kHold;
  has_flown_ = ready_reported_ = stream_reported_ = mission_reported_ = false;
  landed_ = model_.on_ground();
  boot_step_ = steps_;
  ++reboots_;
  const Vec3& place = true_motion().position;
  estimator_.restart({place.x(), place.y(), options_.ground_height}, model_.motion());
  home_ = {0.0, 0.0, local_ground()};
  reported_battery_ = BatteryLevel::kOk;
}

Result Autopilot::pilot_mode(FlightMode mode) {
  remote_control_ = true;
  const auto value = static_cast<std::uint32_t>(mode);
  return set_mode(value >> 16U & 0xFFU, value >> 24U);
}

}  // namespace jink::sim::vehicle
