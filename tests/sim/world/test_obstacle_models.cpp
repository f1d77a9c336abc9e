// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/obstacle_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/world/random_obstacles.hpp"

namespace jink::sim::world {
namespace {

using planner::base::RandomStream;
using std::numbers::pi;

void expect_near(const Vec3& actual, const Vec3& expected, double tolerance = 1e-12) {
  EXPECT_NEAR((actual - expected).norm(), 0.0, tolerance)
      << "actual " << actual.transpose() << ", expected " << expected.transpose();
}

TEST(LinearMotion, MatchesPaperEquations) {
  const config::LinearMotion motion{{1, 2, 3}, {4, -2, 1}, {2, 0, -1}};
  const ObstacleState state = state_at(motion, 3.0);
  expect_near(state.position, {1 + 12 + 9, 2 - 6, 3 + 3 - 4.5});
  expect_near(state.velocity, {10, -2, -2});
  expect_near(state.acceleration, {2, 0, -1});
}

TEST(TrefoilMotion, MatchesContractAtTauZero) {
  const config::TrefoilMotion motion{{10, 20, 30}, {2, 3, 4}, 2.0, 0.0};
  const ObstacleState state = state_at(motion, 0.0);
  expect_near(state.position, {10, 20 - 3, 30});
  // With the rate 1/2: sx (1 + 4), sy (0), -3 sz; and a quarter of sy (-1 + 8).
  expect_near(state.velocity, {5.0, 0, -6.0});
  expect_near(state.acceleration, {0, 3 * 7 / 4.0, 0});
}

TEST(TrefoilMotion, MatchesContractAtAQuarterTurn) {
  // τ = t / 2 + π/4 = π/2 at t = π/2: (sx (1 + 0), sy (0 + 2), -sz (-1)).
  const config::TrefoilMotion motion{{10, 20, 30}, {2, 3, 4}, 2.0, pi / 4};
  const ObstacleState state = state_at(motion, pi / 2);
  expect_near(state.position, {12, 26, 34});
  // cos τ + 4 cos 2τ = -4; -sin τ + 4 sin 2τ = -1; -3 cos 3τ = 0; all times the rate 1/2.
  expect_near(state.velocity, {-4, -1.5, 0});
}

TEST(SineMotion, MatchesContractAtAQuarterPeriod) {
  const config::SineMotion motion{{5, 0, 1}, {0, 2, 3}, {0, 0.2, 0.1}, {0, 0, pi / 2}};
  const ObstacleState state = state_at(motion, 1.25);  // y: a quarter period; z: an eighth, from the top
  expect_near(state.position, {5, 2, 1 + 3 * std::sqrt(0.5)});
  expect_near(state.velocity, {0, 0, -3 * 0.2 * pi * std::sqrt(0.5)});
  expect_near(state.acceleration, {0, -2 * std::pow(0.4 * pi, 2), -3 * std::pow(0.2 * pi, 2) * std::sqrt(0.5)});
}

TEST(SineMotion, ZeroFrequencyStandsAtItsPhase) {
  const config::SineMotion motion{{1, 1, 1}, {2, 0, 0}, {0, 0, 0}, {pi / 2, 0, 0}};
  expect_near(state_at(motion, 7.0).position, {3, 1, 1});
  expect_near(state_at(motion, 7.0).velocity, {0, 0, 0});
}

TEST(BounceMotion, ReflectsAtBothFaces) {
  const config::BounceMotion motion{{8, 2, 1}, {3, -5, 0}, {0, 0, 0}, {10, 10, 4}};
  const ObstacleState first = state_at(motion, 1.0);  // x: 11 folds to 9; y: -3 folds to 3
  expect_near(first.position, {9, 3, 1});
  expect_near(first.velocity, {-3, 5, 0});
  const ObstacleState second = state_at(motion, 4.0);  // x: 20 folds to 0, touching; y: -18 is 18, folds to 2
  expect_near(second.position, {0, 2, 1});
  expect_near(second.velocity, {3, -5, 0});
  expect_near(first.acceleration, {0, 0, 0});
}

TEST(BounceMotion, VelocityAtAContactIsThatAfterIt) {
  const config::BounceMotion motion{{5, 5, 0}, {5, -5, 0}, {0, 0, 0}, {10, 10, 0}};
  expect_near(state_at(motion, 1.0).position, {10, 0, 0});
  expect_near(state_at(motion, 1.0).velocity, {-5, 5, 0});
  // Starting on a face and moving into it: the contact is at once.
  const config::BounceMotion outward{{0, 10, 0}, {-1, 1, 0}, {0, 0, 0}, {10, 10, 0}};
  expect_near(state_at(outward, 0.0).velocity, {1, -1, 0});
  expect_near(state_at(outward, 2.0).position, {2, 8, 0});
}

TEST(BounceMotion, AxisWithoutWidthStands) {
  const config::BounceMotion motion{{1, 5, 2}, {1, 7, 0}, {0, 5, 0}, {10, 5, 4}};
  expect_near(state_at(motion, 3.0).position, {4, 5, 2});
  expect_near(state_at(motion, 3.0).velocity, {1, 0, 0});
}

TEST(BounceMotion, IsExactAfterABillionSeconds) {
  const config::BounceMotion motion{{1, 6, 0}, {3, -3, 0}, {0, 0, 0}, {7, 7, 0}};
  const long long quarter_seconds = 4'000'000'000LL + 1;
  // In quarters of a metre: 4 + 3 per quarter second, folded at 28 and 56. The y axis is the mirror image.
  const long long folded = (4 + 3 * quarter_seconds) % 56;
  const double x = static_cast<double>(folded <= 28 ? folded : 56 - folded) / 4;
  const ObstacleState state = state_at(motion, static_cast<double>(quarter_seconds) / 4);
  EXPECT_EQ(state.position.x(), x);
  EXPECT_EQ(state.position.y(), 7 - x);
  EXPECT_EQ(state.velocity.x(), folded < 28 ? 3 : -3);
  EXPECT_EQ(state.velocity.y(), -state.velocity.x());
}

// 0.1 and 1e8 + 0.3 have no short binary fractions: a fold of the rounded product is off by some 1e-9.
TEST(BounceMotion, LosesNoDigitsWhenSpeedAndTimeAreNotRound) {
  const config::BounceMotion motion{{0.25, 0, 0}, {0.1, 0, 0}, {0, 0, 0}, {1.5, 0, 0}};
  const double t = 1e8 + 0.3;
  const auto exact =
      static_cast<double>(std::fmod(0.25L + static_cast<long double>(0.1) * static_cast<long double>(t), 3.0L));
  EXPECT_NEAR(state_at(motion, t).position.x(), exact <= 1.5 ? exact : 3.0 - exact, 2e-12);
}

TEST(WaypointsMotion, MatchesContractExample) {
  const config::WaypointsMotion motion{{0, 5, 9}, {{3, 3, 1}, {6, 0, 1}, {9, 3, 1}}};
  expect_near(state_at(motion, 0.0).position, {3, 3, 1});
  expect_near(state_at(motion, 2.5).position, {4.5, 1.5, 1});
  expect_near(state_at(motion, 2.5).velocity, {0.6, -0.6, 0});
  expect_near(state_at(motion, 4.0).position, {5.4, 0.6, 1});
  expect_near(state_at(motion, 5.0).position, {6, 0, 1}, 0.0);
  expect_near(state_at(motion, 5.0).velocity, {0.75, 0.75, 0});
  expect_near(state_at(motion, 8.0).position, {8.25, 2.25, 1});
  expect_near(state_at(motion, 8.0).acceleration, {0, 0, 0});
}

TEST(WaypointsMotion, StandsBeforeTheFirstAndFromTheLastPoint) {
  const config::WaypointsMotion motion{{2, 4}, {{1, 0, 0}, {3, 0, 0}}};
  for (const double t : {0.0, 1.0, 1.999}) {
    expect_near(state_at(motion, t).position, {1, 0, 0}, 0.0);
    expect_near(state_at(motion, t).velocity, {0, 0, 0}, 0.0);
  }
  expect_near(state_at(motion, 2.0).velocity, {1, 0, 0});
  for (const double t : {4.0, 5.0, 1e6}) {
    expect_near(state_at(motion, t).position, {3, 0, 0}, 0.0);
    expect_near(state_at(motion, t).velocity, {0, 0, 0}, 0.0);
  }
}

TEST(WaypointsMotion, OnePointStands) {
  const config::WaypointsMotion motion{{3}, {{1, 2, 3}}};
  for (const double t : {0.0, 3.0, 9.0}) expect_near(state_at(motion, t).position, {1, 2, 3}, 0.0);
}

TEST(ObstacleMotion, StandsBeforeTheClockRuns) {
  for (std::uint64_t kind = 0; kind < testing::kMotionKinds; ++kind) {
    RandomStream random(1, kind);
    const config::Motion motion = testing::random_motion(random, kind);
    for (const double t : {-1e-9, -3.0, -planner::base::kInfinity}) {
      const ObstacleState state = state_at(motion, t);
      expect_near(state.position, state_at(motion, 0.0).position, 0.0);
      expect_near(state.velocity, {0, 0, 0}, 0.0);
      expect_near(state.acceleration, {0, 0, 0}, 0.0);
    }
    EXPECT_EQ(speed_bound(motion, -2.0, -1.0), 0.0);
    EXPECT_EQ(chord_deviation(motion, -2.0, 0.0), 0.0);
  }
}

TEST(ObstacleMotion, VelocityAndAccelerationAreTheDerivatives) {
  constexpr double kStep = 1e-5;
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    RandomStream random(2, seed);
    const config::Motion motion = testing::random_motion(random, seed % testing::kMotionKinds);
    const double t = random.uniform(2 * kStep, 10.0);
    const ObstacleState before = state_at(motion, t - kStep);
    const ObstacleState after = state_at(motion, t + kStep);
    const ObstacleState state = state_at(motion, t);
    // A bounce or a waypoint within the step has no derivative; it is rare enough to leave it out.
    const bool smooth = motion.index() < 3;
    if (!smooth && before.velocity != after.velocity) continue;
    ++compared;
    expect_near((after.position - before.position) / (2 * kStep), state.velocity, 1e-6);
    expect_near((after.velocity - before.velocity) / (2 * kStep), state.acceleration, 1e-6);
  }
  EXPECT_GT(compared, 990);
}

TEST(ObstacleMotion, PositionIsContinuousAndWithinTheSpeedBound) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    RandomStream random(3, seed);
    const config::Motion motion = testing::random_motion(random, seed % testing::kMotionKinds);
    const double t0 = random.uniform(-1.0, 8.0);
    const double t1 = t0 + random.uniform(0.0, 3.0);
    const double bound = speed_bound(motion, t0, t1);
    constexpr int kSamples = 200;
    const double step = (t1 - t0) / kSamples;
    Vec3 previous = state_at(motion, t0).position;
    for (int i = 1; i <= kSamples; ++i) {
      const ObstacleState state = state_at(motion, t0 + i * step);
      EXPECT_LE(state.velocity.norm(), bound * (1 + 1e-12)) << seed;
      EXPECT_LE((state.position - previous).norm(), bound * step + 1e-12) << seed;
      previous = state.position;
    }
  }
}

