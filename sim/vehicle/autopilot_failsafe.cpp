// SPDX-License-Identifier: BSD-3-Clause
// Failsafes: what flies when the stream, the position or the battery do not. The intended mode stays what it was, so
// that the flight goes back to it by itself as soon as it can.
#include <algorithm>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {
namespace {

FlightMode offboard_loss_mode(std::int32_t com_obl_rc_act) {
  switch (com_obl_rc_act) {
    case 1:
    case 2:
      return FlightMode::kAltitude;
    case 3:
      return FlightMode::kReturn;
    case 4:
      return FlightMode::kLand;
    case 5:
      return FlightMode::kHold;
    default:
      return FlightMode::kPosition;
  }
}

bool cuts_motors(std::int32_t com_obl_rc_act) {
  return com_obl_rc_act == 6 || com_obl_rc_act == 7;
}

/// PX4 takes the worst of the actions, in this order.
int severity(FlightMode mode) {
  switch (mode) {
    case FlightMode::kPosition:
      return 1;
    case FlightMode::kAltitude:
      return 2;
    case FlightMode::kHold:
      return 4;
    case FlightMode::kReturn:
      return 5;
    case FlightMode::kLand:
      return 6;
    default:
      return 3;
  }
}

/// What can fly without a horizontal position. LAND then is PX4's Descend, which shows under the same number.
FlightMode without_position(FlightMode mode) {
  if (mode == FlightMode::kPosition) return FlightMode::kAltitude;
  return is_manual(mode) ? mode : FlightMode::kLand;
}

/// COM_LOW_BAT_ACT: 0 warns, 1 returns, 2 lands, 3 returns and in an emergency lands.
std::optional<FlightMode> low_battery_mode(std::int32_t action, BatteryLevel level) {
  if (level < BatteryLevel::kCritical || action < 1 || action > 3) return std::nullopt;
  const bool land = action == 2 || (action == 3 && level == BatteryLevel::kEmergency);
  return land ? FlightMode::kLand : FlightMode::kReturn;
}

const char* battery_text(BatteryLevel level) {
  switch (level) {
    case BatteryLevel::kEmergency:
      return "Emergency battery level";
    case BatteryLevel::kCritical:
      return "Critical battery level";
    default:
      return "Low battery level";
  }
}

}  // namespace

bool Autopilot::offboard_runs() const {
  // A refusal keeps it from coming back, not from going on.
  return stream_live() && position_valid() && !(refuses_offboard_ && failsafe_);
}

/// What flies in place of a mode that cannot.
std::optional<FlightMode> Autopilot::mode_fallback() const {
  if (intended_mode_ == FlightMode::kOffboard) {
    if (offboard_runs()) return std::nullopt;
    const FlightMode mode = offboard_loss_mode(parameters_.integer("COM_OBL_RC_ACT"));
    return position_valid() ? mode : without_position(mode);
  }
  if (position_valid() || (is_manual(intended_mode_) && intended_mode_ != FlightMode::kPosition)) return std::nullopt;
  return without_position(intended_mode_);
}

std::optional<FlightMode> Autopilot::battery_failsafe() const {
  if (!armed_ || battery_taken_over_ || battery_level() <= armed_battery_) return std::nullopt;
  auto mode = low_battery_mode(parameters_.integer("COM_LOW_BAT_ACT"), battery_level());
  if (!mode || (mode == FlightMode::kReturn && intended_mode_ == FlightMode::kLand)) return std::nullopt;
  if (time() < battery_acts_at_) mode = FlightMode::kHold;
  return position_valid() ? mode : without_position(*mode);
}

void Autopilot::update_battery() {
  const BatteryLevel level = battery_level();
  if (level < BatteryLevel::kLow || level <= reported_battery_) return;
  reported_battery_ = level;
  report(level == BatteryLevel::kLow ? Severity::kWarning : Severity::kCritical, battery_text(level));
  if (!armed_ || level < BatteryLevel::kCritical) return;
  // Each new level may act anew; the first one leaves a pilot the time to take over.
  battery_taken_over_ = false;
  if (battery_acts_at_ == planner::base::kInfinity) battery_acts_at_ = time() + parameters_.real("COM_FAIL_ACT_T");
}

void Autopilot::update_failsafe() {
  const bool stream_lost = intended_mode_ == FlightMode::kOffboard && !offboard_runs();
  if (stream_lost && cuts_motors(parameters_.integer("COM_OBL_RC_ACT"))) {
    report(Severity::kCritical, "Failsafe activated");
    disarm_now();
    return;
  }
  std::optional<FlightMode> wanted = mode_fallback();
  const auto battery = battery_failsafe();
  if (battery && (!wanted || severity(*battery) > severity(*wanted))) wanted = battery;
  if (wanted && (!failsafe_ || severity(*wanted) > severity(*failsafe_))) {
    report(Severity::kCritical, "Failsafe activated");
    emit_failsafe_event(*wanted);
  }
  failsafe_ = wanted;
}

}  // namespace jink::sim::vehicle
