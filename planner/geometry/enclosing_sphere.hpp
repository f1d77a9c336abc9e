// SPDX-License-Identifier: BSD-3-Clause
// The smallest sphere around a set of points: what the planner takes for an obstacle that is not a sphere.
#pragma once

#include <span>

#include "planner/base/types.hpp"

namespace jink::planner::geometry {

/// A ball, in the frame and unit of the points that it was made from.
struct Sphere {
  Vec3 center = Vec3::Zero();  ///< its centre
  double radius = 0.0;         ///< its radius, >= 0
};

/// The smallest sphere that contains all `points`, in their frame and unit. It is unique; duplicates, a single point,
/// collinear and coplanar sets are all right. No point lies further from the centre than `radius` as computed with
/// doubles, and the radius is minimal to about 1e-12 of itself. Requires at least one point, all finite.
///
/// Source: basis exchange for LP-type problems with the farthest point as pivot (Gärtner, "Fast and robust smallest
/// enclosing balls", 1999). differs: the sphere of the few points of a basis is found by trying every subset, in place
/// of Welzl's recursion, which takes a tolerance to tell dependent points apart. Deterministic; about ten passes over
/// the points, no heap, thread safe.
[[nodiscard]] Sphere smallest_enclosing_sphere(std::span<const Vec3> points);

}  // namespace jink::planner::geometry
