// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/statistics/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace jink::tools::lab::statistics {
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

}  // namespace
}  // namespace jink::tools::lab::statistics
