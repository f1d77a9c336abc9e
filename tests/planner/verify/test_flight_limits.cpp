// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/flight_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::verify {
namespace {

base::TimedPath path_of(const std::vector<std::pair<double, Vec3>>& points) {
  base::TimedPath path;
  for (const auto& [t, position] : points) path.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
  return path;
}

// 3 m in 1 s, then 5 m in 2 s: 3 m/s and 2.5 m/s. Up 0.5 m/s, then down 1 m/s.
TEST(FlightLimits, SpeedAndClimbAreThoseOfTheSegments) {
  const base::TimedPath path =
      path_of({{1, {0, 0, 0}}, {2, {std::sqrt(8.75), 0, 0.5}}, {4, {std::sqrt(8.75), std::sqrt(21.0), -1.5}}});
  FlightLimits limits;
  limits.max_speed = 4.0;
  limits.max_climb = 2.0;
  const LimitsUse use = use_of_limits(path, limits);
  EXPECT_NEAR(use.speed, 0.75, 1e-12);
  EXPECT_NEAR(use.climb, 0.5, 1e-12);
  EXPECT_EQ(use.acceleration, 0.0);
  EXPECT_TRUE(use.within());
  limits.max_speed = 2.99;
  EXPECT_FALSE(use_of_limits(path, limits).within());
  limits.max_speed = 4.0;
  limits.max_climb = 0.99;
  EXPECT_FALSE(use_of_limits(path, limits).within());
}

// 1 m/s for 2 s, then 3 m/s for 1 s and 2 s more: 2 m/s between the middles, 1.5 s apart. From -3 m/s to 1 m/s in a
// second: 4 m/s². From 3 m/s to rest in a second: 3 m/s².
TEST(FlightLimits, AccelerationIsBetweenTheMiddlesOfSegments) {
  const base::TimedPath path = path_of({{0, {0, 0, 0}}, {2, {2, 0, 0}}, {3, {5, 0, 0}}, {5, {11, 0, 0}}});
  FlightLimits limits;
  limits.max_acceleration = 4.0;
  limits.velocity = {1, 0, 0};
  limits.rests = false;
  EXPECT_NEAR(use_of_limits(path, limits).acceleration, 1.0 / 3.0, 1e-12);
  limits.rests = true;
  EXPECT_NEAR(use_of_limits(path, limits).acceleration, 0.75, 1e-12);
  limits.velocity = {-3, 0, 0};
  EXPECT_NEAR(use_of_limits(path, limits).acceleration, 1.0, 1e-12);
  EXPECT_TRUE(use_of_limits(path, limits).within());
  limits.max_acceleration = 3.999;
  EXPECT_FALSE(use_of_limits(path, limits).within());
}

// A corner: the speed stays, the velocity changes by 2 √2 m/s in a second.
TEST(FlightLimits, ATurnIsAnAcceleration) {
  const base::TimedPath path = path_of({{0, {0, 0, 0}}, {1, {2, 0, 0}}, {2, {2, 2, 0}}});
  FlightLimits limits;
  limits.max_acceleration = 1.0;
  limits.velocity = {2, 0, 0};
  limits.rests = false;
  EXPECT_NEAR(use_of_limits(path, limits).acceleration, 2.0 * std::sqrt(2.0), 1e-12);
}

// Blown at 6 m/s, climbing at 3, by a vehicle of 5 and 2: it may stay as fast, not get faster.
TEST(FlightLimits, WhatIsAboveAtTheStartMayComeDown) {
  FlightLimits limits;
  limits.velocity = {std::sqrt(27.0), 0, 3};
  limits.max_speed = 5.0;
  limits.max_climb = 2.0;
  EXPECT_TRUE(use_of_limits(path_of({{0, {0, 0, 0}}, {1, {std::sqrt(27.0), 0, 3}}}), limits).within());
  EXPECT_FALSE(use_of_limits(path_of({{0, {0, 0, 0}}, {1, {std::sqrt(28.0), 0, 3}}}), limits).within());
  EXPECT_FALSE(use_of_limits(path_of({{0, {0, 0, 0}}, {1, {5, 0, 3.1}}}), limits).within());
}

// Of a second at 2 m/s and a second at 3 m/s the last 0.01 s of the first are left, or the first 0.01 s of the second.
TEST(FlightLimits, ACutStepCountsAsAWholeOne) {
  FlightLimits limits;
  limits.max_acceleration = 1.0;
  limits.velocity = {2.49, 0, 0};  // of 1 m/s² from 1.5 to 2.5 m/s
  limits.rests = false;
  EXPECT_NEAR(use_of_limits(path_of({{0, {0, 0, 0}}, {0.01, {0.02, 0, 0}}, {1.01, {3.02, 0, 0}}}), limits).acceleration,
              1.0, 1e-12);
  limits.velocity = {1.5, 0, 0};
  EXPECT_NEAR(use_of_limits(path_of({{0, {0, 0, 0}}, {1, {2, 0, 0}}, {1.01, {2.03, 0, 0}}}), limits).acceleration, 1.0,
              1e-12);
  limits.velocity = {1.99, 0, 0};  // one step's last 0.01 s alone, from 1.5 m/s on
  const base::TimedPath alone = path_of({{0, {0, 0, 0}}, {0.01, {0.02, 0, 0}}});
  EXPECT_NEAR(use_of_limits(alone, limits).acceleration, 2.0, 1e-9);
  limits.step = 1.0;
  EXPECT_NEAR(use_of_limits(alone, limits).acceleration, 0.02, 1e-9);
}

// No other segment is longer than it is: a corner of short segments is sharp at its start, inside, and at its end.
TEST(FlightLimits, ShortSegmentsInsideCountAsTheyAre) {
  FlightLimits limits;
  limits.max_acceleration = 1.0;
  limits.velocity = {1, 0, 0};
  limits.step = 1.0;
  limits.rests = false;
  for (std::size_t corner = 2; corner < 9; ++corner) {
    base::TimedPath path = path_of({{0, {0, 0, 0}}});
    for (std::size_t i = 1; i < 10; ++i) {
      const Vec3 way = i < corner ? Vec3(0.1, 0, 0) : Vec3(0, 0.1, 0);
      path.push_back({0.1 * static_cast<double>(i), path.back().position + way, Vec3::Zero(), Vec3::Zero()});
    }
    EXPECT_NEAR(use_of_limits(path, limits).acceleration, 10.0 * std::sqrt(2.0), 1e-9) << corner;
  }
}

TEST(FlightLimits, NothingIsAskedForByNoWay) {
  EXPECT_TRUE(use_of_limits({}, {}).within());
  FlightLimits limits;
  limits.max_acceleration = 1.0;
  EXPECT_TRUE(use_of_limits(path_of({{0, {1, 2, 3}}}), limits).within());
  EXPECT_EQ(use_of_limits(path_of({{0, {1, 2, 3}}, {1, {1, 2, 3}}}), limits).acceleration, 0.0);
}

TEST(FlightLimits, WhatIsNotANumberIsNotWithin) {
  FlightLimits limits;
  limits.max_acceleration = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(use_of_limits(path_of({{0, {0, 0, 0}}, {1, {1, 0, 0}}}), limits).within());
}

// Constant acceleration of the limit in each step, in any direction, far from the origin and late: within, and all of
// it used where two steps accelerate alike; wherever it is cut off, too.
TEST(FlightLimits, AMotionThatKeepsItsLimitsPasses) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    base::RandomStream random(seed);
    const auto vec = [&] {
      const double x = random.uniform(-1.0, 1.0);
      const double y = random.uniform(-1.0, 1.0);
      return Vec3(x, y, random.uniform(-1.0, 1.0));
    };
    FlightLimits limits;
    limits.step = seed % 2 == 0 ? 0.1 : 0.02;
    limits.max_acceleration = 0.5 + 10.0 * random.uniform(0.0, 1.0);
    limits.velocity = vec();
    limits.rests = false;
    base::TimedPath path{{100.0 * random.uniform(0.0, 1.0), 1000.0 * vec(), limits.velocity, Vec3::Zero()}};
    for (int i = 0; i < 50; ++i) {
      base::TimedPoint& from = path.back();
      from.acceleration = i == 20 ? path[19].acceleration : Vec3(limits.max_acceleration * vec().normalized());
      const Vec3 velocity = from.velocity + limits.step * from.acceleration;
      const Vec3 position = from.position + 0.5 * limits.step * (from.velocity + velocity);
      path.push_back({from.t + limits.step, position, velocity, Vec3::Zero()});
    }
    const LimitsUse use = use_of_limits(path, limits);
    ASSERT_TRUE(use.within()) << seed << ": " << use.acceleration;
    ASSERT_GT(use.acceleration, 1.0 - 1e-6) << seed;
    const double cut = path.front().t + limits.step * random.uniform(0.0, 40.0);
    const base::TimedPath rest = base::remainder(path, cut);
    limits.velocity = rest.front().velocity;
    ASSERT_TRUE(use_of_limits(rest, limits).within()) << seed << ": " << use_of_limits(rest, limits).acceleration;
  }
}

TEST(Verifier, JudgesLimitsWhereTheyAreGiven) {
  const base::TimedPath path = path_of({{0, {0, 0, 0}}, {1, {1, 0, 0}}});
  VerifierInput input;
  input.path = path;
  EXPECT_TRUE(verify(input).flyable());
  EXPECT_EQ(verify(input).limits.speed, 0.0);
  input.limits = FlightLimits{};
  input.limits->max_speed = 0.5;
  EXPECT_NEAR(verify(input).limits.speed, 2.0, 1e-12);
  EXPECT_TRUE(verify(input).free());
  EXPECT_FALSE(verify(input).flyable());
  input.limits->max_speed = 1.0;
  EXPECT_TRUE(verify(input).flyable());
}

}  // namespace
}  // namespace jink::planner::verify
