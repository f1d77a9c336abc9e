// SPDX-License-Identifier: BSD-3-Clause
// The simulated quadrotor: a point mass under Newton's law ([Paper] Eq. (1)) behind the control cascade of a PX4
// autopilot, as measured on its SITL. Local ENU, ground at a fixed height. It knows nothing of modes or messages.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::sim::vehicle {

inline constexpr double kGravity = 9.80665;
inline constexpr double kDegree = 0.017453292519943295;  ///< rad

/// What the vehicle shall do, ENU. A component that is NaN is not asked for: an axis with a position follows it (and
/// its velocity and acceleration are feed-forward), one with a velocity alone follows that, one with an acceleration
/// alone flies it open loop, one with nothing at all stops.
struct Setpoint {
  Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vec3 velocity = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vec3 acceleration = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  double yaw = std::numeric_limits<double>::quiet_NaN();       ///< counter-clockwise from east
  double yaw_rate = std::numeric_limits<double>::quiet_NaN();  ///< feed-forward to yaw, or alone
};

/// The true motion, ENU; the body frame is FLU (x ahead, y left, z up).
struct Motion {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 acceleration = Vec3::Zero();                              ///< of the last step: F / m, [Paper] Eq. (1)
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< body to world
  Vec3 body_rates = Vec3::Zero();                                ///< rad/s about the body's axes
  Vec3 specific_force = Vec3(0, 0, kGravity);                    ///< what an accelerometer feels, in the world frame
  double yaw = 0.0;                                              ///< counter-clockwise from east, in (-pi, pi]
};

/// One direction of the cascade: a position loop around a velocity loop around thrust with two lags.
struct CascadeAxis {
  double position_gain = 0.95;   ///< 1/s, velocity asked for per metre of error
  double velocity_gain = 1.8;    ///< 1/s, acceleration asked for per m/s of error
  double integral_gain = 0.4;    ///< 1/s^2
  double derivative_gain = 0.2;  ///< on the measured acceleration
  double first_lag = 0.14;       ///< s, attitude loop or motors
  double second_lag = 0.14;      ///< s
};

/// The cascade's figures: PX4's, fitted to the step responses of its SITL. The horizontal ones give its 5 m step
/// within 0.05 m and 0.07 m/s rms, the vertical ones its 5 m climb and descent within 6 % in t50, t90 and top speed.
struct Cascade {
  CascadeAxis horizontal{};
  CascadeAxis vertical{.position_gain = 0.95,
                       .velocity_gain = 4.0,
                       .integral_gain = 2.0,
                       .derivative_gain = 0.0,
                       .first_lag = 0.08,
                       .second_lag = 0.02};
  double max_thrust_acceleration = 9.5;  ///< norm of the acceleration that may be asked for, gravity compensated
  double max_tilt = 44.0 * kDegree;      ///< the thrust's angle from the vertical when hovering thrust is kept
  double min_lift_fraction = 0.1;        ///< of the weight, that the rotors never go below in flight
  double drag = 1.0;                     ///< 1/s, deceleration per m/s against the air
  double delay = 0.03;                   ///< s, from setpoint to cascade
  double max_descent = 1.5;              ///< m/s asked for downwards, PX4's MPC_Z_VEL_MAX_DN
  double yaw_gain = 2.8;                 ///< 1/s
  double yaw_lag = 0.3;                  ///< s
  double max_yaw_rate = 139.0 * kDegree;
};

/// Bounds on what the cascade asks for, below what the vehicle can do: parameters and flight phases set them. Less
/// than zero counts as zero.
struct SpeedBounds {
  double speed = planner::base::kInfinity;
  double climb = planner::base::kInfinity;
  double descent = planner::base::kInfinity;
};

/// The attitude (FLU body to ENU world) whose z axis points along `thrust` and whose x axis heads to `yaw`. `thrust` is
/// not zero and not level.
[[nodiscard]] Eigen::Quaterniond attitude_along(const Vec3& thrust, double yaw);

enum class Motors { kOff, kIdle, kFlying };

