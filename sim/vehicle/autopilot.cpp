// SPDX-License-Identifier: BSD-3-Clause
// Commands, arming and what the autopilot says of itself; autopilot_flight.cpp flies, autopilot_failsafe.cpp decides
// what becomes of a flight that lacks something, autopilot_faults.cpp holds the faults,
// autopilot_events.cpp what it says when, autopilot_mission.cpp flies missions.
#include "sim/vehicle/autopilot.hpp"

#include <cmath>
#include <stdexcept>

namespace jink::sim::vehicle {
namespace {

// MAV_MODE_FLAG and MAV_STATE.
constexpr unsigned kFlagCustom = 0x01;
constexpr unsigned kFlagAuto = 0x04;
constexpr unsigned kFlagGuided = 0x08;
constexpr unsigned kFlagStabilize = 0x10;
constexpr unsigned kFlagManualInput = 0x40;
constexpr unsigned kFlagArmed = 0x80;
constexpr std::uint8_t kStateUninitialised = 0;
constexpr std::uint8_t kStateStandby = 3;
constexpr std::uint8_t kStateActive = 4;
constexpr std::uint8_t kStateCritical = 5;
constexpr std::uint8_t kStateTermination = 8;

bool forbids_arming(FlightMode mode) {
  return mode == FlightMode::kLand || mode == FlightMode::kReturn;
}

const AutopilotOptions& checked(const AutopilotOptions& options) {
  if (!options.position.allFinite() || !std::isfinite(options.ground_height) || !std::isfinite(options.yaw)) {
    throw std::invalid_argument("Autopilot: start position, yaw and ground height must be finite");
  }
  return options;
}

Vec3 start_position(const AutopilotOptions& options) {
  return options.airborne ? options.position : Vec3(options.position.x(), options.position.y(), options.ground_height);
}

}  // namespace

bool is_manual(FlightMode mode) {
  switch (mode) {
    case FlightMode::kManual:
    case FlightMode::kAltitude:
    case FlightMode::kPosition:
    case FlightMode::kAcro:
    case FlightMode::kStabilized:
      return true;
    default:
      return false;
  }
}

Autopilot::Autopilot(const AutopilotOptions& options)
    : options_(checked(options)),
      parameters_(options.limits, options.system_id, options.version),
      model_(options.limits, start_position(options), options.ground_height, options.yaw, options.cascade),
      wind_(options.wind, options.seed),
      estimator_(options.estimate, options.seed, model_.motion(), options.airborne),
      home_(start_position(options).x(), start_position(options).y(), options.ground_height),
      hold_position_(start_position(options)),
      remote_control_(options.remote_control) {
  if (!options.airborne) return;
  armed_ = has_flown_ = true;
  landed_ = false;
  phase_ = Phase::kFlying;
  ramp_started_ = -planner::base::kInfinity;
  active_setpoint_.position = hold_position_;
  model_.set_setpoint(active_setpoint_);
  model_.set_wind(wind_.velocity());
  model_.set_motors(Motors::kFlying);
}

Result Autopilot::arm(bool force) {
  if (armed_) return Result::kAccepted;
  const bool able = !crashed_ && landed_ && model_.on_ground() && ready() && !refuses_arming_;
  if (!able || (!force && !prearm_ok())) {
    report(Severity::kCritical, "Arming denied: Resolve system health failures first");
    emit_event(EventKind::kArmingRefused);
    return Result::kTemporarilyRejected;
  }
  armed_ = true;
  armed_at_ = time();
  has_flown_ = false;
  home_ = estimated_motion().position;
  armed_battery_ = reported_battery_ = battery_level();
  phase_ = Phase::kLanded;
  model_.set_motors(Motors::kIdle);
  enter_active_mode();
  report(Severity::kInfo, "Armed by external command");
  emit_armed_event(EventKind::kArmed, ArmingReason::kCommand);
  return Result::kAccepted;
}

Result Autopilot::disarm(bool force) {
  if (!armed_) return Result::kAccepted;
  if (!landed_ && !force) {
    report(Severity::kCritical, "Disarming denied: not landed");
    return Result::kTemporarilyRejected;
  }
  disarm_now();
  report(Severity::kInfo, "Disarmed by external command");
  emit_armed_event(EventKind::kDisarmed, ArmingReason::kCommand);
  return Result::kAccepted;
}

void Autopilot::disarm_now() {
  armed_ = false;
  failsafe_.reset();
  phase_ = Phase::kLanded;
  settled_since_.reset();
  battery_acts_at_ = planner::base::kInfinity;
  battery_taken_over_ = home_was_set_ = false;
  mission_.note_disarmed();
  intended_mode_ = mode_after_disarm_;
  model_.set_motors(Motors::kOff);
}

void Autopilot::crash() {
  if (crashed_) return;
  crashed_ = true;
  disarm_now();
  report(Severity::kCritical, "Collision: motors off");
}

Result Autopilot::set_mode(unsigned main_mode, unsigned sub_mode) {
  constexpr unsigned kAuto = 4;
  if (main_mode == kAuto) {
    switch (static_cast<FlightMode>(sub_mode << 24U | kAuto << 16U)) {
      case FlightMode::kTakeoff:
        return takeoff();
      case FlightMode::kHold:
        return hold();
      case FlightMode::kMission:
        return fly_mission();
      case FlightMode::kReturn:
        return return_home();
      case FlightMode::kLand:
        return land();
      default:  // nobody to follow, nothing known under that number
        return Result::kTemporarilyRejected;
    }
  }
  const auto mode = static_cast<FlightMode>(main_mode << 16U);
  if (mode == FlightMode::kOffboard) {
    if (armed_ && (!stream_live() || !position_valid() || refuses_offboard_)) return Result::kTemporarilyRejected;
    return change_mode(mode);
  }
  if (main_mode <= 0xFFU && is_manual(mode)) {
    if (!armed_ || remote_control_) return change_mode(mode);
    return Result::kTemporarilyRejected;
  }
  return Result::kAccepted;
}

Result Autopilot::change_mode(FlightMode mode) {
  // OFFBOARD is checked before; of the modes flown by hand only this one needs to know where it is.
  const bool by_hand = is_manual(mode) && mode != FlightMode::kPosition;
  if (armed_ && !position_valid() && !by_hand && mode != FlightMode::kOffboard) {
    return Result::kTemporarilyRejected;
  }
  // Whoever changes the mode in a battery's failsafe takes the flight over.
  if (battery_failsafe()) battery_taken_over_ = true;
  intended_mode_ = mode;
  if (!forbids_arming(mode)) mode_after_disarm_ = mode;
  failsafe_.reset();
  enter_active_mode();
  return Result::kAccepted;
}

Result Autopilot::takeoff(std::optional<double> height) {
  const double z = estimated_motion().position.z();
  takeoff_height_ = height && std::isfinite(*height) && *height > z ? *height : z + parameters_.real("MIS_TAKEOFF_ALT");
  return change_mode(FlightMode::kTakeoff);
}

Result Autopilot::land() {
  const Result result = change_mode(FlightMode::kLand);
  if (armed_ && result == Result::kAccepted) {
    report(Severity::kInfo, "Landing at current position");
    emit_event(EventKind::kLanding);
  }
  return result;
}

Result Autopilot::hold() {
  return change_mode(FlightMode::kHold);
}

Result Autopilot::return_home() {
  return change_mode(FlightMode::kReturn);
}

Result Autopilot::reposition(const Vec3& position, double yaw, double speed) {
  const bool held = mode() == FlightMode::kHold;
  const Vec3 place = hold_position_;
  const Result result = change_mode(FlightMode::kHold);
  if (result != Result::kAccepted || !armed_ || landed_) return result;
  // Nothing given: it stops where it comes to rest.
  const bool has_place = std::isfinite(position.x()) && std::isfinite(position.y());
  const bool has_height = std::isfinite(position.z());
  if (held && (has_height || std::isfinite(yaw))) hold_position_.head<2>() = place.head<2>();
  if (has_place) hold_position_.head<2>() = position.head<2>();
  if (has_height) hold_position_.z() = position.z();
  if (std::isfinite(yaw)) hold_yaw_ = yaw;
  if (speed > 0.0) cruise_speed_ = speed;
  return result;
}

Result Autopilot::set_home(const Vec3& position) {
  if (!position.allFinite()) return Result::kDenied;
  home_ = position;
  home_was_set_ = true;
  return Result::kAccepted;
}

Result Autopilot::offboard_setpoint(const Setpoint& setpoint) {
  bool infinite = std::isinf(setpoint.yaw) || std::isinf(setpoint.yaw_rate);
  bool complete = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = setpoint.position[axis];
    const double v = setpoint.velocity[axis];
    const double a = setpoint.acceleration[axis];
    infinite = infinite || std::isinf(p) || std::isinf(v) || std::isinf(a);
    complete = complete && !(std::isnan(p) && std::isnan(v) && std::isnan(a));
  }
  if (infinite || !complete) return Result::kDenied;
  offboard_ = setpoint;
  last_offboard_ = time();
  return Result::kAccepted;
}

