// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/registry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "planner/optimizer/pmomvo.hpp"
#include "tests/support/fronts.hpp"

namespace jink::tools::lab::algorithms {
namespace {

using planner::base::Budget;
using planner::base::OptimizerSettings;
using planner::base::WorkerPool;
using planner::optimizer::Cost;
using planner::optimizer::Front;
using planner::optimizer::Problem;
using testing_support::Zdt;

constexpr Budget::Time kNever = Budget::Time::max();

OptimizerSettings sized(int population, int archive = 100) {
  OptimizerSettings settings;
  settings.population = population;
  settings.archive = archive;
  return settings;
}

/// Another problem, watched: how many solutions were evaluated, and whether all were in the box.
class Watched final : public Problem {
 public:
  explicit Watched(const Problem& problem) : problem_(problem) {}
  [[nodiscard]] int dimension() const override { return problem_.dimension(); }
  [[nodiscard]] int objectives() const override { return problem_.objectives(); }
  [[nodiscard]] std::span<const double> lower() const override { return problem_.lower(); }
  [[nodiscard]] std::span<const double> upper() const override { return problem_.upper(); }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    evaluations_ += static_cast<std::int64_t>(costs.size());
    const std::size_t d = lower().size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!(x[i] >= lower()[i % d] && x[i] <= upper()[i % d])) ++outside_;
    }
    problem_.evaluate(x, costs);
  }
  [[nodiscard]] std::int64_t evaluations() const { return evaluations_; }
  [[nodiscard]] std::int64_t outside() const { return outside_; }

 private:
  const Problem& problem_;
  mutable std::atomic<std::int64_t> evaluations_ = 0;
  mutable std::atomic<std::int64_t> outside_ = 0;
};

/// Two objectives, the distances from two points of a plane, with feasible solutions on one side of a line alone. It
/// has a variable without extent.
class HalfPlane final : public Problem {
 public:
  /// Feasible where x > `from`.
  explicit HalfPlane(double from) : from_(from) {}
  [[nodiscard]] int dimension() const override { return 3; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double u = x[3 * i];
      const double v = x[3 * i + 1];
      const double off = std::abs(x[3 * i + 2] - 5.0);
      costs[i] = {{std::hypot(u + 2.0, v) + off, std::hypot(u + 2.0, v - 1.0) + off, 0.0}, std::max(0.0, from_ - u)};
    }
  }

 private:
  double from_;
  std::vector<double> lower_{-4, -4, 5};
  std::vector<double> upper_{4, 4, 5};
};

/// DTLZ2 (Deb et al. 2002) with three objectives, whose front is an eighth of the unit sphere; no number where the
/// first variable is in the upper tenth.
class Sphere final : public Problem {
 public:
  [[nodiscard]] int dimension() const override { return 6; }
  [[nodiscard]] int objectives() const override { return 3; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const auto at = x.subspan(6 * i, 6);
      double radius = 1.0;
      for (std::size_t j = 2; j < 6; ++j) radius += (at[j] - 0.5) * (at[j] - 0.5);
      const double a = 0.5 * std::numbers::pi * at[0];
      const double b = 0.5 * std::numbers::pi * at[1];
      costs[i] = {{radius * std::cos(a) * std::cos(b), radius * std::cos(a) * std::sin(b), radius * std::sin(a)}, 0.0};
      if (at[0] > 0.9) costs[i].f[1] = std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  std::vector<double> lower_ = std::vector<double>(6, 0.0);
  std::vector<double> upper_ = std::vector<double>(6, 1.0);
};

void expect_same(const Front& a, const Front& b) {
  EXPECT_EQ(a.x, b.x);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a.costs[i].f, b.costs[i].f);
}

