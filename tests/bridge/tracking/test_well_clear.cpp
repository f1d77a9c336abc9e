// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/well_clear.hpp"

#include <gtest/gtest.h>

namespace jink::bridge::tracking {
namespace {

Aircraft aircraft(const Vec3& position, const Vec3& velocity) {
  Aircraft a;
  a.stamp = 100.0;
  a.position = position;
  a.velocity = velocity;
  return a;
}

TEST(WellClear, IsTwoThousandFeetBesideOrTwoHundredAndFiftyAboveOrBelow) {
  const Vec3 here(0, 0, 20);
  EXPECT_FALSE(less_than_well_clear_in(aircraft({610, 0, 20}, Vec3::Zero()), 100.0, here));
  EXPECT_EQ(less_than_well_clear_in(aircraft({609, 0, 20}, Vec3::Zero()), 100.0, here), 0.0);
  EXPECT_FALSE(less_than_well_clear_in(aircraft({0, 0, 96.5}, Vec3::Zero()), 100.0, here));
  EXPECT_EQ(less_than_well_clear_in(aircraft({0, 0, 96}, Vec3::Zero()), 100.0, here), 0.0);
  EXPECT_EQ(less_than_well_clear_in(aircraft({0, 0, -56}, Vec3::Zero()), 100.0, here), 0.0);
}

TEST(WellClear, IsForeseenAMinuteAhead) {
  const Vec3 here(0, 0, 20);
  const auto seconds = less_than_well_clear_in(aircraft({3000, 0, 80}, {-60, 0, 0}), 100.0, here);
  ASSERT_TRUE(seconds);
  EXPECT_NEAR(*seconds, (3000.0 - 609.6) / 60.0, 0.5);
  EXPECT_FALSE(less_than_well_clear_in(aircraft({3000, 0, 80}, {60, 0, 0}), 100.0, here));     // it goes
  EXPECT_FALSE(less_than_well_clear_in(aircraft({3000, 0, 200}, {-60, 0, 0}), 100.0, here));   // above
  EXPECT_TRUE(less_than_well_clear_in(aircraft({3000, 0, 200}, {-60, 0, -3}), 100.0, here));   // it sinks
  EXPECT_FALSE(less_than_well_clear_in(aircraft({3000, 700, 80}, {-60, 0, 0}), 100.0, here));  // beside
  EXPECT_FALSE(less_than_well_clear_in(aircraft({6000, 0, 80}, {-60, 0, 0}), 100.0, here));    // later
}

TEST(WellClear, WhatIsUncertainWidensIt) {
  const Vec3 here(0, 0, 20);
  Aircraft a = aircraft({3000, 700, 80}, {-60, 0, 0});
  a.horizontal_sigma = 50.0;
  EXPECT_TRUE(less_than_well_clear_in(a, 100.0, here));
  a = aircraft({3000, 0, 200}, {-60, 0, 0});
  a.vertical_sigma = 60.0;
  EXPECT_TRUE(less_than_well_clear_in(a, 100.0, here));
  a = aircraft({3000, 0, 200}, {-60, 0, 0});
  a.climb_sigma = 5.0;  // not told
  EXPECT_TRUE(less_than_well_clear_in(a, 100.0, here));
  a = aircraft({3000, 0, 80}, Vec3::Zero());
  a.speed_sigma = 60.0;  // nor where to
  EXPECT_TRUE(less_than_well_clear_in(a, 100.0, here));
}

TEST(WellClear, AMeasurementFliesOnAndIsForgotten) {
  const Vec3 here(0, 0, 20);
  const Aircraft a = aircraft({3000, 0, 80}, {-60, 0, 0});
  EXPECT_NEAR(*less_than_well_clear_in(a, 105.0, here), (3000.0 - 609.6) / 60.0 - 5.0, 0.5);
  EXPECT_FALSE(less_than_well_clear_in(a, 106.1, here));
}

}  // namespace
}  // namespace jink::bridge::tracking
