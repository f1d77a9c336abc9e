// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/shape_corners.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/world/shapes.hpp"

namespace jink::tools::report {
namespace {

constexpr int kRound = 32;   // corners of a circle
constexpr int kUpwards = 8;  // circles from a ball's middle to its pole

struct Corners {
  std::vector<Vec3> operator()(const config::SphereShape& /*sphere*/) const { return {}; }
  std::vector<Vec3> operator()(const config::BoxShape& box) const {
    std::vector<Vec3> corners;
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3 side((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5, (i & 4U) != 0 ? 0.5 : -0.5);
      corners.emplace_back(side.cwiseProduct(box.edges));
    }
    return corners;
  }
  std::vector<Vec3> operator()(const config::CylinderShape& cylinder) const {
    std::vector<Vec3> corners;
    for (const double z : {-0.5 * cylinder.height, 0.5 * cylinder.height}) add_circle(cylinder.radius, z, corners);
    return corners;
  }
  std::vector<Vec3> operator()(const config::CapsuleShape& capsule) const {
    std::vector<Vec3> ball;  // its upper half
    for (int k = 0; k < kUpwards; ++k) {
      const double angle = 0.5 * std::numbers::pi * k / kUpwards;
      add_circle(capsule.radius * std::cos(angle), capsule.radius * std::sin(angle), ball);
    }
    ball.emplace_back(0.0, 0.0, capsule.radius);
    const Eigen::Quaterniond along = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), capsule.b - capsule.a);
    std::vector<Vec3> corners;
    for (const Vec3& corner : ball) {
      corners.emplace_back(capsule.b + along * corner);
      corners.emplace_back(capsule.a + along * Vec3(corner.x(), corner.y(), -corner.z()));
    }
    return corners;
  }
  std::vector<Vec3> operator()(const config::VertexShape& hull) const { return hull.vertices; }

  static void add_circle(double radius, double z, std::vector<Vec3>& corners) {
    for (int k = 0; k < kRound; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kRound;
      corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
};

}  // namespace

std::vector<Vec3> shape_corners(const config::Obstacle& obstacle, double t) {
  std::vector<Vec3> corners = std::visit(Corners(), obstacle.shape);
  const Eigen::Matrix3d axes = sim::world::axes_at(obstacle, t);
  for (Vec3& corner : corners) corner = axes * corner;
  return corners;
}

std::vector<Vec3> solid_corners(const planner::base::Solid& solid) {
  if (solid.is_hull()) return {solid.vertices().begin(), solid.vertices().end()};
  std::vector<Vec3> corners;
  const bool round = solid.corner() + solid.rounding() > 0.0;
  const int around = round ? kRound : 4;
  const int upwards = solid.rounding() > 0.0 ? kUpwards : 0;
  for (int k = 0; k <= upwards; ++k) {
    const double rise = 0.5 * std::numbers::pi * k / kUpwards;
    const double beside = solid.corner() + solid.rounding() * std::cos(rise);
    const double above = solid.half().z() + solid.rounding() * std::sin(rise);
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / around;  // on neither axis, where two corners meet
      const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
      const Vec3 level(std::copysign(solid.half().x(), out.x()), std::copysign(solid.half().y(), out.y()), 0.0);
      for (const double side : {-1.0, 1.0})
        corners.emplace_back(solid.pose().center +
                             solid.pose().axes * (level + beside * out + Vec3(0.0, 0.0, side * above)));
    }
  }
  return corners;
}

}  // namespace jink::tools::report