/// Non-dominated, without duplicates, no more than `archive`, and with the costs of its solutions.
void expect_front(const Problem& problem, const Front& front, int archive) {
  ASSERT_GT(front.size(), 0U);
  ASSERT_LE(front.size(), static_cast<std::size_t>(archive));
  ASSERT_EQ(front.dimension, problem.dimension());
  ASSERT_EQ(front.x.size(), front.size() * static_cast<std::size_t>(front.dimension));
  for (std::size_t i = 0; i < front.size(); ++i) {
    Cost again;
    problem.evaluate(front.solution(i), {&again, 1});
    EXPECT_EQ(again.f, front.costs[i].f);
    EXPECT_EQ(again.violation, front.costs[i].violation);
    for (std::size_t j = 0; j < front.size(); ++j) {
      EXPECT_FALSE(planner::optimizer::dominates(front.costs[i], front.costs[j], problem.objectives()));
      EXPECT_TRUE(i == j || front.costs[i].f != front.costs[j].f);
    }
  }
}

TEST(Algorithms, StandInTheOrderOfTables) {
  const std::vector<std::string_view> expected{"momvo",     "pmomvo-2",  "pmomvo-4", "pmomvo-6", "pmomvo-8",
                                               "pmomvo-10", "pmomvo-12", "mssa",     "mogwo",    "nsga2",
                                               "mopso",     "nspso",     "moead"};
  std::vector<std::string_view> names;
  std::set<std::string_view> labels;
  for (const Algorithm& algorithm : algorithms()) {
    names.push_back(algorithm.name);
    labels.insert(algorithm.label);
    EXPECT_EQ(find_algorithm(algorithm.name), &algorithm);
    EXPECT_FALSE(algorithm.source.empty());
  }
  EXPECT_EQ(names, expected);
  EXPECT_EQ(labels.size(), expected.size());
  EXPECT_EQ(find_algorithm("magic"), nullptr);
  EXPECT_EQ(find_algorithm("pmomvo"), nullptr);  // its slaves are configured, it is no algorithm of a table
  EXPECT_EQ(find_algorithm("pmomvo-6")->slaves, 6);
  EXPECT_EQ(find_algorithm("mogwo")->slaves, 1);
  EXPECT_TRUE(pagmo_version().starts_with("2.")) << pagmo_version();
}

class EachAlgorithm : public ::testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<planner::optimizer::Optimizer> make(const OptimizerSettings& settings,
                                                             const Problem& problem) {
    return find_algorithm(GetParam())->make(settings, problem.dimension(), problem.objectives());
  }
  static int slaves() { return find_algorithm(GetParam())->slaves; }
};

TEST_P(EachAlgorithm, SpendsExactlyPopulationTimesIterationsInTheBox) {
  const Zdt zdt(1, 7, -3.2);
  WorkerPool pool(2);
  for (const auto& [population, iterations] : {std::pair{50, 20}, std::pair{52, 7}, std::pair{13, 11}, std::pair{12, 1},
                                               std::pair{5, 3}, std::pair{1, 4}, std::pair{200, 3}}) {
    if (population < slaves()) continue;
    const Watched problem(zdt);
    const auto optimizer = make(sized(population), problem);
    const Front front = optimizer->run(problem, {}, 3, 5, {iterations, kNever}, pool);
    EXPECT_EQ(problem.evaluations(), population * iterations) << population << " x " << iterations;
    EXPECT_EQ(problem.outside(), 0);
    EXPECT_EQ(optimizer->report().evaluations, population * iterations);
    EXPECT_EQ(optimizer->report().generations, iterations);
    EXPECT_FALSE(optimizer->report().deadline_reached);
    expect_front(zdt, front, 100);
  }
}

TEST_P(EachAlgorithm, GivesTheSameBitsForTheSameSeedAndAnyThreads) {
  const Zdt problem(3);
  WorkerPool one(1);
  WorkerPool several(3);
  const auto optimizer = make(sized(50), problem);
  const auto solve = [&](std::uint64_t seed, std::uint64_t stream, WorkerPool& pool) {
    return Front(optimizer->run(problem, {}, seed, stream, {20, kNever}, pool));
  };
  const Front first = solve(1, 1, one);
  EXPECT_NE(solve(2, 1, one).x, first.x);
  EXPECT_NE(solve(1, 2, one).x, first.x);
  expect_same(solve(1, 1, several), first);  // also after other runs of the same optimizer
  expect_same(make(sized(50), problem)->run(problem, {}, 1, 1, {20, kNever}, one), first);
}

