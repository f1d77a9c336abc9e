// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/error_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planner/base/random.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr int kDraws = 100000;

Vec3 normal(planner::base::RandomStream& random) {
  Vec3 place;
  for (int axis = 0; axis < 3; ++axis) place[axis] = random.normal();
  return place;
}

/// Of Student's t distribution with three degrees of freedom.
Vec3 heavy_tailed(planner::base::RandomStream& random) {
  const double spread = normal(random).squaredNorm() / 3.0;
  return normal(random) / std::sqrt(spread);
}

/// Share of drawn places that are within the radius.
template <typename Draw>
double drawn(Draw draw, double distance, double radius, double sigma) {
  planner::base::RandomStream random(7, 1);
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) inside += (Vec3(distance, 0.0, 0.0) + sigma * draw(random)).norm() < radius ? 1 : 0;
  return static_cast<double>(inside) / kDraws;
}

TEST(ErrorLaw, ContactIsAsLikelyAsItsShareOfDrawnPlaces) {
  const ErrorLaw law = ErrorLaw::normal();
  for (const double distance : {0.0, 0.3, 1.0, 2.5}) {
    for (const double sigma : {0.2, 1.0, 3.0}) {
      EXPECT_NEAR(law.contact_probability(distance, 1.0, sigma), drawn(normal, distance, 1.0, sigma), 0.03)
          << distance << " m away, sigma " << sigma;
    }
  }
}

TEST(ErrorLaw, ContactIsCertainWithoutDoubt) {
  const ErrorLaw law = ErrorLaw::normal();
  EXPECT_EQ(law.contact_probability(0.9, 1.0, 0.0), 1.0);
  EXPECT_EQ(law.contact_probability(1.1, 1.0, 0.0), 0.0);
  EXPECT_EQ(law.contact_probability(0.0, 0.0, 1.0), 0.0);
  EXPECT_LT(law.contact_probability(100.0, 1.0, 1.0), 1e-9);
}

TEST(ErrorLaw, RegionsAreThoseOfTheChiSquareDistribution) {
  const ErrorLaw law = ErrorLaw::normal();
  EXPECT_NEAR(law.region(0.5), std::sqrt(2.366), 0.03);
  EXPECT_NEAR(law.region(0.9), std::sqrt(6.251), 0.1);
  EXPECT_NEAR(law.region(0.99), std::sqrt(11.345), 0.15);
}

TEST(ErrorLaw, TailsAreHeavyToBeginWith) {
  planner::base::RandomStream random(7, 2);
  const ErrorLaw law = ErrorLaw::heavy_tailed();
  for (const double share : {0.5, 0.9, 0.99}) {
    int inside = 0;
    for (int i = 0; i < kDraws; ++i) inside += 0.68 * heavy_tailed(random).norm() < law.region(share) ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(inside) / kDraws, share, 0.01);
  }
}

TEST(ErrorLaw, BecomesWhatIsSeen) {
  planner::base::RandomStream random(7, 3);
  ErrorLaw law = ErrorLaw::heavy_tailed();
  for (int i = 0; i < 4000; ++i) law.saw(normal(random).norm(), 1.0, 0.0);
  EXPECT_NEAR(law.region(0.5), std::sqrt(2.366), 0.1);
  EXPECT_NEAR(law.region(0.9), std::sqrt(6.251), 0.1);
  for (int i = 0; i < 20000; ++i) law.saw(3.0 * normal(random).norm(), 1.0, 0.0);
  EXPECT_NEAR(law.region(0.9), 3.0 * std::sqrt(6.251), 0.5) << "what was is forgotten";
}

TEST(ErrorLaw, NoiseOfWhatIsMeasuredIsNotTheMovers) {
  planner::base::RandomStream random(7, 4);
  for (const double stated : {0.25, 1.0, 4.0}) {  // m, where 1 would be true
    ErrorLaw law = ErrorLaw::heavy_tailed();
    for (int i = 0; i < 4000; ++i) law.saw((normal(random) + 0.4 * normal(random)).norm(), stated, 0.4);
    EXPECT_NEAR(law.region(0.5) * stated, std::sqrt(2.366), 0.15) << stated;
    EXPECT_NEAR(law.region(0.9) * stated, std::sqrt(6.251), 0.4) << stated;
  }
}

TEST(ErrorLaw, WhatIsBeyondAllShellsIsInTheLast) {
  ErrorLaw law = ErrorLaw::normal();
  for (int i = 0; i < 4000; ++i) law.saw(1e6, 1.0, 0.0);
  EXPECT_GT(law.region(0.9), 20.0);
  EXPECT_TRUE(std::isfinite(law.region(1.0)));
}

TEST(ErrorLaws, NowErrorsAreNormal) {
  ErrorLaws laws;
  for (int i = 0; i < 4000; ++i) laws.saw(0, 4.0, 1.0, 0.0);
  EXPECT_NEAR(laws.at(0.0).region(0.5), std::sqrt(2.366), 0.03);
  EXPECT_NEAR(laws.at(0.5).region(0.5), 4.0, 0.5);
  EXPECT_NEAR(laws.at(0.7).region(0.5), 4.0, 0.5);
  EXPECT_LT(laws.at(0.8).region(0.5), 2.0);
}

}  // namespace
}  // namespace jink::bridge::prediction
