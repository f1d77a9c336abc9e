// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace jink::planner::base {
namespace {

// The output of the author's splitmix64.c for the seed 1234567.
TEST(SplitMix64, MatchesReferenceCode) {
  SplitMix64 mix(1234567);
  for (const std::uint64_t expected : {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                       4593380528125082431ULL, 16408922859458223821ULL}) {
    EXPECT_EQ(mix.next(), expected);
  }
}

// The output of the authors' xoshiro256plusplus.c for the state {1, 2, 3, 4}.
TEST(Xoshiro256PlusPlus, MatchesReferenceCode) {
  Xoshiro256PlusPlus engine({1, 2, 3, 4});
  for (const std::uint64_t expected : {41943041ULL, 58720359ULL, 3588806011781223ULL, 3591011842654386ULL,
                                       9228616714210784205ULL, 9973669472204895162ULL, 14011001112246962877ULL,
                                       12406186145184390807ULL, 15849039046786891736ULL, 10450023813501588000ULL}) {
    EXPECT_EQ(engine.next(), expected);
  }
}

TEST(RandomStream, SameTripleGivesSameNumbers) {
  RandomStream a(7, 3, 11);
  RandomStream b(7, 3, 11);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(a.next(), b.next());
    EXPECT_EQ(a.normal(), b.normal());
  }
}

// Recorded once: a change of the seeding changes every published result, so it must not go unnoticed.
TEST(RandomStream, SeedingIsFixed) {
  RandomStream stream(1, 2, 3);
  EXPECT_EQ(stream.next(), 3106975646374847983ULL);
  EXPECT_EQ(stream.next(), 11478482440874270757ULL);
}

TEST(RandomStream, NeighbouringTriplesGiveDifferentNumbers) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    for (std::uint64_t stream = 0; stream < 16; ++stream) {
      for (std::uint64_t substream = 0; substream < 16; ++substream) {
        seen.insert(RandomStream(seed, stream, substream).next());
      }
    }
  }
  EXPECT_EQ(seen.size(), 16U * 16U * 16U);
}

TEST(RandomStream, FirstNumbersOfNeighbouringStreamsAreUncorrelated) {
  constexpr int kStreams = 20000;
  double sum = 0.0;
  for (std::uint64_t i = 0; i < kStreams; ++i) {
    sum += (RandomStream(1, i).uniform() - 0.5) * (RandomStream(1, i + 1).uniform() - 0.5) * 12.0;
  }
  EXPECT_NEAR(sum / kStreams, 0.0, 5.0 / std::sqrt(double{kStreams}));
}

TEST(RandomStream, UniformHasItsMeanAndVarianceAndStaysInRange) {
  constexpr int kCount = 200000;
  RandomStream stream(1);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += (u - 0.5) * (u - 0.5);
  }
  // Five standard errors: sqrt(1/12/n) for the mean, sqrt(1/180/n) for the variance.
  EXPECT_NEAR(sum / kCount, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / kCount));
}

TEST(RandomStream, UniformUsesAll53Bits) {
  RandomStream stream(2);
  std::uint64_t seen_bits = 0;
  for (int i = 0; i < 1000; ++i) {
    const double scaled = stream.uniform() * 0x1.0p53;
    ASSERT_EQ(scaled, std::floor(scaled));
    seen_bits |= static_cast<std::uint64_t>(scaled);
  }
  EXPECT_EQ(seen_bits, (std::uint64_t{1} << 53U) - 1);
}

TEST(RandomStream, PairIsTheTwoHalvesOfOneDraw) {
  RandomStream bits(11);
  RandomStream random(11);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t draw = bits.next();
    const auto [high, low] = random.uniform_pair();
    ASSERT_EQ(high, static_cast<double>(draw >> 32U) / 4294967296.0);
    ASSERT_EQ(low, static_cast<double>(draw & 0xffffffffU) / 4294967296.0);
    ASSERT_LT(std::max(high, low), 1.0);
  }
}

TEST(RandomStream, UniformIntervalStaysInsideEvenWhenItIsOneUlpWide) {
  RandomStream stream(3);
  const double lo = 1e6;
  const double hi = std::nextafter(lo, 2e6);
  for (int i = 0; i < 1000; ++i) {
    const double value = stream.uniform(lo, hi);
    EXPECT_GE(value, lo);
    EXPECT_LE(value, hi);
    const double wide = stream.uniform(-3.0, 5.0);
    EXPECT_GE(wide, -3.0);
    EXPECT_LE(wide, 5.0);
  }
  EXPECT_EQ(stream.uniform(4.0, 4.0), 4.0);
}

TEST(RandomStream, BelowIsUniform) {
  constexpr std::uint64_t kCells = 7;
  constexpr int kCount = 70000;
  RandomStream stream(4);
  std::array<int, kCells> counts{};
  for (int i = 0; i < kCount; ++i) ++counts.at(stream.below(kCells));
  double chi_square = 0.0;
  for (const int count : counts) {
    const double off = count - static_cast<double>(kCount) / kCells;
    chi_square += off * off * kCells / kCount;
  }
  EXPECT_LT(chi_square, 27.9);  // six degrees of freedom, probability 1e-4
}

TEST(RandomStream, BelowRejectsTheBiasedPart) {
  constexpr std::uint64_t kN = 3ULL << 62U;  // 3/4 of 2^64: modulo alone would hit the lowest third half the time
  constexpr int kCount = 30000;
  RandomStream stream(5);
  int low = 0;
  for (int i = 0; i < kCount; ++i) {
    const std::uint64_t value = stream.below(kN);
    ASSERT_LT(value, kN);
    if (value < (1ULL << 62U)) ++low;
  }
  EXPECT_NEAR(static_cast<double>(low) / kCount, 1.0 / 3.0, 5.0 * std::sqrt(2.0 / 9.0 / kCount));
}

TEST(RandomStream, BelowOneIsZero) {
  RandomStream stream(6);
  EXPECT_EQ(stream.below(1), 0U);
}

TEST(RandomStream, NormalHasItsMoments) {
  constexpr int kCount = 200000;
  RandomStream stream(7);
  std::array<double, 5> moments{};
  double lagged = 0.0;
  double previous = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = stream.normal();
    moments[1] += x;
    moments[2] += x * x;
    moments[3] += x * x * x;
    moments[4] += x * x * x * x;
    lagged += x * previous;
    previous = x;
    if (std::abs(x) > 2.0) ++beyond_two;
  }
  // Five standard errors each: the variances of x, x^2, x^3, x^4 are 1, 2, 15, 96.
  const double error = 5.0 / std::sqrt(double{kCount});
  EXPECT_NEAR(moments[1] / kCount, 0.0, error);
  EXPECT_NEAR(moments[2] / kCount, 1.0, error * std::sqrt(2.0));
  EXPECT_NEAR(moments[3] / kCount, 0.0, error * std::sqrt(15.0));
  EXPECT_NEAR(moments[4] / kCount, 3.0, error * std::sqrt(96.0));
  EXPECT_NEAR(lagged / kCount, 0.0, error);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kCount, 0.0455003, error * 0.2084);
}

}  // namespace
}  // namespace jink::planner::base
