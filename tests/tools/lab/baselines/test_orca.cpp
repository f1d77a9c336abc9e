// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/orca.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/base/random.hpp"
#include "tests/tools/lab/baselines/baseline_testing.hpp"

namespace jink::tools::lab::baselines {
namespace {

const double kRoot3 = std::sqrt(3.0);

void expect_half_space(const HalfSpace& h, const Vec3& normal, double offset) {
  EXPECT_NEAR((h.normal - normal).norm(), 0.0, 1e-9) << h.normal.transpose();
  EXPECT_NEAR(h.offset, offset, 1e-9);
}

// 4 m ahead, distance 2 m to be kept, 2 s: the velocity obstacle begins with a ball of 1 m/s around (2, 0, 0) m/s.
TEST(OrcaHalfSpace, StopsShortOfWhatStandsAhead) {
  expect_half_space(orca_half_space({4, 0, 0}, 2.0, {1.5, 0, 0}, Vec3::Zero(), 2.0, 0.3), -Vec3::UnitX(), -1.0);
}

// The same with both moving 1 m/s faster.
TEST(OrcaHalfSpace, MovesWithTheObstacle) {
  expect_half_space(orca_half_space({4, 0, 0}, 2.0, {2.5, 0, 0}, {1, 0, 0}, 2.0, 0.3), -Vec3::UnitX(), -2.0);
}

// The cone's half angle is 30 degrees: its leg on the side of +y is the line vy = vx / sqrt(3), through 0.
TEST(OrcaHalfSpace, IsTangentToTheConesLegForFastOnes) {
  expect_half_space(orca_half_space({4, 0, 0}, 2.0, {3, 0.1, 0}, Vec3::Zero(), 2.0, 0.3), {-0.5, 0.5 * kRoot3, 0}, 0.0);
}

TEST(OrcaHalfSpace, PassesOnTheSideWhereTheVehicleAlreadyIs) {
  const HalfSpace h = orca_half_space({4, 0, 0}, 2.0, {3, 0, -0.1}, Vec3::Zero(), 2.0, 0.3);
  EXPECT_NEAR(h.normal.z(), -0.5 * kRoot3, 1e-9);
}

// 1 m where 2 m are to be kept: within 0.5 s at 2 m/s away.
TEST(OrcaHalfSpace, PartsWhatOverlapsWithinTheContactTime) {
  expect_half_space(orca_half_space({1, 0, 0}, 2.0, Vec3::Zero(), Vec3::Zero(), 2.0, 0.5), -Vec3::UnitX(), 2.0);
}

TEST(OrcaHalfSpace, LeavesOneBesideTheVelocityObstacleWhereItIs) {
  // Flying away: the present velocity stays allowed.
  const HalfSpace h = orca_half_space({4, 0, 0}, 2.0, {-1, 0, 0}, Vec3::Zero(), 2.0, 0.3);
  EXPECT_GT(h.normal.dot(Vec3(-1, 0, 0)), h.offset);
}

// Any velocity in the half-space that ORCA gives for a vehicle whose velocity is one on the boundary is free there; and
// a velocity that the half-space moves to its boundary along the normal is free for the time horizon.
TEST(OrcaHalfSpace, LeadsToVelocitiesThatAreFree) {
  planner::base::RandomStream random(1);
  const auto vector = [&](double most) {
    return Vec3(random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most));
  };
  for (int n = 0; n < 2000; ++n) {
    const Vec3 offset = vector(6.0);
    const double radius = random.uniform(0.2, 2.0);
    if (offset.norm() <= radius) continue;
    const Vec3 velocity = vector(4.0);
    const Vec3 other = vector(4.0);
    const double time = random.uniform(0.5, 4.0);
    const HalfSpace h = orca_half_space(offset, radius, velocity, other, time, 0.3);
    const Vec3 moved = velocity + (h.offset - h.normal.dot(velocity)) * h.normal;
    double nearest = offset.norm();
    for (int i = 0; i <= 400; ++i) nearest = std::min(nearest, (offset - time * i / 400 * (moved - other)).norm());
    EXPECT_GE(nearest, radius - 1e-6) << n;
  }
}

TEST(OrcaPilot, FliesStraightWhereNothingIsInTheWay) {
  OrcaPilot pilot({});
  const planner::verify::Plan made = plan(pilot, job({0, 0, 2}, {10, 0, 2}, {ball(0.5, {5, 8, 2})}));
  EXPECT_EQ(made.status, planner::verify::PlanStatus::kReaches);
  for (const planner::base::TimedPoint& point : made.path) EXPECT_NEAR(point.position.y(), 0.0, 1e-9);
}

TEST(OrcaPilot, KeepsTheLimitsOfTheVehicle) {
  OrcaPilot pilot({});
  planner::base::RandomStream random(5);
  for (int n = 0; n < 100; ++n) {
    std::vector<planner::base::Track> tracks;
    tracks.reserve(12);
    for (int i = 0; i < 12; ++i) {
      tracks.push_back(ball(random.uniform(0.2, 1.0),
                            {random.uniform(1, 8), random.uniform(-3, 3), random.uniform(0, 4)},
                            {random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-1, 1)}));
    }
    const bridge::companion::PlanJob asked = job({0, 0, 2}, {12, 0, 2}, tracks, {2, 0, 0});
    const planner::verify::Plan made = plan(pilot, asked);
    const planner::base::VehicleLimits limits;
    EXPECT_EQ(made.path.front().position, asked.request.position);
    for (std::size_t i = 1; i < made.path.size(); ++i) {
      const auto& [t0, p0, v0, a0] = made.path[i - 1];
      const auto& [t1, p1, v1, a1] = made.path[i];
      EXPECT_LE((p1 - p0).norm() / (t1 - t0), limits.max_speed + 1e-6);
      EXPECT_LE(std::abs(p1.z() - p0.z()) / (t1 - t0), limits.max_climb + 1e-6);
      EXPECT_LE((v1 - v0).norm() / (t1 - t0), limits.max_acceleration + 1e-6);
    }
  }
}

