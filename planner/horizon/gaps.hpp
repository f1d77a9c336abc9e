// SPDX-License-Identifier: BSD-3-Clause
// Ways through what stands and swings together: places between the obstacles, across the path.
#pragma once

#include <vector>

#include "planner/geometry/geometry.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// A place across the path that is clear of the obstacles at some time.
struct Gap {
  Vec3 position = Vec3::Zero();  ///< ENU
  Vec3 velocity = Vec3::Zero();  ///< of the place that stays clear, m/s
  double lacking = 0.0;          ///< of the clearance wanted, m
};

/// The clearest places at time `t` in the plane through `centre` across the path's axis, in the volume and at least
/// kGapSpacing from each other, at most `most`; of those that keep `clearance` (from surface to surface) from
/// everything the nearest to `centre` first. O(obstacles).
std::vector<Gap> find_gaps(const PathRequest& request, const geometry::PathFrame& frame, const Vec3& centre, double t,
                           double clearance, std::size_t most);

inline constexpr double kGapSpacing = 1.0;  ///< m

}  // namespace jink::planner::horizon
