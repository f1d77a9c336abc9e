// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO with more threads, and with more slaves than cores, on one problem.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/bench/missions.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kPopulation = 200;
constexpr int kIterations = 300;
constexpr std::uint32_t kSpinners = 6;
constexpr int kSpins = 1'000'000;  // about a millisecond each

/// One kind of work on one number of threads.
struct Runner {
  std::string name;
  int threads;
  std::function<void(std::uint64_t seed)> work;
  std::vector<double> ms;
};

Runner pmomvo(int slaves, int threads) {
  planner::base::OptimizerSettings settings;
  settings.slaves = slaves;
  settings.population = kPopulation;
  settings.iterations = kIterations;
  const auto optimizer = std::make_shared<planner::optimizer::Pmomvo>(settings, 2, 2);  // shared: std::function copies
  const auto pool = std::make_shared<planner::base::WorkerPool>(threads);
  return {fmt::format("PMOMVO, {} slaves", slaves),
          threads,
          [=](std::uint64_t seed) {
            optimizer->run(middle_step(), {}, seed, 0, planner::base::Budget{kIterations}, *pool);
          },
          {}};
}

/// Tasks that share nothing: what the machine has to give at this time.
Runner spinners(int threads) {
  const auto pool = std::make_shared<planner::base::WorkerPool>(threads);
  return {fmt::format("{} spinning tasks", kSpinners),
          threads,
          [=](std::uint64_t seed) {
            pool->run(kSpinners, [&](std::uint32_t task) {
              planner::base::RandomStream random(seed, task);
              for (int i = 0; i < kSpins; ++i) benchmark::DoNotOptimize(random.next());
            });
          },
          {}};
}

/// Rounds of all in turn, as many as asked for after one that warms up.
void measure(std::vector<Runner>& runners, int rounds) {
  for (int round = 0; round <= rounds; ++round) {
    for (Runner& runner : runners) {
      const double ms = milliseconds([&] { runner.work(static_cast<std::uint64_t>(round)); });
      if (round > 0) runner.ms.push_back(ms);
    }
  }
}

std::vector<std::string> cells(const Runner& runner, std::string last) {
  return {runner.name,
          fmt::format("{}", runner.threads),
          fmt::format("{:.2f}", median(runner.ms)),
          fmt::format("{:.2f}", quantile(runner.ms, 0.1)),
          fmt::format("{:.2f}", quantile(runner.ms, 0.9)),
          std::move(last)};
}

void print_threads(const Options& options) {
  std::vector<Runner> runners;
  for (int threads = 1; threads <= options.cores; ++threads) runners.push_back(pmomvo(6, threads));
  for (int threads = 1; threads <= options.cores; ++threads) runners.push_back(pmomvo(2, threads));
  for (int threads = 1; threads <= options.cores; ++threads) runners.push_back(spinners(threads));
  measure(runners, options.scaling_rounds);
  Table table({"work", "threads", "median, ms", "p10, ms", "p90, ms", "speed-up"});
  double one_thread = 0.0;
  for (const Runner& runner : runners) {
    if (runner.threads == 1) one_thread = median(runner.ms);
    table.row(cells(runner, fmt::format("{:.2f}", one_thread / median(runner.ms))));
  }
  table.print();
}

void print_slaves(const Options& options) {
  std::vector<Runner> runners;
  runners.push_back(pmomvo(options.cores, options.cores));
  for (const int slaves : {2, 4, 6, 8, 10, 12}) {
    if (slaves > options.cores) runners.push_back(pmomvo(slaves, options.cores));
  }
  measure(runners, options.scaling_rounds);
  Table table({"work", "threads", "median, ms", "p10, ms", "p90, ms", "cost over slaves = cores, %"});
  const double base = median(runners.front().ms);
  for (const Runner& runner : runners) {
    table.row(cells(runner, fmt::format("{:+.1f}", 100.0 * (median(runner.ms) / base - 1.0))));
  }
  table.print();
}

}  // namespace

void bench_scaling(const Options& options) {
  print_title("scaling: threads",
              fmt::format("PMOMVO on the middle step of table2-5, n_pop {}, n_iter {}; {} rounds of all in turn. The "
                          "spinning tasks share nothing: they show what the machine has to give meanwhile.",
                          kPopulation, kIterations, options.scaling_rounds));
  print_threads(options);
  print_title("scaling: slaves", "The same problem and number of evaluations, one thread for each core.");
  print_slaves(options);
}

}  // namespace jink::tools::lab::bench
