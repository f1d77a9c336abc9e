// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/grid_repository.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace jink::tools::lab::algorithms {
namespace {

using planner::base::RandomStream;
using planner::optimizer::Cost;

Cost cost(double f1, double f2, double violation = 0.0) {
  return {{f1, f2, 0.0}, violation};
}

TEST(Repository, HoldsWhatBruteForceHolds) {
  RandomStream random(1);
  for (int round = 0; round < 50; ++round) {
    Repository repository(1, 2);
    std::vector<Cost> all;
    for (int i = 0; i < 60; ++i) {
      // On a coarse grid, so that equal ones come, and with violations until a feasible one came.
      const double violation = round % 2 == 0 ? 0.0 : static_cast<double>(random.below(3));
      all.push_back(cost(static_cast<double>(random.below(8)), static_cast<double>(random.below(8)), violation));
      const double x = i;
      repository.add({&x, 1}, all.back());
    }
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < all.size(); ++i) {
      bool keep = true;
      for (std::size_t j = 0; j < all.size(); ++j) {
        const bool same = all[j].f == all[i].f && all[j].violation == all[i].violation;
        keep = keep && !planner::optimizer::dominates(all[j], all[i], 2) && !(same && j < i);
      }
      if (keep) expected.push_back(i);
    }
    ASSERT_EQ(repository.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(repository.x(k)[0], static_cast<double>(expected[k]));
      EXPECT_EQ(repository.costs()[k].f, all[expected[k]].f);
    }
  }
}

TEST(Roulette, DrawsByWeight) {
  RandomStream random(2);
  const std::vector<double> weights{0.0, 1.0, 0.0, 3.0, 0.0};
  std::array<int, 5> drawn{};
  for (int i = 0; i < 40000; ++i) ++drawn[roulette(weights, random)];
  EXPECT_EQ(drawn[0] + drawn[2] + drawn[4], 0);
  EXPECT_NEAR(drawn[1], 10000, 500);
}

/// Two cells of a 2 x 2 grid: three members close together, one far away.
GridRepository three_and_one(const GridSettings& settings, std::size_t capacity = 10) {
  GridRepository repository(settings, capacity, 1, 2);
  const double x = 0.0;
  for (const Cost& c : {cost(0.0, 1.0), cost(0.01, 0.99), cost(0.02, 0.98), cost(1.0, 0.0)}) repository.add({&x, 1}, c);
  return repository;
}

/// How often the lonely member is drawn, of 40 000.
int lonely(const GridRepository& repository) {
  RandomStream random(3);
  int count = 0;
  for (int i = 0; i < 40000; ++i) count += repository.draw(random) == 3 ? 1 : 0;
  return count;
}

// Weights 1 and 3^-2 = 1/9, or e^-1 and e^-3: shares 0.9 and 1/(1 + e^-2) = 0.8808.
TEST(GridRepository, DrawsLeadersFromCellsWithFewMembers) {
  RandomStream random(1);
  GridRepository power = three_and_one({0.1, 2, 2, 2, Pressure::kPower});
  power.settle(random);
  EXPECT_NEAR(lonely(power), 36000, 400);
  GridRepository exponential = three_and_one({0.1, 2, 1, 2, Pressure::kExponential});
  exponential.settle(random);
  EXPECT_NEAR(lonely(exponential), 0.8808 * 40000, 400);
}

TEST(GridRepository, DrawsNoExcludedMember) {
  RandomStream random(1);
  GridRepository repository = three_and_one({0.1, 2, 4, 2, Pressure::kPower});
  repository.settle(random);
  const std::vector<std::size_t> excluded{3, 1};
  std::array<int, 4> drawn{};
  for (int i = 0; i < 2000; ++i) ++drawn[repository.draw(random, excluded)];
  EXPECT_EQ(drawn[1] + drawn[3], 0);
  EXPECT_NEAR(drawn[0], 1000, 150);
}

// Weights 3^2 = 9 and 1, or 1 and e^-4: the lonely one goes in 0.1 and 0.018 of all cases.
TEST(GridRepository, TakesMembersOutWhereItIsCrowded) {
  const auto gone = [](const GridSettings& settings) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 10000; ++seed) {
      RandomStream random(seed);
      GridRepository repository = three_and_one(settings, 3);
      repository.settle(random);
      EXPECT_EQ(repository.members().size(), 3U);
      const auto costs = repository.members().costs();
      count += std::none_of(costs.begin(), costs.end(), [](const Cost& c) { return c.f[0] == 1.0; }) ? 1 : 0;
    }
    return count;
  };
  EXPECT_NEAR(gone({0.1, 2, 2, 2, Pressure::kPower}), 1000, 150);
  EXPECT_NEAR(gone({0.1, 2, 2, 2, Pressure::kExponential}), 180, 60);
}

// Pressures that overflow or vanish if taken literally: 400 members, e^800.
TEST(GridRepository, StandsManyMembersInOneCell) {
  RandomStream random(1);
  GridRepository repository({0.1, 1, 2, 2, Pressure::kExponential}, 390, 1, 2);
  for (int i = 0; i < 400; ++i) {
    const double x = i;
    repository.add({&x, 1}, cost(i, -i));
  }
  repository.settle(random);
  EXPECT_EQ(repository.members().size(), 390U);
  EXPECT_LT(repository.draw(random), 390U);
}

TEST(GridRepository, StandsMembersWithoutExtent) {
  RandomStream random(1);
  GridRepository repository({0.1, 7, 2, 2, Pressure::kExponential}, 5, 1, 2);
  repository.settle(random);  // empty
  const double x = 1.0;
  repository.add({&x, 1}, cost(2.0, 2.0));
  repository.settle(random);
  EXPECT_EQ(repository.draw(random), 0U);
  repository.clear();
  EXPECT_EQ(repository.members().size(), 0U);
}

}  // namespace
}  // namespace jink::tools::lab::algorithms
