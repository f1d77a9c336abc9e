// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/occupancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace jink::bridge::map {
namespace {

using State = Occupancy::State;
using Points = std::vector<Eigen::Vector3f>;

const Vec3 kHome(0.1, 0.1, 1.5);

CloudView seen(const Points& points, const Vec3& from = kHome) {
  CloudView cloud;
  cloud.points = points;
  cloud.sensor = cloud.vehicle = from;
  cloud.own_radius = 0.3;
  return cloud;
}

/// The middle of the cell in which a place is.
Eigen::Vector3f middle(double x, double y, double z) {
  const Vec3 cell = (Vec3(x, y, z) / Occupancy::kCell).array().floor();
  return ((cell + Vec3::Constant(0.5)) * Occupancy::kCell).cast<float>();
}

Vec3 place(const Eigen::Vector3f& point) {
  return point.cast<double>();
}

/// A wall across x, seen densely.
Points wall(double x, double half = 2.0) {
  Points points;
  for (double y = -half; y <= half; y += 0.05)
    for (double z = 0.5; z <= 3.0; z += 0.05) points.emplace_back(Vec3(x, y, z).cast<float>());
  return points;
}

TEST(Occupancy, APointIsOccupiedAndTheWayToItFree) {
  Occupancy grid({});
  const Eigen::Vector3f point = middle(5, 0, 1.5);
  EXPECT_EQ(grid.at(place(point)), State::kUnknown);
  const CloudCounts counts = grid.insert(seen({point, point}));
  EXPECT_EQ(counts, (CloudCounts{1, 0, 0, 0, 1}));
  EXPECT_EQ(grid.at(place(point)), State::kOccupied);
  for (double x = 0.1; x < 4.5; x += 0.05) EXPECT_EQ(grid.at({x, 0.1, 1.5}), State::kFree) << x;
  EXPECT_EQ(grid.at({5.3, 0.1, 1.5}), State::kUnknown) << "behind it";
  EXPECT_EQ(grid.at({3, 0.5, 1.5}), State::kUnknown) << "beside the ray";
}

/// How much of the way from a to b is in a cell, as a share of it; below 0: none is.
double share_within(const Cell& cell, const Vec3& a, const Vec3& b) {
  double enters = 0.0;
  double leaves = 1.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double low = (Occupancy::kCell * cell[axis] - a[axis]) / (b[axis] - a[axis]);
    const double high = (Occupancy::kCell * (cell[axis] + 1) - a[axis]) / (b[axis] - a[axis]);
    enters = std::max(enters, std::min(low, high));
    leaves = std::min(leaves, std::max(low, high));
  }
  return leaves - enters;
}

TEST(Occupancy, RaysFreeTheCellsThatTheyPassAndNoOthers) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-4.0, 4.0);
  Occupancy grid({20.0, 60.0});
  for (int n = 0; n < 100; ++n) {
    const Vec3 from(any(random), any(random), any(random));
    const Points points{middle(any(random), any(random), any(random))};
    CloudView cloud = seen(points, from);
    cloud.vehicle = Vec3::Zero();
    cloud.own_radius = -0.1;
    grid.forget();
    grid.insert(cloud);
    const Vec3 end = place(points[0]);
    if ((end - from).norm() < 0.6) continue;
    const Vec3 to = end - 0.5 * (end - from).normalized();  // what is just before it may be a part of it
    for (int x = -21; x <= 21; ++x)
      for (int y = -21; y <= 21; ++y)
        for (int z = -21; z <= 21; ++z) {
          const double share = share_within({x, y, z}, from, to);
          const Vec3 at = Occupancy::kCell * Vec3(x + 0.5, y + 0.5, z + 0.5);
          const State state = grid.at(at);
          if ((at - end).norm() < 1e-6) {
            ASSERT_EQ(state, State::kOccupied);
          } else if (share > 1e-9) {
            ASSERT_EQ(state, State::kFree) << n;
          } else if (share < -1e-9) {
            ASSERT_EQ(state, State::kUnknown) << n;
          }
        }
  }
}

