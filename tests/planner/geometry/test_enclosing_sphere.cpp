// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/enclosing_sphere.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::planner::geometry {
namespace {

using Points = std::vector<Vec3>;

/// The sphere through two, three or four points by textbook formulas that share nothing with the code under test.
std::optional<Sphere> sphere_through(const Points& p) {
  if (p.size() == 2) return Sphere{0.5 * (p[0] + p[1]), 0.5 * (p[1] - p[0]).norm()};
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[2] - p[0];
  const Vec3 normal = a.cross(b);
  if (p.size() == 3) {
    if (normal.norm() < 1e-9) return std::nullopt;
    const Vec3 x = (a.squaredNorm() * b.cross(normal) + b.squaredNorm() * normal.cross(a)) / (2 * normal.squaredNorm());
    return Sphere{p[0] + x, x.norm()};
  }
  const Vec3 c = p[3] - p[0];
  Eigen::Matrix3d rows;
  rows << a.transpose(), b.transpose(), c.transpose();
  if (std::abs(rows.determinant()) < 1e-9) return std::nullopt;
  const Vec3 x = rows.inverse() * Vec3(0.5 * a.squaredNorm(), 0.5 * b.squaredNorm(), 0.5 * c.squaredNorm());
  return Sphere{p[0] + x, x.norm()};
}

bool contains_all(const Sphere& sphere, const Points& points, double slack) {
  for (const Vec3& p : points) {
    if ((p - sphere.center).norm() > sphere.radius + slack) return false;
  }
  return true;
}

/// The smallest of all spheres through pairs, triples and quadruples that contain every point.
double brute_force_radius(const Points& points) {
  double best = base::kInfinity;
  const auto consider = [&](const Points& subset) {
    const std::optional<Sphere> sphere = sphere_through(subset);
    if (sphere && contains_all(*sphere, points, 1e-9)) best = std::min(best, sphere->radius);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      consider({points[i], points[j]});
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        consider({points[i], points[j], points[k]});
        for (std::size_t l = k + 1; l < points.size(); ++l) consider({points[i], points[j], points[k], points[l]});
      }
    }
  }
  return best;
}

void expect_sphere(const Points& points, const Vec3& center, double radius, double tolerance = 1e-12) {
  const Sphere sphere = smallest_enclosing_sphere(points);
  EXPECT_NEAR((sphere.center - center).norm(), 0.0, tolerance);
  EXPECT_NEAR(sphere.radius, radius, tolerance);
  EXPECT_TRUE(contains_all(sphere, points, 0.0));
}

TEST(EnclosingSphere, SinglePointAndDuplicates) {
  expect_sphere({{1, -2, 3}}, {1, -2, 3}, 0.0);
  expect_sphere({{1, -2, 3}, {1, -2, 3}, {1, -2, 3}}, {1, -2, 3}, 0.0);
}

TEST(EnclosingSphere, TwoPoints) {
  expect_sphere({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}}, {1, 0, 0}, 1.0);
}

TEST(EnclosingSphere, CollinearPointsUseTheEnds) {
  expect_sphere({{1, 1, 1}, {0, 0, 0}, {3, 3, 3}, {2, 2, 2}, {0.5, 0.5, 0.5}}, {1.5, 1.5, 1.5}, 1.5 * std::sqrt(3.0));
}

TEST(EnclosingSphere, AcuteTriangleUsesThreePointsAndObtuseTwo) {
  expect_sphere({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(3.0) / 2, 0}}, {0.5, std::sqrt(3.0) / 6, 0},
                1.0 / std::sqrt(3.0));
  expect_sphere({{0, 0, 0}, {4, 0, 0}, {2, 0.5, 0}}, {2, 0, 0}, 2.0);
}

TEST(EnclosingSphere, RegularTetrahedron) {
  expect_sphere({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {0, 0, 0}, std::sqrt(3.0));
}

// The contract's example: the right angle makes the far face's circle the support, so that the origin is inside.
TEST(EnclosingSphere, CornerTetrahedron) {
  expect_sphere({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, Vec3::Constant(1.0 / 3.0), std::sqrt(2.0 / 3.0));
}

TEST(EnclosingSphere, BoxCorners) {
  Points corners;
  for (const double x : {0.0, 2.0}) {
    for (const double y : {0.0, 4.0}) {
      for (const double z : {0.0, 4.0}) corners.emplace_back(x, y, z);
    }
  }
  expect_sphere(corners, {1, 2, 2}, 3.0);
}

TEST(EnclosingSphere, CoplanarCocircularPoints) {
  Points circle;
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * M_PI * i / 24;
    circle.emplace_back(5 + 2 * std::cos(angle), 1 + 2 * std::sin(angle), -3);
  }
  expect_sphere(circle, {5, 1, -3}, 2.0, 1e-11);
}

TEST(EnclosingSphere, IsMinimalComparedWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    base::RandomStream random(11, seed);
    Points points(2 + random.below(9));
    // Grid coordinates every other time: many duplicates, collinear, coplanar and cospherical points.
    const bool grid = seed % 2 == 0;
    for (Vec3& p : points) {
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = grid ? static_cast<double>(random.below(4)) : random.uniform(-2, 2);
      }
    }
    const Sphere sphere = smallest_enclosing_sphere(points);
    EXPECT_TRUE(contains_all(sphere, points, 0.0)) << seed;
    EXPECT_NEAR(sphere.radius, brute_force_radius(points), 2e-9) << seed;
  }
}

// Minimal sphere, stated as optimality: the centre is a convex combination of points on the surface. Tested by moving
// the centre a little in every direction, which must move it away from some point.
TEST(EnclosingSphere, ManyPointsOnASphereFarFromTheOrigin) {
  base::RandomStream random(12);
  const Vec3 center(1000, -2000, 500);
  Points points(500);
  for (Vec3& p : points) p = center + 3.0 * Vec3(random.normal(), random.normal(), random.normal()).normalized();
  const Sphere sphere = smallest_enclosing_sphere(points);
  EXPECT_TRUE(contains_all(sphere, points, 0.0));
  EXPECT_LE(sphere.radius, 3.0 + 1e-9);
  for (int i = 0; i < 200; ++i) {
    const Vec3 direction = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    double reach = 0.0;
    for (const Vec3& p : points) reach = std::max(reach, (p - (sphere.center + 1e-3 * direction)).norm());
    EXPECT_GT(reach, sphere.radius);
  }
}

TEST(EnclosingSphere, NearlyDegenerateSets) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    base::RandomStream random(13, seed);
    const double flat = std::pow(10.0, -random.uniform(3, 16));
    Points points(3 + random.below(30));
    for (Vec3& p : points) p = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), flat * random.uniform(-1, 1));
    const Sphere sphere = smallest_enclosing_sphere(points);
    // The flattened set's sphere bounds the radius from both sides.
    Points level = points;
    for (Vec3& p : level) p.z() = 0;
    const double level_radius = smallest_enclosing_sphere(level).radius;
    EXPECT_TRUE(contains_all(sphere, points, 0.0)) << seed;
    EXPECT_GE(sphere.radius, level_radius * (1 - 1e-12)) << seed;
    EXPECT_LE(sphere.radius, std::hypot(level_radius, flat) * (1 + 1e-12)) << seed;
  }
}

}  // namespace
}  // namespace jink::planner::geometry
