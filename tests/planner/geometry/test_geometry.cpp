// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/geometry.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "planner/base/random.hpp"

namespace jink::planner::geometry {
namespace {

Vec3 random_point(base::RandomStream& random, double range) {
  const double x = random.uniform(-range, range);
  const double y = random.uniform(-range, range);
  return {x, y, random.uniform(-range, range)};
}

// a = (0,0,0), b = (2,0,0), c = (1,1,0): A = 4, B = 2·(2·(0−1)) = −4, C = 1 + 1 − r².
TEST(LineDiscriminant, HasTheSignOfTheIntersection) {
  const Vec3 a(0, 0, 0);
  const Vec3 b(2, 0, 0);
  const Vec3 center(1, 1, 0);
  EXPECT_DOUBLE_EQ(line_discriminant(a, b, center, 0.5), -12.0);  // 16 − 16·1.75: misses
  EXPECT_DOUBLE_EQ(line_discriminant(a, b, center, 1.0), 0.0);    // 16 − 16·1: tangent
  EXPECT_DOUBLE_EQ(line_discriminant(a, b, center, 1.5), 20.0);   // 16 + 16·0.25: cuts
}

// a = (0,0,0), b = (2,0,0), c = (−5,0,0), r = 0.5: A = 4, B = 2·2·5 = 20, C = 25 − 0.25; 400 − 16·24.75 = 4.
TEST(LineDiscriminant, SeesTheInfiniteLineBehindTheSegment) {
  EXPECT_DOUBLE_EQ(line_discriminant({0, 0, 0}, {2, 0, 0}, {-5, 0, 0}, 0.5), 4.0);
}

// a = (0,0,0), b = (−2,0,1), c = (−1,0,0.5), r = 0.5: A = 5, B = 2·(−2·1 + 1·(−0.5)) = −5, C = 1.25 − 0.25 = 1;
// 25 − 20 = 5. With the absolute values of Eq. (8) as printed B = 2·(2 − 0.5) = 3 and 9 − 20 = −11: a miss.
TEST(LineDiscriminant, KeepsTheDirectionOfABackwardSegment) {
  EXPECT_DOUBLE_EQ(line_discriminant({0, 0, 0}, {-2, 0, 1}, {-1, 0, 0.5}, 0.5), 5.0);
}

// B² − 4AC = 4A(r² − d²), d the distance of the centre from the line.
TEST(LineDiscriminant, EqualsFourATimesRadiusSquaredMinusDistanceSquared) {
  base::RandomStream random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = random_point(random, 10.0);
    const Vec3 b = random_point(random, 10.0);
    const Vec3 center = random_point(random, 10.0);
    const double radius = random.uniform(0.1, 5.0);
    const double distance = (center - a).cross((b - a).normalized()).norm();
    const double expected = 4.0 * (b - a).squaredNorm() * (radius * radius - distance * distance);
    EXPECT_NEAR(line_discriminant(a, b, center, radius), expected, 1e-8 * (1.0 + std::abs(expected)));
  }
}

TEST(SweptDistance, IsZeroWhereCrossingPathsMeetAtTheSameTime) {
  // Both are at (1,0,0) at t = 0.5.
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {2, 0, 0}, {1, -1, 0}, {1, 1, 0}), 0.0, 1e-15);
}

// Relative position (−1,1,0) + t·(2,−4,0): t* = (2 + 4)/20 = 0.3, (−0.4, −0.2, 0), 0.16 + 0.04 = 0.2.
TEST(SweptDistance, OfACrossingAtDifferentTimesIsTheRelativeQuadraticsMinimum) {
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {2, 0, 0}, {1, -1, 0}, {1, 3, 0}), 0.2, 1e-15);
}

TEST(SweptDistance, OfHeadOnMotionCountsTheSegmentAlone) {
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {2, 0, 0}, {5, 0, 0}, {3, 0, 0}), 1.0, 1e-15);  // would meet later
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 0, 0}), 0.0, 1e-15);  // pass at t = 0.75
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {5, 0, 0}), 1.0, 1e-15);  // receding
}

// The obstacle overtakes from x = −1 to 3, 2 m to the side: level at the same x at t = 1/3.
TEST(SweptDistance, OfAnOvertakerIsTheLateralDistance) {
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {1, 0, 0}, {-1, 2, 0}, {3, 2, 0}), 4.0, 1e-15);
}

TEST(SweptDistance, StaysTheSameWithoutRelativeMotion) {
  EXPECT_DOUBLE_EQ(swept_distance_squared({0, 0, 0}, {3, 1, 0}, {0, 2, 1}, {3, 3, 1}), 5.0);  // parallel, equal speed
  EXPECT_DOUBLE_EQ(swept_distance_squared({1, 1, 1}, {1, 1, 1}, {1, 1, 3}, {1, 1, 3}), 4.0);  // both at rest
}

TEST(SweptDistance, SeesAnObstacleThatIsFarAwayAtBothEnds) {
  EXPECT_NEAR(swept_distance_squared({0, 0, 0}, {0, 0, 0}, {1000, 0.5, 0}, {-1000, 0.5, 0}), 0.25, 1e-12);
}

