// SPDX-License-Identifier: BSD-3-Clause
// What an obstacle is where it is no ball: a convex solid about the point that a track follows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::planner::base {

/// A convex solid, relative to a reference point, ENU, m, as it is at yaw 0. Immutable, so that tracks, which are
/// copied many times a second, share it: a hull has any number of vertices.
///
/// It is a prism or a hull. A prism is all that is within `rounding` of a core: in axes of its own, about `center`, a
/// rectangle of half edges half.x and half.y, all within `corner` of it on its plane, up to half.z above and below. A
/// box is one without corner and rounding, a cylinder one of which the corner alone is left of the rectangle, a capsule
/// one with a line as its core.
class Solid {
 public:
  /// Where a prism is: its centre from the reference point, and its own axes in ENU, the columns, orthonormal.
  struct Pose {
    Vec3 center = Vec3::Zero();                          ///< m
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal, right-handed
  };
  /// The extent of a hull along a direction: its points p have low <= normal · p <= high.
  struct Slab {
    Vec3 normal = Vec3::UnitX();  ///< unit vector
    double low = 0.0;             ///< m
    double high = 0.0;            ///< m
  };
  static constexpr std::size_t kSlabs = 17;  ///< directions along which a hull is bounded for the search

  // All throw std::invalid_argument where a number is not finite or a size is below 0; where there is no vertex; where
  // axes are not orthonormal to 1e-6.

  /// A prism of these, m.
  static std::shared_ptr<const Solid> prism(const Vec3& half, double corner, double rounding, const Pose& pose);
  /// A box of these edges along its own axes, m.
  static std::shared_ptr<const Solid> box(const Vec3& edges, const Pose& pose);
  /// A cylinder about its own z, m.
  static std::shared_ptr<const Solid> cylinder(double radius, double height, const Pose& pose);
  /// All within `radius` of the line from a to b, m.
  static std::shared_ptr<const Solid> capsule(double radius, const Vec3& a, const Vec3& b);
  /// The convex hull of points, m; they may be coplanar, collinear, or one.
  static std::shared_ptr<const Solid> hull(std::vector<Vec3> vertices);

  /// Whether it is the hull of vertices(); else a prism.
  [[nodiscard]] bool is_hull() const { return !vertices_.empty(); }
  [[nodiscard]] const Pose& pose() const { return pose_; }                    ///< of a prism
  [[nodiscard]] const Vec3& half() const { return half_; }                    ///< of a prism, m, >= 0
  [[nodiscard]] double corner() const { return corner_; }                     ///< of a prism, m, >= 0
  [[nodiscard]] double rounding() const { return rounding_; }                 ///< of a prism, m, >= 0
  [[nodiscard]] std::span<const Vec3> vertices() const { return vertices_; }  ///< of a hull, m
  /// Of a hull: it lies in all of them. What lies in all of them may be larger than the hull.
  [[nodiscard]] std::span<const Slab> slabs() const { return {slabs_.data(), is_hull() ? slabs_.size() : 0}; }

  /// How far its farthest point is from the reference point, m: whatever the yaw.
  [[nodiscard]] double reach() const { return reach_; }
  /// The largest direction · p of its points p, m. O(vertices).
  [[nodiscard]] double extent(const Vec3& direction) const;

 private:
  Solid() = default;

  Pose pose_;
  Vec3 half_ = Vec3::Zero();
  double corner_ = 0.0;
  double rounding_ = 0.0;
  double reach_ = 0.0;
  std::vector<Vec3> vertices_;
  std::array<Slab, kSlabs> slabs_{};
};

}  // namespace jink::planner::base