TEST(Occupancy, RaysClearWhatIsNotThereAnyMore) {
  Occupancy grid({});
  const Eigen::Vector3f point = middle(3, 0, 1.5);
  const Points before{point};
  const Points after{middle(6, 0, 1.5)};
  for (int i = 0; i < 20; ++i) grid.insert(seen(before));
  EXPECT_EQ(grid.at(place(point)), State::kOccupied);
  int misses = 0;
  for (; grid.at(place(point)) == State::kOccupied; ++misses) grid.insert(seen(after));
  EXPECT_GT(misses, 1) << "one ray that slips past proves nothing";
  EXPECT_LE(misses, 18) << "how often it was seen is not held against it";
}

TEST(Occupancy, WhatOneRayPassesAndAnotherEndsInIsOccupied) {
  Occupancy grid({});
  const Eigen::Vector3f near = middle(3, 0, 1.5);
  const Points points{middle(6, 0, 1.5), near, middle(7, 0, 1.5)};
  grid.insert(seen(points));
  EXPECT_EQ(grid.at(place(near)), State::kOccupied);
}

TEST(Occupancy, PointsThatAreNoneAreCounted) {
  Occupancy grid({8.0, 60.0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const Points points{{nan, 0, 0},        {1, nan, 0},   {1, 0, inf}, {1e7F, 0, 0},
                      {0.2F, 0.1F, 1.4F}, {12, 0, 1.5F}, {3, 3, 0.1F}};
  CloudView cloud = seen(points);
  cloud.floor = 0.3;
  EXPECT_EQ(grid.insert(cloud), (CloudCounts{0, 2, 4, 1, 0}));
  EXPECT_TRUE(grid.boxes().empty());
  EXPECT_EQ(grid.at({7.8, 0.1, 1.5}), State::kFree) << "as far as it is seen";
  EXPECT_EQ(grid.at({8.5, 0.1, 1.5}), State::kUnknown);
  EXPECT_EQ(grid.at({2.9, 2.9, 0.15}), State::kFree) << "the ground is nothing that stands";
}

TEST(Occupancy, WhatIsKnownElsewhereIsLeftOut) {
  Occupancy grid({});
  const Points points = wall(4);
  CloudView cloud = seen(points);
  cloud.elsewhere = [](const Vec3& at) { return at.y() > 0.0; };
  grid.insert(cloud);
  EXPECT_EQ(grid.at({4.01, 1.1, 1.5}), State::kFree);
  EXPECT_EQ(grid.at({4.01, -1.1, 1.5}), State::kOccupied);
}

TEST(Occupancy, PointsInTheSensorsFrameArePlaced) {
  Occupancy grid({});
  const Points points{{2, 0, 0}};
  CloudView cloud = seen(points);
  cloud.to_enu = Eigen::Translation3d(kHome) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ());
  grid.insert(cloud);
  EXPECT_EQ(grid.at(kHome + Vec3(0, 2, 0)), State::kOccupied);
}

TEST(Occupancy, WhatIsSeenNoMoreIsForgotten) {
  Occupancy grid({8.0, 10.0});
  const Points once{middle(3, 0, 1.5)};
  const Points often{middle(0, 3, 1.5)};
  const Points nothing;
  const auto insert = [&](const Points& points, double time) {
    CloudView cloud = seen(points);
    cloud.time = time;
    grid.insert(cloud);
  };
  for (int i = 0; i < 10; ++i) insert(often, 100.0);
  insert(once, 100.0);
  insert(nothing, 102.0);
  EXPECT_EQ(grid.at(place(once[0])), State::kOccupied);
  insert(nothing, 103.0);
  EXPECT_EQ(grid.at(place(once[0])), State::kUnknown) << "seen once";
  insert(nothing, 109.0);
  EXPECT_EQ(grid.at(place(often[0])), State::kOccupied);
  insert(nothing, 110.5);
  EXPECT_EQ(grid.at(place(often[0])), State::kUnknown);
  EXPECT_TRUE(grid.boxes().empty());
  insert(often, 90.0);  // a clock that goes back
  insert(nothing, 1e6);
  EXPECT_EQ(grid.at(place(often[0])), State::kUnknown);
}

// What stays in the window stays known; what leaves it and comes back is unknown.
TEST(Occupancy, TheWindowSlidesAlong) {
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0.3, 0.8, 0.1), Vec3(0, 0, 0.5), Vec3(-70, 0, 0)}) {
    Occupancy grid({});
    const Points points{middle(3, 0, 1.5)};
    const Points nothing;
    grid.insert(seen(points));
    const Vec3 half = 0.5 * Occupancy::kCell * Vec3(256, 256, 64);
    for (int i = 0; i < 60; ++i) {
      const Vec3 vehicle = kHome + i * way;
      grid.insert(seen(nothing, vehicle));
      const bool inside = ((place(points[0]) - vehicle).cwiseAbs().array() < half.array() - 0.2).all();
      const bool outside = ((place(points[0]) - vehicle).cwiseAbs().array() > half.array() + 0.2).any();
      if (inside) {
        EXPECT_EQ(grid.at(place(points[0])), State::kOccupied) << i;
        EXPECT_EQ(grid.boxes().size(), 1U);
      }
      if (outside) {
        EXPECT_EQ(grid.at(place(points[0])), State::kUnknown) << i;
        EXPECT_TRUE(grid.boxes().empty()) << i;
      }
    }
    grid.insert(seen(nothing));
    EXPECT_EQ(grid.boxes().empty(), grid.at(place(points[0])) != State::kOccupied);
  }
}

