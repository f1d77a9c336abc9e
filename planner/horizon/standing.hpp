// SPDX-License-Identifier: BSD-3-Clause
// What stands: how far places and lines are from it.
#pragma once

#include <cstdint>
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

/// Moves the tracks of these ids to what stands, and takes their motion for none. O(tracks + ids).
void set_apart(std::span<const std::uint64_t> ids, std::vector<base::Track>& tracks,
               std::vector<base::Track>& standing);

/// Obstacles at rest. Distances are to their surfaces, and to all that is between its slabs for a hull.
class Standing {
 public:
  /// Forgets what stood before. Each of `tracks` stands where it is, and all of the map, so many standard deviations
  /// of a place larger than it is said to be; of the tracks' the largest counts for all. O(tracks), and O(n log² n)
  /// where tracks or map are others than before.
  void set(std::span<const base::Track> tracks, const MapPlace& map, double sigmas);

  /// From a place to the nearest surface, m, `most` where that is farther; negative in a solid or a sphere. O(log n)
  /// for each of the few that are near.
  [[nodiscard]] double distance(const Vec3& place, double most) const;
  /// Whether all of a line is at least `kept` away, but for less than 0.02 m. As distance() for each step, which is as
  /// long as the place is clear.
  [[nodiscard]] bool is_clear(const Vec3& from, const Vec3& to, double kept) const;
  /// Nothing stands.
  [[nodiscard]] bool empty() const { return tracks_.solids.empty() && map_.solids.empty(); }

 private:
  /// What goes with a map.
  struct Known {
    std::vector<PlacedSolid> solids;  // in the map's order
    double more = 0.0;                // m, that all of it counts as larger
    double up = 0.0;
    double floor = -base::kInfinity;
  };
  static std::vector<PlacedSolid> placed(const geometry::StaticMap& map);
  static double distance(const geometry::StaticMap& map, const Known& known, const Vec3& place, double most);

  geometry::StaticMap tracked_;
  const geometry::StaticMap* given_ = nullptr;
  Known tracks_, map_;
};

}  // namespace jink::planner::horizon
