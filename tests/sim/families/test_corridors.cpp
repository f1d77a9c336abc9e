// SPDX-License-Identifier: BSD-3-Clause
// The families whose figures are published or promised one by one: the literature's corridors, DAIDALUS's encounters,
// the team that swaps places, `late` and `odd`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <variant>

#include "sim/families/families.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

using std::numbers::pi;

constexpr std::uint64_t kCorridors = 20;

const config::LinearMotion& linear(const config::Obstacle& obstacle) {
  return std::get<config::LinearMotion>(obstacle.motion);
}

/// The largest speed of the obstacle in its first 20 s, sampled.
double peak_speed(const config::Obstacle& obstacle) {
  double peak = 0.0;
  for (double t = 0; t < 20; t += 0.005) peak = std::max(peak, world::state_at(obstacle.motion, t).velocity.norm());
  return peak;
}

void expect_cubes(const config::Scenario& scenario, std::size_t count, const planner::base::Box& centers) {
  ASSERT_EQ(scenario.obstacles.size(), count);
  std::size_t curved = 0;
  for (const config::Obstacle& obstacle : scenario.obstacles) {
    EXPECT_EQ(std::get<config::BoxShape>(obstacle.shape).edges, Vec3(0.8, 0.8, 0.8));
    Vec3 center;
    if (const auto* trefoil = std::get_if<config::TrefoilMotion>(&obstacle.motion)) {
      center = trefoil->center;
      ++curved;
    } else if (const auto* sine = std::get_if<config::SineMotion>(&obstacle.motion)) {
      center = sine->center;
    } else {
      center = linear(obstacle).position;
    }
    EXPECT_TRUE(centers.contains(center)) << center.transpose();
  }
  EXPECT_EQ(curved, count * 65 / 100);
}

void expect_limits_of_the_literature(const config::Scenario& scenario) {
  EXPECT_EQ(scenario.vehicle.max_speed, 5.0);
  EXPECT_EQ(scenario.vehicle.cruise_speed, 5.0);
  EXPECT_EQ(scenario.vehicle.max_acceleration, 20.0);
  EXPECT_EQ(scenario.vehicle.max_jerk, 100.0);
  EXPECT_FALSE(scenario.world.has_value());
}

TEST(MaderCorridor, IsAsPublished) {
  for (const std::size_t count : {50U, 100U, 250U}) {
    for (std::uint64_t seed = 1; seed <= kCorridors; ++seed) {
      const config::Scenario scenario = make_world("mader_" + std::to_string(count), seed);
      SCOPED_TRACE(scenario.name);
      expect_cubes(scenario, count, {{2, -3, 1}, {75, 3, 2}});
      expect_limits_of_the_literature(scenario);
      EXPECT_EQ(scenario.start, Vec3(0, 0, 1));
      EXPECT_EQ(scenario.target, Vec3(75, 0, 1));
      for (const config::Obstacle& obstacle : scenario.obstacles) {
        if (const auto* trefoil = std::get_if<config::TrefoilMotion>(&obstacle.motion)) {
          EXPECT_EQ(trefoil->scale, Vec3(1, 1, 1));
          EXPECT_EQ(trefoil->slower, 1.1);
          EXPECT_LE(std::abs(trefoil->offset), 2 * pi);
        }
      }
    }
  }
}

// One that sweeps the goal again and again would make it a world in which nobody can stay there.
TEST(MaderCorridor, NobodyStaysAtTheGoal) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const config::Scenario scenario = make_world("mader_250", seed);
    for (const config::Obstacle& obstacle : scenario.obstacles) {
      config::Scenario alone = scenario;
      alone.obstacles = {obstacle};
      const world::World world(alone);
      double nearest = planner::base::kInfinity;
      for (double t = 0; t < 10; t += 0.1) nearest = std::min(nearest, world.clearance(scenario.target, t));
      EXPECT_GT(nearest, 0.8) << seed;
    }
  }
}

// 5.3 m/s: hypot(5, 3) / 1.1.
TEST(MaderCorridor, MoversPeakAtThePublishedSpeed) {
  double fastest = 0.0;
  for (const config::Obstacle& obstacle : make_world("mader_50", 1).obstacles) {
    const double peak = peak_speed(obstacle);
    if (std::holds_alternative<config::TrefoilMotion>(obstacle.motion)) {
      EXPECT_NEAR(peak, 5.3, 0.01);
    } else {
      EXPECT_NEAR(peak, 1.0 / 1.1, 0.01);
    }
    fastest = std::max(fastest, peak);
  }
  EXPECT_NEAR(fastest, 5.3, 0.01);
}

