// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/base/random.hpp"
#include "tools/lab/arena/statistics.hpp"

namespace jink::tools::lab::arena {
namespace {

TEST(DurationHistogram, QuantilesAreWithinABinOfTheExactOnes) {
  planner::base::RandomStream random(5);
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
}  // namespace jink::tools::lab::arena
