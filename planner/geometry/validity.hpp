// SPDX-License-Identifier: BSD-3-Clause
// What a number of a request may be: the one check of all that is planned for or judged. What is larger than this could
// not be judged to the accuracy that the verifier states.
#pragma once

#include <span>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"

namespace jink::planner::geometry {

inline constexpr double kFarthest = 1e8;  ///< m, from the origin; of a length too
inline constexpr double kFastest = 1e5;   ///< m/s
inline constexpr double kHardest = 1e5;   ///< m/s²
inline constexpr double kLongest = 1e10;  ///< s, from a clock's 0, which may be 1970
inline constexpr double kTurned = 1e5;    ///< rad
inline constexpr double kTurning = 1e3;   ///< rad/s

/// A length, a time, or a standard deviation: not below 0, at most `most`. False for NaN, as all below.
[[nodiscard]] constexpr bool is_amount(double value, double most = kFarthest) {
  return value >= 0.0 && value <= most;
}
/// At most `most` long.
[[nodiscard]] inline bool is_within(const Vec3& vector, double most) {
  return vector.squaredNorm() <= most * most;
}

/// Whether min is nowhere above max; a side without a bound is infinite.
[[nodiscard]] bool is_valid(const base::Box& volume);
/// Whether radius, drag and damping are not below 0, and all else above it.
[[nodiscard]] bool is_valid(const base::VehicleLimits& vehicle);
/// Whether it lies in its sphere of that radius, and turns about its centre at less than kFastest.
[[nodiscard]] bool is_valid(const base::Body& body, double radius);
/// Whether it is a body that moves: radius, standard deviations, age and change not below 0.
[[nodiscard]] inline bool is_valid(const base::Track& track) {
  return is_within(track.position, kFarthest) && is_within(track.velocity, kFastest) &&
         is_within(track.acceleration, kHardest) && is_amount(track.radius) && is_amount(track.position_sigma) &&
         is_amount(track.velocity_sigma) && is_amount(track.age, kLongest) && is_amount(track.sudden_change) &&
         is_valid(track.body, track.radius);
}
/// Whether it neither moves nor turns.
[[nodiscard]] inline bool is_at_rest(const base::Track& track) {
  return track.velocity.isZero(0.0) && track.acceleration.isZero(0.0) && track.body.yaw_rate == 0.0;
}
/// Whether it is a path, and its radius, margin, standard deviations and age are not below 0. O(points).
[[nodiscard]] bool is_valid(const KnownPath& path);
/// Whether it holds a point and its times increase, with no speed between points above kFastest. Of the points times
/// and positions count: these are the path. O(points).
[[nodiscard]] bool is_valid_path(std::span<const base::TimedPoint> path);

/// What a path is planned in and judged among. `acceleration_trust` may be infinite. O(tracks + points of the paths).
[[nodiscard]] bool is_valid_world(const base::Box& volume, std::span<const base::Track> tracks,
                                  std::span<const KnownPath> paths, double acceleration_trust);

}  // namespace jink::planner::geometry
