// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/contact_risk.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "planner/base/solid.hpp"

namespace jink::bridge::prediction {
namespace {

using planner::base::TimedPath;

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

TEST(ContactRisk, IsThatOfTheWorstInstant) {
  const std::vector<Prediction> comes{at({2.0, 0.0, 0.0}, {-2.0, 0.0, 0.0}, 0.0)};
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, {}, 0.3, 0.5, {}), 0.0);  // it is 1 m away by then
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, {}, 0.3, 1.0, {}), 1.0);
}

TEST(ContactRisk, GrowsWithWhatIsNotForeseenAndWithEachMover) {
  const auto risk = [](std::vector<Prediction> all) {
    return contact_risk(stays(Vec3::Zero()), all, {}, 0.3, 1.0, {});
  };
  const double one = risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 3.0)});
  EXPECT_GT(one, 0.005);
  EXPECT_LT(risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 1.0)}), 0.5 * one);
  EXPECT_NEAR(risk({at({2.0, 0.0, 0.0}, Vec3::Zero(), 3.0), at({0.0, -2.0, 0.0}, Vec3::Zero(), 3.0)}),
              1.0 - (1.0 - one) * (1.0 - one), 1e-12);
}

TEST(ContactRisk, WhatCanBeEvadedIsNone) {
  const std::vector<Prediction> comes{at({4.0, 0.0, 0.0}, {-4.0, 0.0, 0.0}, 0.0)};
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, {}, 0.3, 1.5, {}), 1.0);
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, {}, 0.3, 1.5, {0.25, 5.0}), 0.0);  // 1.4 m aside when it is there
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), comes, {}, 0.3, 1.5, {0.9, 5.0}), 1.0);
}

TEST(ContactRisk, AFlatBodyIsNoBall) {
  Prediction plate = at({0.0, 1.0, 0.0}, Vec3::Zero(), 0.0);
  plate.radius = 5.0;
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, {}, 0.3, 1.0, {}), 1.0);
  plate.body.solid = planner::base::Solid::box({9.0, 0.2, 2.0}, {});
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, {}, 0.3, 1.0, {}), 0.0);
  plate.body.yaw = 1.5707963;  // its narrow side towards the place, 4.5 m from its centre
  EXPECT_EQ(contact_risk(stays(Vec3::Zero()), {&plate, 1}, {}, 0.3, 1.0, {}), 1.0);
}

}  // namespace
}  // namespace jink::bridge::prediction
