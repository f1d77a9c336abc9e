// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/statistics/samples.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
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
  if (sorted.empty()) return kNan;
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(below);
  const double low = sorted[below];
  const double high = sorted[std::min(below + 1, sorted.size() - 1)];
  return share == 0.0 || low == high ? low : low + share * (high - low);
}

double mean(std::span<const double> values) {
  if (values.empty()) return kNan;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
  if (values.size() < 2) return kNan;
  const double middle = mean(values);
  double squares = 0.0;
  for (const double v : values) squares += (v - middle) * (v - middle);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

Summary summary(std::span<const double> values, double level) {
  if (!(level > 0.0 && level < 1.0))
    throw std::invalid_argument("the level of an interval has to be between 0 and 1, not " + std::to_string(level));
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    throw std::invalid_argument("a sample has a value that is not finite");
  Summary result{static_cast<int>(values.size()), kNan, kNan, mean(values),
                 standard_deviation(values),      kNan, kNan, kNan};
  if (values.empty()) return result;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  result.least = sorted.front();
  result.greatest = sorted.back();
  result.median = quantile(sorted, 0.5);
  double half = std::numeric_limits<double>::infinity();
  if (values.size() > 1) {
    const double n = static_cast<double>(values.size());
    const boost::math::students_t t(n - 1.0);
    half = boost::math::quantile(boost::math::complement(t, (1.0 - level) / 2.0)) * result.deviation / std::sqrt(n);
  }
  result.low = result.mean - half;
  result.high = result.mean + half;
  return result;
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
  if (count_ == 0) return kNan;
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

}  // namespace jink::tools::lab::statistics
