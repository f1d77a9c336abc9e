// SPDX-License-Identifier: BSD-3-Clause
#include "config/solids.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "planner/base/portable_math.hpp"

namespace jink::config {
namespace {

using planner::geometry::Sphere;

Sphere enclose(const SphereShape& shape) {
  return {Vec3::Zero(), shape.radius};
}
Sphere enclose(const BoxShape& shape) {
  return {Vec3::Zero(), 0.5 * shape.edges.norm()};
}
Sphere enclose(const CylinderShape& shape) {
  return {Vec3::Zero(), planner::base::hypotenuse(shape.radius, 0.5 * shape.height)};
}
Sphere enclose(const CapsuleShape& shape) {
  return {0.5 * (shape.a + shape.b), 0.5 * (shape.b - shape.a).norm() + shape.radius};
}
Sphere enclose(const VertexShape& shape) {
  return planner::geometry::smallest_enclosing_sphere(shape.vertices);
}

/// A shape in axes of its own as a solid about `center`.
struct MakeSolid {
  using Solid = planner::base::Solid;
  Eigen::Matrix3d axes;
  Vec3 center;

  std::shared_ptr<const Solid> operator()(const SphereShape& /*shape*/) const { return nullptr; }
  std::shared_ptr<const Solid> operator()(const BoxShape& shape) const {
    return Solid::box(shape.edges, {-center, axes});
  }
  std::shared_ptr<const Solid> operator()(const CylinderShape& shape) const {
    return Solid::cylinder(shape.radius, shape.height, {-center, axes});
  }
  std::shared_ptr<const Solid> operator()(const CapsuleShape& shape) const {
    return Solid::capsule(shape.radius, axes * shape.a - center, axes * shape.b - center);
  }
  std::shared_ptr<const Solid> operator()(const VertexShape& shape) const {
    std::vector<Vec3> vertices;
    vertices.reserve(shape.vertices.size());
    for (const Vec3& vertex : shape.vertices) vertices.emplace_back(axes * vertex - center);
    return Solid::hull(std::move(vertices));
  }
};

}  // namespace

Sphere bounding_sphere(const Shape& shape) {
  return std::visit([](const auto& s) { return enclose(s); }, shape);
}

Sphere bounding_sphere(const Obstacle& obstacle) {
  const Sphere own = bounding_sphere(obstacle.shape);
  if (obstacle.yaw_rate != 0.0) return {Vec3::Zero(), own.center.norm() + own.radius};
  return {axes_at(obstacle, 0.0) * own.center, own.radius};
}

std::shared_ptr<const planner::base::Solid> solid_of(const Obstacle& obstacle, const Vec3& center) {
  const MakeSolid make{axes_at(obstacle, 0.0), center};
  return std::visit([&](const auto& shape) { return make(shape); }, obstacle.shape);
}

Eigen::Matrix3d axes_at(const Obstacle& obstacle, double t) {
  if (obstacle.yaw_rate == 0.0 && obstacle.orientation.isZero(0.0)) return Eigen::Matrix3d::Identity();
  const double yaw = obstacle.orientation[0] + obstacle.yaw_rate * std::max(t, 0.0);
  return (Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(obstacle.orientation[1], Vec3::UnitY()) *
          Eigen::AngleAxisd(obstacle.orientation[2], Vec3::UnitX()))
      .toRotationMatrix();
}

std::vector<Obstacle> prisms(std::span<const planner::geometry::Vec2> polygon, double min, double max) {
  std::vector<Obstacle> all;
  for (const std::vector<planner::geometry::Vec2>& piece : planner::geometry::convex_pieces(polygon)) {
    Vec3 middle = Vec3::UnitZ() * (0.5 * (min + max));
    for (const planner::geometry::Vec2& corner : piece) middle.head<2>() += corner / static_cast<double>(piece.size());
    VertexShape hull;
    for (const planner::geometry::Vec2& corner : piece) {
      for (const double z : {min, max}) hull.vertices.push_back(Vec3(corner.x(), corner.y(), z) - middle);
    }
    all.push_back({std::move(hull), LinearMotion{middle}});
  }
  return all;
}

planner::base::Track track_at_rest(const Obstacle& obstacle) {
  const Sphere sphere = bounding_sphere(obstacle);
  planner::base::Track track;
  track.position = std::get<LinearMotion>(obstacle.motion).position + sphere.center;
  track.radius = sphere.radius;
  track.body.solid = solid_of(obstacle, sphere.center);
  return track;
}

std::shared_ptr<const planner::geometry::StaticMap> make_map(std::span<const Obstacle> solids) {
  std::vector<planner::base::Track> tracks;
  tracks.reserve(solids.size());
  for (const Obstacle& solid : solids) tracks.push_back(track_at_rest(solid));
  return std::make_shared<const planner::geometry::StaticMap>(std::move(tracks));
}

}  // namespace jink::config
