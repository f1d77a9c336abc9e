// SPDX-License-Identifier: BSD-3-Clause
// jink_bench: how fast and how good the planner is, beside pagmo2.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "tools/lab/bench/measure.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kUsage = 2;  // exit code, as of jink

constexpr const char* kAbout =
    "Measures the planner: time, hypervolume and SLR of the paper's missions beside pagmo2's NSGA-II; warm replanning "
    "among 20, 200 and 2000 moving obstacles; the optimizer with and without each of its parts; threads and slaves; "
    "the parts by Google Benchmark. Prints tables. What is compared runs in turn, and medians are given, since "
    "machines are noisy.";

/// Rows alone: the library's own heading names the machine's load and paths.
class RowReporter final : public benchmark::ConsoleReporter {
 public:
  RowReporter() : ConsoleReporter(OO_None) {}
  bool ReportContext(const Context& context) override {
    name_field_width_ = context.name_field_width;
    printed_header_ = false;
    return true;
  }
};

/// Hands Google Benchmark its flags. Throws CLI::ExtrasError for what it does not know.
void initialise_benchmark(bool quick, std::vector<std::string> flags) {
  flags.insert(flags.begin(), "jink_bench");
  if (quick) flags.insert(flags.begin() + 1, "--benchmark_min_time=0.02");
  std::vector<char*> argv(flags.size());
  std::transform(flags.begin(), flags.end(), argv.begin(), [](std::string& flag) { return flag.data(); });
  auto argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());  // takes its own out
  if (argc > 1) throw CLI::ExtrasError({argv[1]});
}

void bench_parts() {
  print_title(
      "missions and parts",
      "Google Benchmark. each: time of one of the solutions, additions or universes; threads 0: one for each core.");
  RowReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
}

int run(int argc, char** argv) {
  Options options;
  options.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const std::vector<std::string> all{"paper",    "quality", "tangent",    "warm",    "horizon",
                                     "ablation", "worlds",  "prediction", "scaling", "parts"};
  std::vector<std::string> sections;
  CLI::App app(kAbout, "jink_bench");
  app.add_flag("--quick", options.quick, "Every table with few samples, in about a minute");
  auto* seeds = app.add_option("--seeds", options.seeds, "Seeds of the missions, 20 by default, 2 with --quick")
                    ->check(CLI::Range(1, 1000));
  auto* replans =
      app.add_option("--replans", options.replans, "Replans in each world, 10000 by default, 100 with --quick")
          ->check(CLI::Range(1, 1000000));
  app.add_option("--deadline", options.deadline_ms, "ms, of each replan in section horizon; without it there is none")
      ->check(CLI::Range(0.1, 60000.0));
  app.add_option("--recorded", options.recordings, "Recorded movers too, in section prediction: files as of jink arena")
      ->check(CLI::ExistingFile);
  app.add_option("sections", sections,
                 "paper (time), quality (hypervolume, SLR), tangent (plans beside exact paths), warm (plans beside "
                 "larger budgets), horizon, ablation, "
                 "worlds, prediction (stated regions beside where movers are), scaling, parts; all by default")
      ->check(CLI::IsMember(all));
  app.footer("Options that begin with --benchmark_ go to Google Benchmark: --benchmark_filter=REGEX.");
  app.allow_extras();
  try {
    app.parse(argc, argv);
    initialise_benchmark(options.quick, app.remaining());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  if (options.quick) {
    if (seeds->count() == 0) options.seeds = 2;
    if (replans->count() == 0) options.replans = 100;
    options.rounds = 1;
    options.scaling_rounds = 10;
  }
  fmt::print("jink_bench: {}, {}, {} cores, {} seeds{}\n", JINK_BENCH_COMPILER, JINK_BENCH_BUILD_TYPE, options.cores,
             options.seeds, options.quick ? ", every fourth family of worlds" : "");
  const auto wanted = [&](const char* section) {
    return sections.empty() || std::find(sections.begin(), sections.end(), section) != sections.end();
  };
  if (wanted("paper")) bench_paper(options);
  if (wanted("quality")) bench_quality(options);
  if (wanted("tangent")) bench_tangent(options);
  if (wanted("warm")) bench_warm(options);
  if (wanted("horizon")) bench_horizon(options);
  if (wanted("ablation")) bench_ablation(options);
  if (wanted("worlds")) bench_worlds(options);
  if (wanted("prediction")) bench_prediction(options);
  if (wanted("scaling")) bench_scaling(options);
  if (wanted("parts")) bench_parts();
  return 0;
}

}  // namespace
}  // namespace jink::tools::lab::bench

int main(int argc, char** argv) {
  try {
    return jink::tools::lab::bench::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "jink_bench: %s\n", e.what());
    return 1;
  }
}
