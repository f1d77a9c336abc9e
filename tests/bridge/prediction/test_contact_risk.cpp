// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/contact_risk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/solid.hpp"

namespace jink::bridge::prediction {
namespace {

using planner::base::TimedPath;

/// Shares of drawn places that are within the radius.
double drawn(double distance, double radius, double sigma) {
  constexpr int kDraws = 200000;
  planner::base::RandomStream random(7, 1);
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) {
    Vec3 place(distance, 0.0, 0.0);
    for (int axis = 0; axis < 3; ++axis) place[axis] += sigma * random.normal();
    inside += place.norm() < radius ? 1 : 0;
  }
  return static_cast<double>(inside) / kDraws;
}

Prediction at(const Vec3& position, const Vec3& velocity, double acceleration_sigma) {
  planner::base::Track track;
  track.position = position;
  track.velocity = velocity;
  Prediction prediction;
  prediction.motion = track;
  prediction.radius = 0.4;
  prediction.acceleration_sigma = acceleration_sigma;
  return prediction;
}

TimedPath stays(const Vec3& place) {
  return {{0.0, place, Vec3::Zero(), Vec3::Zero()}};
}

TEST(ContactProbability, IsTheShareOfDrawnPlaces) {
  for (const double distance : {0.0, 0.3, 1.0, 2.5}) {
    for (const double sigma : {0.2, 1.0, 3.0}) {
      EXPECT_NEAR(contact_probability(distance, 1.0, sigma), drawn(distance, 1.0, sigma), 0.004)
          << distance << " m away, sigma " << sigma;
    }
  }
}

TEST(ContactProbability, IsCertainWithoutDoubt) {
  EXPECT_EQ(contact_probability(0.9, 1.0, 0.0), 1.0);
  EXPECT_EQ(contact_probability(1.1, 1.0, 0.0), 0.0);
  EXPECT_EQ(contact_probability(0.0, 0.0, 1.0), 0.0);
  EXPECT_EQ(contact_probability(100.0, 1.0, 1.0), 0.0);
}

TEST(ContactRisk, IsThatOfTheWorstInstant) {
  const std::vector<Prediction> comes{at({2.0, 0.0, 0.0}, {-2.0, 0.0, 0.0}, 0.0)};
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, 0.3, 0.5, {}), 0.0);  // it is 1 m away by then
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, 0.3, 1.0, {}), 1.0);
}

TEST(ContactRisk, GrowsWithWhatIsNotForeseenAndWithEachMover) {
  const auto risk = [](std::vector<Prediction> all) { return contact_risk(stays(Vec3::Zero()), all, 0.3, 1.0, {}); };
  const double one = risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 3.0)});
  EXPECT_GT(one, 0.01);
  EXPECT_LT(risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 1.0)}), 0.2 * one);
  EXPECT_NEAR(risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 3.0), at({0.0, -2.0, 0.0}, Vec3::Zero(), 3.0)}),
              1.0 - (1.0 - one) * (1.0 - one), 1e-12);
}

TEST(ContactRisk, WhatCanBeEvadedIsNone) {
  const std::vector<Prediction> comes{at({4.0, 0.0, 0.0}, {-4.0, 0.0, 0.0}, 0.0)};
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, 0.3, 1.5, {}), 1.0);
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, 0.3, 1.5, {0.25, 5.0}), 0.0);  // 1.4 m aside when it is there
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, 0.3, 1.5, {0.9, 5.0}), 1.0);
}

TEST(ContactRisk, AFlatBodyIsNoBall) {
  Prediction plate = at({0.0, 1.0, 0.0}, Vec3::Zero(), 0.0);
  plate.radius = 5.0;
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, 0.3, 1.0, {}), 1.0);
  plate.body.solid = planner::base::Solid::box({9.0, 0.2, 2.0}, {});
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, 0.3, 1.0, {}), 0.0);
  plate.body.yaw = 1.5707963;  // its narrow side towards the place, 4.5 m from its centre
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, 0.3, 1.0, {}), 1.0);
}

}  // namespace
}  // namespace jink::bridge::prediction
