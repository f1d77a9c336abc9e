// SPDX-License-Identifier: BSD-3-Clause
// A request's obstacles, one after the other, whatever tells how they move.
#pragma once

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

/// One of a request's obstacles: where it is, and how fast, at a time t >= 0 (functions, ENU).
template <typename Position, typename Velocity>
struct EachObstacle {
  double wanted;           ///< distance of the centres at which its sphere is as far as is wanted, m
  double kept;             ///< distance of its surface that is wanted, from the vehicle's centre, m
  double until;            ///< the time up to which it counts, s
  const base::Body& body;  ///< in its sphere, at time 0
  Position position;       ///< of its centre
  Velocity velocity;       ///< of its centre

  /// Its solid at time t; none where it is a sphere.
  [[nodiscard]] PlacedSolid solid(double t) const { return {body, position(t), t}; }
};

/// Calls visit(const EachObstacle&) for each of the request's obstacles, tracks first, what stands last. Wanted is that
/// the surfaces are `clearance` apart; from what stands less, by as much as the request's margins differ.
template <typename Visit>
void for_each_obstacle(const PathRequest& request, double clearance, const Visit& visit) {
  constexpr double kDifference = 0.05;  // s, over which twice a known path's velocity is taken
  const double trust = request.acceleration_trust;
  const double wanted = request.vehicle.radius + clearance;
  for (const base::Track& track : request.tracks) {
    const auto position = [&](double t) { return geometry::predict_position(track, t, trust); };
    const auto velocity = [&](double t) { return geometry::predict_velocity(track, t, trust); };
    visit(EachObstacle<decltype(position), decltype(velocity)>{track.radius + wanted, wanted, base::kInfinity,
                                                               track.body, position, velocity});
  }
  for (const geometry::KnownPath& path : request.paths) {
    const auto position = [&](double t) { return path.position(t); };
    const auto velocity = [&](double t) -> Vec3 {
      return (path.position(t + kDifference) - path.position(t - kDifference)) / (2.0 * kDifference);
    };
    visit(EachObstacle<decltype(position), decltype(velocity)>{path.radius + path.margin + wanted, path.margin + wanted,
                                                               path.until, path.body, position, velocity});
  }
  const double beside = wanted - request.margin + request.margin_beside_standing();
  for (const base::Track& track : request.standing) {
    const auto position = [&](double /*t*/) { return track.position; };
    const auto velocity = [](double /*t*/) { return Vec3::Zero().eval(); };
    visit(EachObstacle<decltype(position), decltype(velocity)>{track.radius + beside, beside, base::kInfinity,
                                                               track.body, position, velocity});
  }
}

}  // namespace jink::planner::horizon
