// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace jink::tools::lab::arena {
namespace {

constexpr double kMicrosecond = 1e-3;  // ms

}  // namespace

void DurationHistogram::add(double milliseconds) {
  assert(std::isfinite(milliseconds) && milliseconds >= 0.0);
  const double microseconds = std::max(1.0, milliseconds / kMicrosecond);
  add_bin(static_cast<int>(std::floor(kBinsPerOctave * std::log2(microseconds))), 1);
  max_ = std::max(max_, milliseconds);
}

void DurationHistogram::add(const DurationHistogram& other) {
  for (const auto& [bin, count] : other.bins_) add_bin(bin, count);
  max_ = std::max(max_, other.max_);
}

double DurationHistogram::quantile(double p) const {
  if (count_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const double wanted = std::max(1.0, std::ceil(p * static_cast<double>(count_)));
  std::int64_t seen = 0;
  int bin = 0;
  for (const auto& [at, count] : bins_) {
    seen += count;
    bin = at;
    if (static_cast<double>(seen) >= wanted) break;
  }
  return std::min(max_, kMicrosecond * std::exp2((bin + 0.5) / kBinsPerOctave));
}

}  // namespace jink::tools::lab::arena
