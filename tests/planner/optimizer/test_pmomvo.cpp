// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/pmomvo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/fronts.hpp"

namespace jink::planner::optimizer {
namespace {

using testing_support::Recorded;
using testing_support::volume_of;
using testing_support::Zdt;

constexpr int kDimension = 5;

Zdt zdt1() {
  return Zdt(1, kDimension);
}

base::OptimizerSettings settings(int slaves, int sharing, int population = 50) {
  base::OptimizerSettings s;
  s.slaves = slaves;
  s.sharing = sharing;
  s.population = population;
  return s;
}

/// A copy of the front of a new optimizer's run.
Front solve(const base::OptimizerSettings& s, int generations, int threads, std::span<const double> initial = {}) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(threads);
  Pmomvo optimizer(s, kDimension, 2);
  return optimizer.run(problem, initial, 11, 3, {generations, base::Budget::Time::max()}, pool);
}

void expect_same(const Front& a, const Front& b) {
  EXPECT_EQ(a.x, b.x);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a.costs[i].f, b.costs[i].f);
}

void expect_front(const Front& front) {
  ASSERT_GT(front.size(), 0U);
  ASSERT_EQ(front.x.size(), front.size() * static_cast<std::size_t>(front.dimension));
  for (std::size_t i = 0; i < front.size(); ++i) {
    Cost again;
    zdt1().evaluate(front.solution(i), {&again, 1});
    EXPECT_EQ(again.f, front.costs[i].f);  // costs[i] belongs to solution(i)
    for (std::size_t j = 0; j < front.size(); ++j) {
      EXPECT_FALSE(dominates(front.costs[i], front.costs[j], 2));
      EXPECT_TRUE(i == j || front.costs[i].f != front.costs[j].f);
    }
  }
}

// The true front has 0.8767; the least over 60 seeds is 0.856 (6 slaves).
TEST(Pmomvo, ConvergesOnZdt1) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(2);
  for (const auto& [slaves, sharing] : {std::pair{2, 3}, std::pair{4, 9}, std::pair{6, 9}}) {
    Pmomvo optimizer(settings(slaves, sharing), kDimension, 2);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Front& front = optimizer.run(problem, {}, seed, 0, {}, pool);
      expect_front(front);
      EXPECT_GT(volume_of(front.costs), 0.84) << slaves << " slaves, seed " << seed;
      EXPECT_LT(volume_of(front.costs), 0.8767);
    }
  }
}

TEST(Pmomvo, SameBitsForAnyNumberOfThreads) {
  for (const int slaves : {1, 4, 7}) {
    const Front one = solve(settings(slaves, 5), 30, 1);
    expect_front(one);
    for (const int threads : {2, 8}) expect_same(one, solve(settings(slaves, 5), 30, threads));
  }
}

TEST(Pmomvo, SeedAndStreamNameTheRandomNumbers) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(1);
  Pmomvo optimizer(settings(2, 1), kDimension, 2);
  const auto solution = [&](std::uint64_t seed, std::uint64_t stream) {
    return optimizer.run(problem, {}, seed, stream, {5, base::Budget::Time::max()}, pool).x;
  };
  const std::vector<double> first = solution(1, 1);
  EXPECT_NE(solution(2, 1), first);
  EXPECT_NE(solution(1, 2), first);
  EXPECT_EQ(solution(1, 1), first);  // also after other runs of the same optimizer
}

TEST(Pmomvo, OneSlaveWithoutSharingIsMomvoAlone) {
  const Front front = solve(settings(1, 0), 40, 2);
  const Zdt problem = zdt1();
  Momvo momvo(50, kDimension, 2, settings(1, 0));
  momvo.reset(problem, base::RandomStream(11, 3, 0));
  for (int i = 0; i < 40; ++i) momvo.iterate((i + 1) / 40.0);
  ASSERT_EQ(front.size(), momvo.archive().size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    EXPECT_EQ(front.costs[i].f, momvo.archive().cost(i).f);
    EXPECT_TRUE(std::ranges::equal(front.solution(i), momvo.archive().x(i)));
  }
}

// One slave that takes its own representative back is not the same as one that does not share.
TEST(Pmomvo, SharingHasAnEffect) {
  EXPECT_NE(solve(settings(4, 0), 40, 1).x, solve(settings(4, 9), 40, 1).x);
}

