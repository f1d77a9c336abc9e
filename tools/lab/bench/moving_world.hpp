// SPDX-License-Identifier: BSD-3-Clause
// A volume full of bouncing spheres or boxes, for replanning.
#pragma once

#include <cstdint>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/static_map.hpp"
#include "planner/horizon/path_problem.hpp"
#include "sim/world/world.hpp"

namespace jink::tools::lab::bench {

struct MovingWorldShape {
  int obstacles = 20;
  Vec3 size{40.0, 20.0, 8.0};  ///< of the volume, m
  double mission = 36.0;       ///< between the targets, along x through the middle, m
  bool boxes = false;          ///< of 0.5 to 4 m, which turn, in place of the spheres
  int standing = 0;            ///< boxes of 0.4 to 1.2 m at rest, which a map knows, none within 3 m of the targets
};

/// The worlds of the benchmarks. The mission is the same in all, so that the obstacles are what differs.
inline MovingWorldShape world_of(int obstacles) {
  if (obstacles <= 20) return {obstacles, {40.0, 20.0, 8.0}, 36.0};
  if (obstacles <= 200) return {obstacles, {80.0, 40.0, 12.0}, 36.0};
  return {obstacles, {800.0, 400.0, 12.0}, 36.0};
}

/// Spheres of 0.3 to 0.6 m and up to 3 m/s, spread evenly, reflected at the faces of the volume; none within 3 m of
/// targets[0] at time 0. A function of shape and seed.
class MovingWorld {
 public:
  MovingWorld(const MovingWorldShape& shape, std::uint64_t seed);

  /// Exact positions and velocities at a time. What comes of them is constant velocity: bounces are not foreseen.
  [[nodiscard]] std::vector<planner::base::Track> tracks(double t) const;
  /// What stands.
  [[nodiscard]] const planner::geometry::StaticMap& map() const { return *world_.map(); }
  /// A request from rest at the first target to the second, at time 0, filled as the companion does; without tracks.
  [[nodiscard]] planner::horizon::PathRequest request(const planner::base::HorizonSettings& settings) const;
  /// Whether the vehicle at `position` overlaps an obstacle.
  [[nodiscard]] bool contact(const Vec3& position, double t) const { return world_.clearance(position, t) < 0.0; }

 private:
  sim::world::World world_;
};

}  // namespace jink::tools::lab::bench
