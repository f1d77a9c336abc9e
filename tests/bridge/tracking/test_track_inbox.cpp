// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_inbox.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace jink::bridge::tracking {
namespace {

const planner::base::Box kFence{{-30, -40, 0}, {30, 40, 20}};  // 100 m wide

TrackMessage message_of(const std::vector<Vec3>& positions) {
  TrackMessage message;
  TrackValidator validator(message, positions.size());
  for (const Vec3& position : positions) {
    planner::base::Track track;
    track.position = position;
    track.radius = 1.0;
    validator.add(track);
  }
  return message;
}

TEST(TrackInbox, WhatIsFarBesideTheFenceIsElsewhere) {
  EXPECT_TRUE(elsewhere(message_of({{131.5, 0, 5}}), kFence));
  EXPECT_FALSE(elsewhere(message_of({{130.5, 0, 5}}), kFence));
  EXPECT_FALSE(elsewhere(message_of({{0, 0, 5000}}), kFence));
  EXPECT_TRUE(elsewhere(message_of({{5000, 0, 5}, {0, -5000, 5}}), kFence));
  EXPECT_FALSE(elsewhere(message_of({{5000, 0, 5}, {20, 0, 5}}), kFence));
  EXPECT_FALSE(elsewhere(message_of({}), kFence));
  EXPECT_FALSE(elsewhere(message_of({{5000, 0, 5}}), {}));  // no fence, no place
  TrackMessage placed = message_of({{5000, 0, 5}});
  placed.placed = true;
  EXPECT_FALSE(elsewhere(placed, kFence));
}

// A metric grid's coordinates are beyond the limit of a track: without its tracks the message would say "all clear".
TEST(TrackInbox, WhatIsTooFarToBeATrackIsElsewhereToo) {
  const Vec3 grid(465'000, 5'250'000, 3);
  EXPECT_TRUE(elsewhere(message_of({grid}), kFence));
  EXPECT_TRUE(elsewhere(message_of({grid}), {}));
  EXPECT_FALSE(elsewhere(message_of({grid, {1, 2, 3}}), kFence));
  EXPECT_FALSE(elsewhere(message_of({{std::numeric_limits<double>::quiet_NaN(), 0, 0}}), kFence));
}

}  // namespace
}  // namespace jink::bridge::tracking
