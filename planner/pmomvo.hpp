// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO, [Paper] Algorithm 2: a master and m slaves, each a MOMVO on its share of the universes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/archive.hpp"
#include "planner/budget.hpp"
#include "planner/momvo.hpp"
#include "planner/problem.hpp"
#include "planner/settings.hpp"
#include "planner/worker_pool.hpp"

namespace jink::planner {

/// A set of mutually non-dominated solutions: costs[i] belongs to x[i * dimension .. (i + 1) * dimension).
struct Front {
  int dimension = 0;
  std::vector<double> x;
  std::vector<Cost> costs;

  [[nodiscard]] std::size_t size() const { return costs.size(); }
  [[nodiscard]] std::span<const double> solution(std::size_t i) const {
    const auto d = static_cast<std::size_t>(dimension);
    return {x.data() + i * d, d};
  }
};

/// What a run did.
struct RunReport {
  std::int64_t evaluations = 0;
  int generations = 0;  ///< done by every slave
  bool deadline_reached = false;
};

/// The result depends on (problem, settings, seeds, seed, generations), not on the number of threads: slaves share
/// nothing while they run, and the master works in the order of their numbers.
///
/// m = 1 with l = 0 is MOMVO alone. Universes are dealt out evenly, at least one for each slave.
class Pmomvo {
 public:
  /// For problems of this shape. Throws std::invalid_argument where the settings have less than one slave, iteration or
  /// universe per slave, or an archive that does not hold the extremes.
  Pmomvo(const OptimizerSettings& settings, int dimension, int objectives);

  /// Optimizes `problem` on the threads of `pool`. `initial` holds solutions, one after the other, to be placed among
  /// the random initial universes, dealt out to the slaves in turn. `seed` and `stream` name the random numbers. The
  /// front is valid until the next run. No allocation once the front has reached its largest size.
  const Front& run(const Problem& problem, std::span<const double> initial, std::uint64_t seed, std::uint64_t stream,
                   const Budget& budget, WorkerPool& pool);

  [[nodiscard]] const RunReport& report() const { return report_; }

 private:
  void place_initial(std::span<const double> initial);
  void share();
  void merge();

  OptimizerSettings settings_;
  int dimension_;
  int objectives_;
  std::vector<Momvo> slaves_;
  std::vector<double> shared_;  // representatives that the master sends back, one after the other
  std::vector<Cost> shared_costs_;
  Front front_;
  RunReport report_;
};

}  // namespace jink::planner
