// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot does at each step: failsafe, take-off, guidance of its own modes, landing.
#include <algorithm>
#include <cmath>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {
namespace {

// Take-off as measured: the thrust comes up for about 3 s after arming, the first of which the rotors spool up.
constexpr double kRampTime = 2.2;
constexpr double kRampClimb = 0.25;        ///< m/s, until the ramp ends
constexpr double kTakeoffClimb = 1.0;      ///< m/s, after it
constexpr double kTakeoffClimbTime = 5.0;  ///< s from the ramp's start that the climb stays bounded so
constexpr double kTakeoffDetection = 0.9;  ///< s from the ramp's start: IN_AIR about 2 s after arming
constexpr double kTakeoffDetectionHeight = 0.05;
constexpr double kTakeoffReached = 0.1;  ///< m below the take-off height, from where HOLD takes over

constexpr double kLandDetection = 3.0;  ///< s on the ground and told to go on down
/// s, disarmed: then it is taken for landed wherever it is (MulticopterLandDetector, LNDMC_TRIG_TIME).
constexpr double kDisarmedDetection = 1.0 / 3.0;
constexpr double kLandingVelocity = 0.3;     ///< m/s down: less asked for in OFFBOARD is no wish to land
constexpr double kFailsafeDescent = 0.7;     ///< m/s, the sink without manual control
constexpr double kBrakingTime = 0.8;         ///< s: HOLD stops where it would be after that at its present speed
constexpr double kReturnReached = 0.5;       ///< m, of the return height and of home
constexpr double kMicroseconds = 1e6;        ///< in a second
constexpr double kFastDescentHeight = 10.0;  ///< m, above which LAND sinks at MPC_Z_VEL_MAX_DN
constexpr double kSlowDescentHeight = 5.0;   ///< m, MPC_LAND_SPEED
constexpr double kCrawlHeight = 0.5;         ///< m, MPC_LAND_CRWL

/// The value at x on the line through (x0, y0) and (x1, y1), x0 < x1, constant beyond both.
double interpolate(double x, double x0, double y0, double x1, double y1) {
  return y0 + (y1 - y0) * std::clamp((x - x0) / (x1 - x0), 0.0, 1.0);
}

/// Level: nothing holds the place, the wind takes it along.
void float_away(Setpoint& setpoint) {
  setpoint.position.head<2>().setConstant(std::numeric_limits<double>::quiet_NaN());
  setpoint.velocity.head<2>().setConstant(std::numeric_limits<double>::quiet_NaN());
  setpoint.acceleration.head<2>().setZero();
}

}  // namespace

void Autopilot::step() {
  ++steps_;
  if (!ready_reported_ && ready()) {
    ready_reported_ = true;
    report(Severity::kInfo, "Ready for takeoff!");
  }
  update_battery();
  watch_checks();
  if (armed_) {
    update_failsafe();
    if (guided_mode_ != mode()) enter_active_mode();
  }
  if (armed_) {
    update_takeoff();
    active_setpoint_ = guide();
    model_.set_bounds(bounds());
    model_.set_setpoint(active_setpoint_);
  }
  wind_.step();
  model_.set_wind(wind_.velocity());
  if (!estimator_.exact()) {
    model_.set_estimate(estimated_motion().position, estimated_motion().velocity, estimator_.attitude_error());
  }
  model_.step();
  const bool at_rest = model_.on_ground() && model_.motors() != Motors::kFlying;
  estimator_.step(model_.motion(), parameters_.integer("EKF2_NOAID_TOUT") / kMicroseconds, at_rest,
                  height_above_ground());
  update_landed();
  if (armed_) update_auto_disarm();
  update_home();
}

/// PX4 takes home where it is armed, and before that wherever it stands.
void Autopilot::update_home() {
  if (!armed_ && landed_ && !home_was_set_ && position_valid()) home_ = estimated_motion().position;
}