TEST(Occupancy, RaysEndAtTheWindow) {
  Occupancy grid({25.0, 60.0});
  const Points points{{0.1F, 0.1F, 20.0F}, {10.0F, 0.1F, 14.0F}, {0.1F, 24.0F, 1.5F}};
  const CloudCounts counts = grid.insert(seen(points));
  EXPECT_EQ(counts.hits, 1U);
  EXPECT_EQ(counts.clear, 2U);
  EXPECT_EQ(grid.at({0.1, 0.1, 7.7}), State::kFree);
  EXPECT_EQ(grid.at({0.1, 24.0, 1.5}), State::kOccupied);
}

TEST(Occupancy, AThinPlateIsSeenWithoutHoles) {
  Occupancy grid({});
  grid.insert(seen(wall(3.37)));
  for (double y = -1.9; y < 1.9; y += 0.1)
    for (double z = 0.6; z < 2.9; z += 0.1) EXPECT_EQ(grid.at({3.37, y, z}), State::kOccupied) << y << ' ' << z;
  EXPECT_LE(grid.boxes().size(), 2U) << "one plate, nearly one box";
}

TEST(Occupancy, BoxesCoverAllThatIsOccupiedAndNothingThatIsFree) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-5.0, 5.0);
  std::uniform_real_distribution<double> height(-3.0, 5.0);
  Occupancy grid({});
  Points points = wall(4);
  for (int i = 0; i < 400; ++i) points.emplace_back(Vec3(any(random), any(random), height(random)).cast<float>());
  for (int n = 0; n < 100; ++n) grid.insert(seen(points, kHome + Vec3(0.05 * n, 0, 0)));  // marks wrap around
  const std::vector<CellBox> boxes = grid.boxes();
  EXPECT_EQ(boxes, grid.boxes());
  std::set<std::tuple<int, int, int>> covered;
  for (const CellBox& box : boxes) {
    for (int x = box.min.x(); x < box.max.x(); ++x)
      for (int y = box.min.y(); y < box.max.y(); ++y)
        for (int z = box.min.z(); z < box.max.z(); ++z) {
          covered.insert({x, y, z});
          EXPECT_NE(grid.at(0.2 * Vec3(x + 0.5, y + 0.5, z + 0.5)), State::kFree);
        }
  }
  std::size_t occupied = 0;
  for (int x = -128; x < 160; ++x)
    for (int y = -128; y < 128; ++y)
      for (int z = -32; z < 48; ++z) {
        if (grid.at(0.2 * Vec3(x + 0.5, y + 0.5, z + 0.5)) != State::kOccupied) continue;
        ++occupied;
        EXPECT_TRUE(covered.contains({x, y, z}));
      }
  EXPECT_GT(occupied, 400U);
  EXPECT_LT(boxes.size(), occupied);
}

