// SPDX-License-Identifier: BSD-3-Clause
// The bounded Pareto archive of MOMVO: non-dominated solutions, leader selection, removal where it is crowded.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner/pareto.hpp"
#include "planner/random.hpp"

namespace jink::planner {

/// At most `capacity` mutually non-dominated solutions with different objective vectors. All memory is taken at
/// construction. Not thread-safe: one archive, one slave.
class Archive {
 public:
  /// `crowding` is alpha of [Paper] Eq. (21).
  Archive(std::size_t capacity, int dimension, int objectives, double crowding);

  void clear() { size_ = 0; }

  /// Adds a solution unless a member dominates or equals it; removes the members that it dominates. Where the archive
  /// is full, first one member goes, drawn by roulette with weight N_i/alpha (Eq. (21)), N_i the members in its cell of
  /// objective space, itself included; never a member that is best in an objective. True when it was added.
  /// O(capacity · objectives).
  bool add(std::span<const double> x, const Cost& cost, RandomStream& random);

  /// Prepares draw(): counts neighbours. To be called after the last add() and before the first draw().
  void weigh();
  /// Index of a member, by roulette with weight alpha/N_i: emptier regions are preferred. Precondition: weigh() was
  /// called and the archive is not empty. O(log capacity).
  std::size_t draw(RandomStream& random) const;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<const double> x(std::size_t i) const {
    return {x_.data() + i * static_cast<std::size_t>(dimension_), static_cast<std::size_t>(dimension_)};
  }
  [[nodiscard]] const Cost& cost(std::size_t i) const { return cost_[i]; }
  [[nodiscard]] std::span<const Cost> costs() const { return {cost_.data(), size_}; }

 private:
  void count_neighbours();
  void remove(std::size_t i);
  void remove_crowded(RandomStream& random);

  int dimension_;
  int objectives_;
  double alpha_;
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<double> x_;
  std::vector<Cost> cost_;
  std::vector<int> cell_;
  std::vector<int> occupancy_;
  std::vector<double> cumulative_;
};

}  // namespace jink::planner
