// SPDX-License-Identifier: BSD-3-Clause
// A request's obstacles, one after the other, whatever tells how they move.
#pragma once

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// Calls visit(wanted, until, position, velocity) for each of the request's obstacles, tracks first: the distance of
/// the centres at which the surfaces are `clearance` apart, m; the time up to which it counts, s; where it is, and how
/// fast, at a time (functions of t >= 0, ENU).
template <typename Visit>
void for_each_obstacle(const PathRequest& request, double clearance, const Visit& visit) {
  constexpr double kDifference = 0.05;  // s, over which twice a known path's velocity is taken
  const double trust = request.acceleration_trust;
  const double wanted = request.vehicle.radius + clearance;
  for (const base::Track& track : request.tracks) {
    visit(
        track.radius + wanted, base::kInfinity, [&](double t) { return geometry::predict_position(track, t, trust); },
        [&](double t) { return geometry::predict_velocity(track, t, trust); });
  }
  for (const geometry::KnownPath& path : request.paths) {
    visit(
        path.radius + path.margin + wanted, path.until, [&](double t) { return path.position(t); },
        [&](double t) -> Vec3 {
          return (path.position(t + kDifference) - path.position(t - kDifference)) / (2.0 * kDifference);
        });
  }
}

}  // namespace jink::planner::horizon
