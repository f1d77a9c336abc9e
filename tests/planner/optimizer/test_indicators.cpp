// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/indicators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::planner::optimizer {
namespace {

// Reference (4,4): (1,3) covers 3·1; (2,1) covers (4−2)·(3−1) = 4 more; sum 7.
TEST(Hypervolume, IsTheUnionOfTheRectangles) {
  const std::vector<Point2> points{{2, 1}, {1, 3}};
  EXPECT_DOUBLE_EQ(hypervolume(points, {4, 4}), 7.0);
}

TEST(Hypervolume, IgnoresDominatedDuplicateAndOutlyingPoints) {
  const std::vector<Point2> points{{2, 1}, {1, 3}, {3, 3}, {2, 1}, {5, 0}, {0, 5}, {4, 4}};
  EXPECT_DOUBLE_EQ(hypervolume(points, {4, 4}), 7.0);
  EXPECT_DOUBLE_EQ(hypervolume(std::vector<Point2>{}, {4, 4}), 0.0);
}

TEST(Hypervolume, MatchesMonteCarlo) {
  base::RandomStream random(1);
  constexpr int kSamples = 20000;
  for (int round = 0; round < 20; ++round) {
    std::vector<Point2> points(1 + random.below(15));
    for (Point2& p : points) {
      p[0] = random.uniform(0.0, 1.2);
      p[1] = random.uniform(0.0, 1.2);
    }
    int hits = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double a = random.uniform(0.0, 1.1);
      const double b = random.uniform(0.0, 1.1);
      hits +=
          std::any_of(points.begin(), points.end(), [&](const Point2& p) { return p[0] <= a && p[1] <= b; }) ? 1 : 0;
    }
    const double estimate = 1.21 * hits / kSamples;
    EXPECT_NEAR(hypervolume(points, {1.1, 1.1}), estimate, 5.0 * 1.21 * 0.5 / std::sqrt(kSamples));
  }
}

// The true fronts: ZDT1, f2 = 1 − sqrt(f1): 0.1 + 2/3 + 0.1·1.1 = 0.8767. ZDT2, f2 = 1 − f1²: 0.1 + 1/3 + 0.11 =
// 0.5433.
TEST(Hypervolume, MatchesTheKnownValuesOfZdt) {
  std::vector<Point2> zdt1;
  std::vector<Point2> zdt2;
  constexpr int kPoints = 20000;
  for (int i = 0; i <= kPoints; ++i) {
    const double f1 = static_cast<double>(i) / kPoints;
    zdt1.push_back({f1, 1.0 - std::sqrt(f1)});
    zdt2.push_back({f1, 1.0 - f1 * f1});
  }
  EXPECT_NEAR(hypervolume(zdt1, {1.1, 1.1}), 0.1 + 2.0 / 3.0 + 0.11, 1e-4);
  EXPECT_NEAR(hypervolume(zdt2, {1.1, 1.1}), 0.1 + 1.0 / 3.0 + 0.11, 1e-4);
}

TEST(FrontBounds, AreIdealAndNadirOfTheNonDominated) {
  const std::vector<Point2> points{{1, 8}, {3, 2}, {9, 9}, {2, 4}};  // (9,9) is dominated
  const FrontBounds bounds = front_bounds(points);
  EXPECT_EQ(bounds.ideal, (Point2{1, 2}));
  EXPECT_EQ(bounds.nadir, (Point2{3, 8}));
}

TEST(Normalise, MapsIdealToZeroAndNadirToOne) {
  const FrontBounds bounds{{1, 2}, {3, 8}};
  EXPECT_EQ(normalise({1, 2}, bounds), (Point2{0, 0}));
  EXPECT_EQ(normalise({3, 8}, bounds), (Point2{1, 1}));
  EXPECT_EQ(normalise({2, 11}, bounds), (Point2{0.5, 1.5}));
  EXPECT_EQ(normalise({5, 5}, {{1, 2}, {1, 2}}), (Point2{0, 0}));
}

// Extents 1 of 2 and 3 of 4: sqrt((0.25 + 0.5625)/2).
TEST(MaximumSpread, ComparesExtents) {
  const std::vector<Point2> front{{1, 4}, {2, 1}};
  const std::vector<Point2> reference{{0, 4}, {2, 0}};
  EXPECT_DOUBLE_EQ(maximum_spread(front, reference), std::sqrt(0.8125 / 2.0));
  EXPECT_DOUBLE_EQ(maximum_spread(reference, reference), 1.0);
}

TEST(MaximumSpread, IsDefinedWithoutExtent) {
  const std::vector<Point2> reference{{0, 4}, {2, 0}};
  const std::vector<Point2> level{{0, 1}, {2, 1}};
  EXPECT_EQ(maximum_spread(std::vector<Point2>{{1, 1}}, reference), 0.0);
  EXPECT_DOUBLE_EQ(maximum_spread(level, level), 1.0);  // no extent in the second: counts 1
}

// Gaps 5 (3-4-5) and 10 (6-8-10): the largest over the mean is 10/7.5.
TEST(HoleRelativeSize, IsTheLargestGapOverTheMean) {
  const std::vector<Point2> front{{3, 8}, {0, 12}, {9, 0}, {9, 12}};  // the last is dominated
  EXPECT_DOUBLE_EQ(hole_relative_size(front), 10.0 / 7.5);
}

TEST(HoleRelativeSize, IsOneForEvenOrTinyFronts) {
  EXPECT_DOUBLE_EQ(hole_relative_size(std::vector<Point2>{{0, 3}, {1, 2}, {2, 1}, {3, 0}}), 1.0);
  EXPECT_EQ(hole_relative_size(std::vector<Point2>{{0, 3}, {5, 1}}), 1.0);
  EXPECT_EQ(hole_relative_size(std::vector<Point2>{{1, 1}, {1, 1}, {1, 1}}), 1.0);
  EXPECT_EQ(hole_relative_size(std::vector<Point2>{}), 1.0);
}

TEST(StraightLineRate, IsLengthOverStraightDistance) {
  EXPECT_DOUBLE_EQ(straight_line_rate(12.0, 10.0), 1.2);
  EXPECT_EQ(straight_line_rate(0.0, 0.0), 1.0);
  EXPECT_EQ(straight_line_rate(1.0, 0.0), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace jink::planner::optimizer
