// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "planner/geometry/validity.hpp"
#include "planner/verify/verifier.hpp"
#include "sim/world/shapes.hpp"
#include "tests/sim/examples.hpp"
#include "tests/sim/world/random_obstacles.hpp"

namespace jink::sim::world {
namespace {

using planner::base::RandomStream;
using std::numbers::pi;

constexpr double kVehicleRadius = 0.3;

config::Scenario scenario_with(std::vector<config::Obstacle> obstacles) {
  config::Scenario scenario;
  scenario.vehicle.radius = kVehicleRadius;
  scenario.obstacles = std::move(obstacles);
  return scenario;
}

config::Obstacle corner_at(const Vec3& position) {
  return {config::VertexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, config::LinearMotion{position}};
}

TEST(World, NamesItsObstaclesFromOne) {
  const World world(scenario_with({ball(1, {0, 0, 0}), ball(1, {9, 0, 0})}));
  EXPECT_EQ(world.obstacle_count(), 2);
  EXPECT_EQ(world.id(0), 1U);
  EXPECT_EQ(world.id(1), 2U);
  EXPECT_EQ(world.exact_track(1, 0.0).id, 2U);
}

TEST(World, SphereAndTrackAreAboutTheEnclosingCentre) {
  config::Obstacle moving = corner_at({3, 0, 0});
  moving.motion = config::LinearMotion{{3, 0, 0}, {1, 2, 0}, {0, 0, 2}};
  const World world(scenario_with({moving}));
  const Vec3 expected = Vec3(5, 4, 4) + Vec3::Constant(1.0 / 3.0);
  EXPECT_NEAR((world.sphere(0, 2.0).center - expected).norm(), 0.0, 1e-12);
  EXPECT_NEAR(world.sphere(0, 2.0).radius, std::sqrt(2.0 / 3.0), 1e-12);
  const planner::base::Track track = world.exact_track(0, 2.0);
  EXPECT_NEAR((track.position - expected).norm(), 0.0, 1e-12);
  EXPECT_NEAR((track.velocity - Vec3(1, 2, 4)).norm(), 0.0, 1e-12);
  EXPECT_EQ(track.acceleration, Vec3(0, 0, 2));
  EXPECT_NEAR(track.radius, std::sqrt(2.0 / 3.0), 1e-12);
  EXPECT_EQ(track.position_sigma, 0.0);
  EXPECT_EQ(track.velocity_sigma, 0.0);
  EXPECT_EQ(track.age, 0.0);
}

TEST(World, ClearanceIsToTheTrueShapeOfTheNearestObstacle) {
  const config::Obstacle box{config::BoxShape{{2, 2, 2}}, config::LinearMotion{{0, 0, 0}}};
  const World world(scenario_with({ball(0.5, {10, 0, 0}, {-1, 0, 0}), box}));
  // At t = 0 the box is nearest, by its face: its enclosing sphere would already reach to sqrt(3).
  EXPECT_DOUBLE_EQ(world.clearance({1.5, 0, 0}, 0.0), 0.5 - kVehicleRadius);
  EXPECT_DOUBLE_EQ(world.clearance({5, 0, 0}, 2.0), 2.5 - kVehicleRadius);  // the ball is at 8
  EXPECT_DOUBLE_EQ(world.clearance({0, 0, 0}, 0.0), -1.0 - kVehicleRadius);
}

TEST(World, ClearanceInAHullIsMinusTheVehicleRadius) {
  const World world(scenario_with({corner_at({0, 0, 0})}));
  EXPECT_DOUBLE_EQ(world.clearance({0.1, 0.1, 0.1}, 0.0), -kVehicleRadius);
}

// The quick test by enclosing spheres, whose centre is not the reference point of a hull, must not leave one out.
TEST(World, ClearanceIsTheMinimumOverAllObstacles) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    RandomStream random(30, seed);
    std::vector<config::Obstacle> obstacles;
    for (std::uint64_t i = 0; i < 4; ++i) {
      config::Shape shape = testing::random_shape(random, i % testing::kShapeKinds);
      if (auto* hull = std::get_if<config::VertexShape>(&shape)) {
        for (Vec3& vertex : hull->vertices) vertex += Vec3(3, 0, 0);
      }
      obstacles.push_back({shape, config::LinearMotion{testing::random_vector(random, -3, 3)}});
    }
    const World world(scenario_with(obstacles));
    const Vec3 p = testing::random_vector(random, -4, 4);
    double nearest = planner::base::kInfinity;
    for (int i = 0; i < 4; ++i) {
      const config::Shape& shape = obstacles[static_cast<std::size_t>(i)].shape;
      nearest = std::min(nearest, distance(shape, world.obstacle(i, 1.0).position, p));
    }
    EXPECT_NEAR(world.clearance(p, 1.0), nearest - kVehicleRadius, 1e-9) << seed;
  }
}

