// SPDX-License-Identifier: BSD-3-Clause
// What stands still and is known beforehand, by where it is: thousands of obstacles, of which a plan sees a few.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::planner::geometry {

/// Where two boxes are nearest, m; 0 where they meet.
[[nodiscard]] inline double distance(const base::Box& a, const base::Box& b) {
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0.0).norm();
}
/// A box and all that is within `reach` of its faces.
[[nodiscard]] inline base::Box grown(const base::Box& box, double reach) {
  return {box.min.array() - reach, box.max.array() + reach};
}
/// The smallest box around an obstacle as it is now, ENU, m.
[[nodiscard]] base::Box box_around(const base::Track& track);

/// Obstacles at rest in a hierarchy of their boxes. Immutable, so that all members are thread safe; world, planner and
/// log share one.
class StaticMap {
 public:
  /// The identity of the first: what is tracked has smaller ones, or a writer's hash.
  static constexpr std::uint64_t kFirstId = 1'000'000'000'000;

  StaticMap() = default;
  /// Takes tracks that do not move, whose ids become kFirstId, kFirstId + 1, ... in their order. Throws
  /// std::invalid_argument for one that is_valid() in validity.hpp refuses or that moves or turns. O(n log² n).
  explicit StaticMap(std::vector<base::Track> tracks);

  /// All, in the order given; the index is that of visit().
  [[nodiscard]] std::span<const base::Track> tracks() const { return tracks_; }
  /// The box around one of them.
  [[nodiscard]] const base::Box& box(std::size_t index) const { return boxes_[index]; }

  /// Calls visit(index) for those whose boxes are within `bound`, m, of `where`; it returns the bound from then on, so
  /// that the nearest is found by telling how near it is. A bound below 0 counts as 0. Nearer ones come first, more or
  /// less; the order depends on the map and the calls' results alone. O(log n) for each that is visited.
  template <typename Visit>
  void visit(const base::Box& where, double bound, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::array<std::size_t, 2 * kDeepest> open{};  // nodes to look at
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[open[--count]];
      if (distance(node.box, where) > std::max(bound, 0.0)) continue;
      if (node.right == 0) {
        for (std::size_t i = node.first; i < node.last; ++i) {
          if (distance(boxes_[order_[i]], where) <= std::max(bound, 0.0)) bound = visit(order_[i]);
        }
        continue;
      }
      const std::size_t left = open[count] = static_cast<std::size_t>(&node - nodes_.data()) + 1;
      open[count + 1] = node.right;
      if (distance(nodes_[left].box, where) < distance(nodes_[node.right].box, where))
        std::swap(open[count], open[count + 1]);
      count += 2;
    }
  }

  /// Appends all whose boxes meet `where`, in the order given, each `up` m above where the map has it; `where` is where
  /// they are then.
  void near(base::Box where, double up, std::vector<base::Track>& found) const;

 private:
  static constexpr std::size_t kDeepest = 64;  // levels: halves of any size_t
  static constexpr std::size_t kLeaf = 4;      // obstacles

  struct Node {
    base::Box box;
    std::size_t first = 0, last = 0;  // of order_
    std::size_t right = 0;            // the second half's node, the first half's is the next; 0: a leaf
  };
  std::size_t build(std::size_t first, std::size_t last);

  std::vector<base::Track> tracks_;
  std::vector<base::Box> boxes_;    // of each track
  std::vector<std::size_t> order_;  // of tracks, by node
  std::vector<Node> nodes_;
};

}  // namespace jink::planner::geometry
