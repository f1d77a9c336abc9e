// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/position_history.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planner/base/random.hpp"

namespace jink::bridge::prediction {
namespace {

planner::base::Track seen(const Vec3& position, double sigma) {
  planner::base::Track track;
  track.position = position;
  track.velocity = {7.0, 7.0, 7.0};
  track.position_sigma = sigma;
  return track;
}

bool is_unknown(const planner::base::Track& track) {
  return track.velocity.isZero(0.0) && track.velocity_sigma == PositionHistory::kUnknown;
}

TEST(PositionHistory, KnowsNothingOfWhatWasSeenOnce) {
  PositionHistory history;
  planner::base::Track track = seen({1, 2, 3}, 0.1);
  history.set_velocity(5.0, track);
  EXPECT_TRUE(is_unknown(track));
  history.add(5.0, track);
  history.set_velocity(5.0, track);  // no time has passed
  EXPECT_TRUE(is_unknown(track));
}

// 0.8 m in 0.4 s, each place known to 0.1 m; a metre per second squared makes it 0.2 m/s faster at the end.
TEST(PositionHistory, DividesTheWayByTheTime) {
  PositionHistory history;
  history.add(1.0, seen({1, 0, 0}, 0.1));
  planner::base::Track track = seen({1, 0.8, 0}, 0.1);
  history.set_velocity(1.4, track);
  EXPECT_LT((track.velocity - Vec3(0, 2, 0)).norm(), 1e-12);
  EXPECT_NEAR(track.velocity_sigma, std::sqrt(0.25 * 0.25 + 0.25 * 0.25 + 0.2 * 0.2), 1e-12);
}

TEST(PositionHistory, LooksBackNoFartherThanItHasTo) {
  PositionHistory history;
  planner::base::Track track;
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.1 * i;
    track = seen({t * t, 0, 0}, 0.01);
    history.set_velocity(t, track);
    history.add(t, track);
  }
  EXPECT_NEAR(track.velocity.x(), (4.0 - 1.6 * 1.6) / 0.4, 1e-9);
  track = seen({4, 0, 0}, 0.01);
  history.set_velocity(12.0, track);  // from its last place, ten seconds ago
  EXPECT_TRUE(is_unknown(track));
}

TEST(PositionHistory, DoesNotTellWhatItCannot) {
  PositionHistory history;
  history.add(1.0, seen({0, 0, 0}, 0.1));
  planner::base::Track track = seen({0.01, 0, 0}, 0.1);
  history.set_velocity(1.01, track);  // the noise would be 14 m/s
  EXPECT_TRUE(is_unknown(track));
  track = seen({60, 0, 0}, 0.1);
  history.set_velocity(1.4, track);  // 150 m/s: another
  EXPECT_TRUE(is_unknown(track));
  history.add(0.5, seen({5, 0, 0}, 0.1));  // overtaken on the way
  track = seen({0.4, 0, 0}, 0.1);
  history.set_velocity(1.4, track);
  EXPECT_NEAR(track.velocity.x(), 1.0, 1e-12);
}

TEST(PositionHistory, IsOffByNoMoreThanItSays) {
  planner::base::RandomStream random(1, 1);
  PositionHistory history;
  constexpr double kSigma = 0.1;
  double squares = 0.0;
  double stated = 0.0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const double t = 0.1 * i;
    // It swings with at most 1 m/s².
    planner::base::Track track = seen({std::sin(t) + kSigma * random.normal(), 0, 0}, kSigma);
    history.set_velocity(t, track);
    history.add(t, track);
    if (i < 5) continue;
    squares += (track.velocity.x() - std::cos(t)) * (track.velocity.x() - std::cos(t)) / (kCount - 5);
    stated = track.velocity_sigma;
  }
  EXPECT_LT(std::sqrt(squares), stated);
  EXPECT_GT(std::sqrt(squares), 0.7 * stated);
}

}  // namespace
}  // namespace jink::bridge::prediction
