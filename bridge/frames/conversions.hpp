// SPDX-License-Identifier: BSD-3-Clause
// The one place where the autopilot's north-east-down and global coordinates meet the project's east-north-up. The
// local frames have the same origin, the autopilot's local origin, so positions, velocities and accelerations convert
// alike. All are pure and safe from any thread; non-finite input gives non-finite output.
#pragma once

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>

#include "bridge/frames/geodetic.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::frames {

/// (north, east, down) to (east, north, up). Its own inverse as a map of numbers: both names exist to be read.
[[nodiscard]] Vec3 enu_from_ned(const Vec3& ned);
/// The same as a rotation.
[[nodiscard]] Eigen::Matrix3d enu_from_ned_axes();
/// (east, north, up) to (north, east, down).
[[nodiscard]] Vec3 ned_from_enu(const Vec3& enu);

/// The same angle in (-pi, pi].
[[nodiscard]] double wrap_angle(double angle);

/// Heading (clockwise from north) to yaw (counter-clockwise from east), in (-pi, pi].
[[nodiscard]] double yaw_enu_from_heading(double heading_ned);
/// Yaw (counter-clockwise from east) to heading (clockwise from north), in (-pi, pi].
[[nodiscard]] double heading_from_yaw_enu(double yaw_enu);

/// Body (x ahead, y left, z up) to ENU, from a yaw as above and the pitch (nose up) and roll (right side down) that
/// autopilots tell.
[[nodiscard]] Eigen::Quaterniond attitude_enu(double yaw_enu, double pitch, double roll);

/// The tangent plane at an origin on the WGS 84 ellipsoid: local ENU to geodetic coordinates and back.
class LocalFrame {
 public:
  explicit LocalFrame(const Geodetic& origin);
  [[nodiscard]] const Geodetic& origin() const { return origin_; }
  [[nodiscard]] Geodetic to_geodetic(const Vec3& position_enu) const;
  [[nodiscard]] Vec3 to_enu(const Geodetic& position) const;

 private:
  Geodetic origin_;
  GeographicLib::LocalCartesian tangent_plane_;
};

/// Positions in the tangent plane at `from` as those in the tangent plane at `to`; its rotation converts velocities and
/// accelerations. Exact, as both are Cartesian.
[[nodiscard]] Eigen::Isometry3d between(const Geodetic& from, const Geodetic& to);

}  // namespace jink::bridge::frames
