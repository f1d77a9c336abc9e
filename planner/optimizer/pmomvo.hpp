// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO, [Paper] Algorithm 2: a master and m slaves, each a MOMVO on its share of the universes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/optimizer/momvo.hpp"
#include "planner/optimizer/optimizer.hpp"

namespace jink::planner::optimizer {

/// The result depends on (problem, settings, seeds, seed, generations), not on the number of threads: slaves share
/// nothing while they run, and the master works in the order of their numbers.
///
/// With Operators::kPrinted and l > 0 representatives are also shared before the first cycle, as Algorithm 2 has it in
/// steps 3 and 6: each slave's is then one of its universes, drawn evenly, and what ranks them is one evaluation more
/// of all universes. differs, with the others: what is shared first comes from the first cycle, since random solutions
/// are not worth an evaluation of all.
///
/// m = 1 with l = 0 is MOMVO alone. Universes are dealt out evenly, at least one for each slave.
class Pmomvo final : public Optimizer {
 public:
  /// For problems of this shape. Throws std::invalid_argument where the settings have less than one slave, iteration or
  /// universe per slave, or an archive that does not hold the extremes.
  Pmomvo(const base::OptimizerSettings& settings, int dimension, int objectives);

  /// Runs on the threads of `pool`. `initial` solutions are placed among the random initial universes, dealt out to the
  /// slaves in turn. No allocation once the front has reached its largest size.
  const Front& run(const Problem& problem, std::span<const double> initial, std::uint64_t seed, std::uint64_t stream,
                   const base::Budget& budget, base::WorkerPool& pool) override;

  [[nodiscard]] const RunReport& report() const override { return report_; }

 private:
  void begin(std::uint32_t j, const Problem& problem, std::span<const double> initial,
             const base::RandomStream& random);
  void extend_schedule(int generations, int stop);
  void share();
  void merge();

  base::OptimizerSettings settings_;
  int dimension_;
  int objectives_;
  std::vector<Momvo> slaves_;
  std::vector<Schedule> schedule_;  // of the first generations of a run of `scheduled_`
  int scheduled_ = 0;
  std::vector<double> shared_;  // representatives that the master sends back, one after the other
  std::vector<Cost> shared_costs_;
  Front front_;
  RunReport report_;
};

}  // namespace jink::planner::optimizer
