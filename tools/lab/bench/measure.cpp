// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/bench/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace jink::tools::lab::bench {

double quantile(std::vector<double> samples, double q) {
  assert(!samples.empty());
  std::sort(samples.begin(), samples.end());
  const double at = q * static_cast<double>(samples.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, samples.size() - 1);
  return samples[below] + (at - static_cast<double>(below)) * (samples[above] - samples[below]);
}

double mean(const std::vector<double>& samples) {
  assert(!samples.empty());
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

double deviation(const std::vector<double>& samples) {
  if (samples.size() < 2) return 0.0;
  const double centre = mean(samples);
  double sum = 0.0;
  for (const double sample : samples) sum += (sample - centre) * (sample - centre);
  return std::sqrt(sum / static_cast<double>(samples.size() - 1));
}

void Table::print() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& cells : rows_) {
    assert(cells.size() == widths.size());
    for (std::size_t c = 0; c < cells.size(); ++c) widths[c] = std::max(widths[c], cells[c].size());
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    fmt::print("  {:<{}}", cells[0], widths[0]);
    for (std::size_t c = 1; c < cells.size(); ++c) fmt::print("  {:>{}}", cells[c], widths[c]);
    fmt::print("\n");
  };
  line(rows_.front());
  fmt::print("  {:-<{}}\n", "", std::accumulate(widths.begin(), widths.end(), 2 * (widths.size() - 1)));
  for (auto row = rows_.begin() + 1; row != rows_.end(); ++row) line(*row);
  std::fflush(stdout);
}

void print_title(const std::string& title, const std::string& what) {
  fmt::print("\n== {}\n{}\n\n", title, what);
  std::fflush(stdout);
}

void print_note(const std::string& note) {
  fmt::print("  {}\n", note);
  std::fflush(stdout);
}

}  // namespace jink::tools::lab::bench