// By -sin τ, τ = t/1.1 + offset, a metre to either side, in z alone.
TEST(MaderCorridor, TheRestSwingInHeight) {
  const config::Scenario scenario = make_world("mader_100", 3);
  for (const config::Obstacle& obstacle : scenario.obstacles) {
    const auto* sine = std::get_if<config::SineMotion>(&obstacle.motion);
    if (sine == nullptr) continue;
    const double offset = sine->phase.z() - pi;
    EXPECT_LE(std::abs(offset), 2 * pi + 1e-12);
    for (double t = 0; t < 10; t += 0.37) {
      const Vec3 expected = sine->center - std::sin(t / 1.1 + offset) * Vec3::UnitZ();
      EXPECT_LT((world::state_at(obstacle.motion, t).position - expected).norm(), 1e-9) << t;
    }
  }
}

TEST(SandoCorridor, IsAsTheBenchmark) {
  for (const std::size_t count : {50U, 100U, 200U}) {
    for (std::uint64_t seed = 1; seed <= kCorridors; ++seed) {
      const config::Scenario scenario = make_world("sando_" + std::to_string(count), seed);
      SCOPED_TRACE(scenario.name);
      expect_cubes(scenario, count, {{5, -6, 0.5}, {100, 6, 4.5}});
      expect_limits_of_the_literature(scenario);
      EXPECT_EQ(scenario.start, Vec3(0, 0, 2));
      EXPECT_EQ(scenario.target, Vec3(105, 0, 2));
      EXPECT_EQ(scenario.time_limit, 100.0);
      for (const config::Obstacle& obstacle : scenario.obstacles) {
        if (const auto* trefoil = std::get_if<config::TrefoilMotion>(&obstacle.motion)) {
          EXPECT_TRUE((planner::base::Box{Vec3::Constant(2), Vec3::Constant(4)}).contains(trefoil->scale));
          EXPECT_GE(trefoil->slower, 10.0);
          EXPECT_LE(trefoil->slower, 12.0);
          EXPECT_GE(trefoil->offset, 0.0);
          EXPECT_LE(trefoil->offset, 3.0);
        } else {
          EXPECT_TRUE(linear(obstacle).velocity.isZero(0.0));
        }
      }
    }
  }
}

/// The level angle between the intruder's track and the vehicle's, and its level speed in cruise speeds.
struct Geometry {
  double angle_deg;
  double ratio;
};

Geometry geometry(const config::Scenario& scenario, const config::Obstacle& obstacle) {
  const Vec3 way = scenario.target - scenario.start;
  const Vec3& v = linear(obstacle).velocity;
  const double cross = way.x() * v.y() - way.y() * v.x();
  const double dot = way.x() * v.x() + way.y() * v.y();
  return {std::abs(std::atan2(cross, dot)) * 180 / pi, v.head<2>().norm() / scenario.vehicle.cruise_speed};
}

TEST(Daidalus, EncountersHaveTheirGeometry) {
  int slower = 0;
  int faster = 0;
  std::set<long> angles;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const std::string family : {"daidalus_head_on", "daidalus_crossing", "daidalus_overtaking"}) {
      const config::Scenario scenario = make_world(family, seed);
      SCOPED_TRACE(scenario.name);
      EXPECT_EQ(scenario.start.z(), scenario.target.z());
      EXPECT_GE(scenario.obstacles.size(), 1U);
      EXPECT_LE(scenario.obstacles.size(), 2U);
      for (const config::Obstacle& obstacle : scenario.obstacles) {
        const Geometry g = geometry(scenario, obstacle);
        EXPECT_LE(std::abs(linear(obstacle).velocity.z()), 0.8);
        EXPECT_LE(g.ratio, 3.0);
        if (family == "daidalus_head_on") {
          EXPECT_GE(g.angle_deg, 165.0 - 1e-9);
        } else if (family == "daidalus_crossing") {
          angles.insert(std::lround(g.angle_deg));
        } else {
          EXPECT_LE(g.angle_deg, 15.0 + 1e-9);
          ++(g.ratio > 1.0 ? faster : slower);
        }
      }
    }
  }
  EXPECT_EQ(angles, (std::set<long>{45, 90, 135}));
  EXPECT_GT(slower, 5);
  EXPECT_GT(faster, 5);
}

