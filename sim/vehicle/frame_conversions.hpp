// SPDX-License-Identifier: BSD-3-Clause
// The edge's conversions: ENU and FLU of the simulator to NED and FRD of MAVLink; geodetic ones are bridge/frames'.
#pragma once

#include <Eigen/Geometry>

#include "bridge/frames/conversions.hpp"
#include "planner/base/types.hpp"

namespace jink::sim::vehicle {

using bridge::frames::Geodetic;
using bridge::frames::LocalFrame;

/// Where PX4's SITL starts.
inline constexpr Geodetic kSitlOrigin{47.397743, 8.545594, 489.4};

/// ENU to NED and back: the same swap.
[[nodiscard]] Vec3 swap_enu_ned(const Vec3& v);
/// FLU to FRD and back.
[[nodiscard]] Vec3 swap_flu_frd(const Vec3& v);
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

}  // namespace jink::sim::vehicle