TEST(World, ObstaclesAreTurnedAndTurn) {
  // A plank of 4 m along east, turned by a right angle to the north, and on by another in a second.
  config::Obstacle plank{config::BoxShape{{4, 0.2, 1}}, config::LinearMotion{{1, 0, 0}}};
  plank.orientation.x() = 0.5 * std::numbers::pi;
  const World standing(scenario_with({plank}));
  EXPECT_NEAR(standing.clearance({1, 3, 0}, 0.0), 1.0 - kVehicleRadius, 1e-12);
  EXPECT_NEAR(standing.clearance({4, 0, 0}, 5.0), 2.9 - kVehicleRadius, 1e-12);
  plank.yaw_rate = 0.5 * std::numbers::pi;
  const World turning(scenario_with({plank}));
  EXPECT_NEAR(turning.clearance({1, 3, 0}, -1.0), 1.0 - kVehicleRadius, 1e-12);
  EXPECT_NEAR(turning.clearance({1, 3, 0}, 1.0), 2.9 - kVehicleRadius, 1e-12);
  // In a second its end comes past who hovers 1.9 m from its axis.
  EXPECT_NEAR(turning.sweep({2.9, 0, 0}, 0.0, {2.9, 0, 0}, 1.0).min_clearance, -0.1 - kVehicleRadius, 1e-5);
  // Pitched by a right angle it stands on end.
  plank.orientation = {0.0, 0.5 * std::numbers::pi, 0.0};
  plank.yaw_rate = 0.0;
  EXPECT_NEAR(World(scenario_with({plank})).clearance({1, 0, 3}, 0.0), 1.0 - kVehicleRadius, 1e-12);
}

/// One obstacle; all shapes and motions come in turn with the seeds.
World any_obstacle(RandomStream& random, std::uint64_t seed) {
  const config::Shape shape = testing::random_shape(random, seed % testing::kShapeKinds);
  const config::Motion motion = testing::random_motion(random, seed % testing::kMotionKinds);
  return World(scenario_with({testing::random_obstacle(random, shape, motion)}));
}

// What a track tells is the shape that is there: from afar, near by and inside, whatever the shape and its turn.
TEST(World, ExactTracksHaveTheTrueSurface) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    RandomStream random(33, seed);
    const World world = any_obstacle(random, seed);
    const double t = random.uniform(0, 8);
    const planner::base::Track track = world.exact_track(0, t);
    ASSERT_TRUE(planner::geometry::is_valid(track)) << seed;
    const Vec3 p = track.position + testing::random_vector(random, -4, 4);
    const planner::base::TimedPath here{{0.0, p, Vec3::Zero(), Vec3::Zero()}};
    planner::verify::VerifierInput input;
    input.path = here;
    input.tracks = std::span(&track, 1);
    EXPECT_NEAR(planner::verify::verify(input).min_clearance, world.distance(0, p, t), 1e-8) << seed;
  }
}

TEST(World, WithoutObstaclesAllIsFree) {
  const World world(scenario_with({}));
  EXPECT_EQ(world.clearance({0, 0, 0}, 0.0), planner::base::kInfinity);
  const SweepResult sweep = world.sweep({0, 0, 0}, 2.0, {1, 0, 0}, 3.0);
  EXPECT_EQ(sweep.min_clearance, planner::base::kInfinity);
  EXPECT_EQ(sweep.obstacle, -1);
  EXPECT_EQ(sweep.t_min, 2.0);
  EXPECT_FALSE(world.start_blocked());
}

