// SPDX-License-Identifier: BSD-3-Clause
// The loop that MSSA, MOGWO and MOPSO share: evaluate everybody, learn from it, move everybody.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/lab/algorithms/common.hpp"

namespace jink::tools::lab::algorithms {

/// A population that moves as a whole, with a repository that its front is. Each generation evaluates the population
/// once, in one call and on the calling thread, the first one included. Budgets as for Pmomvo: the clock is looked at
/// after each generation. Allocates.
class Swarm : public planner::optimizer::Optimizer {
 public:
  /// Throws std::invalid_argument, see check_settings().
  Swarm(const planner::base::OptimizerSettings& settings, int dimension, int objectives);

  const planner::optimizer::Front& run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                       std::uint64_t seed, std::uint64_t stream, const planner::base::Budget& budget,
                                       planner::base::WorkerPool& pool) final;

  [[nodiscard]] const planner::optimizer::RunReport& report() const final { return report_; }

 protected:
  /// Forgets the run before. The first solutions are in place, not evaluated.
  virtual void begin() = 0;
  /// Takes in what was evaluated and leaves the repository within its capacity.
  virtual void learn() = 0;
  /// Moves the population, within the box or not; it is moved into it afterwards. `fraction` of the generations are
  /// done, in (0, 1).
  virtual void move(double fraction) = 0;
  [[nodiscard]] virtual const Repository& repository() const = 0;

  [[nodiscard]] std::size_t individuals() const { return costs_.size(); }
  [[nodiscard]] std::span<double> individual(std::size_t i) { return {x_.data() + i * lower_.size(), lower_.size()}; }
  [[nodiscard]] const planner::optimizer::Cost& cost(std::size_t i) const { return costs_[i]; }
  [[nodiscard]] std::span<const double> lower() const { return lower_; }
  [[nodiscard]] std::span<const double> upper() const { return upper_; }
  [[nodiscard]] planner::base::RandomStream& random() { return random_; }

 private:
  std::span<const double> lower_, upper_;  // the problem's box
  std::vector<double> x_;
  std::vector<planner::optimizer::Cost> costs_;
  planner::base::RandomStream random_{0};
  planner::optimizer::Front front_;
  planner::optimizer::RunReport report_;
};

}  // namespace jink::tools::lab::algorithms
