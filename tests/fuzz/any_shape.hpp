// SPDX-License-Identifier: BSD-3-Clause
// Solids of every kind for fuzzers, as what they are made of: the planner's solid and the judge's both come from it.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "planner/base/solid.hpp"
#include "tests/fuzz/numbers.hpp"

namespace jink::fuzz {

struct Shape {
  enum class Kind { kBox, kCylinder, kCapsule, kPrism, kHull };

  Kind kind = Kind::kBox;
  Vec3 half = Vec3::Zero();         ///< of a box, a cylinder (z alone) and a prism
  double corner = 0.0;              ///< of a prism; a cylinder's radius
  double rounding = 0.0;            ///< of a prism; a capsule's radius
  planner::base::Solid::Pose pose;  ///< of all but capsules and hulls
  Vec3 a = Vec3::Zero();            ///< a capsule's ends
  Vec3 b = Vec3::Zero();
  std::vector<Vec3> vertices;  ///< of a hull

  [[nodiscard]] std::shared_ptr<const planner::base::Solid> solid() const {
    using planner::base::Solid;
    switch (kind) {
      case Kind::kBox:
        return Solid::box(2.0 * half, pose);
      case Kind::kCylinder:
        return Solid::cylinder(corner, 2.0 * half.z(), pose);
      case Kind::kCapsule:
        return Solid::capsule(rounding, a, b);
      case Kind::kPrism:
        return Solid::prism(half, corner, rounding, pose);
      case Kind::kHull:
        break;
    }
    return Solid::hull(vertices);
  }
  void grow(double factor) {
    for (Vec3* v : {&half, &pose.center, &a, &b}) *v *= factor;
    for (Vec3& vertex : vertices) vertex *= factor;
    corner *= factor;
    rounding *= factor;
  }
};

/// Along the axes exactly, upright, or anyhow.
inline Eigen::Matrix3d any_axes(Numbers& n) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  switch (n.below(4)) {
    case 0:
      return axes;
    case 1: {
      const auto first = static_cast<Eigen::Index>(n.below(3));
      axes << Vec3::Unit(first), Vec3::Unit((first + 1) % 3), Vec3::Unit((first + 2) % 3);
      return axes;
    }
    case 2:
      return Eigen::AngleAxisd(n.in(-4.0, 4.0), Vec3::UnitZ()).toRotationMatrix();
    default:
      return Eigen::AngleAxisd(n.in(-4.0, 4.0), n.direction()).toRotationMatrix();
  }
}

/// Up to some ten metres about the point that a track follows, mostly near it.
inline Vec3 any_center(Numbers& n) {
  return n.one_in(2) ? Vec3::Zero() : n.vec(n.scale(1e-3, 10.0));
}

/// Half edges of a cube, a plate, a needle or a box.
inline Vec3 any_half(Numbers& n) {
  const double large = n.scale(0.05, 10.0);
  const double thin = n.scale(5e-4, 5e-3);
  switch (n.below(4)) {
    case 0:
      return Vec3::Constant(large);
    case 1:
      return {large, n.in(0.1, 1.0) * large, thin};
    case 2:
      return {thin, thin, large};
    default:
      return {large, n.scale(0.05, 10.0), n.scale(0.05, 10.0)};
  }
}

inline std::vector<Vec3> any_vertices(Numbers& n) {
  const Vec3 half = any_half(n);
  const Vec3 center = any_center(n);
  const Eigen::Matrix3d axes = any_axes(n);
  const std::size_t kind = n.below(6);
  const std::size_t count = kind == 0 ? 8 : 1 + n.below(8);
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 share = n.vec(1.0);
    if (kind == 0)
      share = {(i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0, (i & 4U) != 0 ? 1.0 : -1.0};  // a box
    if (kind == 1) share.z() = 0.0;                                                                  // coplanar
    if (kind == 2) share.y() = share.z() = 0.0;                                                      // collinear
    if (kind == 3) share = share.array().round().matrix();  // many share planes and lines
    const bool again = kind == 4 && i > 0 && n.one_in(2);
    vertices.push_back(again ? vertices[n.below(i)] : center + axes * half.cwiseProduct(share));
  }
  return vertices;
}

inline Shape any_shape(Numbers& n) {
  using Kind = Shape::Kind;
  Shape s;
  s.kind = static_cast<Kind>(n.below(5));
  if (s.kind == Kind::kHull) {
    s.vertices = any_vertices(n);
    return s;
  }
  if (s.kind == Kind::kCapsule) {
    const bool wire = n.one_in(3);
    s.rounding = wire ? 0.005 : n.scale(1e-3, 5.0);
    const Vec3 along = any_axes(n).col(2) * (wire ? 10.0 : n.one_in(8) ? 0.0 : n.scale(0.01, 10.0));
    const Vec3 center = any_center(n);
    s.a = center - along;
    s.b = center + along;
    return s;
  }
  s.pose = {any_center(n), any_axes(n)};
  s.half = any_half(n);
  if (s.kind == Kind::kCylinder) {
    s.corner = s.half.x();  // of a plate a disc, of a needle a pole
    s.half.head<2>().setZero();
  }
  if (s.kind == Kind::kPrism) {
    s.corner = n.one_in(2) ? 0.0 : n.scale(1e-3, 2.0);
    s.rounding = n.one_in(2) ? 0.0 : n.scale(1e-3, 2.0);
    for (double& edge : s.half) edge = n.one_in(4) ? 0.0 : edge;
  }
  return s;
}

}  // namespace jink::fuzz
