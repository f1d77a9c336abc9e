// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/archive.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/fronts.hpp"

namespace jink::planner::optimizer {
namespace {

using testing_support::cost;

bool add(Archive& archive, const Cost& c, base::RandomStream& random) {
  return archive.add(std::array{c.f[0], c.f[1]}, c, random);
}

/// Each member's variables are its objectives: they must have stayed together.
void expect_consistent(const Archive& archive, int objectives) {
  for (std::size_t i = 0; i < archive.size(); ++i) {
    EXPECT_EQ(archive.x(i)[0], archive.cost(i).f[0]);
    EXPECT_EQ(archive.x(i)[1], archive.cost(i).f[1]);
    for (std::size_t j = 0; j < archive.size(); ++j) {
      EXPECT_FALSE(dominates(archive.cost(i), archive.cost(j), objectives));
      EXPECT_TRUE(i == j || archive.cost(i).f != archive.cost(j).f);
    }
  }
}

TEST(Archive, RejectsDominatedCandidate) {
  base::RandomStream random(1);
  Archive archive(5, 2, 2);
  EXPECT_TRUE(add(archive, cost(1, 1), random));
  EXPECT_FALSE(add(archive, cost(1, 2), random));
  EXPECT_FALSE(add(archive, cost(0, 0, 0.5), random));  // better objectives, but it violates
  EXPECT_EQ(archive.size(), 1U);
}

TEST(Archive, RejectsDuplicate) {
  base::RandomStream random(1);
  Archive archive(5, 2, 2);
  EXPECT_TRUE(add(archive, cost(1, 1), random));
  EXPECT_FALSE(add(archive, cost(1, 1), random));
  EXPECT_EQ(archive.size(), 1U);
}

TEST(Archive, RemovesWhatTheCandidateDominates) {
  base::RandomStream random(1);
  Archive archive(5, 2, 2);
  for (const Cost& c : {cost(1, 5), cost(2, 4), cost(3, 3), cost(5, 1)}) EXPECT_TRUE(add(archive, c, random));
  EXPECT_TRUE(add(archive, cost(2, 2), random));  // beats (2,4) and (3,3)
  EXPECT_EQ(archive.size(), 3U);
  expect_consistent(archive, 2);
}

TEST(Archive, FeasibleCandidateReplacesViolators) {
  base::RandomStream random(1);
  Archive archive(5, 2, 2);
  add(archive, cost(0, 1, 2.0), random);
  add(archive, cost(1, 0, 2.0), random);
  EXPECT_EQ(archive.size(), 2U);
  EXPECT_TRUE(add(archive, cost(9, 9), random));
  ASSERT_EQ(archive.size(), 1U);
  EXPECT_EQ(archive.cost(0).violation, 0.0);
}

TEST(Archive, IsEmptyAfterClear) {
  base::RandomStream random(1);
  Archive archive(5, 2, 2);
  add(archive, cost(1, 1), random);
  archive.clear();
  EXPECT_EQ(archive.size(), 0U);
  EXPECT_TRUE(add(archive, cost(2, 2), random));
}

TEST(Archive, HoldsTheNonDominatedOfAllThatFit) {
  base::RandomStream random(2);
  for (int round = 0; round < 100; ++round) {
    Archive archive(200, 2, 2);
    std::vector<Cost> all;
    for (int i = 0; i < 150; ++i) {
      const double f1 = static_cast<double>(random.below(30));
      all.push_back(cost(f1, static_cast<double>(random.below(30))));
      add(archive, all.back(), random);
    }
    expect_consistent(archive, 2);
    for (const Cost& c : all) {
      bool beaten = false;
      for (const Cost& other : all) beaten = beaten || dominates(other, c, 2);
      bool held = false;
      for (const Cost& member : archive.costs()) held = held || member.f == c.f;
      ASSERT_EQ(held, !beaten);
    }
  }
}

// Points on the line f1 + f2 = 1 never dominate each other, so the archive overflows at every batch.
TEST(Archive, NeverExceedsCapacityAndNeverLosesAnExtreme) {
  base::RandomStream random(3);
  for (int round = 0; round < 50; ++round) {
    Archive archive(6, 2, 2);
    double lowest = 2.0;
    double highest = -1.0;
    for (int i = 0; i < 200; ++i) {
      const double f1 = random.uniform();
      EXPECT_TRUE(add(archive, cost(f1, 1.0 - f1), random));
      lowest = std::min(lowest, f1);
      highest = std::max(highest, f1);
      if (random.below(3) > 0) continue;
      archive.settle(random);
      ASSERT_LE(archive.size(), 6U);
      bool has_lowest = false;
      bool has_highest = false;
      for (const Cost& member : archive.costs()) {
        has_lowest = has_lowest || member.f[0] == lowest;
        has_highest = has_highest || member.f[0] == highest;
      }
      ASSERT_TRUE(has_lowest && has_highest);
    }
    expect_consistent(archive, 2);
  }
}

// A batch larger than the room beyond the capacity: the archive settles by itself.
TEST(Archive, TakesABatchOfAnySize) {
  base::RandomStream random(13);
  Archive archive(6, 2, 2);
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(add(archive, cost(i, 1000 - i), random));
  archive.settle(random);
  EXPECT_EQ(archive.size(), 6U);
  EXPECT_EQ(archive.cost(0).f[0], 0.0);
  EXPECT_EQ(archive.cost(5).f[0], 999.0);
  expect_consistent(archive, 2);
}

TEST(Archive, IsInOrderOfTheFirstObjective) {
  base::RandomStream random(14);
  for (const int objectives : {1, 2, 3}) {
    Archive archive(20, 2, objectives);
    for (int i = 0; i < 300; ++i) {
      Cost c;
      for (std::size_t k = 0; k < static_cast<std::size_t>(objectives); ++k) c.f[k] = random.uniform();
      add(archive, c, random);
      if (i % 10 == 0) archive.settle(random);
      for (std::size_t k = 1; k < archive.size(); ++k) ASSERT_LT(archive.cost(k - 1).f, archive.cost(k).f);
    }
    expect_consistent(archive, objectives);
  }
}

// Three objectives on the plane f1 + f2 + f3 = 1 in the smallest archive that holds the extremes.
TEST(Archive, KeepsTheExtremesOfThreeObjectives) {
  base::RandomStream random(4);
  Archive archive(4, 2, 3);
  std::array<double, 3> best{2, 2, 2};
  for (int i = 0; i < 500; ++i) {
    const double a = random.uniform();
    const double b = random.uniform(0.0, 1.0 - a);
    const Cost c{{a, b, 1.0 - a - b}, 0.0};
    archive.add(std::array{a, b}, c, random);
    archive.settle(random);
    for (std::size_t k = 0; k < 3; ++k) {
      best[k] = std::min(best[k], c.f[k]);
      double held = 2.0;
      for (const Cost& member : archive.costs()) held = std::min(held, member.f[k]);
      ASSERT_EQ(held, best[k]);
    }
    ASSERT_LE(archive.size(), 4U);
  }
}

/// The extremes (0,1) and (1,0), a crowd of `crowd` in one cell about 0.25, and one alone at 0.75.
void fill_with_crowd(Archive& archive, int crowd, base::RandomStream& random) {
  add(archive, cost(0, 1), random);
  add(archive, cost(1, 0), random);
  add(archive, cost(0.75, 0.25), random);
  for (int i = 0; i < crowd; ++i) add(archive, cost(0.24 + 0.001 * i, 0.76 - 0.001 * i), random);
}

// Eq. (21), weight 1/N: three cells of one and one of six: each lone member has a quarter of the draws (3·1 + 6·1/6
// = 4), each of the crowd 1/24.
TEST(Archive, DrawPrefersEmptierCells) {
  base::RandomStream random(5);
  Archive archive(20, 2, 2);
  fill_with_crowd(archive, 6, random);
  ASSERT_EQ(archive.size(), 9U);
  archive.settle(random);
  constexpr int kDraws = 24000;
  std::vector<int> hits(9, 0);
  for (int i = 0; i < kDraws; ++i) ++hits[archive.draw(random)];
  for (std::size_t i = 0; i < 9; ++i) {
    const bool alone = archive.cost(i).f[0] < 0.2 || archive.cost(i).f[0] > 0.5;
    const double share = alone ? 0.25 : 1.0 / 24.0;
    EXPECT_NEAR(hits[i], share * kDraws, 5.0 * std::sqrt(share * (1.0 - share) * kDraws)) << i;
  }
}

// Eq. (21), weight N: of the members that may go, 6 weigh 6 each, the lone one and the newcomer 1: 1 in 38 loses the
// lone one.
TEST(Archive, RemovesWhereItIsCrowded) {
  base::RandomStream random(6);
  constexpr int kRounds = 5000;
  int lone_lost = 0;
  for (int round = 0; round < kRounds; ++round) {
    Archive archive(9, 2, 2);
    fill_with_crowd(archive, 6, random);
    ASSERT_EQ(archive.size(), 9U);
    add(archive, cost(0.5, 0.5), random);
    archive.settle(random);
    bool held = false;
    for (const Cost& member : archive.costs()) held = held || member.f[0] == 0.75;
    lone_lost += held ? 0 : 1;
  }
  const double share = 1.0 / 38.0;
  EXPECT_NEAR(lone_lost, share * kRounds, 5.0 * std::sqrt(share * (1.0 - share) * kRounds));
}

TEST(Archive, DrawsEveryMemberWhenTheFrontHasNoExtent) {
  base::RandomStream random(7);
  Archive archive(5, 2, 2);
  add(archive, cost(3, 3), random);
  archive.settle(random);
  EXPECT_EQ(archive.draw(random), 0U);
}

// An extent so small that cells per extent overflow: 10/1e-309 is infinite, and 0 times it is not a number.
TEST(Archive, CopesWithAnExtentNearZero) {
  base::RandomStream random(8);
  Archive archive(5, 2, 2);
  add(archive, cost(0.0, 1.0), random);
  add(archive, cost(1e-309, 0.0), random);
  archive.settle(random);
  std::array<int, 2> hits{};
  for (int i = 0; i < 100; ++i) ++hits[archive.draw(random)];
  EXPECT_GT(hits[0], 0);
  EXPECT_GT(hits[1], 0);
}

TEST(Archive, AllocatesNothingAfterConstruction) {
  base::RandomStream random(9);
  Archive archive(10, 2, 2);
  const test::AllocationGuard guard;
  std::size_t drawn = 0;
  for (int i = 0; i < 100; ++i) {
    const double f1 = random.uniform();
    add(archive, cost(f1, 1.0 - f1), random);
    archive.settle(random);
    drawn += archive.draw(random);
  }
  archive.clear();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(drawn, 0U);
}

TEST(AllocationGuard, CountsAllocations) {
  const test::AllocationGuard guard;
  ::operator delete(::operator new(8));
  EXPECT_EQ(guard.count(), 1U);
}

}  // namespace
}  // namespace jink::planner::optimizer
