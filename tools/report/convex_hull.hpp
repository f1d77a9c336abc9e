// SPDX-License-Identifier: BSD-3-Clause
// The convex hull of a few points as triangles: for drawing.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::tools::report {

using Triangle = std::array<std::size_t, 3>;

/// Triangles over indices into `points` that cover the surface of their convex hull, counter-clockwise seen from
/// outside. Of points in one plane both faces; of points on one line one triangle whose last two corners are the same,
/// of a single point one with all three the same: whoever draws edges and corners misses nothing. Requires at least one
/// point, all finite. Points within 1e-9 of the set's size of a face are taken as on it. O(n f) for f faces.
std::vector<Triangle> convex_hull(std::span<const Vec3> points);

/// The corners of the convex hull of points in the plane with that normal, in order around it. `tolerance` in m: what
/// is less far out is no corner. Requires at least one point.
std::vector<std::size_t> hull_ring(std::span<const Vec3> points, const Vec3& normal, double tolerance = 0.0);

}  // namespace jink::tools::report
