// SPDX-License-Identifier: BSD-3-Clause
// Time of the paper's mission, PMOMVO and pagmo2's NSGA-II in turn.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <utility>

#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/bench/missions.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr const char* kMission = "table2-5";

/// One way to plan the mission, and what came of it.
struct Contender {
  std::string name;
  std::function<planner::verify::Plan(const planner::paper::PaperRequest&)> plan;
  std::vector<double> ms;
  std::vector<double> slr;
  std::int64_t evaluations = 0;  // of one mission
};

/// Missions in turn: in each round every contender plans once, so that what disturbs the machine meets all alike.
void race(std::vector<Contender>& contenders, const Mission& mission, const Options& options) {
  for (Contender& contender : contenders) contender.plan(mission.request(1));  // warm
  for (int seed = 1; seed <= options.seeds; ++seed) {
    const planner::paper::PaperRequest request = mission.request(static_cast<std::uint64_t>(seed));
    for (int round = 0; round < options.rounds; ++round) {
      for (Contender& contender : contenders) {
        planner::verify::Plan plan;
        contender.ms.push_back(milliseconds([&] { plan = contender.plan(request); }));
        contender.evaluations = plan.evaluations;
        if (round == 0) contender.slr.push_back(mission.slr(plan));
      }
    }
  }
}

void print(const std::vector<Contender>& contenders, std::size_t yardstick) {
  Table table({"optimizer", "evaluations", "median, ms", "p10, ms", "p90, ms", "pagmo2 : it", "of p10", "mean SLR",
               "std of SLR"});
  const std::vector<double>& other = contenders[yardstick].ms;
  for (const Contender& c : contenders) {
    table.row({c.name, fmt::format("{}", c.evaluations), fmt::format("{:.2f}", median(c.ms)),
               fmt::format("{:.2f}", quantile(c.ms, 0.1)), fmt::format("{:.2f}", quantile(c.ms, 0.9)),
               fmt::format("{:.1f}", median(other) / median(c.ms)),
               fmt::format("{:.1f}", quantile(other, 0.1) / quantile(c.ms, 0.1)),
               fmt::format("{:.6f}", jink::tools::lab::statistics::mean(c.slr)),
               fmt::format("{:.6f}", jink::tools::lab::statistics::standard_deviation(c.slr))});
  }
  table.print();
}

// The same missions for Google Benchmark, seeds 1, 2, .. in turn.

void mission_pmomvo(benchmark::State& state) {
  const Mission mission(kMission);
  planner::base::WorkerPool pool(static_cast<int>(state.range(0)));
  std::uint64_t seed = 0;
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(planner::paper::plan_paper(mission.request(++seed), pool));
}
BENCHMARK(mission_pmomvo)
    ->Name("mission, PMOMVO")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(0)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void mission_pagmo(benchmark::State& state) {
  const Mission mission(kMission);
  planner::base::WorkerPool pool(1);
  const auto optimizer = algorithms::make_nsga2({}, 2, 2);
  std::uint64_t seed = 0;
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(planner::paper::plan_paper(mission.request(++seed), *optimizer, pool));
}
BENCHMARK(mission_pagmo)->Name("mission, pagmo2 NSGA-II")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace

void bench_paper(const Options& options) {
  const Mission mission(kMission);
  const planner::paper::PaperRequest request = mission.request(1);
  const planner::base::OptimizerSettings& s = request.optimizer;
  print_title(
      "paper mission: time",
      fmt::format(
          "{}, {} waypoints, n_pop {}, n_iter {}, m {}, l {}; the whole mission, {} seeds, rounds of all in "
          "turn for each: {}.\npagmo2 {}: NSGA-II as `jink study` has it, one thread. Ratios: of medians, and of p10, "
          "which a busy machine disturbs less.",
          kMission, request.settings.waypoints, s.population, s.iterations, s.slaves, s.sharing, options.seeds,
          options.rounds, algorithms::pagmo_version()));
  planner::base::WorkerPool one(1);
  planner::base::WorkerPool all(options.cores);
  const auto nsga2 = algorithms::make_nsga2(s, 2, 2);
  std::vector<Contender> contenders;
  const auto add = [&](std::string name,
                       std::function<planner::verify::Plan(const planner::paper::PaperRequest&)> plan) {
    contenders.push_back({std::move(name), std::move(plan), {}, {}, 0});
  };
  add(fmt::format("PMOMVO, {} threads", options.cores), [&](const auto& r) { return plan_paper(r, all); });
  add("PMOMVO, 1 thread", [&](const auto& r) { return plan_paper(r, one); });
  add("pagmo2 NSGA-II", [&](const auto& r) { return plan_paper(r, *nsga2, one); });
  race(contenders, mission, options);
  if (contenders[0].slr != contenders[1].slr) throw std::logic_error("PMOMVO's paths depend on the number of threads");
  print(contenders, 2);
}

}  // namespace jink::tools::lab::bench
