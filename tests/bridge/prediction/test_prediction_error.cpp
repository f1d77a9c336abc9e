// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/prediction_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bridge/prediction/imm_filter.hpp"
#include "planner/base/random.hpp"

namespace jink::bridge::prediction {
namespace {

using planner::base::Track;

constexpr double kSensed = 0.05;  // s

/// One track, measured as in the arena's realistic tier or without noise, filtered and predicted as in flight.
struct Judged {
  explicit Judged(bool with_noise) : noisy(with_noise) {}

  bool noisy;
  PredictionError error;
  LawsByKind laws;
  ImmFilter filter;
  planner::base::RandomStream random{3, 1};
  double t = 0.0;

  template <typename Motion>
  void watch(Motion motion, double until) {
    constexpr double kDifference = 1e-4;
    for (; t <= until + 1e-9; t += kSensed) {
      Track measured;
      measured.position = motion(t);
      measured.velocity = (motion(t + kDifference) - motion(t - kDifference)) / (2.0 * kDifference);
      if (noisy) {
        measured.position_sigma = 0.1;
        measured.velocity_sigma = 0.3;
        for (int axis = 0; axis < 3; ++axis) {
          measured.position[axis] += 0.1 * random.normal();
          measured.velocity[axis] += 0.3 * random.normal();
        }
      }
      Track estimate = measured;
      if (noisy) {
        filter.update(kSensed, measured);
        filter.apply(estimate);
      }
      Prediction predicted;
      predicted.motion = estimate;
      predicted.position_sigma = estimate.position_sigma;
      predicted.velocity_sigma = estimate.velocity_sigma;
      predicted.trust = 0.7;
      error.observe(t, measured, predicted, laws);
    }
  }
};

Vec3 straight(double t) {
  return {2.0 * t, 1.0, -0.5 * t};
}

// [Contracts] trefoil of scale 1, slower 1.1.
Vec3 knot(double t) {
  const double s = t / 1.1;
  return {std::sin(s) + 2.0 * std::sin(2.0 * s), std::cos(s) - 2.0 * std::cos(2.0 * s), -std::sin(3.0 * s)};
}

TEST(PredictionError, ANewTrackMayStopOrTurn) {
  Judged judged(/*with_noise=*/true);
  judged.watch(straight, 0.0);
  EXPECT_GT(judged.error.acceleration_sigma(), 2.0);
  EXPECT_LT(judged.error.acceleration_sigma(), 5.0);
}

TEST(PredictionError, WhoFliesStraightProvesIt) {
  Judged judged(/*with_noise=*/true);
  judged.watch(straight, 1.5);
  EXPECT_LT(judged.error.acceleration_sigma(), 0.8);
}

TEST(PredictionError, WhoTurnsIsFoundOut) {
  Judged judged(/*with_noise=*/true);
  judged.watch(knot, 1.0);
  EXPECT_GT(judged.error.acceleration_sigma(), 3.0);
  judged.watch([](double t) { return Vec3(knot(1.0) + (t - 1.0) * Vec3(1.0, 0.0, 0.0)); }, 6.0);
  EXPECT_LT(judged.error.acceleration_sigma(), 1.0) << "and forgiven";
}

TEST(PredictionError, WithoutNoiseNothingIsAssumed) {
  Judged judged(/*with_noise=*/false);
  judged.watch(straight, 1.0);
  EXPECT_LT(judged.error.acceleration_sigma(), 1e-6);
}

// Walks, stands from 1 s on, and goes on across at 3 s.
Vec3 walker(double t) {
  return {1.2 * std::min(t, 1.0), 1.6 * std::max(0.0, t - 3.0), 0.0};
}

TEST(PredictionError, WhoStopsOrSetsOffAtOnceIsRemembered) {
  Judged judged(/*with_noise=*/false);
  judged.watch(walker, 1.0);
  EXPECT_NEAR(judged.error.sudden_change(), 0.0, 1e-9);
  judged.watch(walker, 2.9);
  EXPECT_NEAR(judged.error.sudden_change(), 1.2, 0.15);
  judged.watch(walker, 3.6);
  EXPECT_NEAR(judged.error.sudden_change(), 1.6, 0.2);
  judged.watch(walker, 20.0);
  EXPECT_NEAR(judged.error.sudden_change(), 1.6, 0.2) << "not forgotten";
}

TEST(PredictionError, WhatChangesSlowlyOrIsMeasuredWithNoiseHasNotChangedAtOnce) {
  Judged judged(/*with_noise=*/false);
  judged.watch([](double t) { return Vec3(2.0 * std::sin(0.7 * t), 0.0, 0.0); }, 10.0);  // at 1 m/s² at most
  EXPECT_LT(judged.error.sudden_change(), 0.4);
  Judged noisy(/*with_noise=*/true);
  noisy.watch(walker, 4.0);
  EXPECT_EQ(noisy.error.sudden_change(), 0.0);
}

// It is believed for what it foresaw itself, and not before.
TEST(PredictionError, ALearnedSwingIsDoubtedUntilItHasShownThatItIsBetter) {
  Judged judged(/*with_noise=*/true);
  judged.watch(knot, 1.0);
  const double before = judged.error.acceleration_sigma();
  Prediction learned;
  learned.motion = HarmonicMotion{};  // stays at the origin
  Track measured;
  measured.position_sigma = 0.1;
  judged.error.observe(1.05, measured, learned, judged.laws);
  EXPECT_NEAR(judged.error.acceleration_sigma(), before, 0.1);
  for (double t = 1.1; t < 2.0; t += kSensed) judged.error.observe(t, measured, learned, judged.laws);
  EXPECT_LT(judged.error.acceleration_sigma(), 0.3 * before);
}

TEST(PredictionError, WhatCameIsHeldAgainstWhatWasPredictedAtEachLead) {
  Judged judged(/*with_noise=*/true);
  const LawsByKind before;
  judged.watch(straight, 1.8);
  for (std::size_t i = 0; i < ErrorLaws::kLeads.size(); ++i) {
    const double lead = ErrorLaws::kLeads[i];
    const bool over = lead < judged.t;
    EXPECT_EQ(judged.laws[0].at(lead).region(0.9) != before[0].at(lead).region(0.9), over) << lead << " s ahead";
    EXPECT_EQ(judged.laws[1].at(lead).region(0.9), before[1].at(lead).region(0.9)) << "nothing swings";
  }
  judged.watch(straight, 20.0);
  for (const double lead : ErrorLaws::kLeads)
    EXPECT_LT(judged.laws[0].at(lead).region(0.99), 0.85 * before[0].at(lead).region(0.99)) << "it goes straight";
}

TEST(Prediction, IsLessSureTheFartherAhead) {
  Prediction prediction;
  prediction.position_sigma = 0.1;
  prediction.velocity_sigma = 0.2;
  prediction.acceleration_sigma = 2.0;
  EXPECT_DOUBLE_EQ(prediction.sigma(0.0), 0.1);
  EXPECT_DOUBLE_EQ(prediction.sigma(1.0), std::sqrt(0.01 + 0.04 + 1.0));
  prediction.age = 1.0;
  EXPECT_DOUBLE_EQ(prediction.sigma(0.0), std::sqrt(0.01 + 0.04 + 1.0));
}

}  // namespace
}  // namespace jink::bridge::prediction
