// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/multiverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace jink::planner::optimizer {
namespace {

// Eq. (19) with 0.2 and 1: 0.2 + 0.8·fraction.
TEST(WormholeProbability, RisesLinearlyFromMinimumToMaximum) {
  const base::OptimizerSettings s;
  EXPECT_DOUBLE_EQ(wormhole_probability(0.0, s), 0.2);
  EXPECT_DOUBLE_EQ(wormhole_probability(0.25, s), 0.4);
  EXPECT_DOUBLE_EQ(wormhole_probability(1.0, s), 1.0);
}

// Eq. (20), corrected: 1 − fraction^(1/6); (1/64)^(1/6) = 1/2.
TEST(TravellingDistance, FallsFromOneToZero) {
  base::OptimizerSettings s;
  EXPECT_DOUBLE_EQ(travelling_distance(0.0, s), 1.0);
  EXPECT_NEAR(travelling_distance(1.0 / 64.0, s), 0.5, 1e-15);
  EXPECT_DOUBLE_EQ(travelling_distance(1.0, s), 0.0);
  s.exploitation = 2.0;
  EXPECT_DOUBLE_EQ(travelling_distance(0.25, s), 0.5);  // 1 − sqrt(0.25)
}

// Eq. (20) as printed, with n_iter = 100 and iter = 64: 1 − 64^(1/6)/100 = 0.98.
TEST(TravellingDistance, StaysNearOneAsPrinted) {
  base::OptimizerSettings s;
  s.operators = base::Operators::kPrinted;
  EXPECT_NEAR(travelling_distance(0.64, s), 0.98, 1e-15);
}

constexpr base::Operators kAll[] = {base::Operators::kPrinted, base::Operators::kCommon, base::Operators::kCorrected,
                                    base::Operators::kAdaptive};

// Eq. (18): of one number u, 2u − 1 has the side as its sign and r as its size. Leader 3, box [-2, 6], TDR 0.25.
TEST(Wormhole, StepsFromTheLeaderAsItsOperatorsSay) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const double signed_r = 2.0 * base::RandomStream(seed).uniform() - 1.0;
    const double side = signed_r < 0.0 ? -1.0 : 1.0;
    const double r = std::abs(signed_r);
    const double expected[] = {3.25 + side * (6.0 + 2.0 * r - 2.0),  // leader + tdr ± (upper − lower·r + lower)
                               3.0 + side * 0.25 * (8.0 * r - 2.0),  // leader ± tdr·((upper − lower)·r + lower)
                               3.0 + side * 2.0 * r,                 // leader ± tdr·(upper − lower)·r, 0.25·8 = 2
                               3.0 + side * 2.0 * r};
    for (std::size_t k = 0; k < 4; ++k) {
      base::RandomStream random(seed);
      EXPECT_DOUBLE_EQ(wormhole(3.0, 0.25, -2.0, 6.0, kAll[k], random), expected[k]);
    }
  }
}

// Leader 3, box [-2, 6], TDR 0.25: 3 + 2·0.25·8·r³ = 3 + 4 r³.
TEST(NarrowWormhole, CubesItsStep) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const double r = 2.0 * base::RandomStream(seed).uniform() - 1.0;
    base::RandomStream random(seed);
    EXPECT_DOUBLE_EQ(narrow_wormhole(3.0, 0.25, -2.0, 6.0, random), 3.0 + 4.0 * r * r * r);
  }
}

TEST(MoveChoice, StartsEvenAndFollowsSuccess) {
  MoveChoice choice;
  EXPECT_EQ(choice.narrow_share(), 0.5);
  for (int i = 0; i < 8; ++i) {
    choice.judge(Move::kWide, i == 0);   // (1 + 1)/(8 + 2) = 0.2
    choice.judge(Move::kNarrow, i < 3);  // (3 + 1)/(8 + 2) = 0.4
  }
  choice.adapt();
  EXPECT_DOUBLE_EQ(choice.narrow_share(), 0.4 / 0.6);
}

TEST(MoveChoice, CreditsNoKindWithWhatWasReceived) {
  MoveChoice choice;
  for (int i = 0; i < 8; ++i) choice.judge(Move::kReceived, true);
  choice.adapt();
  EXPECT_EQ(choice.narrow_share(), 0.5);
}

TEST(MoveChoice, LeavesEachKindATenth) {
  MoveChoice choice;
  for (int generation = 0; generation < 50; ++generation) {
    for (int i = 0; i < 20; ++i) {
      choice.judge(Move::kWide, true);
      choice.judge(Move::kNarrow, false);
    }
    choice.adapt();
  }
  EXPECT_DOUBLE_EQ(choice.narrow_share(), 0.1);
  base::RandomStream random(3);
  int narrow = 0;
  for (int i = 0; i < 10000; ++i) narrow += choice.draw(random) == Move::kNarrow ? 1 : 0;
  EXPECT_NEAR(narrow, 1000, 150);  // 5 sigma: sqrt(10000·0.09) = 30
}

TEST(Wormhole, GoesBothWaysAlike) {
  base::RandomStream random(5);
  int above = 0;
  double sum = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double value = wormhole(0.0, 1.0, 0.0, 1.0, base::Operators::kCorrected, random);
    ASSERT_LT(std::abs(value), 1.0);
    above += value > 0.0 ? 1 : 0;
    sum += value;
  }
  EXPECT_NEAR(above, 0.5 * kDraws, 5 * 71);  // 5 sigma of a binomial: sqrt(20000)/2 = 71
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 * 0.577 / std::sqrt(kDraws));
}

TEST(Wormhole, StaysAtTheLeaderAtTheEndOfTheBudget) {
  base::RandomStream random(6);
  EXPECT_EQ(wormhole(1.5, 0.0, -4.0, 4.0, base::Operators::kCorrected, random), 1.5);
}

// The circulating code's trailing "+ lb" makes the step depend on the origin.
TEST(Wormhole, ShiftingTheBoxShiftsTheResult) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    base::RandomStream here(seed);
    base::RandomStream there(seed);
    EXPECT_NEAR(wormhole(0.3, 0.7, -1.0, 2.0, base::Operators::kCorrected, here) + 10.0,
                wormhole(10.3, 0.7, 9.0, 12.0, base::Operators::kCorrected, there), 1e-12);
  }
}

// Weights 2n − 1, 2n − 3, .. 1: for n = 4 the shares are 7/16, 5/16, 3/16, 1/16.
TEST(WhiteHole, WeightFallsLinearlyWithThePosition) {
  base::RandomStream random(7);
  constexpr int kDraws = 100000;
  for (const std::size_t n : {1UL, 2UL, 4UL, 9UL}) {
    std::vector<int> hits(n, 0);
    for (int i = 0; i < kDraws; ++i) {
      const std::size_t position = white_hole(n, random);
      ASSERT_LT(position, n);
      ++hits[position];
    }
    for (std::size_t k = 0; k < n; ++k) {
      const double share = static_cast<double>(2 * (n - k) - 1) / static_cast<double>(n * n);
      const double sigma = std::sqrt(share * (1.0 - share) * kDraws);
      EXPECT_NEAR(hits[k], share * kDraws, 5.0 * sigma + 0.5) << "position " << k << " of " << n;
    }
  }
}

}  // namespace
}  // namespace jink::planner::optimizer
