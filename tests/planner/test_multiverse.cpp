// SPDX-License-Identifier: BSD-3-Clause
#include "planner/multiverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace jink::planner {
namespace {

// Eq. (19) with 0.2 and 1: 0.2 + 0.8·fraction.
TEST(WormholeProbability, RisesLinearlyFromMinimumToMaximum) {
  const OptimizerSettings s;
  EXPECT_DOUBLE_EQ(wormhole_probability(0.0, s), 0.2);
  EXPECT_DOUBLE_EQ(wormhole_probability(0.25, s), 0.4);
  EXPECT_DOUBLE_EQ(wormhole_probability(1.0, s), 1.0);
}

// Eq. (20), corrected: 1 − fraction^(1/6); (1/64)^(1/6) = 1/2.
TEST(TravellingDistance, FallsFromOneToZero) {
  OptimizerSettings s;
  EXPECT_DOUBLE_EQ(travelling_distance(0.0, s), 1.0);
  EXPECT_NEAR(travelling_distance(1.0 / 64.0, s), 0.5, 1e-15);
  EXPECT_DOUBLE_EQ(travelling_distance(1.0, s), 0.0);
  s.exploitation = 2.0;
  EXPECT_DOUBLE_EQ(travelling_distance(0.25, s), 0.5);  // 1 − sqrt(0.25)
}

// Eq. (18): the first number picks the side, the second is r: leader ± tdr·(upper − lower)·r.
TEST(Wormhole, StepsFromTheLeaderByAShareOfTheRange) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream numbers(seed);
    const double side = numbers.uniform() < 0.5 ? 1.0 : -1.0;
    const double r = numbers.uniform();
    RandomStream random(seed);
    EXPECT_DOUBLE_EQ(wormhole(3.0, 0.25, -2.0, 6.0, random), 3.0 + side * 2.0 * r);  // 0.25·8 = 2
  }
}

TEST(Wormhole, GoesBothWaysAlike) {
  RandomStream random(5);
  int above = 0;
  double sum = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double value = wormhole(0.0, 1.0, 0.0, 1.0, random);
    ASSERT_LT(std::abs(value), 1.0);
    above += value > 0.0 ? 1 : 0;
    sum += value;
  }
  EXPECT_NEAR(above, kDraws / 2, 5 * 71);  // 5 sigma of a binomial: sqrt(20000)/2 = 71
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 * 0.577 / std::sqrt(kDraws));
}

TEST(Wormhole, StaysAtTheLeaderAtTheEndOfTheBudget) {
  RandomStream random(6);
  EXPECT_EQ(wormhole(1.5, 0.0, -4.0, 4.0, random), 1.5);
}

// The circulating code's trailing "+ lb" makes the step depend on the origin.
TEST(Wormhole, ShiftingTheBoxShiftsTheResult) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomStream here(seed);
    RandomStream there(seed);
    EXPECT_NEAR(wormhole(0.3, 0.7, -1.0, 2.0, here) + 10.0, wormhole(10.3, 0.7, 9.0, 12.0, there), 1e-12);
  }
}

// Weights n, n−1, .. 1: for n = 4 the shares are 0.4, 0.3, 0.2, 0.1.
TEST(WhiteHole, WeightFallsLinearlyWithThePosition) {
  RandomStream random(7);
  constexpr int kDraws = 100000;
  for (const std::size_t n : {1UL, 2UL, 4UL, 9UL}) {
    std::vector<int> hits(n, 0);
    for (int i = 0; i < kDraws; ++i) {
      const std::size_t position = white_hole(n, random);
      ASSERT_LT(position, n);
      ++hits[position];
    }
    for (std::size_t k = 0; k < n; ++k) {
      const double share = static_cast<double>(n - k) / (0.5 * static_cast<double>(n * (n + 1)));
      const double sigma = std::sqrt(share * (1.0 - share) * kDraws);
      EXPECT_NEAR(hits[k], share * kDraws, 5.0 * sigma + 0.5) << "position " << k << " of " << n;
    }
  }
}

}  // namespace
}  // namespace jink::planner
