// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/obstacle_motion.hpp"

#include <gtest/gtest.h>

namespace jink::planner::geometry {
namespace {

base::Track example() {
  base::Track track;
  track.id = 7;
  track.position = {1, 0, -1};
  track.velocity = {2, -4, 0};
  track.acceleration = {3, 0, 8};
  track.radius = 0.5;
  return track;
}

// Eq. (4): v = 2 + 3·0.5. Exact Eq. (5)-(7): x = 1 + 2·0.5 + ½·3·0.25 = 2.375, y = −4·0.5, z = −1 + ½·8·0.25.
TEST(PredictPosition, IsExactForConstantAcceleration) {
  EXPECT_EQ(predict_velocity(example(), 0.5), Vec3(3.5, -4, 4));
  EXPECT_EQ(predict_position(example(), 0.5), Vec3(2.375, -2, 0));
}

// As printed: x + v(t+Δt)Δt + ½aΔt² = 1 + 3.5·0.5 + 0.375 = 3.125, which is aΔt² = 3·0.25 = 0.75 too much.
TEST(PredictPosition, DiffersFromThePrintedFormByAccelerationTimesTimeSquared) {
  const base::Track track = example();
  const double dt = 0.5;
  const Vec3 printed = track.position + predict_velocity(track, dt) * dt + 0.5 * track.acceleration * dt * dt;
  EXPECT_DOUBLE_EQ(printed.x(), 3.125);
  EXPECT_EQ(printed - predict_position(track, dt), Vec3(track.acceleration * dt * dt));
}

// Trusted for 0.2 s: x(0.2) = 1 + 0.4 + 0.06 = 1.46, v = 2.6; then 0.3 s at 2.6: 1.46 + 0.78 = 2.24.
TEST(PredictPosition, AcceleratesOnlyWhileTrusted) {
  EXPECT_NEAR(predict_position(example(), 0.5, 0.2).x(), 2.24, 1e-15);
  EXPECT_NEAR(predict_velocity(example(), 0.5, 0.2).x(), 2.6, 1e-15);
  EXPECT_EQ(predict_position(example(), 0.2, 0.2), predict_position(example(), 0.2));
  EXPECT_EQ(predict_position(example(), 1.0, 0.0), Vec3(3, -4, -1));  // no trust: constant velocity
}

TEST(PredictPosition, IsWhereSmallStepsOfTheVelocityLead) {
  for (const double trust : {0.0, 0.7, base::kInfinity}) {
    constexpr int kSteps = 20000;
    constexpr double kTime = 2.0;
    Vec3 p = example().position;
    for (int i = 0; i < kSteps; ++i) {
      p += predict_velocity(example(), (i + 0.5) * kTime / kSteps, trust) * (kTime / kSteps);  // midpoint rule
    }
    EXPECT_LT((p - predict_position(example(), kTime, trust)).norm(), 1e-6) << trust;
  }
}

TEST(Predict, KeepsIdentityAndMovesTheState) {
  const base::Track later = predict(example(), 0.5);
  EXPECT_EQ(later.id, 7U);
  EXPECT_EQ(later.radius, 0.5);
  EXPECT_EQ(later.position, Vec3(2.375, -2, 0));
  EXPECT_EQ(later.velocity, Vec3(3.5, -4, 4));
  EXPECT_EQ(later.acceleration, Vec3(3, 0, 8));
}

TEST(Predict, InTwoStepsIsPredictionInOne) {
  const Vec3 one = predict_position(example(), 1.25);
  EXPECT_LT((predict_position(predict(example(), 0.75), 0.5) - one).norm(), 1e-14);
}

TEST(Predict, DropsAnAccelerationThatIsNoLongerTrusted) {
  const base::Track later = predict(example(), 1.0, 0.5);
  EXPECT_EQ(later.acceleration, Vec3(0, 0, 0));
  EXPECT_LT((predict_position(later, 1.0, 0.5) - predict_position(example(), 2.0, 0.5)).norm(), 1e-14);
}

}  // namespace
}  // namespace jink::planner::geometry
