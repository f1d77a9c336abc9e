// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/linear_program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr double kSpeed = 5.0;

Vec3 direction(planner::base::RandomStream& random) {
  Vec3 v;
  do {
    for (int k = 0; k < 3; ++k) v[k] = random.uniform(-1.0, 1.0);
  } while (v.norm() < 0.1 || v.norm() > 1.0);
  return v.normalized();
}

double violation(const std::vector<HalfSpace>& half_spaces, const Vec3& v) {
  double most = 0.0;
  for (const HalfSpace& h : half_spaces) most = std::max(most, h.offset - h.normal.dot(v));
  return most;
}

/// Half-spaces that all hold at some velocity within the largest speed.
std::vector<HalfSpace> feasible(planner::base::RandomStream& random, int count) {
  const Vec3 inside = random.uniform(0.0, 0.9 * kSpeed) * direction(random);
  std::vector<HalfSpace> result;
  for (int i = 0; i < count; ++i) {
    const Vec3 normal = direction(random);
    result.push_back({normal, normal.dot(inside) - random.uniform(0.0, 1.0)});
  }
  return result;
}

TEST(NearestVelocity, IsTheWishedOneWhereNothingForbidsIt) {
  const auto v = nearest_velocity({}, kSpeed, {1, 2, 3});
  ASSERT_TRUE(v);
  EXPECT_EQ(*v, Vec3(1, 2, 3));
}

TEST(NearestVelocity, IsBoundedByTheLargestSpeed) {
  const auto v = nearest_velocity({}, kSpeed, {0, 0, 20});
  ASSERT_TRUE(v);
  EXPECT_TRUE(v->isApprox(Vec3(0, 0, kSpeed)));
}

TEST(NearestVelocity, LiesOnThePlaneOfAViolatedHalfSpace) {
  const std::vector<HalfSpace> slow{{-Vec3::UnitX(), -1.0}};  // vx <= 1
  const auto v = nearest_velocity(slow, kSpeed, {3, 0.5, -0.25});
  ASSERT_TRUE(v);
  EXPECT_TRUE(v->isApprox(Vec3(1, 0.5, -0.25)));
}

TEST(NearestVelocity, LiesInTheCornerOfThree) {
  const std::vector<HalfSpace> corner{{-Vec3::UnitX(), -1.0}, {-Vec3::UnitY(), -0.5}, {-Vec3::UnitZ(), 0.5}};
  const auto v = nearest_velocity(corner, kSpeed, {3, 3, 3});
  ASSERT_TRUE(v);
  EXPECT_TRUE(v->isApprox(Vec3(1, 0.5, -0.5)));
}

TEST(NearestVelocity, IsNoneBetweenPlanesThatLeaveNothing) {
  const std::vector<HalfSpace> apart{{Vec3::UnitX(), 1.0}, {-Vec3::UnitX(), -0.5}};
  EXPECT_FALSE(nearest_velocity(apart, kSpeed, Vec3::Zero()));
}

TEST(NearestVelocity, IsNoneWhereOnlyHigherSpeedsAreAllowed) {
  const std::vector<HalfSpace> fast{{Vec3::UnitX(), kSpeed + 0.1}};
  EXPECT_FALSE(nearest_velocity(fast, kSpeed, Vec3::Zero()));
}

