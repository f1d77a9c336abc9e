// SPDX-License-Identifier: BSD-3-Clause
// Intervals of proportions, and quantiles: what the arena's and the study's statistics share.
#pragma once

#include <cstdint>
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

}  // namespace jink::tools::lab::statistics
