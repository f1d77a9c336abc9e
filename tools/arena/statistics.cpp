// SPDX-License-Identifier: BSD-3-Clause
#include "tools/arena/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace jink::arena {
namespace {

constexpr double kNormalQuantile = 1.959963984540054;  // of 0.975
constexpr double kMicrosecond = 1e-3;                  // ms

}  // namespace

Proportion wilson(std::int64_t count, std::int64_t of) {
  assert(count >= 0 && count <= of);
  Proportion result{count, of};
  if (of == 0) return result;
  const double n = static_cast<double>(of);
  const double p = result.value();
  const double z2 = kNormalQuantile * kNormalQuantile;
  const double centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kNormalQuantile * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n)) / (1.0 + z2 / n);
  // At the ends the interval touches 0 and 1 exactly; rounding must not say otherwise.
  result.low = count == 0 ? 0.0 : std::max(0.0, centre - half);
  result.high = count == of ? 1.0 : std::min(1.0, centre + half);
  return result;
}

double quantile(const std::vector<double>& sorted, double p) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(below);
  const double low = sorted[below];
  const double high = sorted[std::min(below + 1, sorted.size() - 1)];
  return share == 0.0 || low == high ? low : low + share * (high - low);
}

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

}  // namespace jink::arena