/// Integrates the vehicle at a fixed step. The true motion under power never exceeds the limits' max_speed,
/// max_acceleration and max_climb; only contact with the ground and a fall without motors do. Not thread-safe.
class VehicleModel {
 public:
  static constexpr double kStep = 0.004;  ///< s, PX4's control rate of 250 Hz

  /// At rest at `position`, motors off. Throws std::invalid_argument for limits or figures that are not positive and
  /// finite. `ground_height` is the z that the vehicle cannot sink below.
  VehicleModel(const planner::base::VehicleLimits& limits, const Vec3& position, double ground_height, double yaw = 0.0,
               const Cascade& cascade = {});

  /// Holds from now on, after the cascade's delay.
  void set_setpoint(const Setpoint& setpoint) { setpoint_ = setpoint; }
  void set_bounds(const SpeedBounds& bounds) { bounds_ = bounds; }
  void set_motors(Motors motors);
  /// The velocity of the air: drag is against it.
  void set_wind(const Vec3& velocity) { wind_ = velocity; }
  /// What the cascade flies on from now on instead of the true position, velocity and attitude; the last as the
  /// rotation vector (rad, ENU) from the true to the estimated one.
  void set_estimate(const Vec3& position, const Vec3& velocity, const Vec3& attitude_error) {
    estimated_position_ = position;
    estimated_velocity_ = velocity;
    attitude_error_ = attitude_error;
    flies_on_estimate_ = true;
  }
  /// Moves the positions that are asked for, those in the delay included: an estimate that jumps takes them along.
  void shift_setpoints(const Vec3& by);

  /// Advances by kStep.
  void step();

  [[nodiscard]] const Motion& motion() const { return motion_; }
  [[nodiscard]] Motors motors() const { return motors_; }
  [[nodiscard]] bool on_ground() const { return on_ground_; }
  [[nodiscard]] double ground_height() const { return ground_height_; }
  [[nodiscard]] const planner::base::VehicleLimits& limits() const { return limits_; }
  /// The last acceleration asked for (hover: zero) and the velocity setpoint behind it, for telemetry.
  [[nodiscard]] const Vec3& commanded_acceleration() const { return command_; }
  [[nodiscard]] const Vec3& commanded_velocity() const { return velocity_command_; }

 private:
  [[nodiscard]] const Vec3& known_position() const {
    return flies_on_estimate_ ? estimated_position_ : motion_.position;
  }
  [[nodiscard]] const Vec3& known_velocity() const {
    return flies_on_estimate_ ? estimated_velocity_ : motion_.velocity;
  }
  [[nodiscard]] Vec3 velocity_command(const Setpoint& setpoint) const;
  [[nodiscard]] Vec3 attainable(const Vec3& acceleration) const;
  [[nodiscard]] Vec3 control(const Setpoint& setpoint);
  void apply_lags(const Vec3& command);
  void integrate();
  void touch_ground();
  void turn(const Setpoint& setpoint);
  void update_attitude();

  planner::base::VehicleLimits limits_;
  Cascade cascade_;
  double ground_height_;
  Motion motion_;
  Motors motors_ = Motors::kOff;
  bool on_ground_ = false;
  SpeedBounds bounds_;
  Setpoint setpoint_;
  std::vector<Setpoint> delayed_;  ///< ring buffer, one setpoint per step of the delay
  std::size_t next_delayed_ = 0;
  Vec3 integral_ = Vec3::Zero();  ///< m/s^2, the integral part of the acceleration asked for
  Vec3 command_ = Vec3::Zero();
  Vec3 velocity_command_ = Vec3::Zero();
  Vec3 first_stage_ = Vec3::Zero();
  Vec3 thrust_ = Vec3::Zero();  ///< thrust per mass less the weight's, behind both lags
  double yaw_rate_ = 0.0;
  Vec3 wind_ = Vec3::Zero();
  Vec3 estimated_position_ = Vec3::Zero();
  Vec3 estimated_velocity_ = Vec3::Zero();
  Vec3 attitude_error_ = Vec3::Zero();
  bool flies_on_estimate_ = false;
};

}  // namespace jink::sim::vehicle
