// SPDX-License-Identifier: BSD-3-Clause
// The external repository of MOPSO and MOGWO: an adaptive grid over the objectives says where it is crowded.
#pragma once

#include <span>
#include <vector>

#include "tools/lab/algorithms/common.hpp"

namespace jink::tools::lab::algorithms {

/// How a cell's number of members n counts in a roulette among cells.
enum class Pressure {
  kPower,       ///< n^-leader, n^deletion: MOGWO (leader 1 is the c/n of its paper and of MOPSO's)
  kExponential  ///< e^(-leader n), e^(deletion n): the MOPSO code that circulates (Yarpiz 2015)
};

struct GridSettings {
  double inflation = 0.1;  ///< of the members' extent, added on either side
  int cells = 10;          ///< per objective
  int leader = 4;          ///< pressure towards empty cells when a leader is drawn
  int deletion = 2;        ///< pressure towards crowded cells when a member has to go
  Pressure pressure = Pressure::kPower;
};

/// A Repository of bounded size. Coello Coello, Pulido and Lechuga (2004), Mirjalili et al. (2016): the grid spans the
/// members' extent; leaders come from cells with few members, and members go from cells with many, extremes too.
class GridRepository {
 public:
  GridRepository(const GridSettings& settings, std::size_t capacity, int dimension, int objectives);

  void clear();
  void add(std::span<const double> x, const planner::optimizer::Cost& cost) { members_.add(x, cost); }

  /// Ends a batch: lays the grid over the members, takes members out down to the capacity, and prepares draw().
  void settle(planner::base::RandomStream& random);

  /// Index of a leader: a cell by roulette, then any of its members; never one of `excluded`. Preconditions: settle()
  /// was called after the last add(); more members than are excluded.
  std::size_t draw(planner::base::RandomStream& random, std::span<const std::size_t> excluded = {}) const;

  [[nodiscard]] const Repository& members() const { return members_; }

 private:
  void lay_grid();
  void take_one_out(planner::base::RandomStream& random);
  [[nodiscard]] std::size_t nth_of_cell(std::size_t cell, std::uint64_t nth,
                                        std::span<const std::size_t> excluded) const;
  [[nodiscard]] double leader_weight(int count) const;
  [[nodiscard]] double deletion_weight(int count, int most) const;

  GridSettings settings_;
  std::size_t capacity_;
  Repository members_;
  std::vector<std::size_t> cell_of_;  // of each member, an index into counts_
  std::vector<int> counts_;           // members of each occupied cell
  mutable std::vector<double> weights_;
};

}  // namespace jink::tools::lab::algorithms
