// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/sim/world/random_obstacles.hpp"

namespace jink::sim::world {
namespace {

using planner::base::RandomStream;

const Vec3 kOrigin = Vec3::Zero();

/// The contract's example: the corner of a cube.
const config::VertexShape kCorner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

config::VertexShape corners_of(const config::BoxShape& box) {
  config::VertexShape shape;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) shape.vertices.push_back(box.edges.cwiseProduct(Vec3(x, y, z)));
    }
  }
  return shape;
}

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double square = (b - a).squaredNorm();
  const double u = square > 0 ? std::clamp((p - a).dot(b - a) / square, 0.0, 1.0) : 0.0;
  return (p - a - u * (b - a)).norm();
}

double to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double edges = std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
  const Vec3 normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-9) return edges;
  const Vec3 foot = p - (p - a).dot(normal) / normal.squaredNorm() * normal;
  const bool within = (b - a).cross(foot - a).dot(normal) >= 0 && (c - b).cross(foot - b).dot(normal) >= 0 &&
                      (a - c).cross(foot - c).dot(normal) >= 0;
  return within ? (p - foot).norm() : edges;
}

bool in_tetrahedron(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Eigen::Matrix3d edges;
  edges << b - a, c - a, d - a;
  if (std::abs(edges.determinant()) < 1e-12) return false;
  const Vec3 weights = edges.inverse() * (p - a);
  return weights.minCoeff() >= 0 && weights.sum() <= 1;
}

/// Every point of a hull is in a tetrahedron of its vertices, every point of its surface in a triangle (Carathéodory).
double brute_force_hull(const std::vector<Vec3>& v, const Vec3& p) {
  double best = planner::base::kInfinity;
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k <= j; ++k) {
        best = std::min(best, to_triangle(p, v[i], v[j], v[k]));
        for (std::size_t l = 0; l < k; ++l) {
          if (in_tetrahedron(p, v[i], v[j], v[k], v[l])) return 0.0;
        }
      }
    }
  }
  return best;
}

TEST(BoundingSphere, OfEachShape) {
  EXPECT_EQ(bounding_sphere(config::SphereShape{0.5}).radius, 0.5);
  EXPECT_EQ(bounding_sphere(config::SphereShape{0.5}).center, kOrigin);
  EXPECT_DOUBLE_EQ(bounding_sphere(config::BoxShape{{2, 4, 4}}).radius, 3.0);
  EXPECT_EQ(bounding_sphere(config::BoxShape{{2, 4, 4}}).center, kOrigin);
  EXPECT_DOUBLE_EQ(bounding_sphere(config::CylinderShape{3, 8}).radius, 5.0);
  EXPECT_DOUBLE_EQ(bounding_sphere(config::CapsuleShape{0.5, {0, 0, 0}, {4, 0, 0}}).radius, 2.5);
  EXPECT_EQ(bounding_sphere(config::CapsuleShape{0.5, {0, 0, 0}, {4, 0, 0}}).center, Vec3(2, 0, 0));
  const Sphere corner = bounding_sphere(kCorner);
  EXPECT_NEAR(corner.radius, std::sqrt(2.0 / 3.0), 1e-14);
  EXPECT_NEAR((corner.center - Vec3::Constant(1.0 / 3.0)).norm(), 0.0, 1e-14);
}

TEST(SphereDistance, OutsideOnAndInside) {
  const config::Shape shape = config::SphereShape{2.0};
  EXPECT_DOUBLE_EQ(distance(shape, {1, 1, 1}, {1, 1, 6}), 3.0);
  EXPECT_DOUBLE_EQ(distance(shape, {1, 1, 1}, {3, 1, 1}), 0.0);
  EXPECT_DOUBLE_EQ(distance(shape, {1, 1, 1}, {1, 1, 1}), -2.0);
}

TEST(BoxDistance, FaceEdgeCornerAndInside) {
  const config::Shape shape = config::BoxShape{{2, 4, 6}};
  const Vec3 reference(10, 0, 0);
  EXPECT_DOUBLE_EQ(distance(shape, reference, {13, 1, 2}), 2.0);        // face x
  EXPECT_DOUBLE_EQ(distance(shape, reference, {14, 6, 0}), 5.0);        // edge: 3 and 4 beyond
  EXPECT_DOUBLE_EQ(distance(shape, reference, {10 - 2, -4, -5}), 3.0);  // corner: 1, 2, 2 beyond
  EXPECT_DOUBLE_EQ(distance(shape, reference, {10, 0, 0}), -1.0);       // the way out is along x
  EXPECT_DOUBLE_EQ(distance(shape, reference, {10, 1.75, 0}), -0.25);   // along y
  EXPECT_DOUBLE_EQ(distance(shape, reference, {11, 0.5, 0.5}), 0.0);
}

