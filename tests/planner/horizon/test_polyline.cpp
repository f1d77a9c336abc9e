// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/polyline.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace jink::planner::horizon {
namespace {

const std::vector<Vec3> kCorner{{0, 0, 0}, {4, 0, 0}, {4, 0, 0}, {4, 3, 0}};

TEST(Polyline, IsAsLongAsItsLegs) {
  EXPECT_EQ(length_of(kCorner), 7.0);
  EXPECT_EQ(length_of(std::vector{Vec3(1, 2, 3)}), 0.0);
}

TEST(Polyline, HasAPlaceAtEachLength) {
  EXPECT_EQ(place_along(kCorner, 0.0), Vec3(0, 0, 0));
  EXPECT_EQ(place_along(kCorner, 3.0), Vec3(3, 0, 0));
  EXPECT_EQ(place_along(kCorner, 4.0), Vec3(4, 0, 0));
  EXPECT_EQ(place_along(kCorner, 5.5), Vec3(4, 1.5, 0));
  EXPECT_EQ(place_along(kCorner, 100.0), Vec3(4, 3, 0)) << "no farther than its end";
}

TEST(Polyline, SaysWhatIsLeftFromBesideAPlace) {
  EXPECT_EQ(left_along(kCorner, {1, 0, 0}), 6.0);
  EXPECT_EQ(left_along(kCorner, {1, 2, 0}), 8.0) << "and the way there";
  EXPECT_EQ(left_along(kCorner, {4, 3, 0}), 0.0);
  EXPECT_EQ(left_along(kCorner, {4, 5, 0}), 2.0) << "past the end";
}

}  // namespace
}  // namespace jink::planner::horizon
