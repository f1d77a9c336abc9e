// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/base/stamped.hpp"

#include <gtest/gtest.h>

#include "bridge/tracking/clock_offset.hpp"

namespace jink::bridge::base {
namespace {

TEST(Stamped, APositionIsOneOfATime) {
  const Stamped<Kinematics, Frame::kLocal> moving{{{1, 2, 3}, {2, 0, -1}}, 10.0, 10.1};
  EXPECT_EQ(position_at(moving, 10.0), Vec3(1, 2, 3));
  EXPECT_EQ(position_at(moving, 10.5), Vec3(2, 2, 2.5));
  EXPECT_EQ(moving.age(10.5), 0.5);
}

TEST(Stamped, WhatWasNeverHeardIsOlderThanAnything) {
  const Stamped<Kinematics, Frame::kLocal> nothing;
  EXPECT_FALSE(nothing.heard());
  EXPECT_GT(nothing.age(0.0), 1e300);
}

TEST(ClockOffsetEstimator, StampsAMessageByItsDelay) {
  tracking::ClockOffsetEstimator clock;
  Reception<Frame::kLocal> message{1, 10.0, 0.05};
  EXPECT_EQ(clock.stamp(message), 10.0 - 0.05);
  message.received = 10.1;
  EXPECT_EQ(clock.stamp(message), 10.1 - 0.05);
  message.received = 10.2;
  message.stamp_age = 1.2;  // too late
  EXPECT_FALSE(clock.stamp(message));
}

}  // namespace
}  // namespace jink::bridge::base