TEST(CylinderDistance, SideLidRimAndInside) {
  const config::Shape shape = config::CylinderShape{2.0, 6.0};
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {3, 4, 1}), 3.0);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {1, 1, -4}), 1.0);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {0, 5, 7}), 5.0);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {1.5, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {0, 0, 2.75}), -0.25);
  EXPECT_DOUBLE_EQ(distance(shape, {0, 0, 3}, {0, 0, 3}), deepest(shape));
}

TEST(CapsuleDistance, SideEndAndInside) {
  const config::Shape shape = config::CapsuleShape{0.5, {0, 0, 0}, {4, 0, 0}};
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {1, 3, 4}), 4.5);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {7, 4, 0}), 4.5);
  EXPECT_DOUBLE_EQ(distance(shape, kOrigin, {2, 0, 0.25}), -0.25);
  EXPECT_DOUBLE_EQ(segment_distance(shape, kOrigin, {2, -1, 2}, {2, 1, 2}).distance, 1.5);
  EXPECT_DOUBLE_EQ(distance(config::CapsuleShape{0.5, {1, 0, 0}, {1, 0, 0}}, kOrigin, {1, 0, 2}), 1.5);
}

TEST(HullDistance, VertexEdgeFaceAndInside) {
  const config::Shape shape = kCorner;
  EXPECT_NEAR(distance(shape, {5, 5, 5}, {8, 5, 5}), 2.0, 1e-12);                 // vertex x
  EXPECT_NEAR(distance(shape, kOrigin, {0.5, -3, -4}), 5.0, 1e-12);               // edge on the x axis
  EXPECT_NEAR(distance(shape, kOrigin, {0.25, 0.25, -2}), 2.0, 1e-12);            // face z = 0
  EXPECT_NEAR(distance(shape, kOrigin, {1, 1, 1}), 2.0 / std::sqrt(3.0), 1e-12);  // slanted face
  EXPECT_EQ(distance(shape, kOrigin, {0.1, 0.1, 0.1}), 0.0);
}

TEST(HullDistance, DegenerateHulls) {
  const config::Shape point = config::VertexShape{{{1, 0, 0}}};
  EXPECT_DOUBLE_EQ(distance(point, kOrigin, {4, 4, 0}), 5.0);
  const config::Shape duplicates = config::VertexShape{{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}};
  EXPECT_DOUBLE_EQ(distance(duplicates, kOrigin, {4, 4, 0}), 5.0);
  const config::Shape line = config::VertexShape{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {4, 0, 0}}};
  EXPECT_NEAR(distance(line, kOrigin, {3, 0, 2}), 2.0, 1e-12);
  EXPECT_EQ(distance(line, kOrigin, {3, 0, 0}), 0.0);
  const config::Shape square = config::VertexShape{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}}};
  EXPECT_NEAR(distance(square, kOrigin, {0.3, 0.6, -2}), 2.0, 1e-12);
  EXPECT_NEAR(distance(square, kOrigin, {4, 5, 0}), 5.0, 1e-12);
}

TEST(HullDistance, EqualsBruteForce) {
  int inside = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    RandomStream random(21, seed);
    config::VertexShape shape;
    const std::uint64_t count = 1 + random.below(9);
    const bool grid = seed % 3 == 0;  // duplicates, collinear and coplanar vertices, points on faces
    const auto coordinate = [&] { return grid ? static_cast<double>(random.below(4)) : random.uniform(0, 3); };
    for (std::uint64_t i = 0; i < count; ++i) {
      const double x = coordinate();
      const double y = coordinate();
      shape.vertices.emplace_back(x, y, coordinate());
    }
    const Vec3 point = grid ? Vec3(coordinate(), coordinate(), coordinate()) : testing::random_vector(random, -2, 5);
    const double expected = brute_force_hull(shape.vertices, point);
    EXPECT_NEAR(distance(shape, kOrigin, point), expected, 1e-9) << seed;
    if (expected == 0.0) ++inside;
  }
  EXPECT_GT(inside, 50);
}

TEST(HullDistance, OfABoxesCornersEqualsTheBoxOutside) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    RandomStream random(22, seed);
    const config::BoxShape box{testing::random_vector(random, 0.01, 3)};
    const Vec3 point = testing::random_vector(random, -4, 4);
    EXPECT_NEAR(distance(corners_of(box), kOrigin, point), std::max(distance(box, kOrigin, point), 0.0), 1e-11) << seed;
  }
}

