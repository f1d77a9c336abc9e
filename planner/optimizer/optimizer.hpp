// SPDX-License-Identifier: BSD-3-Clause
// What every multi-objective optimizer of the project looks like: PMOMVO, and those that it is compared with.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "planner/base/budget.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/optimizer/pareto.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::planner::optimizer {

/// A set of mutually non-dominated solutions: costs[i] belongs to x[i * dimension .. (i + 1) * dimension).
struct Front {
  int dimension = 0;        ///< variables of a solution
  std::vector<double> x;    ///< size() · dimension values, one solution after the other
  std::vector<Cost> costs;  ///< size() values

  /// Number of solutions.
  [[nodiscard]] std::size_t size() const { return costs.size(); }
  /// Decision variables of solution i < size().
  [[nodiscard]] std::span<const double> solution(std::size_t i) const {
    const auto d = static_cast<std::size_t>(dimension);
    return {x.data() + i * d, d};
  }
};

/// What a run did.
struct RunReport {
  std::int64_t evaluations = 0;   ///< solutions evaluated
  int generations = 0;            ///< generations done
  bool deadline_reached = false;  ///< the deadline ended the run before its last generation
};

/// An optimizer for problems of one shape (dimension and number of objectives, given at construction).
class Optimizer {
 public:
  virtual ~Optimizer() = default;

  /// Optimizes `problem`. `initial` holds solutions to start from, one after the other; empty: none. `seed` and
  /// `stream` name the random numbers: the same arguments give the same bits for any number of threads, unless the
  /// budget's deadline cuts the run. The front is valid until the next run.
  virtual const Front& run(const Problem& problem, std::span<const double> initial, std::uint64_t seed,
                           std::uint64_t stream, const base::Budget& budget, base::WorkerPool& pool) = 0;

  /// Of the last run.
  [[nodiscard]] virtual const RunReport& report() const = 0;
};

/// Makes an optimizer for problems of one shape. Empty where one is asked for: PMOMVO.
using MakeOptimizer =
    std::function<std::unique_ptr<Optimizer>(const base::OptimizerSettings& settings, int dimension, int objectives)>;

}  // namespace jink::planner::optimizer
