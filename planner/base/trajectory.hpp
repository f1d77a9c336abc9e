// SPDX-License-Identifier: BSD-3-Clause
// A timed path: points in time order; between two points the vehicle flies at constant velocity.
#pragma once

#include <vector>

#include "planner/base/types.hpp"

namespace jink::planner::base {

/// One point of a timed path. Velocity and acceleration are those of the smooth motion the points were taken from; they
/// feed forward to the autopilot. The path itself is defined by times and positions alone.
struct TimedPoint {
  double t = 0.0;                    ///< time of the path, s
  Vec3 position = Vec3::Zero();      ///< ENU, m
  Vec3 velocity = Vec3::Zero();      ///< ENU, m/s
  Vec3 acceleration = Vec3::Zero();  ///< ENU, m/s²
};

/// Points with strictly increasing times; empty: no path.
using TimedPath = std::vector<TimedPoint>;

/// The path's state at time t, linear between points; before the first point the first, after the last the last with
/// zero velocity and acceleration (the vehicle waits there). Precondition: not empty. O(log n).
TimedPoint sample(const TimedPath& path, double t);

/// Sum of the lengths of the path's segments.
double path_length(const TimedPath& path);

/// The part of the path from time t on, with its first point at t exactly. Precondition: not empty.
TimedPath remainder(const TimedPath& path, double t);

/// The path as it is t seconds later: its remainder(), with times that count from then. Precondition: not empty.
TimedPath later(const TimedPath& path, double t);

}  // namespace jink::planner::base
