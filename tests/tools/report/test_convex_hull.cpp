// SPDX-License-Identifier: BSD-3-Clause
// The hull that is drawn: closed, outside of all points, seen from outside; and what has no volume.
#include "tools/report/convex_hull.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "planner/base/random.hpp"

namespace jink::tools::report {
namespace {

/// Six times the volume that the triangles enclose, positive if they are seen from outside.
double volume6(const std::vector<Vec3>& points, const std::vector<Triangle>& faces) {
  double sum = 0.0;
  for (const auto& [a, b, c] : faces) sum += points[a].dot(points[b].cross(points[c]));
  return sum;
}

/// Every edge belongs to two faces, which run along it in opposite directions.
bool closed(const std::vector<Triangle>& faces) {
  std::set<std::pair<std::size_t, std::size_t>> edges;
  for (const Triangle& f : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!edges.emplace(f[k], f[(k + 1) % 3]).second) return false;
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) { return edges.contains({e.second, e.first}); });
}

/// The farthest that any point stands out of any face.
double overhang(const std::vector<Vec3>& points, const std::vector<Triangle>& faces) {
  double most = 0.0;
  for (const auto& [a, b, c] : faces) {
    const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    for (const Vec3& p : points) most = std::max(most, normal.dot(p - points[a]));
  }
  return most;
}

TEST(ConvexHull, OfACubeWithPointsInsideAndOnItsFaces) {
  std::vector<Vec3> points{{0.5, 0.5, 0.5}, {0.5, 0.5, 1.0}, {0.2, 0.7, 0.4}};
  for (const unsigned i : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U})
    points.emplace_back((i & 1U) != 0 ? 1.0 : 0.0, (i & 2U) != 0 ? 1.0 : 0.0, (i & 4U) != 0 ? 1.0 : 0.0);
  const auto faces = convex_hull(points);
  EXPECT_NEAR(volume6(points, faces), 6.0, 1e-12);
  EXPECT_TRUE(closed(faces));
  for (const Triangle& face : faces)
    EXPECT_EQ(std::count(face.begin(), face.end(), 0U), 0) << "the middle is no corner";
}

TEST(ConvexHull, ContainsAllPointsAndIsClosed) {
  planner::base::RandomStream random(7, 0);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> points;
    const int count = 4 + round % 40;
    for (int i = 0; i < count; ++i)
      points.emplace_back(random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0), random.uniform(0.0, 5.0));
    const auto faces = convex_hull(points);
    ASSERT_TRUE(closed(faces)) << round;
    ASSERT_LT(overhang(points, faces), 1e-7) << round;
    ASSERT_GT(volume6(points, faces), 0.0) << round;
  }
}

TEST(ConvexHull, OfWhatHasNoVolume) {
  EXPECT_EQ(convex_hull(std::vector<Vec3>{{1, 2, 3}}), (std::vector<Triangle>{{0, 0, 0}}));
  EXPECT_EQ(convex_hull(std::vector<Vec3>{{1, 2, 3}, {1, 2, 3}}), (std::vector<Triangle>{{0, 0, 0}}));
  const auto line = convex_hull(std::vector<Vec3>{{1, 1, 1}, {0, 0, 0}, {3, 3, 3}, {2, 2, 2}});
  ASSERT_EQ(line.size(), 1U);
  EXPECT_EQ((std::set<std::size_t>(line[0].begin(), line[0].end())), (std::set<std::size_t>{1, 2}));
  // A square with a point inside: two triangles, from both sides.
  const std::vector<Vec3> square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.4, 1}};
  const auto flat = convex_hull(square);
  EXPECT_EQ(flat.size(), 4U);
  double area2 = 0.0;
  for (const auto& [a, b, c] : flat) area2 += (square[b] - square[a]).cross(square[c] - square[a]).norm();
  EXPECT_NEAR(area2, 4.0, 1e-12);  // twice the area, twice
}

}  // namespace
}  // namespace jink::tools::report
