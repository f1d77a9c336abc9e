// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/learned_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bridge/prediction/harmonic_fit.hpp"
#include "bridge/prediction/imm_filter.hpp"
#include "bridge/prediction/motion_learner.hpp"
#include "planner/base/random.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/geometry/validity.hpp"

namespace jink::bridge::prediction {
namespace {

using planner::base::RandomStream;
using planner::base::Track;

constexpr double kStep = 0.05;  // s

// [Contracts] trefoil of scale 1 about (10, 0, 1), slower 1.1.
Vec3 trefoil(double t) {
  const double s = t / 1.1;
  return {10.0 + std::sin(s) + 2.0 * std::sin(2.0 * s), std::cos(s) - 2.0 * std::cos(2.0 * s), 1.0 - std::sin(3.0 * s)};
}

Vec3 swing(double t) {
  return {2.0 + 1.5 * std::sin(1.7 * t), 0.5, 3.0};
}

template <typename Motion>
Track exact(Motion motion, double t) {
  constexpr double kDifference = 1e-4;
  Track track;
  track.radius = 0.4;
  track.position = motion(t);
  track.velocity = (motion(t + kDifference) - motion(t - kDifference)) / (2.0 * kDifference);
  track.acceleration =
      (motion(t + kDifference) + motion(t - kDifference) - 2.0 * motion(t)) / (kDifference * kDifference);
  return track;
}

/// Of a flight in which what was foreseen has come true often enough.
Experience good_experience() {
  Experience all;
  for (PredictionRecord* record : {&all.turns, &all.swings}) {
    while (!record->good()) record->note(/*came_true=*/true);
  }
  return all;
}

/// One track, watched for so long.
struct Watched {
  MotionLearner learned;
  Experience all = good_experience();
  Track last;
  double t = 0.0;
  bool fits = true;  // are made

