// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/solid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "planner/base/random.hpp"

namespace jink::planner::base {
namespace {

/// With the prism's own z along `up`.
Solid::Pose pose_along(const Vec3& center, const Vec3& up) {
  return {center, Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), up).toRotationMatrix()};
}

Vec3 any_direction(RandomStream& random) {
  return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

// Half edges 1, 2, 3: corner at sqrt(1 + 4 + 9).
TEST(Solid, BoxReachesItsFarthestCorner) {
  const auto box = Solid::box({2, 4, 6}, {});
  EXPECT_FALSE(box->is_hull());
  EXPECT_DOUBLE_EQ(box->reach(), std::sqrt(14.0));
  EXPECT_DOUBLE_EQ(box->extent({1, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(box->extent({0, -1, 0}), 2.0);
  EXPECT_DOUBLE_EQ(box->extent({0, 0.6, 0.8}), 2 * 0.6 + 3 * 0.8);
  // 10 m to the west: the corners there are the farthest.
  const auto aside = Solid::box({2, 4, 6}, {{-10, 0, 0}, Eigen::Matrix3d::Identity()});
  EXPECT_DOUBLE_EQ(aside->reach(), std::sqrt(121.0 + 4.0 + 9.0));
  EXPECT_DOUBLE_EQ(aside->extent({1, 0, 0}), -9.0);
  EXPECT_DOUBLE_EQ(aside->extent({-1, 0, 0}), 11.0);
}

// Turned by 45 degrees about the vertical, a square's corner is where its side was.
TEST(Solid, BoxIsTurnedByItsAxes) {
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitZ()).toRotationMatrix();
  const auto box = Solid::box({2, 2, 2}, {Vec3::Zero(), axes});
  EXPECT_NEAR(box->extent({1, 0, 0}), std::sqrt(2.0), 1e-15);
  EXPECT_DOUBLE_EQ(box->extent({0, 0, 1}), 1.0);
}

// Lying along x, radius 3 and half as long as 4: its rim is 5 m away.
TEST(Solid, CylinderHasARim) {
  const auto cylinder = Solid::cylinder(3.0, 8.0, pose_along(Vec3::Zero(), Vec3::UnitX()));
  EXPECT_DOUBLE_EQ(cylinder->reach(), 5.0);
  EXPECT_NEAR(cylinder->extent({1, 0, 0}), 4.0, 1e-14);
  EXPECT_NEAR(cylinder->extent({0, 1, 0}), 3.0, 1e-14);
  EXPECT_NEAR(cylinder->extent({0.8, 0, -0.6}), 4 * 0.8 + 3 * 0.6, 1e-14);
}

TEST(Solid, CapsuleEndsInHalfSpheres) {
  const auto capsule = Solid::capsule(0.5, {0, 0, 0}, {0, 0, 4});
  EXPECT_DOUBLE_EQ(capsule->reach(), 4.5);
  EXPECT_DOUBLE_EQ(capsule->extent({0, 0, 1}), 4.5);
  EXPECT_DOUBLE_EQ(capsule->extent({0, 0, -1}), 0.5);
  EXPECT_DOUBLE_EQ(capsule->extent({0, 1, 0}), 0.5);
  const auto ball = Solid::capsule(0.5, {3, 0, 4}, {3, 0, 4});
  EXPECT_DOUBLE_EQ(ball->reach(), 5.5);
  EXPECT_DOUBLE_EQ(ball->extent({0, 0, 1}), 4.5);
}

// A square of 2 m with rounded corners of 0.5 m, all of it rounded by 0.1 m.
TEST(Solid, PrismIsRoundedTwice) {
  const auto prism = Solid::prism({1, 1, 2}, 0.5, 0.1, {});
  EXPECT_DOUBLE_EQ(prism->extent({1, 0, 0}), 1.6);
  EXPECT_DOUBLE_EQ(prism->extent({0, 0, 1}), 2.1);
  EXPECT_DOUBLE_EQ(prism->reach(), std::hypot(std::sqrt(2.0) + 0.5, 2.0) + 0.1);
}

TEST(Solid, HullIsBoundedByItsVertices) {
  const auto hull = Solid::hull({{1, 0, 0}, {0, 2, 0}, {0, 0, -3}, {0, 0, -3}});
  EXPECT_TRUE(hull->is_hull());
  EXPECT_DOUBLE_EQ(hull->reach(), 3.0);
  EXPECT_DOUBLE_EQ(hull->extent({1, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(hull->extent({-1, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(hull->extent({0, 0, -1}), 3.0);
  ASSERT_EQ(hull->slabs().size(), Solid::kSlabs);
  for (const Solid::Slab& slab : hull->slabs()) {
    EXPECT_NEAR(slab.normal.norm(), 1.0, 1e-15);
    EXPECT_DOUBLE_EQ(slab.high, hull->extent(slab.normal));
    EXPECT_DOUBLE_EQ(slab.low, -hull->extent(-slab.normal));
  }
  EXPECT_TRUE(Solid::box({1, 1, 1}, {})->slabs().empty());
}

// No sampled point of a prism is beyond its extent or its reach, and the farthest ones nearly get there.
TEST(Solid, ReachAndExtentAreThoseOfItsPoints) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomStream random(seed);
    const auto any = [&](double most) { return random.below(3) == 0 ? 0.0 : random.uniform(0.0, most); };
    const Vec3 half(any(2.0), any(2.0), any(2.0));
    const double corner = any(1.0);
    const double rounding = any(1.0);
    const Solid::Pose pose = pose_along(random.uniform(0.0, 3.0) * any_direction(random), any_direction(random));
    const auto prism = Solid::prism(half, corner, rounding, pose);
    const Vec3 direction = any_direction(random);
    double reach = 0.0;
    double extent = -kInfinity;
    for (int n = 0; n < 20000; ++n) {
      const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
      Vec3 own = rounding * any_direction(random) + corner * Vec3(std::cos(angle), std::sin(angle), 0.0);
      for (Eigen::Index i = 0; i < 3; ++i) own[i] += random.below(2) == 0 ? half[i] : -half[i];
      const Vec3 point = pose.center + pose.axes * own;
      reach = std::max(reach, point.norm());
      extent = std::max(extent, direction.dot(point));
    }
    EXPECT_LE(reach, prism->reach() + 1e-12) << seed;
    EXPECT_GE(reach, prism->reach() - 0.05) << seed;
    EXPECT_LE(extent, prism->extent(direction) + 1e-12) << seed;
    EXPECT_GE(extent, prism->extent(direction) - 0.05) << seed;
  }
}

TEST(Solid, RefusesWhatIsNone) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Vec3 zero = Vec3::Zero();
  EXPECT_THROW((void)Solid::box({1, -1e-9, 1}, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::box({1, kInfinity, 1}, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::cylinder(kNaN, 1.0, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::cylinder(1.0, -1.0, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::capsule(-1.0, zero, {1, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)Solid::capsule(1.0, zero, {kNaN, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)Solid::prism(zero, -1.0, 0.0, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::prism(zero, 0.0, -1.0, {}), std::invalid_argument);
  EXPECT_THROW((void)Solid::hull({}), std::invalid_argument);
  EXPECT_THROW((void)Solid::hull({{0, 0, 0}, {0, kInfinity, 0}}), std::invalid_argument);
  EXPECT_THROW((void)Solid::box({1, 1, 1}, {{kNaN, 0, 0}, Eigen::Matrix3d::Identity()}), std::invalid_argument);
  Solid::Pose skew;
  skew.axes(0, 1) = 1e-5;
  EXPECT_THROW((void)Solid::box({1, 1, 1}, skew), std::invalid_argument);
  skew.axes(0, 1) = kNaN;
  EXPECT_THROW((void)Solid::box({1, 1, 1}, skew), std::invalid_argument);
  EXPECT_NO_THROW((void)Solid::box(zero, {}));
}

TEST(Body, TurnsOn) {
  const Body body{Solid::box({1, 1, 1}, {}), 0.5, -0.25};
  const Body later = body.later(4.0);
  EXPECT_EQ(later.solid, body.solid);
  EXPECT_DOUBLE_EQ(later.yaw, -0.5);
  EXPECT_DOUBLE_EQ(later.yaw_rate, -0.25);
}

}  // namespace
}  // namespace jink::planner::base
