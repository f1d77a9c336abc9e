// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/frames/conversions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace jink::bridge::frames {
namespace {

using std::numbers::pi;

TEST(Frames, NedAxesGoToTheirEnuAxes) {
  EXPECT_EQ(enu_from_ned({1, 0, 0}), Vec3(0, 1, 0));   // north
  EXPECT_EQ(enu_from_ned({0, 1, 0}), Vec3(1, 0, 0));   // east
  EXPECT_EQ(enu_from_ned({0, 0, 1}), Vec3(0, 0, -1));  // down
  EXPECT_EQ(enu_from_ned({1, 2, -3}), Vec3(2, 1, 3));
}

TEST(Frames, EnuAxesGoToTheirNedAxes) {
  EXPECT_EQ(ned_from_enu({1, 0, 0}), Vec3(0, 1, 0));   // east
  EXPECT_EQ(ned_from_enu({0, 1, 0}), Vec3(1, 0, 0));   // north
  EXPECT_EQ(ned_from_enu({0, 0, 1}), Vec3(0, 0, -1));  // up
  EXPECT_EQ(ned_from_enu({2, 1, 3}), Vec3(1, 2, -3));
}

TEST(Frames, HeadingsOfTheCompass) {
  EXPECT_DOUBLE_EQ(yaw_enu_from_heading(0.0), pi / 2);        // north
  EXPECT_DOUBLE_EQ(yaw_enu_from_heading(pi / 2), 0.0);        // east
  EXPECT_DOUBLE_EQ(yaw_enu_from_heading(pi), -pi / 2);        // south
  EXPECT_DOUBLE_EQ(yaw_enu_from_heading(-pi / 2), pi);        // west
  EXPECT_DOUBLE_EQ(heading_from_yaw_enu(0.0), pi / 2);        // east
  EXPECT_DOUBLE_EQ(heading_from_yaw_enu(pi / 2), 0.0);        // north
  EXPECT_DOUBLE_EQ(heading_from_yaw_enu(pi), -pi / 2);        // west
  EXPECT_DOUBLE_EQ(heading_from_yaw_enu(-pi / 2), pi);        // south
  EXPECT_DOUBLE_EQ(yaw_enu_from_heading(0.3), pi / 2 - 0.3);  // a little east of north
}

TEST(Frames, WrapIsHalfOpenAtMinusPi) {
  EXPECT_EQ(wrap_angle(pi), pi);
  EXPECT_EQ(wrap_angle(-pi), pi);
  EXPECT_EQ(wrap_angle(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wrap_angle(3 * pi / 2), -pi / 2);
  EXPECT_DOUBLE_EQ(wrap_angle(-3 * pi / 2), pi / 2);
  EXPECT_NEAR(wrap_angle(1.0 + 200 * pi), 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::quiet_NaN())));
}

// A vehicle that flies along its nose does so in either frame: velocity and yaw must turn together.
TEST(Frames, YawPointsAlongTheConvertedVelocity) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> angle(-10.0, 10.0);
  for (int i = 0; i < 10000; ++i) {
    const double heading = angle(generator);
    const Vec3 enu = enu_from_ned({std::cos(heading), std::sin(heading), 0.0});
    const double yaw = yaw_enu_from_heading(heading);
    ASSERT_GT(yaw, -pi);
    ASSERT_LE(yaw, pi);
    ASSERT_NEAR(std::cos(yaw), enu.x(), 1e-12);
    ASSERT_NEAR(std::sin(yaw), enu.y(), 1e-12);
  }
}

TEST(Frames, ThereAndBackIsTheSame) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> coordinate(-1e4, 1e4);
  std::uniform_real_distribution<double> angle(-pi, pi);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 v{coordinate(generator), coordinate(generator), coordinate(generator)};
    ASSERT_EQ(enu_from_ned(ned_from_enu(v)), v);
    ASSERT_EQ(ned_from_enu(enu_from_ned(v)), v);
    ASSERT_EQ(enu_from_ned(v).norm(), Vec3(v.y(), v.x(), v.z()).norm());
    const double a = angle(generator);
    ASSERT_NEAR(heading_from_yaw_enu(yaw_enu_from_heading(a)), a, 1e-12);
  }
}

// Two tangent planes some kilometres apart are turned against each other, and the earth falls away.
TEST(Frames, BetweenTwoOriginsPositionsAreTheSamePlaces) {
  const Geodetic here{47.3977, 8.5456, 488.0};
  const Geodetic there{47.4500, 8.6500, 430.0};
  const Eigen::Isometry3d to_there = between(here, there);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(120, -40, 15), Vec3(-9000, 4000, 900)}) {
    const Vec3 exact = LocalFrame(there).to_enu(LocalFrame(here).to_geodetic(p));
    EXPECT_LT((to_there * p - exact).norm(), 1e-6);
  }
  EXPECT_LT((to_there.linear() * to_there.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT(((between(there, here) * to_there).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-6);
  EXPECT_TRUE(between(here, here).matrix().isIdentity(0.0));
}

}  // namespace
}  // namespace jink::bridge::frames
