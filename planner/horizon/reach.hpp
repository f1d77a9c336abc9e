// SPDX-License-Identifier: BSD-3-Clause
// What of a static map a plan is to know.
#pragma once

#include <algorithm>
#include <cmath>

#include "planner/base/settings.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// A box, ENU, m: nothing outside it can come nearer to a vehicle that flies for the request, as far ahead as is looked
/// at most, than the margin and what uncertainty may ask for on top.
[[nodiscard]] inline base::Box reach_of(const PathRequest& request, const base::HorizonSettings& settings) {
  const double time = std::max(settings.horizon(), settings.for_far().horizon());
  const double beside = request.vehicle.radius + request.margin + settings.clearance_limit;
  const double level = time * std::max(request.vehicle.max_speed, request.velocity.norm()) + beside;
  const double up = time * std::max(request.vehicle.max_climb, std::abs(request.velocity.z())) + beside;
  return {request.position - Vec3(level, level, up), request.position + Vec3(level, level, up)};
}

}  // namespace jink::planner::horizon
