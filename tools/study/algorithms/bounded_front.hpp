// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO with a front no larger than the others': its slaves' archives together hold up to m times as many members.
#pragma once

#include "planner/archive.hpp"
#include "planner/pmomvo.hpp"

namespace jink::study {

/// Pmomvo whose merged front is thinned out to `settings.archive` members as an archive of its own would be, Eq. (21).
/// One slave's front is as it was.
class BoundedPmomvo final : public planner::Optimizer {
 public:
  /// Throws std::invalid_argument for settings that Pmomvo refuses.
  BoundedPmomvo(const planner::OptimizerSettings& settings, int dimension, int objectives);

  const planner::Front& run(const planner::Problem& problem, std::span<const double> initial, std::uint64_t seed,
                            std::uint64_t stream, const planner::Budget& budget, planner::WorkerPool& pool) override;

  [[nodiscard]] const planner::RunReport& report() const override { return pmomvo_.report(); }

 private:
  planner::Pmomvo pmomvo_;
  planner::Archive archive_;
  planner::Front front_;
};

/// What an archive holds, as a front, in the archive's order.
void copy_front(const planner::Archive& archive, int dimension, planner::Front& front);

}  // namespace jink::study