TEST(World, VolumeIncludesItsBounds) {
  config::Scenario scenario = scenario_with({});
  EXPECT_TRUE(World(scenario).inside({1e9, -1e9, 0}));
  scenario.world = planner::base::Box{{-5, -10, 0}, {25, 10, 8}};
  const World world(scenario);
  EXPECT_TRUE(world.inside({-5, 10, 0}));
  EXPECT_TRUE(world.inside({25 + 5e-10, 0, 1}));
  EXPECT_FALSE(world.inside({25 + 2e-9, 0, 1}));
  EXPECT_FALSE(world.inside({0, 0, -1e-6}));
  EXPECT_EQ(world.volume().max, Vec3(25, 10, 8));
}

TEST(World, StartIsBlockedByOverlapAlone) {
  config::Scenario scenario = scenario_with({ball(0.5, {1, 0, 0}, {-1, 0, 0})});
  scenario.start = {0, 0, 0};
  EXPECT_FALSE(World(scenario).start_blocked());  // free now, whatever comes
  scenario.start = {0.25, 0, 0};
  EXPECT_TRUE(World(scenario).start_blocked());
  scenario.vehicle.radius = 0.25;  // touching, in exact binary numbers
  EXPECT_FALSE(World(scenario).start_blocked());
}

TEST(Sweep, HeadOnMeeting) {
  const World world(scenario_with({ball(0.5, {10, 1, 0}, {-2, 0, 0})}));
  // They close at 3 m/s from 10 m: level after 10/3 s, 1 m apart at the side.
  const SweepResult sweep = world.sweep({0, 0, 0}, 0.0, {5, 0, 0}, 5.0);
  EXPECT_NEAR(sweep.min_clearance, 1.0 - 0.5 - kVehicleRadius, 1e-12);
  EXPECT_NEAR(sweep.t_min, 10.0 / 3.0, 1e-9);
  EXPECT_EQ(sweep.obstacle, 0);
}

TEST(World, WhatChasesFliesToWhereItLastSawTheNearestVehicle) {
  World world(scenario_with({{config::SphereShape{0.1}, config::ChaseMotion{{0, 0, 1}, 2.0}}}));
  EXPECT_EQ(world.obstacle(0, 0.0).position, Vec3(0, 0, 1));
  EXPECT_EQ(world.obstacle(0, 0.0).velocity, Vec3::Zero());
  const std::vector<VehicleTruth> far_and_near{{{9, 0, 1}}, {{0, 8, 1}}};
  world.advance(0.0, far_and_near);
  EXPECT_EQ(world.obstacle(0, 0.0).velocity, Vec3(0, 2, 0));
  // What it does not see yet does not turn it.
  const std::vector<VehicleTruth> ahead{{{3, 1, 1}}};
  world.advance(0.3, ahead);
  EXPECT_EQ(world.obstacle(0, 0.3).velocity, Vec3(0, 2, 0));
  world.advance(0.5, ahead);
  EXPECT_EQ(world.obstacle(0, 0.5).position, Vec3(0, 1, 1));
  EXPECT_EQ(world.obstacle(0, 0.5).velocity, Vec3(2, 0, 0));
  // It stands where it has come to its vehicle, and where there is none.
  const std::vector<VehicleTruth> near{{{1.5, 1, 1}}};
  world.advance(1.02, near);
  EXPECT_NEAR(world.obstacle(0, 1.24).position.x(), 1.48, 1e-9);
  EXPECT_EQ(world.obstacle(0, 1.3).position, Vec3(1.5, 1, 1));
  EXPECT_EQ(world.obstacle(0, 1.3).velocity, Vec3::Zero());
  world.advance(1.5, {});
  EXPECT_EQ(world.obstacle(0, 1.9).position, Vec3(1.5, 1, 1));
  const SweepResult passed = world.sweep({0.5, 1, 1}, 0.6, {0.5, 1, 1}, 0.9);
  EXPECT_NEAR(passed.min_clearance, -0.1 - kVehicleRadius, 1e-6);
}

// A vehicle so near that a double cannot tell when it would be there.
TEST(World, WhatHasCaughtAVehicleStandsThere) {
  World world(scenario_with({{config::SphereShape{0.1}, config::ChaseMotion{{0, 0, 1}, 2.0}}}));
  world.advance(1.0, {});
  const std::vector<VehicleTruth> there{{{1e-17, 0, 1}}};
  world.advance(1.5, there);
  for (const double t : {1.5, 1.6, 2.0}) {
    EXPECT_TRUE(world.obstacle(0, t).position.isApprox(Vec3(0, 0, 1), 1e-12)) << t;
    EXPECT_LT(world.obstacle(0, t).velocity.norm(), 1e-12) << t;
  }
  const std::vector<double>& times = std::get<config::WaypointsMotion>(world.spec(0).motion).times;
  EXPECT_EQ(std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()), times.end());
}

