// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

Vec3 PlacedSolid::outward(const Vec3& place) const {
  constexpr double kDifference = 1e-6;  // m
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 aside = kDifference * Vec3::Unit(axis);
    slope[axis] = distance(place + aside) - distance(place - aside);
  }
  const double length = slope.norm();
  return length > 0.0 ? Vec3(slope / length) : Vec3::UnitZ();
}

double PlacedSolid::extent(const Vec3& direction) const {
  // The solid is told at yaw 0: its axes there, and these, tell what was turned.
  const Eigen::Matrix3d yaw = axes_ * solid_->pose().axes.transpose();
  return solid_->extent(yaw.transpose() * direction);
}

}  // namespace jink::planner::horizon
