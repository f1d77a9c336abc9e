// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/vehicle_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace jink::sim::vehicle {
namespace {

void require_positive(const char* what, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string("VehicleModel: ") + what + " must be positive and finite, is " +
                                std::to_string(value));
  }
}

Vec3 clamp_norm(const Vec3& v, double max) {
  const double norm = v.norm();
  return norm > max ? Vec3(v * (max / norm)) : v;
}

/// Shortens the horizontal part alone.
Vec3 clamp_horizontal(const Vec3& v, double max) {
  const double norm = v.head<2>().norm();
  if (norm <= max) return v;
  const double scale = max / norm;
  return {v.x() * scale, v.y() * scale, v.z()};
}

double wrap_angle(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// The part of the way to its input that a first-order lag covers in one step.
double lag_fraction(double time_constant) {
  return time_constant > 0.0 ? 1.0 - std::exp(-VehicleModel::kStep / time_constant) : 1.0;
}

}  // namespace

Eigen::Quaterniond attitude_along(const Vec3& thrust, double yaw) {
  const Vec3 up = thrust.normalized();
  const Vec3 ahead = Vec3(-std::sin(yaw), std::cos(yaw), 0.0).cross(up).normalized();
  Eigen::Matrix3d axes;
  axes << ahead, up.cross(ahead), up;
  return Eigen::Quaterniond(axes);
}

VehicleModel::VehicleModel(const planner::base::VehicleLimits& limits, const Vec3& position, double ground_height,
                           double yaw, const Cascade& cascade)
    : limits_(limits), cascade_(cascade), ground_height_(ground_height) {
  require_positive("mass", limits.mass);
  require_positive("max_speed", limits.max_speed);
  require_positive("max_acceleration", limits.max_acceleration);
  require_positive("max_climb", limits.max_climb);
  require_positive("max_thrust_acceleration", cascade.max_thrust_acceleration);
  require_positive("velocity_gain", std::min(cascade.horizontal.velocity_gain, cascade.vertical.velocity_gain));
  motion_.position = {position.x(), position.y(), std::max(position.z(), ground_height)};
  motion_.yaw = wrap_angle(yaw);
  on_ground_ = position.z() <= ground_height;
  const auto delay_steps = std::max(1L, std::lround(cascade.delay / kStep));
  delayed_.resize(static_cast<std::size_t>(delay_steps));
  set_motors(Motors::kOff);
  update_attitude();
  motion_.body_rates.setZero();
}

void VehicleModel::set_motors(Motors motors) {
  const bool was_flying = motors_ == Motors::kFlying;
  motors_ = motors;
  if (motors == Motors::kFlying) {
    if (was_flying) return;
    // In the air the rotors already carry the weight and hold against the wind; on the ground they first have to speed
    // up.
    first_stage_ = thrust_ = on_ground_ ? Vec3(0, 0, -kGravity) : Vec3(-cascade_.drag * wind_);
    std::fill(delayed_.begin(), delayed_.end(), setpoint_);
  } else {
    first_stage_ = thrust_ = Vec3(0, 0, -kGravity);
  }
  integral_ = motors == Motors::kFlying && !on_ground_ ? thrust_ : Vec3::Zero();
  command_ = thrust_;
}

void VehicleModel::shift_setpoints(const Vec3& by) {
  setpoint_.position += by;
  for (Setpoint& setpoint : delayed_) setpoint.position += by;
}

Vec3 VehicleModel::velocity_command(const Setpoint& setpoint) const {
  Vec3 command = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const CascadeAxis& gains = axis == 2 ? cascade_.vertical : cascade_.horizontal;
    if (std::isfinite(setpoint.velocity[axis])) command[axis] += setpoint.velocity[axis];
    if (std::isfinite(setpoint.position[axis])) {
      command[axis] += gains.position_gain * (setpoint.position[axis] - known_position()[axis]);
    }
  }
  const double speed = std::clamp(bounds_.speed, 0.0, limits_.max_speed);
  const double climb = std::clamp(bounds_.climb, 0.0, std::min(limits_.max_climb, speed));
  const double descent = std::clamp(bounds_.descent, 0.0, std::min({limits_.max_climb, cascade_.max_descent, speed}));
  command.z() = std::clamp(command.z(), -descent, climb);
  return clamp_horizontal(command, std::sqrt(std::max(0.0, speed * speed - command.z() * command.z())));
}

/// The nearest to `acceleration` (gravity compensated, drag not) that the rotors can give and the limits allow.
Vec3 VehicleModel::attainable(const Vec3& acceleration) const {
  const double horizontal = std::min(cascade_.max_thrust_acceleration, kGravity * std::tan(cascade_.max_tilt));
  Vec3 thrust = clamp_horizontal(acceleration, horizontal);
  thrust.z() = std::max(thrust.z(), -(1.0 - cascade_.min_lift_fraction) * kGravity);
  thrust = clamp_norm(thrust, cascade_.max_thrust_acceleration);
  // Drag helps braking and costs when speeding up; what remains is what max_acceleration is about.
  const Vec3 drag = cascade_.drag * (motion_.velocity - wind_);
  return drag + clamp_norm(thrust - drag, limits_.max_acceleration);
}

