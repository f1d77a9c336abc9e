// SPDX-License-Identifier: BSD-3-Clause
// Ways through what stands and swings together: places between the obstacles, across the path.
#pragma once

#include <cstddef>
#include <vector>

#include "planner/geometry/geometry.hpp"
#include "planner/horizon/encounters.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// A place across the path that is clear of the obstacles at some time.
struct Gap {
  Vec3 position = Vec3::Zero();  ///< ENU
  Vec3 velocity = Vec3::Zero();  ///< of the place that stays clear, m/s
  double lacking = 0.0;          ///< of the clearance wanted, m
};

/// The clearest places at time `t` in the plane through `centre` across the path's axis, within settings.lateral_range
/// of it either way, in the volume, and at least two spacings (settings.gap_spacing) from each other, at most `most`;
/// of those that keep first_clearance() (from surface to surface) from everything the nearest to `centre` first.
/// O(obstacles · places).
std::vector<Gap> find_gaps(const PathRequest& request, const geometry::PathFrame& frame, const Vec3& centre, double t,
                           const base::HorizonSettings& settings, std::size_t most);

/// When a place is nearer to something than is asked for, within a horizon.
enum class Taken { kNever, kAtTimes, kThroughout };
/// Looks at a vehicle at that place, `clearance` from surface to surface, m, now, at each waypoint's time and halfway
/// between. O(obstacles · waypoints).
Taken taken(const PathRequest& request, const Vec3& place, double clearance, const base::HorizonSettings& settings);

/// The point of unobstructed flight's line beside an obstacle that is met.
Vec3 beside(const base::TimedPath& unobstructed, const geometry::PathFrame& frame, const Encounter& e);

/// When a gap may be passed in what is met at time `t`: at the next waypoints, half of them at most.
std::vector<double> passages(const base::HorizonSettings& settings, double t);

}  // namespace jink::planner::horizon
