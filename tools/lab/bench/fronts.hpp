// SPDX-License-Identifier: BSD-3-Clause
// How good a front is.
#pragma once

#include <vector>

#include "planner/optimizer/indicators.hpp"

namespace jink::tools::lab::bench {

/// Hypervolume of a front in units of the bounds, reference (1.1, 1.1).
inline double volume_of(const std::vector<planner::optimizer::Point2>& front,
                        const planner::optimizer::FrontBounds& bounds) {
  std::vector<planner::optimizer::Point2> normalised;
  normalised.reserve(front.size());
  for (const planner::optimizer::Point2& point : front)
    normalised.push_back(planner::optimizer::normalise(point, bounds));
  return planner::optimizer::hypervolume(normalised, {1.1, 1.1});
}

}  // namespace jink::tools::lab::bench
