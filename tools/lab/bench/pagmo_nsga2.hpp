// SPDX-License-Identifier: BSD-3-Clause
// pagmo2's NSGA-II behind the project's optimizer interface: the yardstick of the benchmarks.
#pragma once

#include <cstdint>

#include "planner/optimizer/optimizer.hpp"

namespace jink::tools::lab::bench {

/// NSGA-II with pagmo2's default operators and a population of 52 (it takes multiples of four). One thread: pagmo2 has
/// no other way to run it but to evaluate each generation's children at once. Constraint violations are not passed on,
/// so it is for problems that penalise.
class PagmoNsga2 final : public planner::optimizer::Optimizer {
 public:
  enum class Evaluation {
    kOneByOne,  ///< pagmo2's default: fitness() of each child
    kBatch      ///< all children of a generation in one call, through pagmo2's batch evaluator
  };

  /// Each run makes as many generations as bring it nearest to `evaluations`, whatever its budget says.
  explicit PagmoNsga2(int evaluations, Evaluation evaluation = Evaluation::kOneByOne)
      : evaluations_(evaluations), evaluation_(evaluation) {}

  /// Takes no initial solutions and no deadline. The front is the non-dominated set of the last population.
  const planner::optimizer::Front& run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                       std::uint64_t seed, std::uint64_t stream, const planner::base::Budget& budget,
                                       planner::base::WorkerPool& pool) override;

  [[nodiscard]] const planner::optimizer::RunReport& report() const override { return report_; }

 private:
  int evaluations_;
  Evaluation evaluation_;
  planner::optimizer::Front front_;
  planner::optimizer::RunReport report_;
};

/// The version of pagmo2 that this was built with.
const char* pagmo_version();

}  // namespace jink::tools::lab::bench