// Against brute force: nothing that is allowed lies nearer to the wish, and a feasible programme is found feasible.
TEST(NearestVelocity, IsAllowedAndNoSampleIsNearer) {
  planner::base::RandomStream random(1);
  for (int n = 0; n < 2000; ++n) {
    const auto half_spaces = feasible(random, 1 + static_cast<int>(random.below(12)));
    const Vec3 wished = random.uniform(0.0, kSpeed) * direction(random);
    const auto v = nearest_velocity(half_spaces, kSpeed, wished);
    ASSERT_TRUE(v) << n;
    EXPECT_LE(violation(half_spaces, *v), 1e-7) << n;
    EXPECT_LE(v->norm(), kSpeed + 1e-7) << n;
    const double distance = (*v - wished).norm();
    for (int i = 0; i < 300; ++i) {
      // Half of the samples close to the answer, where a better one would be.
      const Vec3 sample = i % 2 == 0 ? Vec3(random.uniform(0.0, kSpeed) * direction(random))
                                     : Vec3(*v + random.uniform(0.0, 0.2) * direction(random));
      if (sample.norm() > kSpeed || violation(half_spaces, sample) > 0.0) continue;
      EXPECT_GE((sample - wished).norm(), distance - 1e-6) << n;
    }
  }
}

TEST(NearestVelocity, FindsNothingOnlyWhereNoSampleIsAllowed) {
  planner::base::RandomStream random(2);
  int none = 0;
  for (int n = 0; n < 500; ++n) {
    std::vector<HalfSpace> half_spaces;
    half_spaces.reserve(8);
    for (int i = 0; i < 8; ++i) half_spaces.push_back({direction(random), random.uniform(-2.0, 2.0)});
    if (nearest_velocity(half_spaces, kSpeed, Vec3::Zero())) continue;
    ++none;
    for (int i = 0; i < 2000; ++i)
      EXPECT_GT(violation(half_spaces, random.uniform(0.0, kSpeed) * direction(random)), 0.0) << n;
  }
  EXPECT_GT(none, 50);
}

TEST(LeastViolatingVelocity, IsTheNearestWhereThereIsOne) {
  planner::base::RandomStream random(3);
  for (int n = 0; n < 200; ++n) {
    const auto half_spaces = feasible(random, 6);
    const Vec3 wished = direction(random);
    double relaxed = -1.0;
    EXPECT_EQ(least_violating_velocity({}, half_spaces, kSpeed, wished, &relaxed),
              *nearest_velocity(half_spaces, kSpeed, wished));
    EXPECT_EQ(relaxed, 0.0);
  }
}

TEST(LeastViolatingVelocity, LiesHalfwayBetweenTwoThatExcludeEachOther) {
  const std::vector<HalfSpace> apart{{Vec3::UnitX(), 1.0}, {-Vec3::UnitX(), 0.0}};  // vx >= 1, vx <= 0
  double relaxed = 0.0;
  const Vec3 v = least_violating_velocity({}, apart, kSpeed, {0, 1, 0}, &relaxed);
  EXPECT_NEAR(relaxed, 0.5, 1e-6);
  EXPECT_NEAR(v.x(), 0.5, 1e-6);
  EXPECT_NEAR(v.y(), 1.0, 1e-3);
}

TEST(LeastViolatingVelocity, KeepsTheHardOnesAndNoSampleViolatesLess) {
  planner::base::RandomStream random(4);
  for (int n = 0; n < 200; ++n) {
    const std::vector<HalfSpace> hard{{Vec3::UnitZ(), -1.0}, {-Vec3::UnitZ(), -1.0}};
    std::vector<HalfSpace> soft;
    soft.reserve(10);
    for (int i = 0; i < 10; ++i) soft.push_back({direction(random), random.uniform(0.0, 3.0)});
    double relaxed = 0.0;
    const Vec3 v = least_violating_velocity(hard, soft, kSpeed, Vec3::Zero(), &relaxed);
    EXPECT_LE(std::abs(v.z()), 1.0 + 1e-6);
    EXPECT_LE(v.norm(), kSpeed + 1e-6);
    EXPECT_LE(violation(soft, v), relaxed + 1e-6);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 sample = random.uniform(0.0, kSpeed) * direction(random);
      if (std::abs(sample.z()) > 1.0) continue;
      EXPECT_GE(violation(soft, sample), relaxed - 1e-6) << n;
    }
  }
}

}  // namespace
}  // namespace jink::tools::lab::baselines
