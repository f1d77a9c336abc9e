// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bridge/vehicle/link_delay.hpp"

namespace jink::bridge::vehicle {
namespace {

TEST(LinkDelay, NothingIsKnownBeforeAnAnswer) {
  const LinkDelay delay;
  EXPECT_FALSE(delay.round_trip());
  EXPECT_EQ(delay.one_way(), 0.0);
}

TEST(LinkDelay, IsHalfOfTheShortestRoundTripLately) {
  LinkDelay delay;
  double now = 10.0;
  const auto answered = [&](double round_trip) {
    now += LinkDelay::kPeriod;
    delay.answered(now - round_trip, now);
  };
  answered(0.4);
  EXPECT_NEAR(delay.one_way(), 0.2, 1e-9);
  answered(0.1);
  answered(0.6);  // waited somewhere
  EXPECT_NEAR(delay.one_way(), 0.05, 1e-9);
  for (std::size_t i = 0; i < LinkDelay::kKept; ++i) answered(0.3);  // another way, for good
  EXPECT_NEAR(*delay.round_trip(), 0.3, 1e-9);
}

TEST(LinkDelay, AnAnswerToNothingAskedLatelyIsNone) {
  LinkDelay delay;
  delay.answered(5.0, 7.1);
  delay.answered(5.0, 4.9);
  delay.answered(std::numeric_limits<double>::quiet_NaN(), 5.0);
  EXPECT_FALSE(delay.round_trip());
}

/// At 50 Hz for so long; `age` of each by the time since the beginning. The longest delay; infinite: one is left out.
template <typename Age>
double longest(StampDelay& delay, double& now, double seconds, Age age) {
  double most = 0.0;
  const double begin = now;
  for (; now < begin + seconds; now += 0.02)
    most = std::max(most, delay.of(now, age(now - begin)).value_or(std::numeric_limits<double>::infinity()));
  return most;
}

TEST(StampDelay, WhatClocksDoIsNoDelay) {
  StampDelay delay;
  double now = 100.0;
  // By the agent's clock, which a slow simulation falls behind until it is set; then by its own since it booted.
  EXPECT_EQ(longest(delay, now, 90.0, [](double t) { return 0.0047 * std::fmod(t, 35.0); }), 0.0);
  StampDelay other;
  EXPECT_EQ(longest(other, now, 90.0, [](double t) { return 1.79e9 + 0.0047 * t; }), 0.0);
  StampDelay ahead;
  EXPECT_EQ(longest(ahead, now, 90.0, [](double t) { return -3600.0 - 0.0047 * t; }), 0.0);
}

TEST(StampDelay, IsTheAgeOfWhatIsStampedByOurClock) {
  StampDelay delay;
  double now = 100.0;
  EXPECT_NEAR(longest(delay, now, 1.0, [](double) { return 0.7; }), 0.7, 1e-9);  // from the beginning
  EXPECT_EQ(longest(delay, now, 1.0, [](double) { return 0.02; }), 0.0);
  EXPECT_NEAR(longest(delay, now, 30.0, [](double) { return 0.9; }), 0.9, 1e-9);
  EXPECT_EQ(delay.of(now, 1.2), std::nullopt);
  EXPECT_EQ(delay.of(now + 0.02, 1.79e9), std::nullopt);  // one by another clock
  EXPECT_EQ(delay.of(now + 0.04, 0.02), 0.0);
}

TEST(StampDelay, CountsFromTheLeastLatelyWhereTheClockIsAnother) {
  StampDelay delay;
  double now = 100.0;
  EXPECT_EQ(longest(delay, now, 20.0, [](double t) { return 1.79e9 + 0.0047 * t; }), 0.0);
  EXPECT_NEAR(longest(delay, now, 1.0, [](double) { return 1.79e9 + 0.0047 * 20.0 + 0.6; }), 0.6, 0.06);
  EXPECT_EQ(delay.of(now, 1.79e9 + 2.0), std::nullopt);
  // Another clock for good, as after a boot, is learned.
  now += 2.5 * StampDelay::kWindow;
  EXPECT_EQ(delay.of(now, 5.0e8), 0.0);
  EXPECT_NEAR(*delay.of(now + 0.02, 5.0e8 + 0.6), 0.6, 1e-6);
}

}  // namespace
}  // namespace jink::bridge::vehicle