Vec3 VehicleModel::control(const Setpoint& setpoint) {
  velocity_command_ = velocity_command(setpoint);
  const Vec3 error = velocity_command_ - known_velocity();
  Vec3 wanted = Vec3::Zero();
  Eigen::Array<bool, 3, 1> open_loop;
  for (int axis = 0; axis < 3; ++axis) {
    const CascadeAxis& gains = axis == 2 ? cascade_.vertical : cascade_.horizontal;
    const bool has_acceleration = std::isfinite(setpoint.acceleration[axis]);
    open_loop[axis] =
        has_acceleration && !std::isfinite(setpoint.position[axis]) && !std::isfinite(setpoint.velocity[axis]);
    if (has_acceleration) wanted[axis] = setpoint.acceleration[axis];
    if (open_loop[axis]) continue;
    wanted[axis] +=
        gains.velocity_gain * error[axis] + integral_[axis] - gains.derivative_gain * motion_.acceleration[axis];
  }
  Vec3 given = attainable(wanted);
  for (int axis = 0; axis < 3; ++axis) {
    const CascadeAxis& gains = axis == 2 ? cascade_.vertical : cascade_.horizontal;
    // Anti-windup by tracking, as PX4's: what saturation takes away is taken from the integral's input.
    const double input = error[axis] - 2.0 / gains.velocity_gain * (wanted[axis] - given[axis]);
    const bool pressed_to_ground = on_ground_ && (axis < 2 || input < 0.0);
    if (open_loop[axis] || pressed_to_ground) continue;
    integral_[axis] += gains.integral_gain * input * kStep;
  }
  return given;
}

void VehicleModel::apply_lags(const Vec3& command) {
  for (int axis = 0; axis < 3; ++axis) {
    const CascadeAxis& gains = axis == 2 ? cascade_.vertical : cascade_.horizontal;
    first_stage_[axis] += lag_fraction(gains.first_lag) * (command[axis] - first_stage_[axis]);
    thrust_[axis] += lag_fraction(gains.second_lag) * (first_stage_[axis] - thrust_[axis]);
  }
}

/// [Paper] Eq. (1): m a = F, with F of the rotors, the weight, the drag and, on the ground, the ground's reaction.
void VehicleModel::integrate() {
  const double mass = limits_.mass;
  const Vec3 gravity(0, 0, -kGravity);
  const Vec3 rotor_force = mass * (thrust_ - gravity);
  const Vec3 drag_force = -mass * cascade_.drag * (motion_.velocity - wind_);
  Vec3 acceleration = (rotor_force + drag_force + mass * gravity) / mass;
  const bool flying = motors_ == Motors::kFlying;
  // The lags let thrust and drag drift apart by a little after `attainable` saw them; the limit holds all the same.
  if (flying) acceleration = clamp_norm(acceleration, limits_.max_acceleration);

  const Vec3 before = motion_.velocity;
  Vec3 velocity = before + kStep * acceleration;
  if (flying) {
    // Both are projections on convex sets that hold `before`, so the acceleration only gets smaller.
    velocity = clamp_norm(velocity, limits_.max_speed);
    velocity.z() = std::clamp(velocity.z(), -limits_.max_climb, limits_.max_climb);
  }
  motion_.velocity = velocity;
  motion_.position += kStep * velocity;
  touch_ground();
  motion_.acceleration = (motion_.velocity - before) / kStep;
  motion_.specific_force = motion_.acceleration - gravity;
}

void VehicleModel::touch_ground() {
  on_ground_ = motion_.position.z() <= ground_height_ && motion_.velocity.z() <= 0.0;
  if (motion_.position.z() < ground_height_) motion_.position.z() = ground_height_;
  if (on_ground_) motion_.velocity.setZero();  // skids grip: no bouncing, no sliding
}

void VehicleModel::turn(const Setpoint& setpoint) {
  double wanted = 0.0;
  if (motors_ == Motors::kFlying && !on_ground_) {
    if (std::isfinite(setpoint.yaw)) wanted += cascade_.yaw_gain * wrap_angle(setpoint.yaw - motion_.yaw);
    if (std::isfinite(setpoint.yaw_rate)) wanted += setpoint.yaw_rate;
    wanted = std::clamp(wanted, -cascade_.max_yaw_rate, cascade_.max_yaw_rate);
  }
  yaw_rate_ = on_ground_ ? 0.0 : yaw_rate_ + lag_fraction(cascade_.yaw_lag) * (wanted - yaw_rate_);
  motion_.yaw = wrap_angle(motion_.yaw + kStep * yaw_rate_);
}

void VehicleModel::update_attitude() {
  Vec3 up = Vec3::UnitZ();
  if (motors_ == Motors::kFlying && !on_ground_) up = thrust_ + Vec3(0, 0, kGravity);
  up.z() = std::max(up.z(), 0.1);  // the lags may undershoot the least lift by a little
  const Eigen::Quaterniond attitude = attitude_along(up, motion_.yaw);
  const Eigen::Quaterniond change = motion_.attitude.conjugate() * attitude;
  motion_.body_rates = 2.0 * std::copysign(1.0, change.w()) * change.vec() / kStep;
  motion_.attitude = attitude;
}

void VehicleModel::step() {
  const Setpoint delayed = delayed_[next_delayed_];
  delayed_[next_delayed_] = setpoint_;
  next_delayed_ = (next_delayed_ + 1) % delayed_.size();
  if (motors_ == Motors::kFlying) {
    command_ = control(delayed);
    // The thrust points where the estimated attitude says, which is off.
    apply_lags(command_ - attitude_error_.cross(command_ + Vec3(0, 0, kGravity)));
  }
  integrate();
  turn(delayed);
  update_attitude();
}

}  // namespace jink::sim::vehicle