TEST(HullDistance, StaysAccurateForSlivers) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    RandomStream random(23, seed);
    const config::BoxShape box{{1.0, std::pow(10.0, -random.uniform(0, 9)), std::pow(10.0, -random.uniform(0, 9))}};
    const Vec3 point = testing::random_vector(random, -1, 1);
    EXPECT_NEAR(distance(corners_of(box), kOrigin, point), std::max(distance(box, kOrigin, point), 0.0), 1e-10) << seed;
  }
}

TEST(SegmentDistance, WorkedByHand) {
  const SegmentDistance sphere = segment_distance(config::SphereShape{1.0}, kOrigin, {-4, 3, 0}, {4, 3, 0});
  EXPECT_DOUBLE_EQ(sphere.distance, 2.0);
  EXPECT_DOUBLE_EQ(sphere.fraction, 0.5);
  // Through a box off its centre: deepest where the two nearest faces are equally far, anywhere on a plateau of -0.25.
  const SegmentDistance box = segment_distance(config::BoxShape{{2, 2, 2}}, kOrigin, {-4, 0.75, 0}, {4, 0.75, 0});
  EXPECT_DOUBLE_EQ(box.distance, -0.25);
  // Past an edge: the nearest point of the diagonal way is its middle (2, 2), 1 and 1 beyond.
  const SegmentDistance edge = segment_distance(config::BoxShape{{2, 2, 2}}, kOrigin, {0, 4, 0}, {4, 0, 0});
  EXPECT_DOUBLE_EQ(edge.distance, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(edge.fraction, 0.5);
  const SegmentDistance hull = segment_distance(kCorner, kOrigin, {1, 1, 4}, {1, 1, -4});
  EXPECT_NEAR(hull.distance, std::sqrt(0.5), 1e-12);  // the edge from x to y, at z = 0
  EXPECT_NEAR(hull.fraction, 0.5, 1e-12);
  EXPECT_EQ(segment_distance(kCorner, kOrigin, {0.2, 0.2, 4}, {0.2, 0.2, -4}).distance, 0.0);
}

// A minimum that is attained where it says, and that no sample is below.
TEST(SegmentDistance, IsTheMinimumOfTheDistance) {
  for (std::uint64_t seed = 0; seed < 900; ++seed) {
    RandomStream random(24, seed);
    const config::Shape shape = testing::random_shape(random, seed % testing::kShapeKinds);
    const Vec3 reference = testing::random_vector(random, -1, 1);
    const Vec3 begin = testing::random_vector(random, -3, 3);
    Vec3 end = testing::random_vector(random, -3, 3);
    if (seed % 5 == 0) end = begin;
    if (seed % 5 == 1) end.tail<2>() = begin.tail<2>();  // along an axis
    const SegmentDistance found = segment_distance(shape, reference, begin, end);
    ASSERT_GE(found.fraction, 0.0);
    ASSERT_LE(found.fraction, 1.0);
    EXPECT_NEAR(distance(shape, reference, begin + found.fraction * (end - begin)), found.distance, 1e-9) << seed;
    for (int i = 0; i <= 100; ++i) {
      EXPECT_GE(distance(shape, reference, begin + i / 100.0 * (end - begin)), found.distance - 1e-9) << seed;
    }
    EXPECT_GE(found.distance, deepest(shape) - 1e-12);
  }
}

TEST(ShapeDistance, TrueShapeIsWithinItsBoundingSphere) {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    RandomStream random(25, seed);
    const config::Shape shape = testing::random_shape(random, seed % testing::kShapeKinds);
    const Vec3 point = testing::random_vector(random, -4, 4);
    const Sphere sphere = bounding_sphere(shape);
    EXPECT_GE(distance(shape, kOrigin, point), (point - sphere.center).norm() - sphere.radius - 1e-9) << seed;
  }
}

TEST(Deepest, IsTheDistanceAtTheCentre) {
  EXPECT_DOUBLE_EQ(deepest(config::SphereShape{2.0}), -2.0);
  EXPECT_DOUBLE_EQ(deepest(config::BoxShape{{2, 4, 1}}), distance(config::BoxShape{{2, 4, 1}}, kOrigin, kOrigin));
  EXPECT_DOUBLE_EQ(deepest(kCorner), 0.0);
}

}  // namespace
}  // namespace jink::sim::world