TEST(OrcaPilot, BrakesForTheEndOfTheVolume) {
  OrcaPilot pilot({});
  // Between a wall of the volume and an obstacle that comes from the other side at 4 m/s.
  bridge::companion::PlanJob asked = job({0, 0, 2}, {10, 0, 2}, {ball(2.0, {0, -6, 2}, {0, 4, 0})});
  asked.request.volume = {{-20, -20, 1}, {20, 1, 3}};
  const planner::verify::Plan made = plan(pilot, asked);
  EXPECT_TRUE(made.verification.inside_volume);
}

/// Two that fly towards each other, each planning twenty times a second with the other one as its obstacle.
TEST(OrcaPilot, TwoThatMeetHeadOnPassClear) {
  OrcaPilot pilot({});
  std::array<planner::base::TimedPoint, 2> states{{{0, {0, 0, 3}, {}, {}}, {0, {14, 0, 3}, {}, {}}}};
  const std::array<Vec3, 2> targets{{{14, 0, 3}, {0, 0, 3}}};
  states[0].velocity.setZero();
  states[1].velocity.setZero();
  double nearest = 14.0;
  for (int step = 0; step < 300; ++step) {
    const std::array<planner::base::TimedPoint, 2> before = states;
    for (std::size_t i = 0; i < 2; ++i) {
      const planner::base::TimedPoint& other = before[1 - i];
      const planner::verify::Plan made = plan(
          pilot, job(before[i].position, targets[i], {ball(0.3, other.position, other.velocity)}, before[i].velocity));
      states[i] = planner::base::sample(made.path, 0.05);
    }
    nearest = std::min(nearest, (states[0].position - states[1].position).norm());
  }
  EXPECT_GE(nearest, 0.6);
  EXPECT_LT((states[0].position - targets[0]).norm(), 0.3);
  EXPECT_LT((states[1].position - targets[1]).norm(), 0.3);
}

}  // namespace
}  // namespace jink::tools::lab::baselines
