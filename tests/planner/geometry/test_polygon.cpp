// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::planner::geometry {
namespace {

using Corners = std::vector<Vec2>;

double area(const Corners& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % corners.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

/// By the crossings of a ray, which shares nothing with the code under test.
bool inside(const Corners& corners, const Vec2& p) {
  bool in = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % corners.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      in = !in;
  }
  return in;
}

bool convex(const Corners& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corners three{corners[i], corners[(i + 1) % corners.size()], corners[(i + 2) % corners.size()]};
    if (!(area(three) > 0.0)) return false;
  }
  return true;
}

void expect_cut_well(const Corners& corners) {
  const std::vector<Corners> pieces = convex_pieces(corners);
  double sum = 0.0;
  for (const Corners& piece : pieces) {
    EXPECT_TRUE(convex(piece));
    sum += area(piece);
  }
  EXPECT_NEAR(sum, std::abs(area(corners)), 1e-9 * std::abs(area(corners)));
  base::RandomStream random(7);
  for (int n = 0; n < 200; ++n) {
    const Vec2 p(random.uniform(-6, 6), random.uniform(-6, 6));
    const bool found = std::any_of(pieces.begin(), pieces.end(), [&](const Corners& c) { return inside(c, p); });
    EXPECT_EQ(found, inside(corners, p)) << p.transpose();
  }
}

const Corners kAngle{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};  // an L

Corners reversed(Corners corners) {
  std::reverse(corners.begin(), corners.end());
  return corners;
}

TEST(Polygon, WhatBoundsOneAreaIsSimple) {
  EXPECT_TRUE(is_simple(kAngle));
  EXPECT_TRUE(is_simple(reversed(kAngle)));
  EXPECT_TRUE(is_simple(Corners{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_TRUE(is_simple(Corners{{0, 0}, {1, 0}, {2, 0}, {2, 2}})) << "a corner may be on an edge's line";
}

TEST(Polygon, WhatMeetsItselfIsNot) {
  EXPECT_FALSE(is_simple(Corners{}));
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {2, 2}, {2, 0}, {0, 2}})) << "crosses itself";
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {1, 0}, {2, 0}})) << "has no area";
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {1, 0}, {1, 0}, {0, 1}})) << "has a corner twice";
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}})) << "touches its first edge with a corner";
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {4, 0}, {2, 0}, {2, 2}})) << "goes there and back";
  EXPECT_FALSE(is_simple(Corners{{0, 0}, {1, 0}, {0, std::numeric_limits<double>::quiet_NaN()}}));
}

TEST(Polygon, AConvexOneIsItsOnlyPiece) {
  const Corners square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  ASSERT_EQ(convex_pieces(square).size(), 1U);
  EXPECT_EQ(convex_pieces(square).front(), square);
  EXPECT_GT(area(convex_pieces(reversed(square)).front()), 0.0) << "counter-clockwise";
  // Corners at which nothing turns are none.
  EXPECT_EQ(convex_pieces(Corners{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}).front().size(), 4U);
}

TEST(Polygon, AnyOtherIsCutIntoConvexOnes) {
  expect_cut_well(kAngle);
  expect_cut_well(reversed(kAngle));
  expect_cut_well(
      {{0, 0}, {5, 0}, {5, 4}, {4, 4}, {4, 1}, {3, 1}, {3, 4}, {2, 4}, {2, 1}, {1, 1}, {1, 4}, {0, 4}});  // comb
  base::RandomStream random(3);
  for (int n = 0; n < 50; ++n) {  // stars, whose corners are at any distance
    Corners star;
    const int corners = 3 + static_cast<int>(random.uniform(0, 20));
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      star.push_back(random.uniform(0.5, 5.0) * Vec2(std::cos(angle), std::sin(angle)));
    }
    ASSERT_TRUE(is_simple(star));
    expect_cut_well(n % 2 == 0 ? star : reversed(star));
  }
}

}  // namespace
}  // namespace jink::planner::geometry
