// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/topsis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/base/random.hpp"
#include "tests/support/fronts.hpp"

namespace jink::planner::optimizer {
namespace {

using testing_support::cost;

// Column 1, shifted: 0 1 3, sum 4: p = 0, 1/4, 3/4; entropy = ln 4 /4 + (3/4) ln(4/3) = 0.562335; over ln 3: 0.511860;
// divergence 0.488140. Column 2, shifted: 2 2 0: p = 1/2, 1/2, 0; entropy ln 2 = 0.693147; over ln 3: 0.630930;
// divergence 0.369070. Weights 0.488140/0.857210 and 0.369070/0.857210.
TEST(EntropyWeights, MatchHandWorkedExample) {
  const std::vector<Cost> costs{cost(1, 5), cost(2, 5), cost(4, 3)};
  const std::vector<double> w = entropy_weights(costs, 2);
  EXPECT_NEAR(w[0], 0.569452, 1e-5);
  EXPECT_NEAR(w[1], 0.430548, 1e-5);
}

TEST(EntropyWeights, SumToOneAndIgnoreConstantColumns) {
  const std::vector<Cost> costs{cost(1, 5), cost(2, 5), cost(4, 5)};
  const std::vector<double> w = entropy_weights(costs, 2);
  EXPECT_DOUBLE_EQ(w[0], 1.0);
  EXPECT_DOUBLE_EQ(w[1], 0.0);
}

TEST(EntropyWeights, AreEqualWhereAllColumnsAreConstant) {
  EXPECT_EQ(entropy_weights(std::vector<Cost>{cost(1, 5), cost(1, 5)}, 2), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(entropy_weights(std::vector<Cost>{cost(1, 5)}, 2), (std::vector<double>{0.5, 0.5}));
}

// Columns shifted: (0 1 4) and (4 1 0), both of length sqrt(17); weights 1/2. Squared distances times 34, to the ideal
// and the anti-ideal: a: 0 + 16, 16 + 0; b: 1 + 1, 9 + 9; c as a. Closeness a, c: 4/(4+4) = 0.5; b:
// sqrt(18)/(sqrt(2)+sqrt(18)) = 0.75.
TEST(Topsis, PrefersTheCompromiseOfAHandWorkedExample) {
  const std::vector<Cost> costs{cost(10, -3), cost(11, -6), cost(14, -7)};
  EXPECT_EQ(topsis_order(costs, 2, std::array{0.5, 0.5}), (std::vector<int>{1, 0, 2}));  // 0 and 2 tie: by index
}

// The same front with weights 0.9, 0.1, squared distances times 170: a: 0.1·16 to the ideal, 0.9·16 to the anti-ideal:
// 3.7947/(1.2649 + 3.7947) = 0.75; b: 0.9 + 0.1 = 1 and 0.9·9 + 0.1·9 = 9: 3/(1 + 3) = 0.75 as well; with 0.95, 0.05:
// a: sqrt(0.8) = 0.8944 and sqrt(15.2) = 3.8987: 0.8134; b stays 0.75; c: 0.1866.
TEST(Topsis, FollowsUserWeights) {
  const std::vector<Cost> costs{cost(14, -7), cost(11, -6), cost(10, -3)};
  EXPECT_EQ(topsis_order(costs, 2, std::array{0.95, 0.05}), (std::vector<int>{2, 1, 0}));
  EXPECT_EQ(topsis_order(costs, 2, std::array{0.05, 0.95}), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(topsis_order(costs, 2, std::array{0.85, 0.15}).front(), 1);
}

// The length of a column decides, not its unit: the second in millimetres changes nothing.
TEST(Topsis, IsIndependentOfUnitsAndOffsets) {
  base::RandomStream random(1);
  for (int round = 0; round < 100; ++round) {
    std::vector<Cost> costs;
    std::vector<Cost> scaled;
    for (int i = 0; i < 12; ++i) {
      const double f1 = random.uniform();
      const double f2 = random.uniform();
      costs.push_back(cost(f1, f2));
      scaled.push_back(cost(f1 - 5.0, 1000.0 * f2 + 3.0));
    }
    EXPECT_EQ(topsis_order(costs, 2), topsis_order(scaled, 2));
  }
}

// Minimised objectives with positive weights: what dominates comes first.
TEST(Topsis, NeverPutsADominatedSolutionBeforeItsDominator) {
  base::RandomStream random(2);
  for (int round = 0; round < 200; ++round) {
    std::vector<Cost> costs;
    for (int i = 0; i < 15; ++i) {
      const double f1 = random.uniform();
      costs.push_back({{f1, random.uniform(), random.uniform()}, random.below(3) == 0 ? random.uniform() : 0.0});
    }
    const std::vector<int> order = topsis_order(costs, 3, std::array{0.6, 0.05, 0.35});
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        ASSERT_FALSE(
            dominates(costs[static_cast<std::size_t>(order[j])], costs[static_cast<std::size_t>(order[i])], 3));
      }
    }
  }
}

TEST(Topsis, OrdersOneSolutionAndNone) {
  EXPECT_EQ(topsis_order(std::vector<Cost>{cost(1, 2)}, 2), (std::vector<int>{0}));
  EXPECT_TRUE(topsis_order(std::vector<Cost>{}, 2).empty());
}

TEST(Topsis, IgnoresAConstantColumn) {
  const std::vector<Cost> costs{cost(3, 1), cost(1, 1), cost(2, 1)};
  EXPECT_EQ(topsis_order(costs, 2), (std::vector<int>{1, 2, 0}));
  EXPECT_EQ(topsis_order(costs, 2, std::array{0.01, 0.99}), (std::vector<int>{1, 2, 0}));
}

TEST(Topsis, OrdersByIndexWhereAllColumnsAreConstant) {
  EXPECT_EQ(topsis_order(std::vector<Cost>(5, cost(2, 2)), 2), (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(Topsis, PutsInfeasibleSolutionsBehindByViolation) {
  const std::vector<Cost> costs{cost(0, 0, 2.0), cost(9, 9), cost(0, 0, 1.0), cost(1, 1)};
  EXPECT_EQ(topsis_order(costs, 2), (std::vector<int>{3, 1, 2, 0}));
}

// An infeasible outlier must not stretch the scale on which the feasible are compared.
TEST(Topsis, ComparesTheFeasibleAmongThemselves) {
  const std::vector<Cost> feasible{cost(10, -3), cost(11, -6), cost(14, -7)};
  std::vector<Cost> all = feasible;
  all.push_back({{1e300, 1e300, 1e300}, 1e300});
  std::vector<int> expected = topsis_order(feasible, 2);
  expected.push_back(3);
  EXPECT_EQ(topsis_order(all, 2), expected);
}

}  // namespace
}  // namespace jink::planner::optimizer
