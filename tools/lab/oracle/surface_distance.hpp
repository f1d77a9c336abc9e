// SPDX-License-Identifier: BSD-3-Clause
// How far a point is from an obstacle's surface, in formulae of the judge's own.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"
#include "sim/world/shapes.hpp"

namespace jink::tools::lab::oracle {

/// In metres, from the surface to a point that is given relative to the obstacle's reference point, along its own axes;
/// negative inside. Of a hull of vertices the distance is sim's.
inline double surface_distance(const config::Shape& shape, const Vec3& relative) {
  if (const auto* sphere = std::get_if<config::SphereShape>(&shape)) return relative.norm() - sphere->radius;
  if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
    const Vec3 beyond = relative.cwiseAbs() - 0.5 * box->edges;
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
  }
  if (const auto* cylinder = std::get_if<config::CylinderShape>(&shape)) {
    const double out = std::sqrt(relative.x() * relative.x() + relative.y() * relative.y()) - cylinder->radius;
    const double over = std::abs(relative.z()) - 0.5 * cylinder->height;
    if (out <= 0.0 || over <= 0.0) return std::max(out, over);
    return std::sqrt(out * out + over * over);
  }
  if (const auto* capsule = std::get_if<config::CapsuleShape>(&shape)) {
    const Vec3 line = capsule->b - capsule->a;
    const double square = line.squaredNorm();
    const double share = square > 0.0 ? std::clamp(line.dot(relative - capsule->a) / square, 0.0, 1.0) : 0.0;
    return (relative - capsule->a - share * line).norm() - capsule->radius;
  }
  return sim::world::distance(shape, Vec3::Zero(), relative);
}

/// A box around the shape, relative to its reference point, when its own axes point so.
inline planner::base::Box box_around(const config::Shape& shape, const Eigen::Matrix3d& axes) {
  Vec3 low = Vec3::Constant(planner::base::kInfinity);
  Vec3 high = -low;
  const auto take_in = [&](const Vec3& point, const Vec3& reach) {
    low = low.cwiseMin(axes * point - reach);
    high = high.cwiseMax(axes * point + reach);
  };
  if (const auto* sphere = std::get_if<config::SphereShape>(&shape)) {
    take_in(Vec3::Zero(), Vec3::Constant(sphere->radius));
  } else if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
    take_in(Vec3::Zero(), axes.cwiseAbs() * (0.5 * box->edges));
  } else if (const auto* cylinder = std::get_if<config::CylinderShape>(&shape)) {
    take_in(Vec3::Zero(), axes.cwiseAbs() * Vec3(cylinder->radius, cylinder->radius, 0.5 * cylinder->height));
  } else if (const auto* capsule = std::get_if<config::CapsuleShape>(&shape)) {
    for (const Vec3& end : {capsule->a, capsule->b}) take_in(end, Vec3::Constant(capsule->radius));
  } else {
    for (const Vec3& vertex : std::get<config::VertexShape>(shape).vertices) take_in(vertex, Vec3::Zero());
  }
  return {low, high};
}

}  // namespace jink::tools::lab::oracle
