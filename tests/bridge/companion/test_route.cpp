// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/route.hpp"

#include <gtest/gtest.h>

namespace jink::bridge::companion {
namespace {

TEST(Route, GoesOnAtAWaypointOnTheWayAndArrivesAtTheLastOne) {
  Route route({{10, 0, 2}, {20, 0, 2}});
  EXPECT_FALSE(route.pass({9, 0, 2}));
  EXPECT_FALSE(route.arrived({20, 0, 2}, Vec3::Zero()));
  EXPECT_TRUE(route.pass({9.5, 0, 2}));
  EXPECT_EQ(route.target(), Vec3(20, 0, 2));
  EXPECT_FALSE(route.pass({20, 0, 2}));  // that is the last one
  EXPECT_TRUE(route.arrived({19.8, 0, 2}, Vec3::Zero()));
  EXPECT_FALSE(route.arrived({19.8, 0, 2}, {1, 0, 0}));
}

TEST(Route, AcceptsToHaveComeNearTheLastWaypoint) {
  Route route({{10, 0, 2}, {20, 0, 2}}, /*acceptance=*/0.8);
  EXPECT_FALSE(route.arrived({19.5, 0, 2}, {3, 0, 0})) << "the first comes first";
  EXPECT_TRUE(route.pass({9.5, 0, 2}));
  EXPECT_FALSE(route.arrived({19.1, 0, 2}, Vec3::Zero()));
  EXPECT_TRUE(route.arrived({19.3, 0, 2}, {3, 0, 0}));
}

TEST(Route, IsStuckWhereItComesNoNearer) {
  Route route({{10, 0, 2}, {20, 0, 2}});
  EXPECT_FALSE(route.stuck(1.0, {0, 0, 2}));
  EXPECT_FALSE(route.stuck(4.9, {0.4, 0, 2}));
  EXPECT_TRUE(route.stuck(5.1, {0.4, 0, 2}));
  EXPECT_FALSE(route.stuck(5.2, {0.6, 0, 2}));
  EXPECT_TRUE(route.pass({10, 0, 2}));
  EXPECT_FALSE(route.stuck(20.0, {10, 0, 2}));  // the next has its own time
}

}  // namespace
}  // namespace jink::bridge::companion