TEST(ObstacleMotion, SpeedBoundIsReachedWhereItClaimsToBeExact) {
  EXPECT_DOUBLE_EQ(speed_bound(config::LinearMotion{{0, 0, 0}, {-4, 0, 0}, {2, 0, 0}}, 1.0, 4.0), 4.0);  // |-2|, |4|
  EXPECT_DOUBLE_EQ(speed_bound(config::TrefoilMotion{{0, 0, 0}, {2, 2, 2}, 4.0, 0.0}, 0.0, 1.0),
                   state_at(config::TrefoilMotion{{0, 0, 0}, {2, 2, 2}, 4.0, 0.0}, 0.0).velocity.norm());
  EXPECT_DOUBLE_EQ(speed_bound(config::BounceMotion{{0, 0, 0}, {3, 4, 9}, {-1, -1, 0}, {1, 1, 0}}, 0.0, 1.0), 5.0);
  const config::WaypointsMotion waypoints{{0, 1, 2}, {{0, 0, 0}, {5, 0, 0}, {6, 0, 0}}};
  EXPECT_DOUBLE_EQ(speed_bound(waypoints, 0.5, 1.5), 5.0);
  EXPECT_DOUBLE_EQ(speed_bound(waypoints, 1.25, 1.5), 1.0);
  EXPECT_DOUBLE_EQ(speed_bound(waypoints, 3.0, 4.0), 0.0);
}

