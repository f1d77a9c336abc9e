// SPDX-License-Identifier: BSD-3-Clause
// An obstacle's true shape as corners to draw.
#pragma once

#include <vector>

#include "config/scenario.hpp"
#include "planner/base/solid.hpp"
#include "planner/base/types.hpp"

namespace jink::tools::report {

/// Points whose convex hull is the shape, relative to its reference point, ENU, m, at time t, s; what is round has so
/// many that it is nowhere off by more than half a percent of its radius. None of a sphere.
std::vector<Vec3> shape_corners(const config::Obstacle& obstacle, double t);
/// The same of a solid at rest.
std::vector<Vec3> solid_corners(const planner::base::Solid& solid);

}  // namespace jink::tools::report
