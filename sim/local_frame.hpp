// SPDX-License-Identifier: BSD-3-Clause
// The edge's conversions: ENU and FLU of the simulator to NED, FRD and geodetic coordinates of MAVLink.
#pragma once

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>

#include "planner/types.hpp"

namespace jink::sim {

struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;  ///< above the ellipsoid; the simulator's mean sea level is the ellipsoid
};

/// Where PX4's SITL starts.
inline constexpr Geodetic kSitlOrigin{47.397743, 8.545594, 489.4};

/// The tangent plane at an origin.
class LocalFrame {
 public:
  explicit LocalFrame(const Geodetic& origin);
  [[nodiscard]] const Geodetic& origin() const { return origin_; }
  [[nodiscard]] Geodetic to_geodetic(const planner::Vec3& position_enu) const;
  [[nodiscard]] planner::Vec3 to_enu(const Geodetic& position) const;

 private:
  Geodetic origin_;
  GeographicLib::LocalCartesian tangent_plane_;
};

/// ENU to NED and back: the same swap.
[[nodiscard]] planner::Vec3 swap_enu_ned(const planner::Vec3& v);
/// FLU to FRD and back.
[[nodiscard]] planner::Vec3 swap_flu_frd(const planner::Vec3& v);
/// Yaw counter-clockwise from east to yaw clockwise from north and back, in (-pi, pi].
[[nodiscard]] double swap_yaw(double yaw);
/// FLU body to ENU world, as FRD body to NED world, w >= 0.
[[nodiscard]] Eigen::Quaterniond attitude_ned(const Eigen::Quaterniond& attitude_enu);

struct RollPitchYaw {
  double roll = 0.0;
  double pitch = 0.0;
  double yaw = 0.0;
};
/// Angles of the z-y-x sequence.
[[nodiscard]] RollPitchYaw roll_pitch_yaw(const Eigen::Quaterniond& attitude);

}  // namespace jink::sim
