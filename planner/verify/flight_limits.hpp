// SPDX-License-Identifier: BSD-3-Clause
// Whether a vehicle can fly a path: its speed, climb and acceleration against the limits.
#pragma once

#include <span>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

namespace jink::planner::verify {

/// What a path may ask of a vehicle. A limit that is not there is infinite.
struct FlightLimits {
  Vec3 velocity = Vec3::Zero();               ///< of the vehicle at the path's first point, ENU, m/s
  double max_speed = base::kInfinity;         ///< m/s
  double max_climb = base::kInfinity;         ///< m/s, up and down
  double max_acceleration = base::kInfinity;  ///< m/s²
  double step = 0.0;  ///< s, of a whole segment, where a path is one segment that may be cut off
  bool rests = true;  ///< the path ends at rest
};

/// The most that a path asks for, each relative to its limit; 0 where nothing was judged.
struct LimitsUse {
  double speed = 0.0;         ///< of max_speed
  double climb = 0.0;         ///< of max_climb
  double acceleration = 0.0;  ///< of max_acceleration

  /// Whether all limits, or so many times the limits, are kept, but for rounding: 1e-9 of each.
  [[nodiscard]] bool within(double times = 1.0) const {
    const double most = times * (1.0 + 1e-9);
    return speed <= most && climb <= most && acceleration <= most;
  }
};

/// Judges all of a path, whose points are taken from a motion with constant acceleration between them: the velocity of
/// a segment, its way over its duration, is that of the motion in the middle of it. Speed and climb are those of the
/// segments. Acceleration is the change from one segment to the next over the time between their middles, from
/// `limits.velocity` to the first segment over half of that one, and from the last segment to rest, where the path ends
/// at rest, over half of the last. So a motion that keeps its limits passes. A path may begin and end in the middle of
/// a step, whose rest is short and flown at the velocity of the whole: its first and its last segment count as no
/// shorter than the ones beside them, and `limits.step` where there is no other.
///
/// A vehicle that is faster at the start than its limits may come down from there: not above the limit, or what
/// `limits.velocity` has, where that is more. What rounding of coordinates and times can amount to is taken off.
/// Precondition: the path's numbers are finite, its times increase. O(points), no allocation, thread-safe.
[[nodiscard]] LimitsUse use_of_limits(std::span<const base::TimedPoint> path, const FlightLimits& limits);

}  // namespace jink::planner::verify
