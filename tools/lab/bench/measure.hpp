// SPDX-License-Identifier: BSD-3-Clause
// What all benchmarks share: options, a stopwatch, statistics of samples, aligned tables on stdout.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/lab/statistics/samples.hpp"

namespace jink::tools::lab::bench {

inline constexpr std::uint64_t kSeed = 1;  ///< of what has one

/// How much is measured. `--quick` keeps every table and takes few samples.
struct Options {
  bool quick = false;
  int cores = 1;
  int seeds = 20;            ///< missions of each kind, with seeds 1 .. seeds
  int rounds = 5;            ///< of all timed missions with each seed
  int replans = 10000;       ///< in each moving world
  double deadline_ms = 0.0;  ///< of these; 0: none
  int scaling_rounds = 50;
  std::vector<std::string> recordings;  ///< files of recorded movers
};

/// The families of worlds that are measured: all, with `--quick` every fourth.
std::vector<std::string_view> measured_families(const Options& options);

/// Wall time of one call, ms.
template <typename Work>
double milliseconds(const Work& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
}

using jink::tools::lab::statistics::mean;
using jink::tools::lab::statistics::standard_deviation;
/// statistics::quantile() of values in any order.
double quantile(std::vector<double> samples, double q);
inline double median(const std::vector<double>& samples) {
  return quantile(samples, 0.5);
}

/// Columns as wide as their widest cell; the first to the left, the others to the right. Units stand in the heads.
class Table {
 public:
  explicit Table(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  /// Precondition: as many cells as heads.
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  void print() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// A section's title with what it measures, and an empty line before.
void print_title(const std::string& title, const std::string& what);
/// One line below a table.
void print_note(const std::string& note);

// The sections; each prints its tables.
void bench_paper(const Options& options);       ///< time of paper missions, beside pagmo2
void bench_quality(const Options& options);     ///< hypervolume and SLR, beside pagmo2
void bench_tangent(const Options& options);     ///< open-loop plans beside exact shortest paths
void bench_warm(const Options& options);        ///< plans of a flight beside larger budgets
void bench_horizon(const Options& options);     ///< warm replanning in moving worlds
void bench_ablation(const Options& options);    ///< what each part of the optimizer is worth
void bench_prediction(const Options& options);  ///< stated regions beside where movers are
void bench_worlds(const Options& options);      ///< plans and flights in the families of worlds
void bench_scaling(const Options& options);     ///< threads and slaves

}  // namespace jink::tools::lab::bench
