// SPDX-License-Identifier: BSD-3-Clause
// What the judge knows of all that stands: the map and the obstacles that never move.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"
#include "sim/world/world.hpp"
#include "tools/lab/oracle/cells.hpp"
#include "tools/lab/oracle/feasibility.hpp"

namespace jink::tools::lab::oracle {

/// The scenario with its map among its obstacles, behind them: the judge makes no difference.
[[nodiscard]] config::Scenario with_map_as_obstacles(const config::Scenario& scenario);
/// The scenario with all obstacles that never move among its map. With its other obstacles or without them.
[[nodiscard]] config::Scenario with_standing_as_map(const config::Scenario& scenario, bool with_movers);

/// true_clearance() of feasibility.hpp in a world without a map: of with_map_as_obstacles().
[[nodiscard]] double true_clearance(const sim::world::World& world, std::span<const TimedPoint> path);

/// How far what stands is, and how long it takes to the target round it, both looked up on a lattice through the start.
/// Distances are worked out where they are asked for first, so one serves one thread.
class Standing {
 public:
  /// In `box`, for a vehicle whose centre keeps off `keep_off`, m, from what stands. O(box) where something stands.
  Standing(const config::Scenario& scenario, const planner::base::Box& box, double keep_off);

  /// Nothing stands there.
  [[nodiscard]] bool empty() const { return world_.map()->tracks().empty(); }
  /// Not nearer than keep_off all the way from one place to the other.
  [[nodiscard]] bool clear(const Vec3& from, const Vec3& to);
  /// At least so far from what stands, m; at most 0.22 m less than the truth.
  [[nodiscard]] double least_distance(const Vec3& place);

  // Where something stands:

  /// How long a vehicle that neither speeds up nor brakes is under way from there to the target, s; infinite where the
  /// lattice has no way.
  [[nodiscard]] double time_to_go(const Vec3& place) const;
  /// Where that way leads, so far on, m.
  [[nodiscard]] Vec3 ahead(const Vec3& place, double far) const;

 private:
  [[nodiscard]] bool contains(const Index& node) const { return (node >= 0).all() && (node < count_).all(); }
  [[nodiscard]] std::size_t number(const Index& node) const {
    return static_cast<std::size_t>((node.z() * count_.y() + node.y()) * count_.x() + node.x());
  }
  [[nodiscard]] Index node_of(std::size_t number) const;
  [[nodiscard]] Vec3 place_of(const Index& node) const { return origin_ + spacing_ * node.cast<double>().matrix(); }
  [[nodiscard]] Index nearest(const Vec3& place) const {
    return ((place - origin_) / spacing_).array().round().cast<int>();
  }
  /// Of the nodes about the place the one from which the target is reached first, with the way there; -1: there is
  /// none.
  [[nodiscard]] std::int64_t best_node(const Vec3& place, double& time) const;
  [[nodiscard]] double duration(const Vec3& way) const;
  [[nodiscard]] double distance(const Index& node);
  void find_ways();

  sim::world::World world_;  ///< of what stands alone
  double keep_off_;
  double max_speed_, max_climb_;
  Vec3 start_, target_;
  double spacing_;
  Vec3 origin_;
  Index count_;
  std::vector<double> distances_;   ///< of the nodes; below 0 where not known yet
  std::vector<double> times_;       ///< from them to the target
  std::vector<std::int32_t> next_;  ///< on the way there; the node itself: straight to the target
};

}  // namespace jink::tools::lab::oracle
