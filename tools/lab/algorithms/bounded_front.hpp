// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO with a front no larger than the others': its slaves' archives together hold up to m times as many members.
#pragma once

#include "planner/optimizer/archive.hpp"
#include "planner/optimizer/pmomvo.hpp"

namespace jink::tools::lab::algorithms {

/// Pmomvo whose merged front is thinned out to `settings.archive` members as an archive of its own would be, Eq. (21).
/// One slave's front is as it was.
class BoundedPmomvo final : public planner::optimizer::Optimizer {
 public:
  /// Throws std::invalid_argument for settings that Pmomvo refuses.
  BoundedPmomvo(const planner::base::OptimizerSettings& settings, int dimension, int objectives);

  const planner::optimizer::Front& run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                       std::uint64_t seed, std::uint64_t stream, const planner::base::Budget& budget,
                                       planner::base::WorkerPool& pool) override;

  [[nodiscard]] const planner::optimizer::RunReport& report() const override { return pmomvo_.report(); }

 private:
  planner::optimizer::Pmomvo pmomvo_;
  planner::optimizer::Archive archive_;
  planner::optimizer::Front front_;
};

/// What an archive holds, as a front, in the archive's order.
void copy_front(const planner::optimizer::Archive& archive, int dimension, planner::optimizer::Front& front);

}  // namespace jink::tools::lab::algorithms
