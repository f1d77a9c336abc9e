// SPDX-License-Identifier: BSD-3-Clause
// Which obstacles can be met during each step of a horizon, and how they move then.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

/// What an obstacle is worth keeping away from: its radius and `hard` more, and `soft` beyond that as its track's
/// uncertainty asks for.
struct Clearance {
  double hard = 0.0;                ///< the vehicle's radius and the margin
  double sigma_factor = 0.0;        ///< standard deviations of the position that are kept free
  double track_acceleration = 0.0;  ///< what a track's acceleration may be off by, m/s²
  double sudden_change = 0.0;       ///< by which a noisy track's velocity may be another at once, and an exact one's
                                    ///< at most, m/s: by as much as it has been seen to be
  double limit = 0.0;               ///< the most that uncertainty may ask for
  double acceleration_trust = base::kInfinity;  ///< as in predict_position
  double hard_beside_standing = 0.0;            ///< `hard` of what stands
  double reaction = 0.0;               ///< s, for which a vehicle goes on as it does where a track moves otherwise,
  double evading = base::kInfinity;    ///< m/s², with which it evades from then on,
  double most_gain = base::kInfinity;  ///< s, that the track gains on it at most

  /// How far a track, whose velocity is another at once by `change`, m/s, gains on the vehicle until that, evading, is
  /// as fast, m.
  [[nodiscard]] double evasion(double change) const {
    return change * std::min(most_gain, reaction + 0.5 * change / evading);  // most_gain too where that is 0 / 0
  }
};

/// One obstacle during one step of the horizon, in which it moves evenly. One that turns within the step is larger by
/// as much as it strays from even motion.
struct NearbyObstacle {
  Vec3 from,                  ///< its centre when the step begins, ENU, m
      to;                     ///< its centre when the step ends
  Vec3 middle;                ///< halfway
  double hard = 0.0,          ///< distance of the centres that is asked for, never less
      soft = 0.0;             ///< distance of the centres that is asked for, better not less
  double near = 0.0;          ///< from the middle: farther away, both are kept throughout the step
  double reaction = 0.0;      ///< steps for which the vehicle's own coming nearer counts in advance,
  double most_advance = 0.0;  ///< and by how much at most, m
  int solid = -1;             ///< which of NearbyObstacles::solid() it is, none: a sphere

  /// By how much nearer it counts for who comes nearer by `nearer` in the step by its own motion, m.
  [[gnu::always_inline]] [[nodiscard]] double advance(double nearer) const {
    const double ahead = reaction * (nearer > 0.0 ? nearer : 0.0);
    return ahead < most_advance ? ahead : most_advance;
  }
};

/// A solid during one step. Of its distances `radius` is taken off those of NearbyObstacle, which are from the centre.
struct NearbySolid {
  PlacedSolid from,     ///< when the step begins
      middle,           ///< halfway
      to;               ///< when the step ends
  double radius = 0.0;  ///< of the sphere that it is in, its margin not counted, m
  double near = 0.0;  ///< m; farther from it halfway by half of the vehicle's way, the soft distance is kept throughout
  base::Box keep_out;  ///< out of which the soft distance is kept throughout the step
};

/// Where the obstacles of one step are halfway, by coordinate, to be looked at several at once.
struct NearbyMiddles {
  const double* x;             ///< east, m; each to be read in whole groups of NearbyObstacles::kAtOnce
  const double* y;             ///< north, m
  const double* z;             ///< up, m
  const double* near_squared;  ///< (NearbyObstacle::near + most_advance)², m²
};

/// For each step the obstacles that come within their soft distance of the region in which the vehicle then is. Not
/// thread-safe while build() runs; keeps its memory from one build to the next.
class NearbyObstacles {
 public:
  /// `where[n]` holds the vehicle from time n·step to (n + 1)·step, in which it moves evenly, by no more than `fastest`
  /// m/s. Tracks are valid at time 0, and so are the offsets of the known paths. Within a step they keep their order,
  /// tracks first. O(tracks + near tracks · steps + points of the known paths + what stands), and for each near known
  /// path O(steps · log(points)).
  void build(std::span<const base::Track> tracks, std::span<const geometry::KnownPath> paths,
             std::span<const base::Track> standing, const Clearance& clearance, double step, double fastest,
             std::span<const base::Box> where);

  /// The obstacles of one step but for what stands, 0 <= step < where.size() of the last build(); valid until the next.
  [[nodiscard]] std::span<const NearbyObstacle> during(int step) const {
    const auto n = static_cast<std::size_t>(step);
    return {met_.data() + begin_[n], begin_[n + 1] - begin_[n]};
  }
  static constexpr std::size_t kAtOnce = 8;  ///< middles that are looked at together; so many may follow the last
  /// The middles of during(step), in its order; valid until the next build().
  [[nodiscard]] NearbyMiddles middles(int step) const {
    const std::size_t first = begin_[static_cast<std::size_t>(step)];
    return {x_.data() + first, y_.data() + first, z_.data() + first, near_squared_.data() + first};
  }
  /// Of each obstacle that stands, out of which its soft distance is kept; valid until the next build().
  [[nodiscard]] std::span<const base::Box> standing_boxes() const { return boxes_; }
  /// What stands, in the same order: during any step, the same.
  [[nodiscard]] const NearbyObstacle& standing(std::size_t i) const { return standing_[i]; }
  /// The solid of an obstacle that has one; valid until the next build().
  [[nodiscard]] const NearbySolid& solid(const NearbyObstacle& obstacle) const {
    return solids_[static_cast<std::size_t>(obstacle.solid)];
  }
  /// How many tracks and known paths are met in at least one step.
  [[nodiscard]] std::size_t obstacles() const { return obstacles_; }
  /// The steps in which each of them is met, summed up.
  [[nodiscard]] std::size_t meetings() const { return met_.size(); }

 private:
  /// A number of steps, and where the vehicle is during all of them.
  struct Group {
    std::size_t first = 0, last = 0;
    base::Box where;
  };
  template <typename Motion>
  void add(const Motion& motion, const Clearance& clearance, double step, double fastest,
           std::span<const base::Box> where, const base::Box& everywhere);
  void add_standing(const base::Track& track, const Clearance& clearance, std::span<const base::Box> where,
                    const base::Box& everywhere);

  std::vector<Group> groups_;
  std::vector<NearbyObstacle> found_, met_;       // by track, and by step
  std::vector<double> x_, y_, z_, near_squared_;  // of met_, as middles()
  std::vector<NearbyObstacle> standing_;
  std::vector<base::Box> boxes_;  // of what stands
  std::vector<NearbySolid> solids_;
  std::vector<std::size_t> step_;   // of each found
  std::vector<std::size_t> begin_;  // of each step in met_, and the end
  std::vector<std::size_t> next_;
  std::size_t obstacles_ = 0;
};

}  // namespace jink::planner::horizon
