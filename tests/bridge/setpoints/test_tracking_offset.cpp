// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/tracking_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace jink::bridge::setpoints {
namespace {

using planner::base::TimedPath;
using planner::base::TimedPoint;

/// Velocity and acceleration are the position's derivatives, between 2.2 and 8 s.
void expect_derivatives(const OffsetForecast& forecast) {
  constexpr double kStep = 1e-4;  // s
  for (double t = 2.2; t < 8.0; t += 0.37) {
    const TimedPoint before = forecast.at(t - kStep);
    const TimedPoint after = forecast.at(t + kStep);
    EXPECT_LT((forecast.at(t).velocity - (after.position - before.position) / (2 * kStep)).norm(), 1e-6) << t;
    EXPECT_LT((forecast.at(t).acceleration - (after.velocity - before.velocity) / (2 * kStep)).norm(), 1e-6) << t;
  }
}

TEST(OffsetForecast, DiesDownSmoothly) {
  const OffsetForecast forecast{2.0, {1, -2, 0.5}};
  EXPECT_EQ(forecast.at(1.0).position, forecast.offset);
  EXPECT_EQ(forecast.at(2.0).position, forecast.offset);
  EXPECT_EQ(forecast.at(2.0).velocity, Vec3::Zero());
  EXPECT_LT((forecast.at(5.0).position - 0.5 * forecast.offset).norm(), 1e-12);
  EXPECT_LT(forecast.at(8.0).position.norm() + forecast.at(8.0).velocity.norm(), 1e-12);
  EXPECT_EQ(forecast.at(100.0).acceleration, Vec3::Zero());
  expect_derivatives(forecast);
}

TEST(OffsetForecast, ItsRateDiesDownSooner) {
  const OffsetForecast forecast{2.0, {1, 0, 0}, OffsetForecast::kFade, {0, -1, 0.5}};
  EXPECT_EQ(forecast.at(2.0).velocity, forecast.rate);
  EXPECT_NEAR(forecast.at(2.1).position.y(), -0.6 * (1 - std::exp(-0.1 / 0.6)), 1e-4);
  EXPECT_NEAR(forecast.at(2.0 + OffsetForecast::kRateFade).velocity.z(), 0.5 / std::numbers::e, 0.02);
  EXPECT_LT(forecast.at(8.0).position.norm() + forecast.at(8.0).velocity.norm(), 1e-12);
  expect_derivatives(forecast);
}

TEST(OffsetForecast, WhatIsAddedCanBeTakenOff) {
  const OffsetForecast forecast{0.0, {0.3, 0.2, -0.1}, 1.0};
  TimedPath path;
  for (double t = 0.0; t < 2.0; t += 0.1) path.push_back({t, {t, 0, 1}, {1, 0, 0}, Vec3::Zero()});
  const TimedPath added = forecast.added_to(path);
  EXPECT_EQ(added.front().position, Vec3(0.3, 0.2, 0.9));
  EXPECT_EQ(added.back().position, path.back().position);
  const TimedPath back = forecast.taken_off(added);
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LT((back[i].position - path[i].position).norm(), 1e-12);
    EXPECT_LT((back[i].velocity - path[i].velocity).norm(), 1e-12);
    EXPECT_LT((back[i].acceleration - path[i].acceleration).norm(), 1e-12);
  }
}

TEST(OffsetForecast, WithoutTimeToDieDownThereIsNone) {
  EXPECT_EQ((OffsetForecast{0.0, {1, 1, 1}, 0.0}.at(0.0).position), Vec3::Zero());
}

TEST(TrackingOffset, ForecastsTheNewestAndKnowsHowWrongItWas) {
  TrackingOffset offset;
  EXPECT_EQ(offset.forecast().at(3.0).position, Vec3::Zero());
  EXPECT_FALSE(offset.error());
  double t = 0.0;
  const auto run = [&](double seconds, const auto& value) {
    for (const double end = t + seconds; t < end; t += 0.02) offset.observe(t, value(t), Vec3::Zero());
  };
  run(1.9, [](double) { return Vec3(0.5, 0, 0); });
  EXPECT_FALSE(offset.error());  // too few forecasts have come to their second
  run(3.0, [](double) { return Vec3(0.5, 0, 0); });
  EXPECT_EQ(offset.forecast().offset, Vec3(0.5, 0, 0));
  ASSERT_TRUE(offset.error());
  EXPECT_LT(*offset.error(), 0.03);  // 0.5 m was foreseen
  // A swing of 4 s is 90 degrees ahead of where it was foreseen a second before.
  run(12.0, [](double at) { return Vec3(0.5 * std::sin(0.5 * std::numbers::pi * at), 0, 0); });
  EXPECT_NEAR(*offset.error(), 0.5 * std::sqrt(2.0), 0.04);
  run(12.0, [](double) { return Vec3(0, 0, 0); });
  EXPECT_LT(*offset.error(), 1e-9);
}

TEST(TrackingOffset, AJumpOfTheReferenceIsNotAnErrorAndTimesThatDoNotGrowAreNone) {
  TrackingOffset offset;
  for (double t = 0.0; t < 4.0; t += 0.02) offset.observe(t, {0.9, 0, 0}, Vec3::Zero());
  const double before = offset.error().value();
  offset.forget();
  EXPECT_EQ(offset.forecast().offset, Vec3::Zero());
  for (double t = 4.0; t < 8.0; t += 0.02) offset.observe(t, {0, 0.1, 0}, Vec3::Zero());
  EXPECT_LE(*offset.error(), before);
  const OffsetForecast newest = offset.forecast();
  offset.observe(newest.begun, {7, 7, 7}, {1, 1, 1});
  offset.observe(newest.begun - 1.0, {7, 7, 7}, {1, 1, 1});
  EXPECT_EQ(offset.forecast().offset, newest.offset);
}

// The position does what the vehicle does; the velocity is 0.4 m/s off.
TEST(VelocityError, IsWhatThePositionDoesNotDo) {
  VelocityError error;
  const auto fly = [&](double from, double to, const Vec3& wrong) {
    for (double t = from; t < to; t += 0.02)
      error.observe(t, {std::sin(t), 2.0 * t, 1.0}, Vec3(std::cos(t), 2.0, 0.3) + wrong);
  };
  fly(0.0, 5.0, Vec3::Zero());
  EXPECT_LT(error.value().norm(), 1e-3);
  fly(5.0, 10.0, {0.4, -0.1, 0});
  EXPECT_LT((error.value() - 0.8 * Vec3(0.4, -0.1, 0)).norm(), 1e-3);  // the height is left alone
  // After a jump of the position, a gap, or what came before.
  error.forget();
  error.observe(10.0, {50, 0, 0}, {1, 0, 0});
  error.observe(12.0, {0, 0, 0}, {1, 0, 0});
  error.observe(11.0, {90, 0, 0}, {1, 0, 0});
  EXPECT_LT((error.value() - 0.8 * Vec3(0.4, -0.1, 0)).norm(), 1e-3);
  fly(20.0, 30.0, {5, 0, 0});
  EXPECT_NEAR(error.value().norm(), 0.8, 1e-6);  // bounded
}

}  // namespace
}  // namespace jink::bridge::setpoints
