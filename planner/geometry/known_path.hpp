// SPDX-License-Identifier: BSD-3-Clause
// An obstacle that has said where it is going to be: another vehicle of the team and its committed path.
#pragma once

#include <cstdint>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

namespace jink::planner::geometry {

/// A sphere, or a body in it, on a timed path: it stands at the first point before that point's time, moves at constant
/// velocity between points (velocity and acceleration of the points are not read), and stays at the last point after
/// that. What it does after the last point is not known, so from there on its uncertainty grows as that of a track
/// whose acceleration is not known. That it keeps to the path at all is what `velocity_sigma` doubts, as it doubts a
/// track's velocity.
struct KnownPath {
  std::uint64_t id = 0;            ///< whose path it is; named in Verification::nearest_id
  base::TimedPath points;          ///< never empty; times in a clock of their own
  double offset = 0.0;             ///< the time of the points that is time 0 of what the path is held against
  double radius = 0.0;             ///< of the sphere that moves on the path, m
  double margin = 0.0;             ///< how far it may be off the path: part of the distance never to be gone below
  double position_sigma = 0.0;     ///< standard deviation of the position, per axis
  double velocity_sigma = 0.0;     ///< growth of it with the time since the path was told and the time looked ahead
  double age = 0.0;                ///< time since the path was told
  double until = base::kInfinity;  ///< regarded up to then: later the other one gives way
  base::Body body{};               ///< in the sphere, as it is at time 0

  /// Where its centre is at time t, ENU, m; t counts from `offset` on the points' clock. Precondition: a point.
  [[nodiscard]] Vec3 position(double t) const { return base::sample(points, t + offset).position; }
  /// The largest speed between any two points.
  [[nodiscard]] double fastest() const;
};

}  // namespace jink::planner::geometry