  template <typename Motion>
  void watch(Motion motion, double until, std::uint64_t name = 1) {
    for (; t <= until + 1e-9; t += kStep) {
      last = exact(motion, t);
      learned.observe(t, last, last, name, all);
      if (fits && learned.fit_due() <= t) learned.fit(t, last, last);
    }
    t -= kStep;
  }
  [[nodiscard]] std::optional<Forecast> forecast(double now) const { return learned.forecast(now, t, last, all); }
};

bool relied_on(const Forecast& forecast) {
  return forecast.plain_until < planner::base::kInfinity;
}

TEST(HarmonicMotion, LaterIsTheSameMotion) {
  HarmonicMotion motion;
  motion.frequency = 0.8;
  for (Eigen::Index i = 0; i < motion.terms.size(); ++i) motion.terms(i) = 0.1 * static_cast<double>(i) - 1.0;
  const HarmonicMotion later = motion.later(1.3);
  for (const double t : {0.0, 0.7, 5.0}) EXPECT_NEAR((later.position(t) - motion.position(1.3 + t)).norm(), 0.0, 1e-12);
}

TEST(BouncingMotion, FoldsBackAtEveryBound) {
  BouncingMotion motion;
  motion.begin = {1, 0, 0};
  motion.velocity = {2, -1, 0.5};
  motion.room.min = {0, -planner::base::kInfinity, -5};
  motion.room.max = {3, planner::base::kInfinity, 1};
  EXPECT_EQ(motion.first_turn().t, 1.0);
  EXPECT_NEAR((motion.position(0.5) - Vec3(2, -0.5, 0.25)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((motion.position(2.0) - Vec3(1, -2, 1)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((motion.position(3.0) - Vec3(1, -3, 0.5)).norm(), 0.0, 1e-12);  // -1 folded to 1, 1.5 to 0.5
}

TEST(HarmonicFit, FindsATrefoilOutOfHalfAPeriod) {
  std::vector<MotionSample> samples;
  for (double t = 0.0; t <= 3.5; t += 0.1) {
    const Track track = exact(trefoil, t);
    samples.push_back({t, track.position, track.velocity});
  }
  const auto fit = fit_harmonics(samples, 0.01, 0.01);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->motion.frequency, 1.0 / 1.1, 0.05);
  EXPECT_LT(fit->misfit, 1.0);
  const double last = samples.back().t;
  for (const double ahead : {0.5, 1.0, 1.5})
    EXPECT_LT((fit->motion.position(ahead) - trefoil(last + ahead)).norm(), 0.1) << ahead;
}

TEST(HarmonicFit, AsksForAFewSamples) {
  const std::vector<MotionSample> samples(kFewestSamples - 1);
  EXPECT_FALSE(fit_harmonics(samples, 0.1, 0.1).has_value());
}

TEST(MotionLearner, ForecastsWhatSwings) {
  Watched watched;
  watched.watch(swing, 5.0);
  const auto forecast = watched.forecast(5.2);
  ASSERT_TRUE(forecast.has_value());
  EXPECT_EQ(forecast->plain_until, MotionLearner::kLead);
  const planner::geometry::KnownPath path = to_path(*forecast, 3.0, 0.1);
  ASSERT_TRUE(planner::geometry::is_valid(path));
  for (const double ahead : {0.0, 1.0, 2.0, 3.0})
    EXPECT_LT((path.position(ahead) - swing(5.2 + ahead)).norm(), 0.05) << ahead;
}

TEST(MotionLearner, ForecastsATrefoilWithinOnePeriod) {
  Watched watched;
  watched.watch(trefoil, 6.0);
  const auto forecast = watched.forecast(6.0);
  ASSERT_TRUE(forecast.has_value());
  const planner::geometry::KnownPath path = to_path(*forecast, 2.0, 0.1);
  for (const double ahead : {0.5, 1.0, 2.0}) EXPECT_LT((path.position(ahead) - trefoil(6.0 + ahead)).norm(), 0.25);
}

// Where measurements are exact, there is no need to wait for the better part of a period.
TEST(MotionLearner, ForecastsAnExactTrefoilSoon) {
  Watched watched;
  watched.watch(trefoil, 1.4);
  const auto forecast = watched.forecast(1.4);
  ASSERT_TRUE(forecast.has_value());
  EXPECT_TRUE(relied_on(*forecast));
  const planner::geometry::KnownPath path = to_path(*forecast, 2.0, 0.1);
  for (const double ahead : {0.5, 1.0}) EXPECT_LT((path.position(ahead) - trefoil(1.4 + ahead)).norm(), 0.15) << ahead;
}

TEST(MotionLearner, IsUnexplainedUntilItIsUnderstood) {
  Watched watched;
  watched.watch(trefoil, 0.0);
  EXPECT_TRUE(watched.learned.unexplained(0.0));
  watched.t += kStep;
  watched.watch(trefoil, 1.4);
  EXPECT_FALSE(watched.learned.unexplained(1.4));
  Watched steady;
  steady.watch([](double t) { return Vec3(2.0 * t, 1.0, -0.5 * t); }, 1.0);
  EXPECT_FALSE(steady.learned.unexplained(1.0));
}

TEST(MotionLearner, IsUnexplainedForAWhileOnly) {
  // Thrown about at random: never understood.
  Watched watched;
  RandomStream random(5);
  Vec3 push = Vec3::Zero();
  Track track;
  for (double t = 0.0; t < MotionLearner::kLongestUnexplained + 0.5; t += kStep) {
    const Vec3 target(random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0));
    push += 0.5 * (target - push);
    track.acceleration = push;
    track.velocity += kStep * push;
    track.position += kStep * track.velocity;
    watched.learned.observe(t, track, track, 1, watched.all);
    if (watched.learned.fit_due() <= t) watched.learned.fit(t, track, track);
    EXPECT_EQ(watched.learned.unexplained(t), t < MotionLearner::kLongestUnexplained && push.norm() > 0.0) << t;
  }
}

TEST(MotionLearner, LeavesSteadyMotionAlone) {
  Watched watched;
  watched.watch([](double t) { return Vec3(2.0 * t, 1.0, -0.5 * t); }, 6.0);
  EXPECT_FALSE(watched.forecast(6.0).has_value());
}

TEST(MotionLearner, StopsBelievingWhenTheMotionIsAnother) {
  Watched watched;
  watched.watch(swing, 5.0);
  ASSERT_TRUE(watched.forecast(5.0).has_value());
  const Vec3 place = swing(5.0);
  const Track before = exact(swing, 5.0);
  watched.t += kStep;
  watched.watch([&](double t) { return Vec3(place + (t - 5.0) * Vec3(before.velocity.x(), 3.0, 0.0)); }, 6.0);
  const auto forecast = watched.forecast(6.0);
  EXPECT_FALSE(forecast.has_value() && relied_on(*forecast));
}

/// Between -1 and 1 on y at 1 m/s, from `y` on.
Vec3 bouncing(double t, double y) {
  const double phase = std::fmod(y + 1.0 + t, 4.0);
  return {0.5 * y, phase > 2.0 ? 3.0 - phase : phase - 1.0, 2.0};
}

TEST(MotionLearner, KnowsWhereItTurnedBefore) {
  Watched watched;
  watched.watch([](double t) { return bouncing(t, 0.03); }, 4.0);  // turned at 0.97 and at 2.97
  const auto forecast = watched.forecast(4.0);
  ASSERT_TRUE(forecast.has_value());
  EXPECT_FALSE(relied_on(*forecast));  // it may as well go on
  const planner::geometry::KnownPath path = to_path(*forecast, 3.0, 0.1);
  EXPECT_LT((path.position(2.5) - bouncing(6.5, 0.03)).norm(), 0.1);
}

// The third time round, plain prediction counts until a second after the turn, and for ever once the track has passed.
TEST(MotionLearner, ReliesOnATurnThatCameTwice) {
  Watched watched;
  watched.fits = false;
  watched.watch([](double t) { return bouncing(t, 0.03); }, 6.0);  // at 0.97, 2.97 and 4.97
  const auto forecast = watched.forecast(6.0);
  ASSERT_TRUE(forecast.has_value());
  EXPECT_FALSE(relied_on(*forecast));  // on its way down, where it turned once
  watched.t += kStep;
  watched.watch([](double t) { return bouncing(t, 0.03); }, 8.0);
  const auto again = watched.forecast(8.0);
  ASSERT_TRUE(again.has_value());
  EXPECT_NEAR(again->plain_until, 8.97 - 8.0 + MotionLearner::kLead, 1e-6);
  EXPECT_LT((to_path(*again, 3.0, 0.1).position(2.5) - bouncing(10.5, 0.03)).norm(), 0.1);
  const Vec3 place = bouncing(8.0, 0.03);
  watched.t += kStep;
  watched.watch([&](double t) { return Vec3(place + (t - 8.0) * Vec3::UnitY()); }, 9.5);  // and on beyond 1
  EXPECT_FALSE(watched.forecast(9.5).has_value());
}

// At most a tenth may be wrong, by the rule of succession: eight turns where it turned before, or eight seconds.
TEST(MotionLearner, ReliesOnNothingWithoutARecord) {
  Watched watched;
  watched.all = {};
  watched.fits = false;
  const auto until = [&](double t) {
    watched.watch([](double s) { return bouncing(s, 0.03); }, t);
    watched.t += kStep;
    return watched.forecast(watched.t);
  };
  ASSERT_TRUE(until(18.0).has_value());
  EXPECT_FALSE(relied_on(*until(18.1)));  // 9 turns, the first on either side foreseen by nobody
  EXPECT_TRUE(relied_on(*until(20.1)));
  watched.all.turns.note(/*came_true=*/false);  // another track walked on
  EXPECT_FALSE(relied_on(*until(20.2)));
  Watched swinging;
  swinging.all = {};
  swinging.watch(swing, 5.0);
  ASSERT_TRUE(swinging.forecast(5.0).has_value());
  EXPECT_FALSE(relied_on(*swinging.forecast(5.0)));
  swinging.t += kStep;
  swinging.watch(swing, 14.0);
  EXPECT_TRUE(relied_on(*swinging.forecast(14.0)));
}

// What has swung as foreseen for eight seconds is not avoided where it would be if it went straight on; what then does
// is, from when it has shown that.
TEST(MotionLearner, ReliesOnASwingAloneThatKeepsComingTrue) {
  Watched watched;
  watched.watch(swing, 7.0);
  ASSERT_TRUE(watched.forecast(7.0).has_value());
  EXPECT_EQ(watched.forecast(7.0)->plain_until, MotionLearner::kLead);
  watched.t += kStep;
  watched.watch(swing, 14.0);
  ASSERT_TRUE(watched.forecast(14.0).has_value());
  EXPECT_EQ(watched.forecast(14.0)->plain_until, 0.0);
  const Track before = exact(swing, 14.0);
  watched.t += kStep;
  watched.watch([&](double t) { return Vec3(before.position + (t - 14.0) * before.velocity); }, 14.8);
  EXPECT_FALSE(watched.forecast(14.8).has_value() && relied_on(*watched.forecast(14.8)));
}

TEST(PredictionRecord, DoubtsByTheRuleOfSuccession) {
  PredictionRecord record;
  EXPECT_EQ(record.doubt(), 0.5);
  for (int i = 0; i < 7; ++i) record.note(/*came_true=*/true);
  EXPECT_NEAR(record.doubt(), 1.0 / 9.0, 1e-12);
  EXPECT_FALSE(record.good());
  record.note(/*came_true=*/true);
  EXPECT_TRUE(record.good());
  record.note(/*came_true=*/false);
  EXPECT_NEAR(record.doubt(), 2.0 / 11.0, 1e-12);
  EXPECT_FALSE(record.good());
}

TEST(MotionLearner, RecordsWhatComesTrueAndWhatDoesNot) {
  Watched watched;
  watched.all = {};
  watched.fits = false;
  watched.watch([](double t) { return bouncing(t, 0.03); }, 8.0);  // two turns where it turned before
  EXPECT_NEAR(watched.all.turns.doubt(), 1.0 / 4.0, 1e-12);
  const Vec3 place = bouncing(8.0, 0.03);
  watched.t += kStep;
  watched.watch([&](double t) { return Vec3(place + (t - 8.0) * Vec3::UnitY()); }, 9.5);  // and on beyond 1
  EXPECT_NEAR(watched.all.turns.doubt(), 2.0 / 5.0, 1e-12);
}

/// What the realistic tier's sensor makes of a motion, filtered as the track table does.
struct Noisy {
  MotionLearner learned;
  Experience all = good_experience();
  ImmFilter filter;
  Track last;
  RandomStream random{3};
  std::uint64_t name = 1;

  /// A fit at most every `pause` seconds.
  template <typename Motion>
  void observe(Motion motion, double t, double pause) {
    constexpr double kPositionNoise = 0.1, kVelocityNoise = 0.3;
    Track measured = exact(motion, t);
    measured.acceleration.setZero();
    measured.position_sigma = kPositionNoise;
    measured.velocity_sigma = kVelocityNoise;
    const auto noise = [&] {
      const double x = random.normal();
      const double y = random.normal();
      return Vec3(x, y, random.normal());
    };
    measured.position += kPositionNoise * noise();
    measured.velocity += kVelocityNoise * noise();
    last = measured;
    filter.update(kStep, measured);
    filter.apply(last);
    learned.observe(t, measured, last, name, all);
    if (learned.fit_due() > t || t < fitted_ + pause) return;
    learned.fit(t, measured, last);
    fitted_ = t;
  }

 private:
  double fitted_ = -1.0;
};

// In a crowd the fits come in turn, each track's more than a trial apart. What has proved right stays believed between.
TEST(MotionLearner, IsBelievedBetweenFitsThatAreRare) {
  int believed = 0, asked = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Noisy noisy;
    noisy.random = RandomStream(seed);
    for (double t = 0.0; t < 24.0; t += kStep) {
      noisy.observe(swing, t, 1.3);
      if (t < 16.0) continue;
      const auto forecast = noisy.learned.forecast(t, t, noisy.last, noisy.all);
      ++asked;
      believed += forecast && relied_on(*forecast) ? 1 : 0;
    }
  }
  EXPECT_GT(believed, 9 * asked / 10);
}

// Every measurement counts: of 64 single ones, the rest left out, the forecast would be off by 0.051 m.
TEST(MotionLearner, ForecastsMoreExactlyThanItIsMeasured) {
  Noisy noisy;
  double squares = 0.0;
  int asked = 0;
  for (double t = 0.0; t < 20.0; t += kStep) {
    noisy.observe(swing, t, 0.0);
    if (t < 12.0) continue;
    const auto forecast = noisy.learned.forecast(t, t, noisy.last, noisy.all);
    if (!forecast || !std::holds_alternative<HarmonicMotion>(forecast->motion)) continue;
    ++asked;
    squares += (to_path(*forecast, 1.0, 0.1).position(1.0) - swing(t + 1.0)).squaredNorm();
  }
  ASSERT_GT(asked, 100);
  EXPECT_LT(std::sqrt(squares / asked), 0.045);
}

TEST(LearnedBounds, IsKnownWhereTwoTurnedAndNoneWasBeyond) {
  LearnedBounds room;
  room.saw({0, 2.6, 0}, 0.4);
  room.turned(1, 1, true, 3.0);
  EXPECT_EQ(room.bounds(0.4).max.y(), planner::base::kInfinity);  // one alone proves nothing
  room.turned(1, 1, true, 3.0);
  EXPECT_EQ(room.bounds(0.4).max.y(), planner::base::kInfinity);
  room.turned(2, 1, true, 3.02);
  EXPECT_NEAR(room.bounds(0.2).max.y(), 2.8, 1e-12);
  EXPECT_EQ(room.bounds(0.2).min.y(), -planner::base::kInfinity);
  room.saw({0, 3.5, 0}, 0.4);
  EXPECT_EQ(room.bounds(0.4).max.y(), planner::base::kInfinity);
}

TEST(MotionLearner, TurnsWhereOthersTurned) {
  Experience all;
  for (const std::uint64_t name : {1U, 2U}) {
    MotionLearner learned;
    for (double t = 0.0; t < 1.5; t += kStep) {
      const double y = 0.03 * static_cast<double>(name);
      const Track track = exact([y](double s) { return bouncing(s, y); }, t);
      learned.observe(t, track, track, name, all);
    }
  }
  MotionLearner third;
  const Track track = exact([](double t) { return bouncing(t, -0.5); }, 0.0);
  third.observe(0.0, track, track, 3, all);
  const auto forecast = third.forecast(0.0, 0.0, track, all);
  ASSERT_TRUE(forecast.has_value());
  EXPECT_LT((to_path(*forecast, 3.0, 0.1).position(2.5) - bouncing(2.5, -0.5)).norm(), 0.1);
}

// What noise puts behind a plane for a moment was not beyond it.
TEST(MotionLearner, TurnsWhereOthersTurnedInNoise) {
  Experience all = good_experience();
  std::uint64_t tracks = 0;
  /// How far from where it is a second after it was watched for so long it is foreseen, m.
  const auto watch = [&all, &tracks](double y, double until) {
    Noisy noisy;
    noisy.all = all;
    noisy.name = ++tracks;
    noisy.random = RandomStream(tracks);
    double t = 0.0;
    for (; t < until; t += kStep) noisy.observe([y](double s) { return bouncing(s, y); }, t, 0.0);
    t -= kStep;
    all = noisy.all;
    const auto forecast = noisy.learned.forecast(t, t, noisy.last, all);
    const Vec3 plain = planner::geometry::predict_position(noisy.last, 1.0);
    return ((forecast ? to_path(*forecast, 2.0, 0.1).position(1.0) : plain) - bouncing(t + 1.0, y)).norm();
  };
  double squares = 0.0;
  constexpr int kAsked = 10;
  for (int i = 0; i < kAsked; ++i) {
    watch(0.2 * i, 3.0);
    for (int n = 0; n < 20; ++n) watch(0.95, 0.1);  // comes into view where they turn
    const double error = watch(-0.9, 1.2);          // has not turned yet, and will
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / kAsked), 0.3);
}

TEST(ObstaclesOf, WhatMovesNearbyMayStop) {
  std::vector<Track> tracks(4);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i].id = 10 + i;
    tracks[i].radius = 0.4;
    tracks[i].position = {3, 0, 1};
    tracks[i].velocity = {2, 0, 0};
  }
  tracks[1].velocity = {0.1, 0, 0};  // hardly moves
  tracks[2].velocity_sigma = 1.0;    // may not move at all
  tracks[3].position = {-20, 0, 1};  // far off
  std::vector<planner::geometry::KnownPath> paths;
  add_stops(tracks, {0, 0, 1}, 10.0, paths);
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_TRUE(planner::geometry::is_valid(paths[0]));
  EXPECT_EQ(paths[0].id, 10U);
  EXPECT_EQ(paths[0].radius, 0.4);
  EXPECT_EQ(paths[0].points.front().position, tracks[0].position);
  EXPECT_NEAR(paths[0].points.back().position.x(), 3.5, 1e-12) << "v² / 2a";
  EXPECT_NEAR(paths[0].points.back().t, 0.5, 1e-12);
  EXPECT_LT(paths[0].until, 1.0) << "it is seen by then";
  tracks[0].velocity = {4, 0, 0};
  paths.clear();
  add_stops(tracks, {0, 0, 1}, 10.0, paths);
  EXPECT_GE(paths.at(0).until, 0.45 + 1.0) << "who follows as fast has reacted and stopped no sooner";
}

