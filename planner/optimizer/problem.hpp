// SPDX-License-Identifier: BSD-3-Clause
// What an optimizer may know of a problem: a box and a cost.
#pragma once

#include <span>

#include "planner/optimizer/pareto.hpp"

namespace jink::planner::optimizer {

/// A constrained multi-objective minimisation problem over a box. Implementations are immutable while they are
/// optimized: evaluate() is called by several slaves at once and neither allocates nor locks.
class Problem {
 public:
  virtual ~Problem() = default;
  [[nodiscard]] virtual int dimension() const = 0;                  ///< number of decision variables
  [[nodiscard]] virtual int objectives() const = 0;                 ///< 1 .. kMaxObjectives
  [[nodiscard]] virtual std::span<const double> lower() const = 0;  ///< bounds, dimension() values
  [[nodiscard]] virtual std::span<const double> upper() const = 0;  ///< bounds, dimension() values

  /// Costs of costs.size() solutions; `x` holds them one after the other, dimension() values each, within the box.
  virtual void evaluate(std::span<const double> x, std::span<Cost> costs) const = 0;
};

}  // namespace jink::planner::optimizer
