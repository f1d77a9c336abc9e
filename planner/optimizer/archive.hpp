// SPDX-License-Identifier: BSD-3-Clause
// The bounded Pareto archive of MOMVO: non-dominated solutions, leader selection, removal where it is crowded.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/optimizer/pareto.hpp"

namespace jink::planner::optimizer {

/// Mutually non-dominated solutions with different objective vectors, in rising order of their first objective (then
/// second, then third). Solutions are added a batch at a time; settle() then brings the archive down to its capacity.
/// All memory is taken at construction. Not thread-safe: one archive, one slave.
///
/// N_i of [Paper] Eq. (21) is the number of members in a member's cell of a grid of ten cells per objective over the
/// members' extent, itself included. differs: alpha of Eq. (21) has no part in it, since a factor common to all weights
/// of a roulette cancels out; and members that are best in an objective never go, so that the front keeps its ends.
class Archive {
 public:
  /// `capacity` > objectives, so that the extremes fit.
  Archive(std::size_t capacity, int dimension, int objectives);

  /// Removes all members. O(capacity), allocates nothing.
  void clear();

  /// Adds a solution unless a member dominates or equals it; removes the members that it dominates. True when it was
  /// added. O(log n + n·moved) for two objectives, O(n) for three. Until settle() there may be more members than the
  /// capacity; where the room for them ends too, settle() happens here.
  bool add(std::span<const double> x, const Cost& cost, base::RandomStream& random);

  /// Ends a batch: where there are more members than the capacity, members go, one after the other, drawn by roulette
  /// with weight N_i (Eq. (21)), never one that is best in an objective. Prepares draw(). O(n).
  void settle(base::RandomStream& random);

  /// Index of a member, by roulette with weight 1/N_i: emptier regions are preferred. Precondition: settle() was called
  /// after the last add(), and the archive is not empty. O(1).
  std::size_t draw(base::RandomStream& random) const {
    // 1/N_i over the members of a cell sums to 1: every occupied cell is as likely, and every member of it.
    const double at = random.uniform() * static_cast<double>(occupied_.size());
    const auto k = static_cast<std::size_t>(at);
    const Cell& cell = cells_[occupied_[k]];
    const auto among = static_cast<std::size_t>((at - static_cast<double>(k)) * cell.count);
    return members_[cell.begin + among];
  }

  /// Number of members.
  [[nodiscard]] std::size_t size() const { return costs_.size(); }
  /// Decision variables of member i < size(), `dimension` values. Valid until the archive changes.
  [[nodiscard]] std::span<const double> x(std::size_t i) const {
    return {x_.data() + slots_[i] * static_cast<std::size_t>(dimension_), static_cast<std::size_t>(dimension_)};
  }
  /// Cost of member i < size().
  [[nodiscard]] const Cost& cost(std::size_t i) const { return costs_[i]; }
  /// Costs of all members, in their order. Valid until the archive changes.
  [[nodiscard]] std::span<const Cost> costs() const { return costs_; }

 private:
  struct Cell {
    std::size_t begin = 0;  // in members_
    int count = 0;
    int extremes = 0;
  };
  void find_cells();
  [[nodiscard]] bool extreme(std::size_t i) const;
  void thin_out(base::RandomStream& random);
  void erase(std::size_t begin, std::size_t end);

  int dimension_;
  int objectives_;
  std::size_t capacity_;
  std::vector<double> x_;           // by slot
  std::vector<Cost> costs_;         // sorted
  std::vector<std::size_t> slots_;  // parallel to costs_
  std::vector<std::size_t> free_;   // slots without a member
  std::array<std::size_t, kMaxObjectives> best_{};
  std::vector<Cell> cells_;
  std::vector<std::size_t> occupied_;  // cells with members
  std::vector<std::size_t> cell_of_;   // of each member
  std::vector<std::size_t> members_;   // cell by cell
};

}  // namespace jink::planner::optimizer