TEST(SweptDistance, IsTheMinimumOfDenseSamples) {
  base::RandomStream random(2);
  constexpr int kSamples = 400;
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = random_point(random, 5.0);
    const Vec3 b = random_point(random, 5.0);
    const Vec3 c = random_point(random, 5.0);
    const Vec3 d = random_point(random, 5.0);
    double sampled = base::kInfinity;
    for (int n = 0; n <= kSamples; ++n) {
      const double t = static_cast<double>(n) / kSamples;
      sampled = std::min(sampled, ((a + t * (b - a)) - (c + t * (d - c))).norm());
    }
    const double exact = std::sqrt(swept_distance_squared(a, b, c, d));
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_GE(exact, sampled - ((b - d) - (a - c)).norm() / kSamples);  // the distance changes no faster than this
  }
}

void expect_right_handed(const PathFrame& frame, double tolerance) {
  EXPECT_NEAR(frame.axis.norm(), 1.0, tolerance);
  EXPECT_NEAR(frame.left.norm(), 1.0, tolerance);
  EXPECT_NEAR(frame.up.norm(), 1.0, tolerance);
  EXPECT_NEAR(frame.axis.dot(frame.left), 0.0, tolerance);
  EXPECT_NEAR(frame.axis.dot(frame.up), 0.0, tolerance);
  EXPECT_NEAR(frame.left.dot(frame.up), 0.0, tolerance);
  EXPECT_NEAR(frame.axis.cross(frame.left).dot(frame.up), 1.0, tolerance);
}

TEST(PathFrame, IsEastNorthUpForAMissionToTheEast) {
  const PathFrame frame({1, 2, 3}, {5, 2, 3});
  EXPECT_EQ(frame.axis, Vec3::UnitX());
  EXPECT_EQ(frame.left, Vec3::UnitY());
  EXPECT_EQ(frame.up, Vec3::UnitZ());
  EXPECT_DOUBLE_EQ(frame.length, 4.0);
}

TEST(PathFrame, LooksBackwardWithUpStillUp) {
  const PathFrame frame({0, 0, 0}, {-2, 0, 0});
  expect_right_handed(frame, 1e-15);
  EXPECT_EQ(frame.axis, -Vec3::UnitX());
  EXPECT_EQ(frame.left, -Vec3::UnitY());
  EXPECT_EQ(frame.up, Vec3::UnitZ());
}

TEST(PathFrame, HasLeftNorthForAVerticalMission) {
  for (const double end : {4.0, -4.0}) {
    const PathFrame frame({1, 1, 1}, {1, 1, 1 + end});
    expect_right_handed(frame, 1e-15);
    EXPECT_EQ(frame.left, Vec3::UnitY());
    EXPECT_DOUBLE_EQ(frame.length, 4.0);
  }
}

TEST(PathFrame, PointsEastWhereStartAndTargetCoincide) {
  const PathFrame frame({1, 2, 3}, {1, 2, 3});
  expect_right_handed(frame, 1e-15);
  EXPECT_EQ(frame.axis, Vec3::UnitX());
  EXPECT_DOUBLE_EQ(frame.length, 0.0);
  EXPECT_EQ(frame.to_enu({1, 0, 0}), Vec3(2, 2, 3));
}

TEST(PathFrame, StaysOrthonormalJustOffTheVertical) {
  for (const double lean : {1e-3, 1e-5, 1e-6, 1e-7, 1e-9}) expect_right_handed({{0, 0, 0}, {lean, lean, 1}}, 2e-6);
}

TEST(PathFrame, IsOrthonormalWithLevelLeftAndInvertible) {
  base::RandomStream random(3);
  for (int i = 0; i < 500; ++i) {
    const PathFrame frame(random_point(random, 10.0), random_point(random, 10.0));
    expect_right_handed(frame, 1e-12);
    EXPECT_NEAR(frame.left.z(), 0.0, 1e-15);
    EXPECT_GE(frame.up.z(), 0.0);
    const Vec3 p = random_point(random, 10.0);
    EXPECT_LT((frame.to_enu(frame.from_enu(p)) - p).norm(), 1e-12);
  }
}

TEST(AngleBetween, MatchesKnownAngles) {
  EXPECT_DOUBLE_EQ(angle_between({1, 0, 0}, {5, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(angle_between({1, 0, 0}, {0, 2, 0}), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(angle_between({1, 0, 0}, {-3, 0, 0}), std::numbers::pi);
  EXPECT_DOUBLE_EQ(angle_between({1, 0, 0}, {1, 0, 1}), std::numbers::pi / 4);
}

TEST(AngleBetween, IsAccurateForTinyAngles) {
  // acos of the dot product would give 0 or 1.5e-8 here.
  EXPECT_NEAR(angle_between({1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-20);
}

TEST(AngleBetween, IsZeroWithoutADirection) {
  EXPECT_EQ(angle_between({0, 0, 0}, {1, 0, 0}), 0.0);
  EXPECT_EQ(angle_between({1, 0, 0}, {-1e-10, 0, 0}), 0.0);
}

}  // namespace
}  // namespace jink::planner::geometry