// A lidar's lines are farther apart than a cell is high; what was seen to be free stays open.
TEST(Occupancy, LinesOfAWallAreOneBoxAndItsWindowIsOpen) {
  Occupancy grid({});
  Points points;
  for (double y = -2.0; y <= 2.0; y += 0.05)
    for (double z = 0.5; z <= 3.0; z += 0.4) points.emplace_back(Vec3(3.9, y, z).cast<float>());
  grid.insert(seen(points));
  EXPECT_EQ(grid.boxes().size(), 1U);
  for (double y = -0.5; y <= 0.5; y += 0.05)
    for (double z = 1.0; z <= 2.0; z += 0.05)
      points.emplace_back(Vec3(6.0, 1.5 * y, 1.5 + 1.5 * (z - 1.5)).cast<float>());
  for (int n = 0; n < 20; ++n) grid.insert(seen(points));
  for (const CellBox& box : grid.boxes()) {
    const Vec3 low = 0.2 * box.min.cast<double>();
    const Vec3 high = 0.2 * box.max.cast<double>();
    const Vec3 window(3.9, 0.1, 1.15);
    EXPECT_FALSE((low.array() < window.array()).all() && (window.array() < high.array()).all());
  }
}

// Up to where rays have passed, and no farther than what stands.
TEST(Occupancy, AColumnIsFreeAsFarAsItWasSeen) {
  Occupancy grid({});
  grid.insert(seen({middle(5, 0, 1.5)}));
  const auto unseen = grid.free_column({3.1, 3.1, 1.5}, 0.3);
  EXPECT_EQ(unseen.low, 1.5);
  EXPECT_EQ(unseen.high, 1.5);
  grid.free_around(kHome, 1.5);
  const auto room = grid.free_column(kHome, 0.3);
  EXPECT_NEAR(room.high, kHome.z() + 1.5, 0.25);
  EXPECT_NEAR(room.low, kHome.z() - 1.5, 0.25);
  Points ceiling = wall(6.0);  // and over 3 m ahead, and the ground there
  for (double x = 2.0; x < 4.0; x += 0.05) {
    for (double y = -1.0; y < 1.0; y += 0.05) {
      ceiling.push_back(middle(x, y, 2.5));
      ceiling.push_back(middle(x, y, 0.1));
    }
  }
  CloudView cloud = seen(ceiling);
  cloud.floor = 0.3;
  for (int i = 0; i < 3; ++i) grid.insert(cloud);
  const auto ahead = grid.free_column({3.1, 0.1, 1.5}, 0.3);
  EXPECT_LE(ahead.high, 2.5);
  EXPECT_GE(ahead.high, 1.9);
  EXPECT_LE(ahead.low, 1.1);
}

TEST(Occupancy, APlaceIsKnownWhereAllOfItWasSeen) {
  const Vec3 far(100, 0, 0);
  Occupancy grid({});
  EXPECT_FALSE(grid.is_known(kHome, 0.3, far));
  for (int i = 0; i < 3; ++i) grid.insert(seen(wall(6.0)));
  EXPECT_TRUE(grid.is_known({4.0, 0.1, 1.5}, 0.3, far));
  EXPECT_FALSE(grid.is_known({4.0, 0.1, 1.5}, 1.5, far)) << "the rays went through a part of it";
  EXPECT_FALSE(grid.is_known({7.0, 0.1, 1.5}, 0.3, far)) << "behind the wall";
  EXPECT_FALSE(grid.is_known({-2.0, 0.1, 1.5}, 0.3, far)) << "where nobody looked";
  EXPECT_FALSE(grid.is_known({1000, 0, 0}, 0.3, far)) << "out of the window";
  grid.free_around({-2.0, 0.1, 1.5}, 0.4);
  EXPECT_TRUE(grid.is_known({-2.0, 0.1, 1.5}, 0.3, far));
  // Who is near to what is unknown may stay, and go away from it, but no nearer.
  const Vec3 edge(-2.2, 0.1, 1.5);
  EXPECT_FALSE(grid.is_known(edge, 0.4, far));
  EXPECT_TRUE(grid.is_known(edge, 0.4, edge));
  EXPECT_TRUE(grid.is_known(edge + Vec3(0.1, 0, 0), 0.3, edge));
  EXPECT_FALSE(grid.is_known(edge - Vec3(0.01, 0, 0), 0.4, edge));
}

TEST(Occupancy, RefusesSettingsThatAreNone) {
  EXPECT_THROW(Occupancy({0.0, 60.0}), std::invalid_argument);
  EXPECT_THROW(Occupancy({26.0, 60.0}), std::invalid_argument);
  EXPECT_THROW(Occupancy({8.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace jink::bridge::map
