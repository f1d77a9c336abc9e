// SPDX-License-Identifier: BSD-3-Clause
// What searches on a grid share: a name for each place, and the list of what is to be looked at.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

namespace jink::planner::horizon {

/// Cells from the first one, either way, that have a grid_key().
inline constexpr int kFarthestCell = 1 << 19;

/// Another number for each cell.
[[nodiscard]] inline std::uint64_t grid_key(const Eigen::Vector3i& cell) {
  const auto part = [](int x) { return static_cast<std::uint64_t>(std::int64_t{x} + kFarthestCell); };
  return (part(cell.x()) << 42U) | (part(cell.y()) << 21U) | part(cell.z());
}

/// How many cells a cell and its neighbours are.
inline constexpr int kGridSteps = 27;
/// From a cell to one of them, 0 <= n < kGridSteps.
[[nodiscard]] inline Eigen::Vector3i grid_step(int n) {
  return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
}

/// Nodes by the estimate of the whole way over them, the least first; of equal ones the first in number.
class OpenList {
 public:
  [[nodiscard]] bool empty() const { return heap_.empty(); }  ///< nothing is left
  void clear() { heap_.clear(); }                             ///< for another search
  /// Adds a node, which may be in it already.
  void push(double estimate, int node) {
    heap_.push_back({estimate, node});
    std::push_heap(heap_.begin(), heap_.end());
  }
  /// Takes out the next. Precondition: not empty.
  int pop() {
    std::pop_heap(heap_.begin(), heap_.end());
    const int node = heap_.back().node;
    heap_.pop_back();
    return node;
  }

 private:
  struct Entry {
    double estimate;
    int node;
    bool operator<(const Entry& other) const {  // the best is the largest
      return estimate != other.estimate ? estimate > other.estimate : node > other.node;
    }
  };
  std::vector<Entry> heap_;
};

}  // namespace jink::planner::horizon