TEST_P(EachAlgorithm, KeepsItsBudget) {
  const Zdt problem(1);
  WorkerPool pool(1);
  const auto optimizer = make(sized(50), problem);
  const Front whole = optimizer->run(problem, {}, 1, 0, {20, kNever}, pool);
  const auto far = std::chrono::steady_clock::now() + std::chrono::hours(1);
  expect_same(optimizer->run(problem, {}, 1, 0, {20, far}, pool), whole);
  EXPECT_FALSE(optimizer->report().deadline_reached);

  const Front cut = optimizer->run(problem, {}, 1, 0, {20, Budget::Time::min()}, pool);
  EXPECT_TRUE(optimizer->report().deadline_reached);
  EXPECT_EQ(optimizer->report().generations, 1);
  EXPECT_EQ(optimizer->report().evaluations, 50);
  expect_same(optimizer->run(problem, {}, 1, 0, {20, kNever, 1}, pool), cut);

  for (const int stop : {2, 13, 20, 40}) {
    expect_front(problem, optimizer->run(problem, {}, 1, 0, {20, kNever, stop}, pool), 100);
    EXPECT_EQ(optimizer->report().generations, std::min(stop, 20));
    EXPECT_EQ(optimizer->report().evaluations, 50 * std::min(stop, 20));
    EXPECT_FALSE(optimizer->report().deadline_reached);
  }
  EXPECT_THROW(optimizer->run(problem, {}, 1, 0, {0, kNever}, pool), std::invalid_argument);
}

TEST_P(EachAlgorithm, StartsFromInitialSolutions) {
  const Zdt problem(1, 5);
  WorkerPool pool(1);
  // On the true front: no later solution can dominate them.
  std::vector<double> initial;
  const std::vector<double> first{0.0, 0.01, 0.25, 0.49, 1.0};
  for (const double f1 : first) {
    initial.push_back(f1);
    initial.insert(initial.end(), 4, f1 == 1.0 ? -3.0 : 0.0);  // the last one from outside the box
  }
  const auto optimizer = make(sized(50), problem);
  const Front& front = optimizer->run(problem, initial, 1, 0, {2, kNever}, pool);
  for (const double f1 : first) {
    EXPECT_TRUE(std::any_of(front.costs.begin(), front.costs.end(), [&](const Cost& c) { return c.f[0] == f1; })) << f1;
  }
  const std::vector<double> many(60 * 5, 0.5);
  expect_front(problem, optimizer->run(problem, many, 1, 0, {3, kNever}, pool), 100);
}

TEST_P(EachAlgorithm, KeepsNoMoreThanTheArchive) {
  const Zdt problem(1, 5);
  WorkerPool pool(1);
  for (const int archive : {3, 10, 31}) {
    const auto optimizer = make(sized(50, archive), problem);
    expect_front(problem, optimizer->run(problem, {}, 1, 0, {40, kNever}, pool), archive);
  }
}

TEST_P(EachAlgorithm, RefusesSettingsThatCannotWork) {
  const Zdt problem(1, 5);
  EXPECT_THROW(make(sized(0), problem), std::invalid_argument);
  EXPECT_THROW(make(sized(50, 2), problem), std::invalid_argument);
  OptimizerSettings settings = sized(50);
  settings.iterations = 0;
  EXPECT_THROW(make(settings, problem), std::invalid_argument);
  if (slaves() > 1) {
    EXPECT_THROW(make(sized(slaves() - 1), problem), std::invalid_argument);
  }
}