// Algorithm 2, steps 1 to 6, for two slaves of three universes: a random representative of each, and each slave's worst
// replaced by those of them that are not dominated, before the first iteration.
TEST(Pmomvo, SharesBeforeTheFirstCycleAsPrinted) {
  const Zdt zdt(1, 2);
  base::OptimizerSettings s = settings(2, 1, 6);
  s.operators = base::Operators::kPrinted;
  std::size_t both = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<std::vector<double>> universes;
    std::vector<std::vector<double>> representatives;
    std::vector<Cost> sent(2);
    for (std::size_t j = 0; j < 2; ++j) {
      base::RandomStream random(seed, 5, j);
      std::vector<double>& x = universes.emplace_back();
      for (int i = 0; i < 6; ++i) x.push_back(random.uniform());
      const double* chosen = x.data() + 2 * random.below(3);
      zdt.evaluate(representatives.emplace_back(chosen, chosen + 2), {&sent[j], 1});
    }
    std::vector<std::vector<double>> expected = universes;
    for (std::size_t j = 0; j < 2; ++j) {
      std::vector<Cost> costs(3);
      zdt.evaluate(universes[j], costs);
      Ranking ranking(3);
      const std::span<const int> order = ranking.order(costs, 2);
      std::size_t place = 2;
      for (std::size_t k = 0; k < 2; ++k) {
        if (dominates(sent[1 - k], sent[k], 2)) continue;
        std::ranges::copy(representatives[k], expected[j].begin() + 2 * order[place--]);
      }
      both += place == 0 ? 1 : 0;
    }
    const Recorded problem(zdt);
    base::WorkerPool pool(1);
    Pmomvo optimizer(s, 2, 2);
    optimizer.run(problem, {}, seed, 5, {2}, pool);
    ASSERT_EQ(problem.batches.size(), 6U);
    EXPECT_EQ(optimizer.report().evaluations, 3 * 6);
    EXPECT_EQ(problem.batches[0], universes[0]);
    EXPECT_EQ(problem.batches[1], universes[1]);
    EXPECT_EQ(problem.batches[2], expected[0]);
    EXPECT_EQ(problem.batches[3], expected[1]);
  }
  EXPECT_GT(both, 5U);
  EXPECT_LT(both, 35U);
}

TEST(Pmomvo, SharesOnlyAfterTheFirstCycleElsewhere) {
  const Zdt zdt(1, 2);
  for (const auto& [operators, sharing] :
       {std::pair{base::Operators::kCorrected, 1}, std::pair{base::Operators::kPrinted, 0}}) {
    const Recorded problem(zdt);
    base::OptimizerSettings s = settings(2, sharing, 6);
    s.operators = operators;
    base::WorkerPool pool(1);
    Pmomvo optimizer(s, 2, 2);
    optimizer.run(problem, {}, 1, 0, {2}, pool);
    EXPECT_EQ(problem.batches.size(), 4U);
    EXPECT_EQ(optimizer.report().evaluations, 2 * 6);
  }
}

TEST(Pmomvo, DealsAllUniversesOut) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(1);
  Pmomvo optimizer(settings(6, 3), kDimension, 2);
  optimizer.run(problem, {}, 1, 0, {20, base::Budget::Time::max()}, pool);
  EXPECT_EQ(optimizer.report().generations, 20);
  EXPECT_EQ(optimizer.report().evaluations, 20 * 50);
  EXPECT_FALSE(optimizer.report().deadline_reached);
}

TEST(Pmomvo, RefusesSettingsThatCannotWork) {
  const auto make = [](const base::OptimizerSettings& s) { Pmomvo(s, kDimension, 2); };
  EXPECT_THROW(make(settings(0, 0)), std::invalid_argument);
  EXPECT_THROW(make(settings(6, 0, 5)), std::invalid_argument);  // more slaves than universes
  EXPECT_THROW(make(settings(2, -1)), std::invalid_argument);
  base::OptimizerSettings s = settings(2, 0);
  s.iterations = 0;
  EXPECT_THROW(make(s), std::invalid_argument);
  s = settings(2, 0);
  s.archive = 2;
  EXPECT_THROW(make(s), std::invalid_argument);
  EXPECT_NO_THROW(make(settings(5, 0, 5)));
}

// Ten cycles, three iterations: the first cycles are empty, and there is nothing yet to share.
TEST(Pmomvo, WorksWithMoreCyclesThanIterations) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(2);
  Pmomvo optimizer(settings(3, 9), kDimension, 2);
  for (const int generations : {1, 3, 9, 10, 11}) {
    expect_front(optimizer.run(problem, {}, 1, 0, {generations, base::Budget::Time::max()}, pool));
    EXPECT_EQ(optimizer.report().generations, generations);
  }
}

