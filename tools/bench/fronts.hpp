// SPDX-License-Identifier: BSD-3-Clause
// How good a front is.
#pragma once

#include <vector>

#include "planner/indicators.hpp"

namespace jink::bench {

/// Hypervolume of a front in units of the bounds, reference (1.1, 1.1).
inline double volume_of(const std::vector<planner::Point2>& front, const planner::FrontBounds& bounds) {
  std::vector<planner::Point2> normalised;
  normalised.reserve(front.size());
  for (const planner::Point2& point : front) normalised.push_back(normalise(point, bounds));
  return planner::hypervolume(normalised, {1.1, 1.1});
}

}  // namespace jink::bench
