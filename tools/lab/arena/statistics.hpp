// SPDX-License-Identifier: BSD-3-Clause
// The statistics of a campaign: how long plans took, beside the intervals and quantiles that all tools share.
#pragma once

#include <cstdint>
#include <map>

#include "tools/lab/statistics/statistics.hpp"

namespace jink::tools::lab::arena {

using statistics::Proportion;
using statistics::quantile;
using statistics::wilson;

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

}  // namespace jink::tools::lab::arena
