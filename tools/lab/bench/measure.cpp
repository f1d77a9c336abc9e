// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/bench/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <numeric>

#include "sim/families/families.hpp"

namespace jink::tools::lab::bench {

std::vector<std::string_view> measured_families(const Options& options) {
  std::vector<std::string_view> families;
  const auto all = sim::families::world_families();
  for (std::size_t i = 0; i < all.size(); i += options.quick ? 4 : 1) families.push_back(all[i]);
  return families;
}

double quantile(std::vector<double> samples, double q) {
  std::sort(samples.begin(), samples.end());
  return jink::tools::lab::statistics::quantile(samples, q);
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