void Autopilot::enter_active_mode() {
  if (guided_mode_ == FlightMode::kMission) mission_.pause();
  guided_mode_ = mode();
  hold_position_ = estimated_motion().position + kBrakingTime * estimated_motion().velocity;
  hold_position_.z() = std::max(hold_position_.z(), local_ground());
  hold_yaw_ = std::numeric_limits<double>::quiet_NaN();
  cruise_speed_ = planner::base::kInfinity;
  return_climbed_ = return_arrived_ = false;
  if (guided_mode_ != FlightMode::kMission || !armed_) return;
  mission_order_ = {};
  mission_.begin(mission_view());
  report(Severity::kInfo, "Executing Mission");
}

bool Autopilot::takeoff_wanted() const {
  if (mode() == FlightMode::kTakeoff) return true;
  if (mode() == FlightMode::kMission) return mission_order_.kind == MissionOrder::Kind::kFly;
  if (mode() != FlightMode::kOffboard) return false;
  if (std::isfinite(offboard_.position.z())) return offboard_.position.z() > estimated_motion().position.z();
  if (std::isfinite(offboard_.velocity.z())) return offboard_.velocity.z() > 0.0;
  return offboard_.acceleration.z() > 0.0;
}

void Autopilot::update_takeoff() {
  const double now = time();
  if (phase_ == Phase::kLanded && takeoff_wanted() && now - armed_at_ >= parameters_.real("COM_SPOOLUP_TIME")) {
    phase_ = Phase::kRamp;
    ramp_started_ = now;
    hold_position_ = estimated_motion().position;
    model_.set_motors(Motors::kFlying);
  } else if (phase_ != Phase::kLanded && landed_ && !takeoff_wanted()) {
    phase_ = Phase::kLanded;
    model_.set_motors(Motors::kIdle);
  } else if (phase_ == Phase::kRamp && now - ramp_started_ >= kRampTime) {
    phase_ = Phase::kFlying;
  }
  if (mode() == FlightMode::kTakeoff && phase_ == Phase::kFlying &&
      estimated_motion().position.z() >= takeoff_height_ - kTakeoffReached) {
    finish_takeoff();
  }
}

void Autopilot::finish_takeoff() {
  const Vec3 hover(hold_position_.x(), hold_position_.y(), std::max(takeoff_height_, estimated_motion().position.z()));
  hold();
  hold_position_ = hover;
}

/// Bounds of the parameters, and of the flight phase.
SpeedBounds Autopilot::bounds() const {
  SpeedBounds result{.speed = parameters_.real("MPC_XY_VEL_MAX"),
                     .climb = parameters_.real("MPC_Z_VEL_MAX_UP"),
                     .descent = parameters_.real("MPC_Z_VEL_MAX_DN")};
  if (mode() != FlightMode::kOffboard) {
    const double cruise = std::isfinite(cruise_speed_) ? cruise_speed_ : parameters_.real("MPC_XY_CRUISE");
    result.speed = std::min(result.speed, cruise);
  }
  if (phase_ == Phase::kRamp) {
    result.climb = std::min(result.climb, kRampClimb);
  } else if (time() - ramp_started_ < kTakeoffClimbTime) {
    result.climb = std::min(result.climb, kTakeoffClimb);
  }
  return result;
}

Setpoint Autopilot::guide() {
  switch (mode()) {
    case FlightMode::kOffboard:
      return offboard_;
    case FlightMode::kTakeoff: {
      Setpoint setpoint = guide_hold();
      setpoint.position.z() = takeoff_height_;
      setpoint.velocity.z() = 0.0;
      return setpoint;
    }
    case FlightMode::kLand:
      return guide_descent(landing_speed());
    case FlightMode::kReturn:
      return guide_return();
    case FlightMode::kHold:
      return guide_hold();
    case FlightMode::kMission:
      return guide_mission();
    default:
      return guide_manual();
  }
}

/// Sticks centred; without a remote control PX4 sinks.
Setpoint Autopilot::guide_manual() const {
  if (!remote_control_) return guide_descent(kFailsafeDescent);
  Setpoint setpoint = guide_hold();
  if (mode() == FlightMode::kPosition) return setpoint;
  float_away(setpoint);
  if (mode() == FlightMode::kAltitude) return setpoint;
  // Level and with the thrust of hover: nothing holds anything.
  setpoint.position.z() = setpoint.velocity.z() = std::numeric_limits<double>::quiet_NaN();
  setpoint.acceleration.z() = 0.0;
  return setpoint;
}

