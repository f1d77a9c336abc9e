// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace jink::planner::geometry {

double line_discriminant(const Vec3& a, const Vec3& b, const Vec3& center, double radius) {
  const Vec3 delta = b - a;  // Eq. (8)
  const Vec3 offset = a - center;
  const double A = delta.squaredNorm();                     // Eq. (11)
  const double B = 2.0 * delta.dot(offset);                 // Eq. (12)
  const double C = offset.squaredNorm() - radius * radius;  // Eq. (13)
  return B * B - 4.0 * A * C;                               // Eq. (14)
}

double swept_distance_squared(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 start = a - c;
  const Vec3 change = (b - d) - start;
  const double A = change.squaredNorm();
  const double s = A > 0.0 ? std::clamp(-change.dot(start) / A, 0.0, 1.0) : 0.0;
  return (start + s * change).squaredNorm();
}

PathFrame::PathFrame(const Vec3& start, const Vec3& target) : origin(start), length((target - start).norm()) {
  if (length < 1e-9) return;
  axis = (target - start) / length;
  const Vec3 level = Vec3::UnitZ().cross(axis);
  left = level.norm() > 1e-6 ? Vec3(level.normalized()) : Vec3(Vec3::UnitY());
  up = axis.cross(left);
}

double angle_between(const Vec3& u, const Vec3& v) {
  if (u.norm() < 1e-9 || v.norm() < 1e-9) return 0.0;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace jink::planner::geometry
