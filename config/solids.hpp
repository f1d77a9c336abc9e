// SPDX-License-Identifier: BSD-3-Clause
// What the planner takes for a file's obstacle: the sphere around its shape, and the solid within.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/solid.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/enclosing_sphere.hpp"
#include "planner/geometry/polygon.hpp"
#include "planner/geometry/static_map.hpp"

namespace jink::config {

/// The smallest sphere around the shape; its centre is relative to the reference point, in the shape's own axes.
[[nodiscard]] planner::geometry::Sphere bounding_sphere(const Shape& shape);

/// The same around an obstacle however it has turned, relative to its reference point, ENU; of one that turns, about
/// that point.
[[nodiscard]] planner::geometry::Sphere bounding_sphere(const Obstacle& obstacle);

/// What a track tells of the obstacle's shape about `center`, relative to its reference point, ENU, at yaw 0 being as
/// it is at t = 0. None for a sphere.
[[nodiscard]] std::shared_ptr<const planner::base::Solid> solid_of(const Obstacle& obstacle, const Vec3& center);

/// The obstacle's own axes at time `t`, in ENU: the columns. Before t = 0 it does not turn.
[[nodiscard]] Eigen::Matrix3d axes_at(const Obstacle& obstacle, double t);

/// Prisms over a simple polygon, from `min` to `max` > min, m.
[[nodiscard]] std::vector<Obstacle> prisms(std::span<const planner::geometry::Vec2> polygon, double min, double max);

/// What reaches no higher above the ground than this is the ground itself, as in a map made from measurements, and not
/// an obstacle: a vehicle stands on it. m.
inline constexpr double kRelief = 0.3;

/// The track of an obstacle that does not move, its motion being a LinearMotion without velocity; without an id.
[[nodiscard]] planner::base::Track track_at_rest(const Obstacle& obstacle);

/// The map of such obstacles; shared, as all that fly by it have the same, and copies of a mission too.
[[nodiscard]] std::shared_ptr<const planner::geometry::StaticMap> make_map(std::span<const Obstacle> solids);

}  // namespace jink::config