TEST_P(EachAlgorithm, PrefersFeasibleSolutionsThenSmallViolations) {
  WorkerPool pool(1);
  const HalfPlane some(2.0);  // the unconstrained optima, at -2, are far from feasible
  const auto optimizer = make(sized(50), some);
  const Front feasible = optimizer->run(some, {}, 1, 0, {40, kNever}, pool);
  expect_front(some, feasible, 100);
  for (std::size_t i = 0; i < feasible.size(); ++i) {
    EXPECT_EQ(feasible.costs[i].violation, 0.0);
    EXPECT_LT(feasible.solution(i)[0], 2.3);
  }
  const HalfPlane none(10.0);
  const Front least = optimizer->run(none, {}, 1, 0, {40, kNever}, pool);
  expect_front(none, least, 100);
  EXPECT_LT(least.costs.front().violation, 6.1);  // of 6 to 14
}

TEST_P(EachAlgorithm, TakesThreeObjectivesAndCostsThatAreNoNumbers) {
  const Sphere sphere;
  const Watched problem(sphere);
  WorkerPool pool(2);
  const auto optimizer = make(sized(60), problem);
  const Front& front = optimizer->run(problem, {}, 1, 0, {60, kNever}, pool);
  expect_front(sphere, front, 100);
  EXPECT_EQ(problem.evaluations(), 60 * 60);
  double mean = 0.0;
  for (const Cost& cost : front.costs) {
    mean += std::hypot(cost.f[0], cost.f[1], cost.f[2]) / static_cast<double>(front.size());
  }
  EXPECT_LT(mean, 1.12);  // the front is at 1, a random solution at 1.33
}

INSTANTIATE_TEST_SUITE_P(All, EachAlgorithm, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const Algorithm& algorithm : algorithms()) names.emplace_back(algorithm.name);
                           return names;
                         }()),
                         [](const auto& each) {
                           std::string name = each.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(PagmoAlgorithms, RefuseASingleObjective) {
  for (const char* name : {"nsga2", "nspso", "moead"}) {
    EXPECT_THROW(find_algorithm(name)->make(sized(50), 2, 1), std::invalid_argument) << name;
  }
}

// m = 1 is MOMVO alone, whose front the bound leaves as it is.
TEST(Algorithms, MomvoIsPmomvoOfOneSlaveThatDoesNotShare) {
  const Zdt problem(1);
  WorkerPool pool(1);
  OptimizerSettings settings = sized(50);
  settings.slaves = 1;
  settings.sharing = 0;
  planner::optimizer::Pmomvo alone(settings, problem.dimension(), 2);
  const Front expected = alone.run(problem, {}, 4, 2, {40, kNever}, pool);
  settings.slaves = 7;
  settings.sharing = 9;
  const auto momvo = find_algorithm("momvo")->make(settings, problem.dimension(), 2);
  expect_same(momvo->run(problem, {}, 4, 2, {40, kNever}, pool), expected);
}

TEST(Algorithms, PmomvoOfANameHasThatManySlavesAndTheSharingOfTheSettings) {
  const Zdt problem(1);
  WorkerPool pool(1);
  OptimizerSettings settings = sized(50);
  settings.slaves = 6;
  settings.archive = 1000;  // more than is found, so that the bound changes nothing but the order
  const auto costs = [](const Front& front) {
    std::vector<std::array<double, 3>> list;
    for (const Cost& cost : front.costs) list.push_back(cost.f);
    std::sort(list.begin(), list.end());
    return list;
  };
  std::set<std::vector<std::array<double, 3>>> different;
  for (const int sharing : {0, 3, 9}) {
    settings.sharing = sharing;
    planner::optimizer::Pmomvo six(settings, problem.dimension(), 2);
    const auto expected = costs(six.run(problem, {}, 4, 2, {20, kNever}, pool));
    const auto named = find_algorithm("pmomvo-6")->make(settings, problem.dimension(), 2);
    EXPECT_EQ(costs(named->run(problem, {}, 4, 2, {20, kNever}, pool)), expected);
    different.insert(expected);
  }
  EXPECT_EQ(different.size(), 3U);
}

}  // namespace
}  // namespace jink::tools::lab::algorithms