TEST(ObstacleMotion, StaysWithinTheChordDeviation) {
  int tight = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    RandomStream random(4, seed);
    const config::Motion motion = testing::random_motion(random, seed % testing::kMotionKinds);
    const double t0 = random.uniform(-0.5, 8.0);
    const double t1 = t0 + std::pow(10.0, random.uniform(-4, 0.7));
    const double bound = chord_deviation(motion, t0, t1);
    const Vec3 from = state_at(motion, t0).position;
    const Vec3 to = state_at(motion, t1).position;
    double largest = 0.0;
    for (int i = 1; i < 200; ++i) {
      const double u = i / 200.0;
      const Vec3 on_chord = (1 - u) * from + u * to;
      largest = std::max(largest, (state_at(motion, (1 - u) * t0 + u * t1).position - on_chord).norm());
    }
    EXPECT_LE(largest, bound + 1e-13) << seed;
    if (largest > 0.5 * bound) ++tight;
  }
  EXPECT_GT(tight, 300);  // a bound that is never near the truth would make the sweep slow
}

TEST(ObstacleMotion, ChordDeviationIsNothingOnStraightPieces) {
  const config::BounceMotion bounce{{5, 5, 5}, {2, 1, 0}, {0, 0, 0}, {10, 10, 10}};
  EXPECT_LE(chord_deviation(bounce, 0.0, 2.4), 1e-9);
  EXPECT_GT(chord_deviation(bounce, 2.4, 2.6), 0.1);
  EXPECT_LE(chord_deviation(bounce, 2.6, 4.9), 1e-9);
  EXPECT_EQ(chord_deviation(config::LinearMotion{{0, 0, 0}, {9, 9, 9}, {0, 0, 0}}, 1.0, 5.0), 0.0);
  EXPECT_EQ(chord_deviation(config::LinearMotion{{0, 0, 0}, {9, 9, 9}, {0, 4, 0}}, 1.0, 5.0), 8.0);
  const config::WaypointsMotion waypoints{{1, 2}, {{0, 0, 0}, {5, 0, 0}}};
  EXPECT_EQ(chord_deviation(waypoints, 0.0, 1.0), 0.0);
  EXPECT_EQ(chord_deviation(waypoints, 1.0, 2.0), 0.0);
  EXPECT_EQ(chord_deviation(waypoints, 2.0, 9.0), 0.0);
  EXPECT_GT(chord_deviation(waypoints, 1.9, 2.1), 0.1);
}

}  // namespace
}  // namespace jink::sim::world
