// SPDX-License-Identifier: BSD-3-Clause
// The optimizer's parts, each for itself.
#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/optimizer/archive.hpp"
#include "planner/optimizer/momvo.hpp"
#include "planner/optimizer/pareto.hpp"
#include "tools/lab/bench/missions.hpp"

namespace jink::tools::lab::bench {
namespace {

/// Random solutions in a problem's box, one after the other.
std::vector<double> random_solutions(const planner::optimizer::Problem& problem, std::size_t count,
                                     std::uint64_t seed) {
  planner::base::RandomStream random(seed);
  std::vector<double> x;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < problem.lower().size(); ++j)
      x.push_back(random.uniform(problem.lower()[j], problem.upper()[j]));
  }
  return x;
}

/// Time of one of `count` things that an iteration does.
benchmark::Counter each(double count) {
  return {count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

void waypoint_evaluate(benchmark::State& state) {
  const planner::paper::WaypointProblem& problem = middle_step();
  std::vector<planner::optimizer::Cost> costs(static_cast<std::size_t>(state.range(0)));
  const std::vector<double> x = random_solutions(problem, costs.size(), 1);
  for ([[maybe_unused]] auto _ : state) {
    problem.evaluate(x, costs);
    benchmark::DoNotOptimize(costs.data());
    benchmark::ClobberMemory();
  }
  state.counters["each"] = each(static_cast<double>(costs.size()));
}
BENCHMARK(waypoint_evaluate)->Name("WaypointProblem::evaluate")->ArgName("solutions")->Arg(1)->Arg(8)->Arg(50);

/// Costs about a front that comes nearer, as an archive sees them during a run.
std::vector<planner::optimizer::Cost> falling_costs(std::size_t count, int objectives) {
  planner::base::RandomStream random(2);
  std::vector<planner::optimizer::Cost> costs(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double level = 1.0 + 0.2 * random.uniform() * (1.0 - static_cast<double>(i) / static_cast<double>(count));
    double rest = 1.0;
    for (int k = 0; k + 1 < objectives; ++k) {
      const double share = rest * random.uniform();
      costs[i].f[static_cast<std::size_t>(k)] = level * share;
      rest -= share;
    }
    costs[i].f[static_cast<std::size_t>(objectives - 1)] = level * rest;
  }
  return costs;
}

/// Batches of 8, as a slave of six adds them, until 5000 were offered; the batch's end is part of it.
void archive_add(benchmark::State& state) {
  const auto objectives = static_cast<int>(state.range(0));
  const std::vector<planner::optimizer::Cost> costs = falling_costs(5000, objectives);
  planner::optimizer::Archive archive(100, 2, objectives);
  planner::base::RandomStream random(3);
  const std::array<double, 2> x{};
  for ([[maybe_unused]] auto _ : state) {
    archive.clear();
    for (std::size_t i = 0; i < costs.size(); ++i) {
      archive.add(x, costs[i], random);
      if (i % 8 == 7) archive.settle(random);
    }
    benchmark::DoNotOptimize(archive.size());
  }
  state.counters["each"] = each(static_cast<double>(costs.size()));
}
BENCHMARK(archive_add)->Name("Archive::add")->ArgName("objectives")->Arg(2)->Arg(3);

void ranking_order(benchmark::State& state) {
  std::vector<planner::optimizer::Cost> costs(static_cast<std::size_t>(state.range(0)));
  planner::base::RandomStream random(4);
  for (planner::optimizer::Cost& cost : costs) cost.f = {random.uniform(), random.uniform(), random.uniform()};
  planner::optimizer::Ranking ranking(costs.size());
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(ranking.order(costs, static_cast<int>(state.range(1))).data());
  state.counters["each"] = each(static_cast<double>(costs.size()));
}
BENCHMARK(ranking_order)
    ->Name("Ranking::order")
    ->ArgNames({"solutions", "objectives"})
    ->ArgsProduct({{8, 50, 200}, {2, 3}});

void random_uniform(benchmark::State& state) {
  planner::base::RandomStream random(5);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(random.uniform());
}
BENCHMARK(random_uniform)->Name("RandomStream::uniform");

/// A slave in the middle of its run, the archive full.
void momvo_iterate(benchmark::State& state) {
  planner::optimizer::Momvo momvo(static_cast<std::size_t>(state.range(0)), 2, 2, {});
  momvo.reset(middle_step(), planner::base::RandomStream(6));
  for (int i = 1; i <= 100; ++i) momvo.iterate(0.005 * i);
  for ([[maybe_unused]] auto _ : state) momvo.iterate(0.5);
  state.counters["each"] = each(static_cast<double>(state.range(0)));
}
BENCHMARK(momvo_iterate)->Name("Momvo::iterate")->ArgName("universes")->Arg(8)->Arg(50);

void pool_run(benchmark::State& state) {
  planner::base::WorkerPool pool(static_cast<int>(state.range(0)));
  for ([[maybe_unused]] auto _ : state) pool.run(6, [](std::uint32_t) {});
}
BENCHMARK(pool_run)->Name("WorkerPool::run, 6 empty tasks")->ArgName("threads")->Arg(1)->Arg(0)->UseRealTime();

}  // namespace
}  // namespace jink::tools::lab::bench
