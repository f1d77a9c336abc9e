// SPDX-License-Identifier: BSD-3-Clause
// What stands: how far places and lines are from it.
#pragma once

#include <span>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

/// Obstacles at rest. Distances are to their surfaces, and to all that is between its slabs for a hull.
class Standing {
 public:
  /// Forgets what stood before. Each of `tracks` stands, so many of its position's standard deviations larger than it
  /// is said to be. O(tracks).
  void set(std::span<const base::Track> tracks, double sigmas);

  /// From a place to the nearest surface, m, `most` where that is farther; negative in a solid or a sphere. O(tracks).
  [[nodiscard]] double distance(const Vec3& place, double most) const;
  /// Whether all of a line is at least `kept`, > 0, away, but for less than 0.02 m. O(tracks · steps), a step as long as
  /// the place is clear.
  [[nodiscard]] bool is_clear(const Vec3& from, const Vec3& to, double kept) const;
  /// Nothing stands.
  [[nodiscard]] bool empty() const { return things_.empty(); }

 private:
  struct Thing {
    Vec3 center;
    double radius;  // that encloses it
    double more;    // that it counts as larger than its solid
    PlacedSolid solid;
  };
  std::vector<base::Track> tracks_;  // own the solids
  std::vector<Thing> things_;
};

}  // namespace jink::planner::horizon
