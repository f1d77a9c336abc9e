// SPDX-License-Identifier: BSD-3-Clause
// The one place where the autopilot's north-east-down meets the project's east-north-up. Both frames have the same
// origin, the autopilot's local origin, so positions, velocities and accelerations convert alike. All are pure and safe
// from any thread; non-finite input gives non-finite output.
#pragma once

#include "planner/types.hpp"

namespace jink::bridge {

/// (north, east, down) to (east, north, up). Its own inverse as a map of numbers: both names exist to be read.
[[nodiscard]] planner::Vec3 enu_from_ned(const planner::Vec3& ned);
/// (east, north, up) to (north, east, down).
[[nodiscard]] planner::Vec3 ned_from_enu(const planner::Vec3& enu);

/// The same angle in (-pi, pi].
[[nodiscard]] double wrap_angle(double angle);

/// Heading (clockwise from north) to yaw (counter-clockwise from east), in (-pi, pi].
[[nodiscard]] double yaw_enu_from_heading(double heading_ned);
/// Yaw (counter-clockwise from east) to heading (clockwise from north), in (-pi, pi].
[[nodiscard]] double heading_from_yaw_enu(double yaw_enu);

}  // namespace jink::bridge
