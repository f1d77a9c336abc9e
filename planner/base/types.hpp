// SPDX-License-Identifier: BSD-3-Clause
// The value types that every module shares. Frame: local ENU, metres, seconds, radians, z up.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>

namespace jink {

/// A point or a vector in a frame that its name or its owner tells; local ENU unless said otherwise.
using Vec3 = Eigen::Vector3d;

}  // namespace jink

namespace jink::planner::base {

/// Positive infinity: no bound.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An axis-aligned volume, bounds included. The default is unbounded.
struct Box {
  Vec3 min = Vec3::Constant(-kInfinity);  ///< smallest coordinates, m
  Vec3 max = Vec3::Constant(kInfinity);   ///< largest coordinates, m

  /// Whether p is inside, or outside by no more than `tolerance` in each coordinate; false where a number is not one.
  [[nodiscard]] bool contains(const Vec3& p, double tolerance = 0.0) const {
    return ((p - min).array() >= -tolerance).all() && ((max - p).array() >= -tolerance).all();
  }
};

/// What a vehicle is and can do. The defaults are the Parrot AR.Drone 2.0's of config/vehicles/ardrone2.yaml.
struct VehicleLimits {
  double radius = 0.30;           ///< of the sphere that encloses the vehicle
  double length = 0.52;           ///< l_uav of [Paper] Eq. (15)
  double mass = 0.42;             ///< kg, [Paper] Eq. (1)
  double max_speed = 5.0;         ///< Euclidean norm of the velocity
  double cruise_speed = 3.0;      ///< flown where nothing asks for another speed
  double max_acceleration = 6.0;  ///< Euclidean norm
  double max_jerk = 30.0;         ///< Euclidean norm
  double max_climb = 2.0;         ///< |vertical speed|, up and down
  double drag = 0.0;              ///< 1/s, deceleration per speed; with which learning it in flight begins
  double damping = 0.0;           ///< of a commanded acceleration, that the autopilot takes off again; not learned
};

class Solid;

/// What an obstacle is within the sphere that encloses it, and how it is turned.
struct Body {
  std::shared_ptr<const Solid> solid;  ///< relative to the sphere's centre; none: all of the sphere
  double yaw = 0.0;                    ///< about the vertical, counter-clockwise from above, rad
  double yaw_rate = 0.0;               ///< rad/s, constant

  /// The same body t seconds later.
  [[nodiscard]] Body later(double t) const { return {solid, yaw + t * yaw_rate, yaw_rate}; }
};

/// One tracked obstacle, valid at the instant that its container states: a sphere in constant-acceleration motion, or a
/// body in it.
struct Track {
  std::uint64_t id = 0;              ///< as the writer of the track names it
  Vec3 position = Vec3::Zero();      ///< of the centre, ENU, m
  Vec3 velocity = Vec3::Zero();      ///< ENU, m/s
  Vec3 acceleration = Vec3::Zero();  ///< ENU, m/s²
  double radius = 0.0;               ///< m
  double position_sigma = 0.0;       ///< standard deviation of the position, per axis
  double velocity_sigma = 0.0;       ///< standard deviation of the velocity, per axis
  double age = 0.0;                  ///< time since the measurement that this is predicted from
  Body body{};                       ///< in the sphere
  double sudden_change = 0.0;        ///< by which its velocity has been seen to be another at once, at most, m/s

  /// Whether it is known without noise.
  [[nodiscard]] bool is_exact() const { return position_sigma <= 0.0 && velocity_sigma <= 0.0; }
};

}  // namespace jink::planner::base