TEST(ObstaclesOf, PlainPredictionStandsBesideAForecastForAsLongAsItCounts) {
  constexpr double kHorizon = 2.0, kTrust = 0.5;
  std::vector<Track> tracks(3);
  for (std::size_t i = 0; i < 3; ++i) {
    tracks[i].id = 10 + i;
    tracks[i].radius = 0.4;
    tracks[i].position_sigma = 0.1;
    tracks[i].velocity = {1, 0, 0};
    tracks[i].acceleration = {0, 1, 0};
  }
  Forecast relied;
  relied.track = 1;
  relied.motion = HarmonicMotion{};
  relied.plain_until = 1.25;
  Forecast beside;
  beside.track = 2;
  beside.motion = BouncingMotion{};
  const std::vector<Forecast> forecasts{relied, beside};
  const Obstacles obstacles = obstacles_of(tracks, forecasts, {}, kHorizon, 0.1, kTrust);
  ASSERT_EQ(obstacles.tracks.size(), 2U);
  EXPECT_EQ(obstacles.tracks[0].id, 10U);
  EXPECT_EQ(obstacles.tracks[1].id, 12U);
  ASSERT_EQ(obstacles.paths.size(), 3U);
  EXPECT_EQ(obstacles.paths[0].id, 11U);
  EXPECT_NEAR(obstacles.paths[0].points.back().t, kHorizon, 1e-9);
  const planner::geometry::KnownPath& plain = obstacles.paths[1];
  ASSERT_TRUE(planner::geometry::is_valid(plain));
  EXPECT_EQ(plain.id, 11U);
  EXPECT_EQ(plain.until, 1.25);
  EXPECT_EQ(plain.radius, tracks[1].radius);
  EXPECT_EQ(plain.position_sigma, tracks[1].position_sigma);
  for (const double t : {0.0, 0.5, 1.25})
    EXPECT_LT((plain.position(t) - planner::geometry::predict_position(tracks[1], t, kTrust)).norm(), 0.002) << t;
  EXPECT_EQ(obstacles.paths[2].id, 12U);
}

}  // namespace
}  // namespace jink::bridge::prediction
