// SPDX-License-Identifier: BSD-3-Clause
// Statistics of samples: proportions with their intervals, quantiles, means, durations. Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace jink::tools::lab::statistics {

/// A part of a whole, with the 95 % interval of its probability.
struct Proportion {
  std::int64_t count = 0;
  std::int64_t of = 0;
  double low = 0.0;
  double high = 1.0;

  /// count / of; 0 of nothing.
  [[nodiscard]] double value() const { return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of); }
};

/// The proportion with Wilson's score interval (Wilson 1927, J. Am. Stat. Assoc. 22, p. 209-212), without a correction
/// for continuity: inside [0, 1], and of use for counts of 0 and of all. Of nothing nothing is known: [0, 1]. Requires
/// 0 <= count <= of.
[[nodiscard]] Proportion wilson(std::int64_t count, std::int64_t of);

/// The quantile `p` in [0, 1] of sorted values, linear between neighbours (Hyndman and Fan's type 7, R's and NumPy's
/// default). Infinite values are allowed. NaN without values.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double p);

/// NaN without values.
[[nodiscard]] double mean(std::span<const double> values);
/// The sample standard deviation, n - 1 below; NaN for fewer than two values.
[[nodiscard]] double standard_deviation(std::span<const double> values);

/// A sample in brief.
struct Summary {
  int count = 0;
  double least = 0.0, greatest = 0.0;
  double mean = 0.0;
  double deviation = 0.0;  ///< standard_deviation()
  double median = 0.0;
  double low = 0.0, high = 0.0;  ///< the interval of the mean (Student); -inf and inf for a single value
};

/// All NaN without values. A single value has no deviation (NaN) and says nothing of the mean. Throws
/// std::invalid_argument for a value that is not finite, or a level outside (0, 1).
[[nodiscard]] Summary summary(std::span<const double> values, double level = 0.95);

/// Durations counted in bins of equal ratio, so that those of many flights can be added up without keeping each.
class DurationHistogram {
 public:
  /// A bin's upper end is this much over its lower one: 2^(1/32), 2.2 %. Below 1 microsecond all is one bin.
  static constexpr int kBinsPerOctave = 32;

  /// Requires a finite value >= 0.
  void add(double milliseconds);
  void add(const DurationHistogram& other);
  /// A bin as bins() gave it once, and the largest value that goes with all bins.
  void add_bin(int bin, std::int64_t count) {
    bins_[bin] += count;
    count_ += count;
  }
  void set_max(double milliseconds) { max_ = milliseconds; }

  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Exact, ms; 0 without values.
  [[nodiscard]] double max() const { return max_; }
  /// ms, to within 1.1 %: the middle of the bin that holds the smallest value with at least a share `p` at or below it.
  /// NaN without values.
  [[nodiscard]] double quantile(double p) const;
  [[nodiscard]] const std::map<int, std::int64_t>& bins() const { return bins_; }

 private:
  std::map<int, std::int64_t> bins_;
  std::int64_t count_ = 0;
  double max_ = 0.0;
};

}  // namespace jink::tools::lab::statistics
