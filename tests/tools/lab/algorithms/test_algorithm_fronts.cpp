// SPDX-License-Identifier: BSD-3-Clause
// How near each algorithm comes to the fronts of ZDT1-3, that it is at work and stays so: the floors are the least that
// was measured over 20 seeds, less a margin.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "planner/base/random.hpp"
#include "tests/support/fronts.hpp"
#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::algorithms {
namespace {

using testing_support::volume_of;
using testing_support::Zdt;

struct Floors {
  const char* name;
  std::array<double, 3> few;   ///< 5 variables, 10 000 evaluations, reference (1.1, 1.1)
  std::array<double, 3> many;  ///< 30 variables, 5000 evaluations, reference (11, 11)
};

/// The fronts have 0.8764, 0.5431, 1.3313 and 120.67, 120.33, 128.78.
const std::vector<Floors> kFloors{
    {"momvo", {0.850, 0.520, 1.295}, {118.0, 111.0, 123.0}},
    {"pmomvo-2", {0.856, 0.526, 1.310}, {116.5, 109.5, 122.0}},
    {"pmomvo-4", {0.859, 0.527, 1.300}, {115.5, 108.5, 120.5}},
    {"pmomvo-6", {0.861, 0.527, 1.310}, {116.0, 108.0, 120.0}},
    {"pmomvo-8", {0.860, 0.527, 1.300}, {114.5, 107.0, 119.0}},
    {"pmomvo-10", {0.859, 0.525, 1.280}, {112.5, 106.0, 116.5}},
    {"pmomvo-12", {0.859, 0.526, 1.310}, {113.0, 105.0, 117.0}},
    {"mssa", {0.780, 0.420, 1.150}, {103.0, 94.5, 105.3}},
    {"mogwo", {0.840, 0.500, 1.290}, {118.5, 109.5, 125.0}},
    {"nsga2", {0.860, 0.505, 1.050}, {114.0, 94.5, 116.5}},
    {"mopso", {0.853, 0.522, 1.305}, {110.0, 106.0, 112.5}},
    {"nspso", {0.860, 0.525, 1.315}, {116.0, 109.0, 118.0}},
    {"moead", {0.859, 0.526, 1.310}, {110.5, 97.0, 109.0}},
};

/// Hypervolume of so many random solutions.
double random_search(const Zdt& problem, int evaluations, std::uint64_t seed, double reference) {
  planner::base::RandomStream random(seed, 1000);
  const auto d = static_cast<std::size_t>(problem.dimension());
  std::vector<double> x(d * static_cast<std::size_t>(evaluations));
  for (double& value : x) value = random.uniform();
  std::vector<planner::optimizer::Cost> costs(static_cast<std::size_t>(evaluations));
  problem.evaluate(x, costs);
  return volume_of(costs, {reference, reference});
}

class OnZdt : public ::testing::TestWithParam<Floors> {};

TEST_P(OnZdt, ComesNearTheFrontOfFewVariables) {
  planner::base::WorkerPool pool(1);
  for (int number = 1; number <= 3; ++number) {
    const Zdt problem(number, 5);
    planner::base::OptimizerSettings settings;
    const auto optimizer = find_algorithm(GetParam().name)->make(settings, 5, 2);
    const double best = planner::optimizer::hypervolume(problem.front(), {1.1, 1.1});
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const planner::optimizer::Front& front = optimizer->run(problem, {}, seed, 0, {200}, pool);
      const double volume = volume_of(front.costs, {1.1, 1.1});
      EXPECT_GT(volume, GetParam().few[static_cast<std::size_t>(number - 1)]) << "ZDT" << number << ", seed " << seed;
      EXPECT_LT(volume, best + 1e-3);
      EXPECT_GT(volume, random_search(problem, 10000, seed, 1.1) + 0.25);
    }
  }
}

TEST_P(OnZdt, LeavesRandomSearchBehindAmongManyVariables) {
  planner::base::WorkerPool pool(1);
  for (int number = 1; number <= 3; ++number) {
    const Zdt problem(number);
    planner::base::OptimizerSettings settings;
    const auto optimizer = find_algorithm(GetParam().name)->make(settings, problem.dimension(), 2);
    const double best = planner::optimizer::hypervolume(problem.front(), {11.0, 11.0});
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const planner::optimizer::Front& front = optimizer->run(problem, {}, seed, 0, {100}, pool);
      const double volume = volume_of(front.costs, {11.0, 11.0});
      EXPECT_GT(volume, GetParam().many[static_cast<std::size_t>(number - 1)]) << "ZDT" << number << ", seed " << seed;
      EXPECT_LT(volume, best);
      EXPECT_GT(volume, random_search(problem, 5000, seed, 11.0));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, OnZdt, ::testing::ValuesIn(kFloors), [](const auto& each) {
  std::string name = each.param.name;
  std::erase(name, '-');
  return name;
});

TEST(Zdt, NoAlgorithmIsLeftOut) {
  ASSERT_EQ(kFloors.size(), algorithms().size());
  for (std::size_t i = 0; i < kFloors.size(); ++i) EXPECT_EQ(kFloors[i].name, algorithms()[i].name);
}

// Moved away from the origin, to where its variables are far from 0: what does not look at where the origin is finds
// the same up to rounding. MSSA and MOGWO are published with steps that do look.
TEST(Zdt, WhereTheOriginIsMattersToNoneButMssaAndMogwo) {
  planner::base::WorkerPool pool(1);
  const Zdt here(1);
  const Zdt there(1, 30, 4.0);
  planner::base::OptimizerSettings settings;
  const auto mean = [&](const Algorithm& algorithm, const Zdt& problem) {
    const auto optimizer = algorithm.make(settings, problem.dimension(), 2);
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      sum += volume_of(optimizer->run(problem, {}, seed, 0, {100}, pool).costs, {11.0, 11.0});
    }
    return sum / 8.0;
  };
  for (const Algorithm& algorithm : algorithms()) {
    if (algorithm.name == "mssa") continue;
    const double difference = mean(algorithm, there) - mean(algorithm, here);
    if (algorithm.name == "mogwo") {
      EXPECT_LT(difference, -1.0);
    } else {
      EXPECT_NEAR(difference, 0.0, 1.0) << algorithm.name;
    }
  }
}

}  // namespace
}  // namespace jink::tools::lab::algorithms
