// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/sight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace jink::bridge::companion {
namespace {

vehicle::VehicleState state(double t, const Vec3& position, double yaw) {
  vehicle::VehicleState told;
  told.motion = {{position, {2.0, 0.0, 0.0}}, t, t};
  told.attitude = Eigen::AngleAxisd(yaw, Vec3::UnitZ());
  told.attitude_stamp = t;
  return told;
}

TEST(PoseHistory, IsBetweenWhatWasTold) {
  PoseHistory poses;
  EXPECT_FALSE(poses.at(1.0).has_value());
  poses.add(state(1.0, {1, 0, 2}, 0.0));
  poses.add(state(1.2, {2, 0, 3}, 0.4));
  const auto pose = poses.at(1.05);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR((pose->translation() - Vec3(1.25, 0, 2.25)).norm(), 0.0, 1e-12);
  const Vec3 ahead = pose->linear() * Vec3::UnitX();
  EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()), 0.1, 1e-12);
}

TEST(PoseHistory, GoesOnForAMomentAndNoLonger) {
  PoseHistory poses;
  poses.add(state(1.0, {1, 0, 2}, 0.0));
  poses.add(state(1.2, {2, 0, 3}, 0.4));
  EXPECT_NEAR((poses.at(1.3)->translation() - Vec3(2.2, 0, 3)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(poses.at(1.2 + PoseHistory::kBeyond + 0.01).has_value());
  EXPECT_FALSE(poses.at(1.0 - PoseHistory::kBeyond - 0.01).has_value());
  for (int i = 0; i < 100; ++i) poses.add(state(1.3 + 0.05 * i, {2, 0, 3}, 0.4));
  EXPECT_FALSE(poses.at(1.5).has_value()) << "too long ago";
  EXPECT_TRUE(poses.at(5.0).has_value());
}

TEST(PoseHistory, JumpsWithTheLocalFrame) {
  PoseHistory poses;
  poses.add(state(1.0, {1, 0, 2}, 0.0));
  poses.shift({0, 5, 0});
  EXPECT_NEAR((poses.at(1.0)->translation() - Vec3(1, 5, 2)).norm(), 0.0, 1e-12);
  poses.forget();
  EXPECT_FALSE(poses.at(1.0).has_value());
}

TEST(PoseHistory, IsLevelWhereNothingButAYawIsTold) {
  PoseHistory poses;
  vehicle::VehicleState told = state(1.0, {1, 0, 2}, 0.0);
  told.attitude_stamp = base::kNever;
  told.yaw = 0.5 * std::numbers::pi;
  poses.add(told);
  EXPECT_NEAR((poses.at(1.0)->linear() * Vec3::UnitX() - Vec3::UnitY()).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace jink::bridge::companion
