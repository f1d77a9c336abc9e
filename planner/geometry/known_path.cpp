// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/known_path.hpp"

#include <algorithm>
#include <cmath>

namespace jink::planner::geometry {

double KnownPath::fastest() const {
  double most = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    most = std::max(most, (points[i].position - points[i - 1].position).norm() / (points[i].t - points[i - 1].t));
  }
  return most;
}

bool KnownPath::well_formed() const {
  // `until` may be infinite.
  if (points.empty() || std::isnan(until)) return false;
  if (!std::isfinite(offset + radius + margin + position_sigma + velocity_sigma + age)) return false;
  double before = -base::kInfinity;
  for (const base::TimedPoint& point : points) {
    if (!(std::isfinite(point.t) && point.t > before && point.position.allFinite())) return false;
    before = point.t;
  }
  return std::isfinite(fastest());
}

}  // namespace jink::planner::geometry
