// SPDX-License-Identifier: BSD-3-Clause
// What the comparators have in common: settings, first solutions, and the set of non-dominated solutions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/settings.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/optimizer/pareto.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::tools::lab::algorithms {

/// Throws std::invalid_argument where population or iterations are less than 1 or the archive does not hold the
/// extremes of all objectives. Of no use for PMOMVO, which asks for more.
void check_settings(const planner::base::OptimizerSettings& settings, int objectives);
/// The same for the generations of a run.
void check_budget(const planner::base::Budget& budget);

/// Fills `x`, solutions one after the other: the initial ones first, moved into the box, as many as there is room for;
/// then random ones.
void first_solutions(const planner::optimizer::Problem& problem, std::span<const double> initial,
                     planner::base::RandomStream& random, std::span<double> x);

/// Mutually non-dominated solutions with different objective vectors under constrained domination, in the order in
/// which they came. It has no bound: whoever owns it takes members out by the rule of his algorithm.
class Repository {
 public:
  explicit Repository(int dimension, int objectives)
      : dimension_(static_cast<std::size_t>(dimension)), objectives_(objectives) {}

  void clear();
  /// Adds a solution unless a member dominates or equals it, and takes out the members that it dominates. O(members).
  void add(std::span<const double> x, const planner::optimizer::Cost& cost);
  void remove(std::size_t i);

  [[nodiscard]] std::size_t size() const { return costs_.size(); }
  [[nodiscard]] int objectives() const { return objectives_; }
  [[nodiscard]] std::span<const double> x(std::size_t i) const { return {x_.data() + i * dimension_, dimension_}; }
  [[nodiscard]] std::span<const planner::optimizer::Cost> costs() const { return costs_; }
  void copy_to(planner::optimizer::Front& front) const;

 private:
  std::size_t dimension_;
  int objectives_;
  std::vector<double> x_;
  std::vector<planner::optimizer::Cost> costs_;
};

/// An index drawn by roulette: i with probability weights[i] / their sum. Preconditions: no negative weight, a positive
/// sum.
std::size_t roulette(std::span<const double> weights, planner::base::RandomStream& random);

}  // namespace jink::tools::lab::algorithms
