// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/trajectory.hpp"

#include <gtest/gtest.h>

#include "planner/base/random.hpp"

namespace jink::planner::base {
namespace {

const Vec3 kZero = Vec3::Zero();

// East 2 m in 1 s, then north 3 m in 2 s.
TimedPath corner() {
  return {{1.0, {0, 0, 1}, {2, 0, 0}, {1, 0, 0}},
          {2.0, {2, 0, 1}, {0, 1.5, 0}, {0, 3, 0}},
          {4.0, {2, 3, 1}, {0, 1, 0}, {0, 1, 0}}};
}

TEST(Sample, IsLinearBetweenPoints) {
  const TimedPoint p = sample(corner(), 1.25);
  EXPECT_EQ(p.t, 1.25);
  EXPECT_EQ(p.position, Vec3(0.5, 0, 1));
  EXPECT_EQ(p.velocity, Vec3(1.5, 0.375, 0));
  EXPECT_EQ(p.acceleration, Vec3(0.75, 0.75, 0));
  EXPECT_EQ(sample(corner(), 3.0).position, Vec3(2, 1.5, 1));
}

TEST(Sample, GivesAPointAtItsOwnTime) {
  const TimedPoint p = sample(corner(), 2.0);
  EXPECT_EQ(p.position, Vec3(2, 0, 1));
  EXPECT_EQ(p.velocity, Vec3(0, 1.5, 0));
}

TEST(Sample, IsTheFirstPointBeforeTheStart) {
  const TimedPoint p = sample(corner(), -5.0);
  EXPECT_EQ(p.t, -5.0);
  EXPECT_EQ(p.position, Vec3(0, 0, 1));
  EXPECT_EQ(p.velocity, Vec3(2, 0, 0));
}

TEST(Sample, WaitsAtTheLastPointAfterTheEnd) {
  for (const double t : {4.0, 9.0}) {
    const TimedPoint p = sample(corner(), t);
    EXPECT_EQ(p.t, t);
    EXPECT_EQ(p.position, Vec3(2, 3, 1));
    EXPECT_EQ(p.velocity, Vec3(0, 0, 0));
    EXPECT_EQ(p.acceleration, Vec3(0, 0, 0));
  }
}

TEST(PathLength, SumsTheSegments) {
  EXPECT_DOUBLE_EQ(path_length(corner()), 5.0);
  EXPECT_EQ(path_length({{0.0, {1, 1, 1}, kZero, kZero}}), 0.0);
  EXPECT_EQ(path_length({}), 0.0);
}

TEST(Remainder, StartsAtTheTimeAsked) {
  const TimedPath rest = remainder(corner(), 1.25);
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_EQ(rest[0].t, 1.25);
  EXPECT_EQ(rest[0].position, Vec3(0.5, 0, 1));
  EXPECT_EQ(rest[1].t, 2.0);
  EXPECT_EQ(rest[2].t, 4.0);
}

TEST(Remainder, DoesNotRepeatAPointAtItsOwnTime) {
  const TimedPath rest = remainder(corner(), 2.0);
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[0].t, 2.0);
  EXPECT_EQ(rest[1].t, 4.0);
}

TEST(Remainder, AfterTheEndIsOneRestingPoint) {
  const TimedPath rest = remainder(corner(), 6.0);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].t, 6.0);
  EXPECT_EQ(rest[0].position, Vec3(2, 3, 1));
  EXPECT_EQ(rest[0].velocity, Vec3(0, 0, 0));
}

TEST(Later, IsTheRemainderWithTimesFromThen) {
  const TimedPath rest = later(corner(), 1.25);
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_EQ(rest[0].t, 0.0);
  EXPECT_EQ(rest[0].position, Vec3(0.5, 0, 1));
  EXPECT_EQ(rest[1].t, 0.75);
  EXPECT_EQ(rest[2].t, 2.75);
}

TEST(Remainder, FollowsTheSamePathAtAnyTime) {
  RandomStream random(4);
  TimedPath path;
  for (int i = 0; i < 30; ++i) {
    path.push_back(
        {i * 0.3 + random.uniform(0.0, 0.2), {random.normal(), random.normal(), random.normal()}, kZero, kZero});
  }
  for (int i = 0; i < 200; ++i) {
    const double from = random.uniform(-1.0, 10.0);
    const TimedPath rest = remainder(path, from);
    for (std::size_t k = 1; k < rest.size(); ++k) ASSERT_LT(rest[k - 1].t, rest[k].t);
    const double t = random.uniform(from, 12.0);
    EXPECT_LT((sample(rest, t).position - sample(path, t).position).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace jink::planner::base
