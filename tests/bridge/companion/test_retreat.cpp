// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/retreat.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace jink::bridge::companion {
namespace {

using planner::base::TimedPath;
using planner::horizon::PathRequest;
using prediction::Prediction;

constexpr double kPeriod = 0.05;  // s, between plans

Prediction mover(const Vec3& position, double acceleration_sigma) {
  planner::base::Track track;
  track.position = position;
  track.radius = 0.5;
  Prediction prediction;
  prediction.motion = track;
  prediction.radius = 0.5;
  prediction.acceleration_sigma = acceleration_sigma;
  return prediction;
}

/// A vehicle that rests in the middle and is to fly to the east, and what is flown: that it stays.
struct Hovers {
  Retreat retreat{planner::base::HorizonSettings{}};
  PathRequest request;
  TimedPath flown{{0.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  double now = 10.0;

  Hovers() {
    request.target = {30.0, 0.0, 0.0};
    request.margin = 0.35;
    request.volume = {{-20.0, -20.0, -5.0}, {40.0, 20.0, 10.0}};
  }
  std::optional<Vec3> choose(const std::vector<Prediction>& predictions) {
    now += kPeriod;
    return retreat.choose(now, request, flown, predictions, {});
  }
  std::optional<Vec3> choose_for(double seconds, const std::vector<Prediction>& predictions) {
    std::optional<Vec3> refuge;
    for (double t = 0.0; t < seconds; t += kPeriod) refuge = choose(predictions);
    return refuge;
  }
};

TEST(Retreat, WithNothingAroundTheVehicleGoesOnAtOnce) {
  Hovers hovers;
  EXPECT_FALSE(hovers.choose({}));
  EXPECT_EQ(hovers.retreat.risk(), 0.0);
}

TEST(Retreat, WhatIsUnderstoodIsThePlannersAffair) {
  Hovers hovers;
  EXPECT_FALSE(hovers.choose({mover({1.2, 0.0, 0.0}, 1.0)}));
}

TEST(Retreat, LeadsAwayFromWhatNobodyUnderstands) {
  Hovers hovers;
  (void)hovers.choose({});  // it has begun
  const std::vector<Prediction> wild{mover({1.5, 0.0, 0.0}, 5.0)};
  const std::optional<Vec3> refuge = hovers.choose_for(2 * kPeriod, wild);
  ASSERT_TRUE(refuge);
  EXPECT_GT(hovers.retreat.risk(), Retreat::kMost);
  EXPECT_LT(refuge->x(), -1.0);
  EXPECT_TRUE(hovers.request.volume.contains(*refuge));
}

TEST(Retreat, HoldsOnToItsRefuge) {
  Hovers hovers;
  (void)hovers.choose({});
  const std::optional<Vec3> first = hovers.choose_for(2 * kPeriod, {mover({1.5, 0.0, 0.0}, 5.0)});
  ASSERT_TRUE(first);
  EXPECT_EQ(hovers.choose({mover({1.5, 0.1, 0.0}, 5.0)}), first);
  EXPECT_EQ(hovers.choose({mover({1.5, -0.1, 0.1}, 5.0)}), first);
}

TEST(Retreat, TakesItsRefugeAlongWhenTheEstimateJumps) {
  Hovers hovers;
  (void)hovers.choose({});
  const std::optional<Vec3> first = hovers.choose_for(2 * kPeriod, {mover({1.5, 0.0, 0.0}, 5.0)});
  ASSERT_TRUE(first);
  const Vec3 jump(0.5, -2.0, 0.3);
  hovers.retreat.shift(jump);
  hovers.request.position += jump;
  hovers.flown.front().position += jump;
  EXPECT_EQ(hovers.choose({mover(Vec3(1.5, 0.0, 0.0) + jump, 5.0)}), Vec3(*first + jump));
}

TEST(Retreat, GoesOnOnceTheWayIsCalm) {
  Hovers hovers;
  (void)hovers.choose({});
  ASSERT_TRUE(hovers.choose_for(2 * kPeriod, {mover({1.5, 0.0, 0.0}, 5.0)}));
  EXPECT_TRUE(hovers.choose_for(0.3, {})) << "not at once";
  EXPECT_FALSE(hovers.choose_for(0.3, {}));
}

TEST(Retreat, DoesNotWaitForEver) {
  Hovers hovers;
  (void)hovers.choose({});
  const std::vector<Prediction> wild{mover({1.5, 0.0, 0.0}, 5.0)};
  EXPECT_TRUE(hovers.choose_for(Retreat::kLongest - 0.5, wild));
  EXPECT_FALSE(hovers.choose_for(1.0, wild));
  EXPECT_FALSE(hovers.choose_for(Retreat::kLongest - 1.0, wild)) << "and goes on for as long";
  EXPECT_TRUE(hovers.choose_for(1.0, wild));
}

// What a refuge is worth is what flying there as plans do is worth, not as hard as the vehicle can.
TEST(Retreat, ARefugeIsSaferByTheMotionThatPlansHave) {
  int refuges = 0;
  for (const double flown_to : {0.0, 30.0}) {
    for (double away = 3.5; away <= 6.0; away += 0.25) {
      Hovers hovers;
      (void)hovers.choose({});
      hovers.request.velocity = {3.0, 0.0, 0.0};
      std::vector<Prediction> wild{mover({away, 0.0, 0.0}, 5.0)};
      wild[0].radius = 1.5;
      planner::horizon::PathProblem problem{planner::base::HorizonSettings{}};
      const auto planned = [&](const Vec3& target) {
        PathRequest request = hovers.request;
        request.target = target;
        problem.prepare(request);
        return problem.unobstructed_motion();
      };
      const auto risk = [&](const TimedPath& path) {
        return prediction::contact_risk(path, wild, {}, hovers.request.vehicle.radius, 2.5, {});
      };
      hovers.flown = planned({flown_to, 0.0, 0.0});
      const std::optional<Vec3> refuge = hovers.choose_for(2 * kPeriod, wild);
      if (!refuge) continue;
      ++refuges;
      EXPECT_LT(risk(planned(*refuge)), 0.8 * risk(hovers.flown)) << flown_to << " " << away;
    }
  }
  EXPECT_GT(refuges, 5);
}

// A wall behind it: the way back is none.
TEST(Retreat, LeadsThroughNothingThatStands) {
  Hovers hovers;
  (void)hovers.choose({});
  std::vector<planner::base::Track> standing(1);
  standing[0].position = {-2.0, 0.0, 0.0};
  standing[0].radius = 1.2;
  hovers.request.standing = standing;
  const std::optional<Vec3> refuge = hovers.choose_for(2 * kPeriod, {mover({1.5, 0.0, 0.0}, 5.0)});
  ASSERT_TRUE(refuge);
  EXPECT_GT((*refuge - standing[0].position).norm(), standing[0].radius + hovers.request.vehicle.radius);
}

// Who begins among what nobody understands does not fly into it.
TEST(Retreat, DoesNotBeginIntoIt) {
  Hovers hovers;
  EXPECT_TRUE(hovers.choose({mover({3.5, 0.0, 0.0}, 5.0)}));
}

}  // namespace
}  // namespace jink::bridge::companion
