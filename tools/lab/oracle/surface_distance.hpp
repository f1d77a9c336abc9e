// SPDX-License-Identifier: BSD-3-Clause
// How far a point is from an obstacle's surface, in formulae of the judge's own.
#pragma once

#include <algorithm>
#include <variant>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"
#include "sim/world/shapes.hpp"

namespace jink::tools::lab::oracle {

/// In metres, from the surface to a point that is given relative to the obstacle's reference point, along its own axes;
/// negative in a sphere or a box. Of the others the distance is sim's.
inline double surface_distance(const config::Shape& shape, const Vec3& relative) {
  if (const auto* sphere = std::get_if<config::SphereShape>(&shape)) return relative.norm() - sphere->radius;
  if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
    const Vec3 beyond = relative.cwiseAbs() - 0.5 * box->edges;
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
  }
  return sim::world::distance(shape, Vec3::Zero(), relative);
}

}  // namespace jink::tools::lab::oracle
