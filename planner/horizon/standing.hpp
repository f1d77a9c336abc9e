// SPDX-License-Identifier: BSD-3-Clause
// What stands: how far places and lines are from it.
#pragma once

#include <span>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/geometry/static_map.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

/// A static map as a flight sees it.
struct MapPlace {
  const geometry::StaticMap* map = nullptr;  ///< borrowed; none: there is none
  double up = 0.0;                           ///< z of the local frame less the map's, m
  double floor = -base::kInfinity;  ///< z in the local frame, m: what reaches no higher is the ground, not an obstacle
  double sigma = 0.0;               ///< standard deviation of the vehicle's own place in it, m
};

/// Obstacles at rest. Distances are to their surfaces, and to all that is between its slabs for a hull.
class Standing {
 public:
  /// Forgets what stood before. Each of `tracks` stands, and all of the map, so many of its position's standard
  /// deviations larger than it is said to be. O(tracks); O(map) where the map is another.
  void set(std::span<const base::Track> tracks, const MapPlace& map, double sigmas);

  /// From a place to the nearest surface, m, `most` where that is farther; negative in a solid or a sphere. O(tracks).
  [[nodiscard]] double distance(const Vec3& place, double most) const;
  /// Whether all of a line is at least `kept`, > 0, away, but for less than 0.02 m. O(tracks · steps), a step as long
  /// as the place is clear.
  [[nodiscard]] bool is_clear(const Vec3& from, const Vec3& to, double kept) const;
  /// Nothing stands.
  [[nodiscard]] bool empty() const { return things_.empty() && mapped_.empty(); }

 private:
  struct Thing {
    Vec3 center;
    double radius;  // that encloses it
    double more;    // that it counts as larger than its solid
    PlacedSolid solid;
  };
  std::vector<base::Track> tracks_;  // own the solids
  std::vector<Thing> things_;
  MapPlace map_;
  double map_more_ = 0.0;            // as Thing::more
  std::vector<PlacedSolid> mapped_;  // in the map's order
};

}  // namespace jink::planner::horizon