/// Keeps the place where it comes to rest.
Setpoint Autopilot::guide_hold() const {
  Setpoint setpoint;
  setpoint.position = hold_position_;
  setpoint.velocity.setZero();
  setpoint.yaw = hold_yaw_;
  return setpoint;
}

Setpoint Autopilot::guide_descent(double speed) const {
  Setpoint setpoint;
  setpoint.position.head<2>() = hold_position_.head<2>();
  setpoint.velocity = {0.0, 0.0, -speed};
  if (!position_valid() || mode() == FlightMode::kAltitude) float_away(setpoint);
  return setpoint;
}

/// Climbs to RTL_RETURN_ALT above home, flies home, lands.
Setpoint Autopilot::guide_return() {
  const Motion& motion = estimated_motion();
  const double return_height = std::max(home_.z() + parameters_.real("RTL_RETURN_ALT"), hold_position_.z());
  if (motion.position.z() >= return_height - kReturnReached) return_climbed_ = true;
  if (!return_climbed_) {
    Setpoint setpoint = guide_hold();
    setpoint.position.z() = return_height;
    return setpoint;
  }
  Setpoint setpoint;
  setpoint.position = {home_.x(), home_.y(), return_height};
  if ((motion.position - home_).head<2>().norm() < kReturnReached) return_arrived_ = true;
  if (return_arrived_) {
    setpoint.position.z() = std::numeric_limits<double>::quiet_NaN();
    setpoint.velocity = {0.0, 0.0, -landing_speed()};
  }
  return setpoint;
}

double Autopilot::landing_speed() const {
  const double height = height_above_ground();
  const double fast = parameters_.real("MPC_Z_VEL_MAX_DN");
  const double slow = std::min(parameters_.real("MPC_LAND_SPEED"), fast);
  const double crawl = std::min(parameters_.real("MPC_LAND_CRWL"), slow);
  if (height > kSlowDescentHeight) return interpolate(height, kSlowDescentHeight, slow, kFastDescentHeight, fast);
  return interpolate(height, kCrawlHeight, crawl, kSlowDescentHeight, slow);
}

/// PX4's land detector wants a vertical velocity setpoint: a position below the ground is no wish to land for it.
bool Autopilot::descent_wanted() const {
  return std::isnan(active_setpoint_.position.z()) && active_setpoint_.velocity.z() <= -kLandingVelocity;
}

void Autopilot::update_landed() {
  const double now = time();
  const bool flying = phase_ != Phase::kLanded;
  if (landed_) {
    const bool risen = height_above_ground() > kTakeoffDetectionHeight;
    if (flying && risen && now - ramp_started_ >= kTakeoffDetection) {
      landed_ = false;
      has_flown_ = true;
      report(Severity::kInfo, "Takeoff detected");
      emit_event(EventKind::kTakeoffDetected);
    }
    return;
  }
  if (armed_ && !(model_.on_ground() && descent_wanted())) {
    settled_since_.reset();
    return;
  }
  if (!settled_since_) settled_since_ = now;
  if (now - *settled_since_ >= (armed_ ? kLandDetection : kDisarmedDetection)) touch_down();
}

void Autopilot::touch_down() {
  landed_ = true;
  landed_at_ = time();
  settled_since_.reset();
  phase_ = Phase::kLanded;
  if (!armed_) return;  // it says so of its flights alone
  model_.set_motors(Motors::kIdle);
  report(Severity::kInfo, "Landing detected");
  emit_event(EventKind::kLandingDetected);
}

void Autopilot::update_auto_disarm() {
  if (!landed_) return;
  const double delay = parameters_.real(has_flown_ ? "COM_DISARM_LAND" : "COM_DISARM_PRFLT");
  const double since = has_flown_ ? landed_at_ : armed_at_;
  if (delay <= 0.0 || time() - since < delay) return;
  report(Severity::kInfo, has_flown_ ? "Disarmed by landing" : "Disarmed by auto preflight disarming");
  // The number of the other reason is in no recording.
  if (has_flown_) emit_armed_event(EventKind::kDisarmed, ArmingReason::kLanding);
  disarm_now();
}

}  // namespace jink::sim::vehicle