// A ball of 1 cm at 100 m/s crosses the way of a standing vehicle's centre within a millisecond's step.
TEST(Sweep, SeesWhatCrossesWithinAStep) {
  const World world(scenario_with({ball(0.01, {-50, 0, 0}, {100, 0, 0})}));
  EXPECT_GT(world.clearance({0, 0.005, 0}, 0.490), 0.5);
  EXPECT_GT(world.clearance({0, 0.005, 0}, 0.510), 0.5);
  const SweepResult sweep = world.sweep({0, 0.005, 0}, 0.490, {0, 0.005, 0}, 0.510);
  EXPECT_NEAR(sweep.min_clearance, 0.005 - 0.01 - kVehicleRadius, 1e-9);
  EXPECT_NEAR(sweep.t_min, 0.5, 1e-9);
}

// The same with motions whose chord is nowhere near: there and back within the step, so that both ends are far away.
TEST(Sweep, SeesWhatComesAndGoesWithinAStep) {
  const config::WaypointsMotion dart{{0, 1, 1.0005, 1.001}, {{50, 0, 0}, {50, 0, 0}, {0, 0, 0}, {50, 0, 0}}};
  const config::BounceMotion bounce{{50, 0, 0}, {-100, 0, 0}, {0, 0, 0}, {60, 0, 0}};
  const config::SineMotion swing{{50, 0, 0}, {50, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  const config::LinearMotion thrown{{50, 0, 0}, {-100, 0, 0}, {100, 0, 0}};  // turns at t = 1, x = 0
  const Vec3 p(-0.2, 0, 0);
  const std::vector<std::pair<config::Motion, double>> cases = {
      {dart, 1.0005}, {bounce, 0.5}, {swing, 0.75}, {thrown, 1}};
  for (const auto& [motion, contact] : cases) {
    const World world(scenario_with({{config::SphereShape{0.01}, motion}}));
    const SweepResult sweep = world.sweep(p, 0.0, p, 2 * contact);
    EXPECT_NEAR(sweep.min_clearance, 0.2 - 0.01 - kVehicleRadius, World::kSweepTolerance) << motion.index();
    EXPECT_NEAR(sweep.t_min, contact, 1e-3) << motion.index();
  }
}

TEST(Sweep, TellsAGrazeFromAMiss) {
  const double touching = 0.5 + kVehicleRadius;
  const World world(scenario_with({ball(0.5, {10, 0, 0}, {-7, 0, 0})}));
  for (const double gap : {-1e-5, 1e-5}) {
    const double y = touching + gap;
    EXPECT_NEAR(world.sweep({0, y, 0}, 0.0, {0, y, 3}, 3.0 / 0.1).min_clearance,
                std::hypot(y, 0.1 * 10 / std::hypot(7.0, 0.1)) - touching, 2e-6);  // rising at 0.1 m/s meanwhile
    EXPECT_NEAR(world.sweep({0, y, 0}, 0.0, {0, y, 0}, 3.0).min_clearance, gap, World::kSweepTolerance);
  }
}

TEST(Sweep, KnowsWhichObstacleAndPrefersTheFirstOfEqualOnes) {
  const World world(scenario_with({ball(0.5, {5, 4, 0}), ball(0.5, {5, 2, 0}), ball(0.5, {5, -2, 0})}));
  const SweepResult sweep = world.sweep({0, 0, 0}, 0.0, {10, 0, 0}, 10.0);
  EXPECT_EQ(sweep.obstacle, 1);
  EXPECT_NEAR(sweep.t_min, 5.0, 1e-9);
}

TEST(Sweep, OfNoDurationIsAlongTheWayAtThatInstant) {
  const World world(scenario_with({ball(0.5, {0, 0, 0}, {1, 0, 0})}));
  EXPECT_NEAR(world.sweep({0, 2, 0}, 3.0, {6, 2, 0}, 3.0).min_clearance, 1.5 - kVehicleRadius, 1e-12);
  EXPECT_NEAR(world.sweep({3, 2, 0}, 3.0, {3, 2, 0}, 3.0).min_clearance, 1.5 - kVehicleRadius, 1e-12);
}

TEST(Sweep, BeforeTheClockRunsObstaclesStand) {
  const World world(scenario_with({ball(0.5, {5, 0, 0}, {-1, 0, 0})}));
  EXPECT_NEAR(world.sweep({0, 0, 0}, -9.0, {0, 0, 0}, -1.0).min_clearance, 4.5 - kVehicleRadius, 1e-12);
  // It starts within the step.
  EXPECT_NEAR(world.sweep({0, 0, 0}, -1.0, {0, 0, 0}, 2.0).min_clearance, 2.5 - kVehicleRadius, 1e-6);
}

// The worst case for branch and bound: the distance to a ball that circles the vehicle is the same all the time.
TEST(Sweep, EndsWhereTheClearanceIsConstant) {
  const config::SineMotion circle{{0, 0, 0}, {3, 3, 0}, {0.2, 0.2, 0}, {pi / 2, 0, 0}};
  const World world(scenario_with({{config::SphereShape{0.5}, circle}}));
  EXPECT_NEAR(world.sweep({0, 0, 0}, 0.0, {0, 0, 0}, 10.0).min_clearance, 2.5 - kVehicleRadius, 1e-6);
}

// No sample is below the result, and the result is reached at the time and by the obstacle that it names: with that it
// is the minimum. All motions, all shapes.
TEST(Sweep, IsTheMinimumOfTheClearance) {
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    RandomStream random(31, seed);
    std::vector<config::Obstacle> obstacles;
    for (std::uint64_t i = 0; i < 1 + seed % 4; ++i) {
      const config::Shape shape = testing::random_shape(random, random.below(testing::kShapeKinds));
      obstacles.push_back(
          testing::random_obstacle(random, shape, testing::random_motion(random, (seed + i) % testing::kMotionKinds)));
    }
    const World world(scenario_with(std::move(obstacles)));
    const Vec3 p0 = testing::random_vector(random, -3, 3);
    const Vec3 p1 = testing::random_vector(random, -3, 3);
    const double t0 = random.uniform(-0.5, 6);
    const double t1 = t0 + std::pow(10.0, random.uniform(-3, 0.8));
    const SweepResult sweep = world.sweep(p0, t0, p1, t1);
    ASSERT_GE(sweep.t_min, t0);
    ASSERT_LE(sweep.t_min, t1);
    ASSERT_GE(sweep.obstacle, 0);
    ASSERT_LT(sweep.obstacle, world.obstacle_count());
    constexpr int kSamples = 200;
    for (int i = 0; i <= kSamples; ++i) {
      const double u = static_cast<double>(i) / kSamples;
      const double sample = world.clearance((1 - u) * p0 + u * p1, (1 - u) * t0 + u * t1);
      ASSERT_GE(sample, sweep.min_clearance - World::kSweepTolerance - 1e-9) << "seed " << seed << ", u " << u;
    }
    const double u = (sweep.t_min - t0) / (t1 - t0);
    const Vec3 p = (1 - u) * p0 + u * p1;
    EXPECT_NEAR(world.clearance(p, sweep.t_min), sweep.min_clearance, World::kSweepTolerance + 1e-9) << seed;
    const planner::geometry::Sphere sphere = world.sphere(sweep.obstacle, sweep.t_min);
    EXPECT_GE(sweep.min_clearance, (p - sphere.center).norm() - sphere.radius - kVehicleRadius - 1e-9) << seed;
    if (sweep.min_clearance < 0) ++contacts;
  }
  EXPECT_GT(contacts, 60);
  EXPECT_LT(contacts, 540);
}

// A step split in two sees the same as the whole.
TEST(Sweep, OfTwoHalvesIsThatOfTheWhole) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomStream random(32, seed);
    const World world = any_obstacle(random, seed);
    const Vec3 p0 = testing::random_vector(random, -5, 5);
    const Vec3 p1 = testing::random_vector(random, -5, 5);
    const double whole = world.sweep(p0, 1.0, p1, 4.0).min_clearance;
    const Vec3 middle = 0.5 * (p0 + p1);
    const double halves =
        std::min(world.sweep(p0, 1.0, middle, 2.5).min_clearance, world.sweep(middle, 2.5, p1, 4.0).min_clearance);
    EXPECT_NEAR(whole, halves, 2 * World::kSweepTolerance) << seed;
  }
}

}  // namespace
}  // namespace jink::sim::world
