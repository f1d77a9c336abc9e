// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/portable_math.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "planner/base/random.hpp"

namespace jink::planner::base {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ArcTangent, KnowsTheSpecialDirections) {
  EXPECT_EQ(arc_tangent2(0.0, 0.0), 0.0);
  EXPECT_EQ(arc_tangent2(0.0, 3.0), 0.0);
  EXPECT_EQ(arc_tangent2(0.0, -3.0), kPi);
  EXPECT_EQ(arc_tangent2(2.0, 0.0), kPi / 2);
  EXPECT_DOUBLE_EQ(arc_tangent2(1.0, 1.0), kPi / 4);
  EXPECT_DOUBLE_EQ(arc_tangent2(1.0, -1.0), 3 * kPi / 4);
  EXPECT_DOUBLE_EQ(arc_tangent2(std::sqrt(3.0), 1.0), kPi / 3);
}

TEST(ArcTangent, MatchesTheLibraryInEveryDirectionAndSize) {
  RandomStream random(1);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double angle = random.uniform(0.0, kPi);
    const double size = std::exp(random.uniform(-200.0, 200.0));
    const double y = std::abs(size * std::sin(angle));
    const double x = size * std::cos(angle);
    worst = std::max(worst, std::abs(arc_tangent2(y, x) - std::atan2(y, x)));
  }
  EXPECT_LT(worst, 9e-16);  // two units in the last place of pi
}

TEST(ArcTangent, IsAccurateForTinyAngles) {
  for (double y = 1e-300; y < 1e-3; y *= 7.0) EXPECT_DOUBLE_EQ(arc_tangent2(y, 1.0), std::atan2(y, 1.0));
}

TEST(SineCosine, MatchesTheLibraryInEveryQuadrant) {
  for (int i = -4000; i <= 4000; ++i) {
    const double x = 0.0173 * i;
    const auto [sine, cosine] = sine_cosine(x);
    EXPECT_NEAR(sine, std::sin(x), 1e-14) << x;
    EXPECT_NEAR(cosine, std::cos(x), 1e-14) << x;
  }
  for (const double x : {-9.9e4, 12345.678, 9.9e4}) {
    EXPECT_NEAR(sine_cosine(x).sine, std::sin(x), 1e-11) << x;
    EXPECT_NEAR(sine_cosine(x).cosine, std::cos(x), 1e-11) << x;
  }
}

TEST(Logarithm, MatchesTheLibrary) {
  EXPECT_EQ(logarithm(1.0), 0.0);
  RandomStream random(2);
  for (int i = 0; i < 200000; ++i) {
    const double x = std::exp(random.uniform(-700.0, 700.0));
    ASSERT_NEAR(logarithm(x), std::log(x), 4e-16 * std::max(1.0, std::abs(std::log(x)))) << x;
    const double near_one = random.uniform(0.5, 2.0);
    ASSERT_NEAR(logarithm(near_one), std::log(near_one), 4e-16) << near_one;
  }
}

TEST(Exponential, MatchesTheLibrary) {
  EXPECT_EQ(exponential(0.0), 1.0);
  RandomStream random(3);
  for (int i = 0; i < 200000; ++i) {
    const double x = random.uniform(-700.0, 700.0);
    ASSERT_NEAR(exponential(x) / std::exp(x), 1.0, 2e-16 * std::max(4.0, std::abs(x))) << x;
    const double small = random.uniform(-1.0, 1.0);
    ASSERT_NEAR(exponential(small), std::exp(small), 1e-15) << small;
  }
}

TEST(Hypotenuse, KnowsTheSpecialTriangles) {
  EXPECT_EQ(hypotenuse(0.0, 0.0), 0.0);
  EXPECT_EQ(hypotenuse(3.0, -4.0), 5.0);
  EXPECT_EQ(hypotenuse(-12.0, 5.0), 13.0);
  EXPECT_EQ(hypotenuse(1e100, 1e-100), 1e100);
  EXPECT_EQ(hypotenuse(std::numeric_limits<double>::infinity(), 1.0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(hypotenuse(std::numeric_limits<double>::quiet_NaN(), 1.0)));
  EXPECT_TRUE(std::isnan(hypotenuse(1.0, std::numeric_limits<double>::quiet_NaN())));
}

TEST(Hypotenuse, IsWithinOneUnitInTheLastPlace) {
  RandomStream random(1);
  for (int i = 0; i < 200000; ++i) {
    const double size = std::exp(random.uniform(-300.0, 300.0));
    const double x = size * random.uniform(-1.0, 1.0);
    const double y = size * random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 1.0 : std::exp(random.uniform(-40.0, 0.0)));
    const auto [a, b] = std::pair<long double, long double>(x, y);
    const auto exact = static_cast<double>(std::sqrt(a * a + b * b));
    EXPECT_LE(std::abs(hypotenuse(x, y) - exact), std::nextafter(exact, 1e300) - exact) << x << " " << y;
  }
}

}  // namespace
}  // namespace jink::planner::base