TEST(Antipodal, VehiclesFaceEachOtherAcrossACircleOrASphere) {
  std::set<std::size_t> sizes;
  int level = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const config::Scenario scenario = make_world("antipodal", seed);
    SCOPED_TRACE(scenario.name);
    const auto team = config::all_vehicles(scenario);
    sizes.insert(team.size());
    EXPECT_TRUE(scenario.obstacles.empty());
    const Vec3 middle = 0.5 * (scenario.start + scenario.target);
    const double radius = (scenario.start - middle).norm();
    bool flat = true;
    for (const config::ScenarioVehicle& vehicle : team) {
      EXPECT_NEAR((vehicle.start - middle).norm(), radius, 1e-9);
      EXPECT_LT((vehicle.target - (2 * middle - vehicle.start)).norm(), 1e-9);
      EXPECT_GE(vehicle.start.z(), 1.0);
      EXPECT_GE(vehicle.target.z(), 1.0);
      flat = flat && std::abs(vehicle.start.z() - middle.z()) < 1e-9;
    }
    level += flat ? 1 : 0;
  }
  EXPECT_EQ(sizes, (std::set<std::size_t>{2, 3, 4, 5, 6}));
  EXPECT_GT(level, 10);
  EXPECT_LT(level, 50);
}

// Each at the same speed along its own line: in the middle at the same time.
TEST(Antipodal, StraightFlightsMeetInTheMiddle) {
  for (std::uint64_t seed = 1; seed <= kCorridors; ++seed) {
    const config::Scenario scenario = make_world("antipodal", seed);
    const auto team = config::all_vehicles(scenario);
    for (std::size_t k = 1; k < team.size(); ++k) {
      const world::SweepResult nearest = world::sweep({team[0].start, team[0].target, team[0].vehicle.radius},
                                                      {team[k].start, team[k].target, team[k].vehicle.radius}, 0, 1);
      EXPECT_LT(nearest.min_clearance, -kStraightOverlap) << seed;
    }
  }
}

TEST(Late, HoldsStandingOncomingAndCrossingOnes) {
  int standing = 0;
  int oncoming = 0;
  int crossing = 0;
  for (std::uint64_t seed = 1; seed <= kCorridors; ++seed) {
    const config::Scenario scenario = make_world("late", seed);
    const Vec3 forward = (scenario.target - scenario.start).normalized();
    for (const config::Obstacle& obstacle : scenario.obstacles) {
      const Vec3& v = linear(obstacle).velocity;
      EXPECT_LE(v.norm(), 3.0 + 1e-9);
      if (v.isZero(0.0)) {
        ++standing;
      } else {
        ++(v.normalized().dot(forward) < -0.99 ? oncoming : crossing);
      }
    }
  }
  EXPECT_GT(standing, 10);
  EXPECT_GT(oncoming, 10);
  EXPECT_GT(crossing, 10);
}

TEST(Odd, MotionIsExactlyAlongOrAcrossTheLine) {
  int far = 0;
  int mirrored = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const config::Scenario scenario = make_world("odd", seed);
    SCOPED_TRACE(scenario.name);
    const Vec3 forward = (scenario.target - scenario.start).normalized();
    far += scenario.start.head<2>().norm() > 1000.0 ? 1 : 0;
    EXPECT_EQ(scenario.start.z(), scenario.target.z());
    for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {
      const config::LinearMotion& m = linear(scenario.obstacles[i]);
      const double with = m.velocity.norm() > 0.0 ? std::abs(m.velocity.normalized().dot(forward)) : 1.0;
      EXPECT_TRUE(with < 1e-9 || with > 1.0 - 1e-9) << with;
      // The centre passes through the line.
      const Vec3 from = m.position - scenario.start;
      const Vec3 off = from - from.dot(forward) * forward;
      const Vec3 left = with < 0.5 ? Vec3(off - off.dot(m.velocity) / m.velocity.squaredNorm() * m.velocity) : off;
      EXPECT_LT(left.norm(), 1e-8);
      if (i > 0 && linear(scenario.obstacles[i - 1]).velocity == Vec3(-m.velocity)) ++mirrored;
    }
  }
  EXPECT_GT(far, 5);
  EXPECT_GT(mirrored, 5);
}

}  // namespace
}  // namespace jink::sim::families
