// SPDX-License-Identifier: BSD-3-Clause
// Collision tests of the objective functions: the paper's line test and the swept test. The check of finished plans is
// planner/verify/verifier, which shares nothing with this file.
#pragma once

#include "planner/base/types.hpp"

namespace jink::planner::geometry {

/// Discriminant of [Paper] Eq. (14) for the infinite line through a and b and a sphere: B² − 4AC, m⁴; negative where
/// the line misses the sphere. differs: signed differences (Eq. (8) prints absolute values, which mirror the segment)
/// and the segment's own start in B and C (Eq. (12), (13) print the waypoint before it).
double line_discriminant(const Vec3& a, const Vec3& b, const Vec3& center, double radius);

/// Smallest squared distance during one segment in which the vehicle moves from a to b and the obstacle from c to d,
/// both at constant velocity: the quadratic in relative motion, restricted to t ∈ [0, 1].
double swept_distance_squared(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// An orthonormal frame along the mission: axis from start to target, `left` level, `up` = axis × left. Where start and
/// target coincide the axis is east; where the axis is vertical `left` is north.
struct PathFrame {
  Vec3 origin = Vec3::Zero();  ///< the start, ENU, m
  Vec3 axis = Vec3::UnitX();   ///< unit vector from start to target, ENU
  Vec3 left = Vec3::UnitY();   ///< unit vector, level, ENU
  Vec3 up = Vec3::UnitZ();     ///< axis × left, ENU
  double length = 0.0;         ///< from start to target, m

  PathFrame() = default;
  /// The frame from `start` to `target`, ENU, m. Any two finite points will do, also the same one twice.
  PathFrame(const Vec3& start, const Vec3& target);

  /// ENU point of coordinates along (axis, left, up).
  [[nodiscard]] Vec3 to_enu(const Vec3& q) const { return origin + q.x() * axis + q.y() * left + q.z() * up; }
  /// Coordinates along (axis, left, up) of an ENU point.
  [[nodiscard]] Vec3 from_enu(const Vec3& p) const {
    const Vec3 d = p - origin;
    return {d.dot(axis), d.dot(left), d.dot(up)};
  }
};

/// Angle between two directions, rad in [0, π]; 0 where either is shorter than 1e-9.
double angle_between(const Vec3& u, const Vec3& v);

}  // namespace jink::planner::geometry
