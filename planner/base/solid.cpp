// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "planner/base/portable_math.hpp"

namespace jink::planner::base {
namespace {

void check(bool good, const char* what) {
  if (!good) throw std::invalid_argument(what);
}

void check_size(double size) {
  check(std::isfinite(size) && size >= 0.0, "solid: a size that is not finite or below 0");
}

void check_pose(const Solid::Pose& pose) {
  constexpr double kSkew = 1e-6;
  check(pose.center.allFinite(), "solid: a centre that is not finite");
  const Eigen::Matrix3d product = pose.axes.transpose() * pose.axes;
  const Eigen::Matrix3d skew = product - Eigen::Matrix3d::Identity();
  check((skew.array().abs() <= kSkew).all(), "solid: axes that are not orthonormal");  // false for NaN
}

/// The axes, the diagonals of a cube's faces and of the cube itself, and four more on the level: much stands upright.
std::array<Vec3, Solid::kSlabs> directions() {
  std::array<Vec3, Solid::kSlabs> all{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1},  {1, 1, 0}, {1, -1, 0}, {1, 0, 1},
                                      {1, 0, -1},    {0, 1, 1}, {0, 1, -1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1},
                                      {-1, 1, 1},    {2, 1, 0}, {2, -1, 0}, {1, 2, 0}, {1, -2, 0}};
  for (Vec3& direction : all) direction.normalize();
  return all;
}

}  // namespace

std::shared_ptr<const Solid> Solid::prism(const Vec3& half, double corner, double rounding, const Pose& pose) {
  for (const double size : {half.x(), half.y(), half.z(), corner, rounding}) check_size(size);
  check_pose(pose);
  Solid solid;
  solid.pose_ = pose;
  solid.half_ = half;
  solid.corner_ = corner;
  solid.rounding_ = rounding;
  // The farthest point is on the side on which the centre is.
  const Vec3 far = (pose.axes.transpose() * pose.center).cwiseAbs() + half;
  solid.reach_ = hypotenuse(far.head<2>().norm() + corner, far.z()) + rounding;
  return std::make_shared<const Solid>(std::move(solid));
}

std::shared_ptr<const Solid> Solid::box(const Vec3& edges, const Pose& pose) {
  return prism(0.5 * edges, 0.0, 0.0, pose);
}

std::shared_ptr<const Solid> Solid::cylinder(double radius, double height, const Pose& pose) {
  return prism({0.0, 0.0, 0.5 * height}, radius, 0.0, pose);
}

std::shared_ptr<const Solid> Solid::capsule(double radius, const Vec3& a, const Vec3& b) {
  const double length = (b - a).norm();
  Pose pose{0.5 * (a + b), Eigen::Matrix3d::Identity()};
  if (length > 0.0) {
    const Vec3 along = (b - a) / length;
    Eigen::Index least = 0;  // the axis from which it is farthest
    along.cwiseAbs().minCoeff(&least);
    const Vec3 side = Vec3::Unit(least).cross(along).normalized();
    pose.axes << along.cross(side), -side, along;
  }
  return prism({0.0, 0.0, 0.5 * length}, 0.0, radius, pose);
}

std::shared_ptr<const Solid> Solid::hull(std::vector<Vec3> vertices) {
  check(!vertices.empty(), "solid: a hull without a vertex");
  Solid solid;
  for (const Vec3& vertex : vertices) {
    check(vertex.allFinite(), "solid: a vertex that is not finite");
    solid.reach_ = std::max(solid.reach_, vertex.norm());
  }
  solid.vertices_ = std::move(vertices);
  const std::array<Vec3, kSlabs> all = directions();
  for (std::size_t i = 0; i < kSlabs; ++i) solid.slabs_[i] = {all[i], -solid.extent(-all[i]), solid.extent(all[i])};
  return std::make_shared<const Solid>(std::move(solid));
}

double Solid::extent(const Vec3& direction) const {
  if (is_hull()) {
    double most = -kInfinity;
    for (const Vec3& vertex : vertices_) most = std::max(most, direction.dot(vertex));
    return most;
  }
  const Vec3 own = pose_.axes.transpose() * direction;
  return direction.dot(pose_.center) + half_.dot(own.cwiseAbs()) + corner_ * own.head<2>().norm() +
         rounding_ * own.norm();
}

}  // namespace jink::planner::base
