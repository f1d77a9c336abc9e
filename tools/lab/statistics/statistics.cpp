// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/statistics/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace jink::tools::lab::statistics {
namespace {

constexpr double kNormalQuantile = 1.959963984540054;  // of 0.975

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

}  // namespace jink::tools::lab::statistics
