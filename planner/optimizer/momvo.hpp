// SPDX-License-Identifier: BSD-3-Clause
// MOMVO, [Paper] Algorithm 1: one population of universes with its archive. A slave of PMOMVO is one of these.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/settings.hpp"
#include "planner/optimizer/archive.hpp"
#include "planner/optimizer/multiverse.hpp"
#include "planner/optimizer/pareto.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::planner::optimizer {

/// With Operators::kPrinted to the letter: Eq. (18) moves what a wormhole takes to the best universe, a leader that
/// roulette draws from the archive for each universe, and keeps the rest, so that the inflation rates of Algorithm 1,
/// steps 6 and 8, have no effect. differs, with the others: a component that no wormhole takes comes through a white
/// hole with a probability that is the universe's inflation rate, as in Mirjalili's MVO; and that rate is the
/// universe's place in the ranking, 0 for the best to 1 for the worst, not its normalised fitness, of which several
/// objectives do not have one.
///
/// A pure function of (problem, settings, seeds, random stream). All memory is taken at construction; reset() and
/// iterate() allocate nothing. Not thread-safe: one population, one thread at a time.
class alignas(64) Momvo {
 public:
  /// `universes` >= 1 of `dimension` variables.
  Momvo(std::size_t universes, int dimension, int objectives, const base::OptimizerSettings& settings);

  /// Starts over on `problem` (which must outlive the run) with a random population.
  void reset(const Problem& problem, base::RandomStream random);
  /// Places a solution, moved into the box, among the initial universes; `slot` is taken modulo their number.
  void place(std::size_t slot, std::span<const double> x);

  /// One iteration: evaluate, update the archive, rank, then move every universe through black and white holes and
  /// wormholes, back into the box where a move left it.
  void iterate(const Schedule& schedule);
  /// The same where `fraction` in (0, 1] of the budget is used when it ends.
  void iterate(double fraction) { iterate(schedule_at(fraction, settings_)); }

  /// Evaluates and ranks the universes, for what is exchanged before the first iteration.
  void rank();
  /// Draws the representative that this population sends to the master, by roulette from its own archive; before the
  /// first iteration one of the universes, each as likely. Precondition: rank() or an iteration.
  std::span<const double> representative();
  /// Cost of the representative drawn last.
  [[nodiscard]] const Cost& representative_cost() const { return representative_cost_; }
  /// Replaces the `rank`-th worst universe (0: the worst) of the last ranking. No kind of move is credited with it.
  void replace_worst(std::size_t rank, std::span<const double> x);

  /// The non-dominated solutions found since reset().
  [[nodiscard]] const Archive& archive() const { return archive_; }
  /// Probability that the next move is narrow, with Operators::kAdaptive.
  [[nodiscard]] double narrow_share() const { return moves_.narrow_share(); }
  /// How many universes this population has.
  [[nodiscard]] std::size_t universes() const { return universes_; }

 private:
  std::span<double> universe(std::size_t i) {
    return {x_.data() + i * static_cast<std::size_t>(dimension_), static_cast<std::size_t>(dimension_)};
  }
  void move(const Schedule& schedule);
  void move_widely(std::size_t i, double inflation, const Schedule& schedule, base::RandomStream& random);
  void move_narrowly(std::size_t i, double tdr, base::RandomStream& random);

  std::size_t universes_;
  int dimension_;
  int objectives_;
  base::OptimizerSettings settings_;
  const Problem* problem_ = nullptr;
  std::span<const double> lower_, upper_;  // the problem's box
  base::RandomStream random_{0};
  Archive archive_;
  Ranking ranking_;
  std::span<const int> order_;
  std::vector<double> x_;
  std::vector<double> previous_;
  std::vector<Cost> costs_;
  std::vector<Move> kinds_;  // how each universe has come to be where it is
  MoveChoice moves_;
  Cost representative_cost_;
};

}  // namespace jink::planner::optimizer
