// SPDX-License-Identifier: BSD-3-Clause
// An obstacle's true shape, placed relative to its moving reference point: how far a point or a straight way is from
// it. What the planner takes for it is config/solids. Where the reference point goes is sim/world/obstacle_models.
#pragma once

#include "config/scenario.hpp"
#include "config/solids.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/enclosing_sphere.hpp"

namespace jink::sim::world {

using config::axes_at;
using config::bounding_sphere;
using config::solid_of;
using planner::geometry::Sphere;

/// Distance in metres from `point` to the surface of the shape whose reference point is at `reference`, along its own
/// axes; negative inside (then the way out). Inside the convex hull of vertices it is 0: the depth is not computed.
/// Exact to about 1e-12 of the size, and 1e-10 for hulls. O(n) per step for n vertices, with a few steps; no heap,
/// thread safe.
[[nodiscard]] double distance(const config::Shape& shape, const Vec3& reference, const Vec3& point);

/// The nearest point of a straight way.
struct SegmentDistance {
  double distance = planner::base::kInfinity;  ///< the smallest value of distance() along the way
  double fraction = 0.0;  ///< where: 0 at its beginning, 1 at its end; any one place if there are several
};

/// The minimum of distance() over the points from `begin` to `end`, exact like it, for a cylinder to 1e-9 m. The two
/// may be equal.
[[nodiscard]] SegmentDistance segment_distance(const config::Shape& shape, const Vec3& reference, const Vec3& begin,
                                               const Vec3& end);

/// The smallest value that distance() can return for this shape: minus its depth, <= 0.
[[nodiscard]] double deepest(const config::Shape& shape);

}  // namespace jink::sim::world
