// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace jink::bridge::vehicle
