// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/known_path.hpp"

#include <algorithm>

namespace jink::planner::geometry {

double KnownPath::fastest() const {
  double most = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    most = std::max(most, (points[i].position - points[i - 1].position).norm() / (points[i].t - points[i - 1].t));
  }
  return most;
}

}  // namespace jink::planner::geometry