bool Autopilot::stream_live() const {
  return last_offboard_ && time() - *last_offboard_ < parameters_.real("COM_OF_LOSS_T");
}

bool Autopilot::prearm_ok() const {
  if (!ready() || crashed_ || (refuses_arming_ && !armed_)) return false;
  if (is_manual(mode())) return remote_control_;
  if (!position_valid()) return false;
  if (mode() == FlightMode::kOffboard) return stream_live() && (armed_ || !refuses_offboard_);
  if (mode() == FlightMode::kMission) return mission_.available();
  return armed_ || !forbids_arming(mode());
}

LandedState Autopilot::landed_state() const {
  if (landed_) return LandedState::kOnGround;
  if (mode() == FlightMode::kMission) {
    if (mission_order_.kind == MissionOrder::Kind::kLand) return LandedState::kLanding;
    return mission_order_.takeoff ? LandedState::kTakeoff : LandedState::kInAir;
  }
  if (mode() == FlightMode::kTakeoff) return LandedState::kTakeoff;
  return mode() == FlightMode::kLand ? LandedState::kLanding : LandedState::kInAir;
}

Heartbeat Autopilot::heartbeat() const {
  unsigned flags = kFlagCustom;
  switch (mode()) {
    case FlightMode::kManual:
    case FlightMode::kAcro:
      flags |= kFlagManualInput;
      break;
    case FlightMode::kAltitude:
    case FlightMode::kPosition:
    case FlightMode::kStabilized:
      flags |= kFlagManualInput | kFlagStabilize;
      break;
    case FlightMode::kOffboard:
      // PX4 knows what to control only once a setpoint has told it.
      if (armed_ || last_offboard_) flags |= kFlagStabilize;
      break;
    default:
      flags |= kFlagStabilize | kFlagGuided | kFlagAuto;
  }
  if (armed_) flags |= kFlagArmed;
  std::uint8_t state = prearm_ok() ? kStateStandby : kStateUninitialised;
  if (armed_) state = failsafe_ || warning_is_critical() ? kStateCritical : kStateActive;
  if (crashed_) state = kStateTermination;
  return {static_cast<std::uint8_t>(flags), static_cast<std::uint32_t>(mode()), state};
}

std::optional<Setpoint> Autopilot::active_setpoint() const {
  if (model_.motors() != Motors::kFlying) return std::nullopt;
  return active_setpoint_;
}

}  // namespace jink::sim::vehicle
