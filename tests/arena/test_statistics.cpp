// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/random.hpp"
#include "tools/arena/statistics.hpp"

namespace jink::arena {
namespace {

TEST(Wilson, AgreesWithPublishedIntervals) {
  // Newcombe 1998, Statistics in Medicine 17, p. 857-872, table I, method 3.
  struct Case {
    std::int64_t count, of;
    double low, high;
  };
  for (const Case& c : {Case{81, 263, 0.2553, 0.3662}, Case{15, 148, 0.0624, 0.1605}, Case{0, 20, 0.0, 0.1611},
                        Case{1, 29, 0.0061, 0.1718}}) {
    const Proportion p = wilson(c.count, c.of);
    EXPECT_NEAR(p.low, c.low, 5e-5) << c.count << " of " << c.of;
    EXPECT_NEAR(p.high, c.high, 5e-5) << c.count << " of " << c.of;
    EXPECT_EQ(p.value(), static_cast<double>(c.count) / static_cast<double>(c.of));
  }
}

TEST(Wilson, MirrorsAndEndsAtZeroAndOne) {
  for (const std::int64_t of : {1, 3, 10, 997, 1000000}) {
    EXPECT_EQ(wilson(0, of).low, 0.0);
    EXPECT_EQ(wilson(of, of).high, 1.0);
    for (const std::int64_t count : {std::int64_t{0}, of / 3, of / 2}) {
      const Proportion p = wilson(count, of), q = wilson(of - count, of);
      EXPECT_NEAR(p.low, 1.0 - q.high, 1e-12);
      EXPECT_NEAR(p.high, 1.0 - q.low, 1e-12);
      EXPECT_LE(p.low, p.value());
      EXPECT_GE(p.high, p.value());
    }
  }
}

TEST(Wilson, NothingIsKnownOfNothing) {
  const Proportion p = wilson(0, 0);
  EXPECT_EQ(p.low, 0.0);
  EXPECT_EQ(p.high, 1.0);
}

TEST(Quantile, IsLinearBetweenNeighbours) {
  const std::vector<double> values{1.0, 2.0, 4.0, 8.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.05), 1.15);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 4.0 + 0.7 * 4.0);
  EXPECT_EQ(quantile(values, 1.0), 8.0);
  EXPECT_EQ(quantile({7.0}, 0.3), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Quantile, KeepsInfinity) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(quantile({1.0, infinity, infinity}, 0.75), infinity);
  EXPECT_EQ(quantile({1.0, infinity}, 0.0), 1.0);
}

TEST(DurationHistogram, QuantilesAreWithinABinOfTheExactOnes) {
  planner::RandomStream random(5);
  std::vector<double> values;
  DurationHistogram histogram;
  for (int i = 0; i < 5000; ++i) {
    values.push_back(0.05 * std::exp(6.0 * random.uniform()));
    histogram.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double p : {0.01, 0.5, 0.99}) {
    const double exact = values[static_cast<std::size_t>(std::ceil(p * 5000.0)) - 1];
    EXPECT_NEAR(histogram.quantile(p) / exact, 1.0, 0.011) << p;
  }
  EXPECT_EQ(histogram.max(), values.back());
  EXPECT_LE(histogram.quantile(1.0), histogram.max());
  EXPECT_EQ(histogram.count(), 5000);
}

TEST(DurationHistogram, OfTwoPartsIsThatOfTheWhole) {
  DurationHistogram a, b, whole;
  for (int i = 1; i <= 100; ++i) {
    (i % 3 == 0 ? a : b).add(0.1 * i);
    whole.add(0.1 * i);
  }
  a.add(b);
  EXPECT_EQ(a.bins(), whole.bins());
  EXPECT_EQ(a.max(), whole.max());
  EXPECT_EQ(a.count(), 100);
}

TEST(DurationHistogram, WithoutValuesHasNoQuantile) {
  EXPECT_TRUE(std::isnan(DurationHistogram().quantile(0.5)));
  DurationHistogram zero;
  zero.add(0.0);
  EXPECT_EQ(zero.quantile(0.5), 0.0);
}

}  // namespace
}  // namespace jink::arena
