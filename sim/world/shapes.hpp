// SPDX-License-Identifier: BSD-3-Clause
// An obstacle's true shape, placed relative to its moving reference point: how far a point or a straight way is from
// it, and the sphere that the planner takes for it. Where the reference point goes is sim/world/obstacle_models.
#pragma once

#include <memory>

#include "config/scenario.hpp"
#include "planner/base/solid.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/enclosing_sphere.hpp"

namespace jink::sim::world {

using planner::geometry::Sphere;

/// The smallest sphere around the shape; its centre is relative to the reference point, in the shape's own axes.
[[nodiscard]] Sphere bounding_sphere(const config::Shape& shape);

/// The same around an obstacle however it has turned, relative to its reference point, ENU; of one that turns, about
/// that point.
[[nodiscard]] Sphere bounding_sphere(const config::Obstacle& obstacle);

/// What a track tells of the obstacle's shape about `center`, relative to its reference point, ENU, at yaw 0 being as
/// it is at t = 0. None for a sphere.
[[nodiscard]] std::shared_ptr<const planner::base::Solid> solid_of(const config::Obstacle& obstacle,
                                                                   const Vec3& center);

/// The obstacle's own axes at time `t`, in ENU: the columns. Before t = 0 it does not turn.
[[nodiscard]] Eigen::Matrix3d axes_at(const config::Obstacle& obstacle, double t);

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
