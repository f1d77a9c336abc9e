// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/approach.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>

namespace jink::planner::horizon {
namespace {

base::TimedPoint at(const Vec3& position, const Vec3& velocity) {
  return {0.0, position, velocity, Vec3::Zero()};
}

ApproachLimits limits(double change, double braking) {
  return {1.0, 5.0, 5.0, change, braking};  // in steps of a second
}

// 3 m from rest: with N steps of braking to w = 6 / (N + 1), of which each takes w / N: 2 m/s in two steps of 1 m/s.
// The way is 1 m while it speeds up, then 1.5 m and 0.5 m.
TEST(Approach, LandsFromRestAsByHand) {
  const Approach approach({3, 0, 0}, limits(2.0, 1.0));
  base::TimedPath path{at({0, 0, 0}, {0, 0, 0})};
  const std::optional<Landing> landing = approach.landing(path.back());
  ASSERT_TRUE(landing);
  EXPECT_EQ(landing->braking, 2);
  EXPECT_EQ(landing->velocity, Vec3(2, 0, 0));
  EXPECT_EQ(landing->change, 2.0);
  approach.fly(*landing, path);
  ASSERT_EQ(path.size(), 4U);
  const std::array<double, 4> where = {0.0, 1.0, 2.5, 3.0};
  const std::array<double, 4> speed = {0.0, 2.0, 1.0, 0.0};
  const std::array<double, 4> acceleration = {2.0, -1.0, -1.0, 0.0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(path[i].t, static_cast<double>(i));
    EXPECT_DOUBLE_EQ(path[i].position.x(), where[i]);
    EXPECT_DOUBLE_EQ(path[i].velocity.x(), speed[i]);
    EXPECT_DOUBLE_EQ(path[i].acceleration.x(), acceleration[i]);
  }
}

// The same with a change of at most 1.9 m/s: 2 m/s is out of reach, which is steered for.
TEST(Approach, HasNoLandingOutOfReach) {
  const Approach approach({3, 0, 0}, limits(1.9, 1.0));
  const base::TimedPoint rest = at({0, 0, 0}, {0, 0, 0});
  EXPECT_FALSE(approach.landing(rest));
  EXPECT_EQ(approach.wished_velocity(rest), Vec3(2, 0, 0));
}

// 100 m away N = 14 and 13.3 m/s would do; at 5 m/s at most there is none yet, nor at a climb of 5 m/s.
TEST(Approach, CruisesWhileItIsFar) {
  const Approach approach({0, 0, 100}, limits(20.0, 1.0));
  const base::TimedPoint rest = at({0, 0, 0}, {0, 0, 0});
  EXPECT_FALSE(approach.landing(rest));
  EXPECT_NEAR((approach.wished_velocity(rest) - Vec3(0, 0, 5)).norm(), 0.0, 1e-12);
}

// At 2 m/s with 2 m to go: 2 m/s² · s²/2 with one step to 1 m/s and one to rest, 1.5 m and 0.5 m. Planned braking of
// 0.5 m/s a step would have begun earlier; harder it still can.
TEST(Approach, BrakesHarderWhereItComesFast) {
  const Approach approach({2, 0, 0}, limits(1.0, 0.5));
  const std::optional<Landing> landing = approach.landing(at({0, 0, 0}, {2, 0, 0}));
  ASSERT_TRUE(landing);
  EXPECT_EQ(landing->braking, 1);
  EXPECT_EQ(landing->velocity, Vec3(1, 0, 0));
  EXPECT_FALSE(Approach({1.5, 0, 0}, limits(1.0, 0.5)).landing(at({0, 0, 0}, {2, 0, 0})));
}

// In three steps, one and two of braking: w = (6 - 1) / 3.
TEST(Approach, LandsInAsManyStepsAsAskedFor) {
  const Approach approach({3, 0, 0}, limits(2.0, 1.0));
  const base::TimedPoint now = at({0, 0, 0}, {1, 0, 0});
  const std::optional<Landing> landing = approach.landing_in(now, 3);
  ASSERT_TRUE(landing);
  EXPECT_EQ(landing->braking, 2);
  EXPECT_DOUBLE_EQ(landing->velocity.x(), 5.0 / 3.0);
  EXPECT_EQ(approach.after(*landing, now, 3).position, Vec3(3, 0, 0));
  EXPECT_EQ(approach.after(*landing, now, 3).velocity, Vec3(0, 0, 0));
  EXPECT_FALSE(approach.landing_in(now, 2));  // 2.5 m/s, braked in one step
}

}  // namespace
}  // namespace jink::planner::horizon
