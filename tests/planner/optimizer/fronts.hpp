// SPDX-License-Identifier: BSD-3-Clause
// How good a front is, for the tests of the optimizers.
#pragma once

#include <span>
#include <vector>

#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::planner::testing {

/// Hypervolume of the first two objectives, reference (1.1, 1.1).
inline double volume_of(std::span<const optimizer::Cost> costs) {
  std::vector<optimizer::Point2> points;
  for (const optimizer::Cost& c : costs) points.push_back({c.f[0], c.f[1]});
  return optimizer::hypervolume(points, {1.1, 1.1});
}

}  // namespace jink::planner::testing
