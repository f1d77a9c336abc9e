// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/pareto.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "planner/base/random.hpp"
#include "tests/support/fronts.hpp"

namespace jink::planner::optimizer {
namespace {

using testing_support::cost;

TEST(Dominates, NeedsNoWorseEverywhereAndBetterSomewhere) {
  EXPECT_TRUE(dominates(cost(1, 1), cost(2, 2), 2));
  EXPECT_TRUE(dominates(cost(1, 2), cost(2, 2), 2));
  EXPECT_FALSE(dominates(cost(2, 2), cost(2, 2), 2));
  EXPECT_FALSE(dominates(cost(1, 3), cost(2, 2), 2));
  EXPECT_FALSE(dominates(cost(2, 2), cost(1, 3), 2));
}

TEST(Dominates, LooksAtTheGivenObjectivesAlone) {
  const Cost a{{1, 5, 9}, 0.0};
  const Cost b{{2, 6, 1}, 0.0};
  EXPECT_TRUE(dominates(a, b, 1));
  EXPECT_TRUE(dominates(a, b, 2));
  EXPECT_FALSE(dominates(a, b, 3));
}

TEST(Dominates, PrefersASmallerViolationToAnyObjective) {
  EXPECT_TRUE(dominates(cost(9, 9, 0.1), cost(1, 1, 0.2), 2));
  EXPECT_FALSE(dominates(cost(1, 1, 0.2), cost(9, 9, 0.1), 2));
  EXPECT_TRUE(dominates(cost(9, 9), cost(1, 1, 1e-12), 2));
  EXPECT_TRUE(dominates(cost(1, 1, 0.2), cost(2, 2, 0.2), 2));  // equal violation: Pareto
}

TEST(MakeRankable, LeavesFiniteCostsAlone) {
  Cost c{{1, -2, 3}, 4};
  make_rankable(c);
  EXPECT_EQ(c.f, (std::array<double, 3>{1, -2, 3}));
  EXPECT_EQ(c.violation, 4.0);
}

TEST(MakeRankable, PutsEveryNonFiniteCostBehindAllOthers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const Cost bad[] = {cost(nan, 0),     cost(0, nan),    cost(-inf, 0),   cost(inf, 0),
                      {{0, 0, nan}, 0}, cost(0, 0, nan), cost(0, 0, inf), cost(inf, -inf)};
  for (Cost c : bad) {
    make_rankable(c);
    EXPECT_TRUE(dominates(cost(1e9, 1e9, 1e9), c, 2));
    EXPECT_FALSE(dominates(c, cost(1e9, 1e9, 1e9), 2));
    EXPECT_TRUE(std::isfinite(c.violation + c.f[0] + c.f[1] + c.f[2]));
  }
}

TEST(Ranking, PutsNanLast) {
  std::vector<Cost> costs{cost(std::numeric_limits<double>::quiet_NaN(), 0), cost(5, 5, 3), cost(1, 1)};
  for (Cost& c : costs) make_rankable(c);
  Ranking ranking(3);
  const auto order = ranking.order(costs, 2);
  EXPECT_EQ(std::vector<int>(order.begin(), order.end()), (std::vector<int>{2, 1, 0}));
}

// Front 0: (0,4), (1,3), (3,1), (4,0) at indices 0 3 1 4, extents 4 and 4. Crowding of index 3: (3−0)/4 + (4−1)/4
// = 1.5, of index 1: (4−1)/4 + (3−0)/4 = 1.5, the extremes infinite: order 0 4 1 3 by index within ties. Front 1:
// index 2.
TEST(Ranking, OrdersByFrontThenCrowdingThenIndex) {
  const std::vector<Cost> costs{cost(0, 4), cost(3, 1), cost(5, 5), cost(1, 3), cost(4, 0)};
  Ranking ranking(5);
  const auto order = ranking.order(costs, 2);
  EXPECT_EQ(std::vector<int>(order.begin(), order.end()), (std::vector<int>{0, 4, 1, 3, 2}));
  EXPECT_EQ(ranking.fronts()[2], 1);
}

// f1 = 0, 1, 2, 10 with f2 falling alike: crowding of f1 = 1: 2/10 twice, of f1 = 2: 9/10 twice, so 2 comes first.
TEST(Ranking, PrefersTheWiderGap) {
  const std::vector<Cost> costs{cost(0, 10), cost(1, 9), cost(2, 8), cost(10, 0)};
  Ranking ranking(4);
  const auto order = ranking.order(costs, 2);
  EXPECT_EQ(std::vector<int>(order.begin(), order.end()), (std::vector<int>{0, 3, 2, 1}));
}

TEST(Ranking, OrdersEqualSolutionsByIndex) {
  const std::vector<Cost> costs(6, cost(1, 1));
  Ranking ranking(6);
  const auto order = ranking.order(costs, 2);
  EXPECT_EQ(order.front(), 0);
  for (const int front : ranking.fronts()) EXPECT_EQ(front, 0);
}

std::vector<Cost> random_costs(base::RandomStream& random, std::size_t n, int objectives) {
  std::vector<Cost> costs(n);
  for (Cost& c : costs) {
    for (int k = 0; k < objectives; ++k) c.f[static_cast<std::size_t>(k)] = static_cast<double>(random.below(8));
    if (random.below(4) == 0) c.violation = static_cast<double>(random.below(3));
  }
  return costs;
}

/// Peels fronts by the definition: what no unassigned solution dominates goes next.
std::vector<int> peel(const std::vector<Cost>& costs, int objectives) {
  std::vector<int> front(costs.size(), -1);
  for (int level = 0; std::find(front.begin(), front.end(), -1) != front.end(); ++level) {
    std::vector<std::size_t> next;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      bool dominated = false;
      for (std::size_t j = 0; j < costs.size(); ++j) {
        dominated = dominated || (front[j] < 0 && dominates(costs[j], costs[i], objectives));
      }
      if (front[i] < 0 && !dominated) next.push_back(i);
    }
    for (const std::size_t i : next) front[i] = level;
  }
  return front;
}

/// Crowding distance of one solution among its front, each objective by neighbours in the order (value, index).
double crowding(const std::vector<Cost>& costs, const std::vector<int>& fronts, std::size_t self, int objectives) {
  double sum = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(objectives); ++k) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (fronts[i] == fronts[self]) members.push_back(i);
    }
    std::stable_sort(members.begin(), members.end(), [&](auto a, auto b) { return costs[a].f[k] < costs[b].f[k]; });
    const auto at = static_cast<std::size_t>(std::find(members.begin(), members.end(), self) - members.begin());
    if (at == 0 || at + 1 == members.size()) return std::numeric_limits<double>::infinity();
    const double extent = costs[members.back()].f[k] - costs[members.front()].f[k];
    if (extent > 0.0) sum += (costs[members[at + 1]].f[k] - costs[members[at - 1]].f[k]) / extent;
  }
  return sum;
}

TEST(Ranking, MatchesBruteForce) {
  base::RandomStream random(8);
  Ranking ranking(40);
  for (int round = 0; round < 300; ++round) {
    const int objectives = 1 + static_cast<int>(random.below(3));
    const std::vector<Cost> costs = random_costs(random, 1 + random.below(40), objectives);
    const auto order = ranking.order(costs, objectives);
    const std::vector<int> fronts = peel(costs, objectives);
    ASSERT_EQ(std::vector<int>(ranking.fronts().begin(), ranking.fronts().end()), fronts);
    std::vector<int> expected(costs.size());
    std::iota(expected.begin(), expected.end(), 0);
    std::vector<double> crowd(costs.size());
    for (std::size_t i = 0; i < costs.size(); ++i) crowd[i] = crowding(costs, fronts, i, objectives);
    std::sort(expected.begin(), expected.end(), [&](int a, int b) {
      const auto i = static_cast<std::size_t>(a);
      const auto j = static_cast<std::size_t>(b);
      return std::tuple(fronts[i], -crowd[i], a) < std::tuple(fronts[j], -crowd[j], b);
    });
    ASSERT_EQ(std::vector<int>(order.begin(), order.end()), expected);
  }
}

}  // namespace
}  // namespace jink::planner::optimizer