TEST(Pmomvo, ExpiredDeadlineStillGivesTheFirstGeneration) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(2);
  Pmomvo optimizer(settings(4, 3), kDimension, 2);
  const Front& front = optimizer.run(problem, {}, 1, 0, {40, base::Budget::Time::min()}, pool);
  expect_front(front);
  EXPECT_TRUE(optimizer.report().deadline_reached);
  EXPECT_EQ(optimizer.report().generations, 1);
  EXPECT_EQ(optimizer.report().evaluations, 50);
}

// The master that looks at the clock after every generation gives the same bits as the one that does not.
TEST(Pmomvo, ADeadlineThatIsFarAwayChangesNothing) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(2);
  Pmomvo optimizer(settings(4, 3), kDimension, 2);
  const auto far = std::chrono::steady_clock::now() + std::chrono::hours(1);
  const Front with = optimizer.run(problem, {}, 1, 0, {40, far}, pool);
  EXPECT_FALSE(optimizer.report().deadline_reached);
  expect_same(with, optimizer.run(problem, {}, 1, 0, {40}, pool));
}

TEST(Pmomvo, StopsAfterAnyGeneration) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(2);
  Pmomvo optimizer(settings(4, 3), kDimension, 2);
  for (const int stop : {1, 7, 10, 39, 40, 100}) {
    expect_front(optimizer.run(problem, {}, 1, 0, {40, base::Budget::Time::max(), stop}, pool));
    EXPECT_EQ(optimizer.report().generations, std::min(stop, 40));
  }
}

// Budget: the same schedule, stopped after the generations that the stopped run reports, repeats it.
TEST(Pmomvo, RunStoppedByDeadlineIsRepeatedByItsGenerations) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(1);
  Pmomvo optimizer(settings(4, 3), kDimension, 2);
  const Front stopped = optimizer.run(problem, {}, 1, 0, {40, base::Budget::Time::min()}, pool);
  const int generations = optimizer.report().generations;
  expect_same(stopped, optimizer.run(problem, {}, 1, 0, {40, base::Budget::Time::max(), generations}, pool));
  EXPECT_FALSE(optimizer.report().deadline_reached);
}

TEST(Pmomvo, RefusesABudgetWithoutGenerations) {
  const Zdt problem = zdt1();
  base::WorkerPool pool(1);
  Pmomvo optimizer(settings(4, 3), kDimension, 2);
  EXPECT_THROW(optimizer.run(problem, {}, 1, 0, {0}, pool), std::invalid_argument);
}

TEST(Pmomvo, InitialSolutionsAppear) {
  // Five solutions on the true front, for two slaves: no later solution can dominate them.
  std::vector<double> initial;
  for (const double f1 : {0.0, 0.01, 0.25, 0.49, 1.0}) {
    initial.push_back(f1);
    initial.insert(initial.end(), kDimension - 1, 0.0);
  }
  const Front front = solve(settings(2, 1), 4, 1, initial);
  for (const double f1 : {0.0, 0.01, 0.25, 0.49, 1.0}) {
    EXPECT_TRUE(std::any_of(front.costs.begin(), front.costs.end(), [&](const Cost& c) { return c.f[0] == f1; })) << f1;
  }
}

TEST(Pmomvo, TakesMoreInitialSolutionsThanUniverses) {
  const std::vector<double> initial(30 * kDimension, 0.5);
  expect_front(solve(settings(3, 2, 10), 10, 2, initial));
}

TEST(Pmomvo, SecondRunAllocatesNothing) {
  const Zdt problem = zdt1();
  for (const int threads : {1, 3}) {
    base::WorkerPool pool(threads);
    Pmomvo optimizer(settings(4, 5), kDimension, 2);
    const std::vector<double> initial(3 * kDimension, 0.5);
    const base::Budget budget{30, base::Budget::Time::max()};
    const std::size_t size = optimizer.run(problem, initial, 1, 0, budget, pool).size();
    const test::AllocationGuard guard;
    EXPECT_EQ(optimizer.run(problem, initial, 1, 0, budget, pool).size(), size);
    EXPECT_EQ(guard.count(), 0U);
  }
}

}  // namespace
}  // namespace jink::planner::optimizer
