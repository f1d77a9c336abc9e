// SPDX-License-Identifier: BSD-3-Clause
// Others' worlds, by their published figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <variant>

#include "sim/families/families.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

using std::numbers::pi;

constexpr std::uint64_t kWorlds = 10;

const config::WaypointsMotion& waypoints(const config::Obstacle& obstacle) {
  return std::get<config::WaypointsMotion>(obstacle.motion);
}

Vec3 edges(const config::Obstacle& obstacle) {
  return std::get<config::BoxShape>(obstacle.shape).edges;
}

/// The formula as the launch files have it, but for the offset, which is within τ here.
Vec3 launched_trefoil(const Vec3& center, const Vec3& scale, double tau) {
  return center + Vec3(scale.x() / 6 * (std::sin(tau) + 2 * std::sin(2 * tau)),
                       scale.y() / 5 * (std::cos(tau) - 2 * std::cos(2 * tau)), -scale.z() / 2 * std::sin(3 * tau));
}

/// That it moves by the formula; its scales, before they are divided.
Vec3 expect_launched_trefoil(const config::Obstacle& obstacle) {
  const auto& motion = std::get<config::TrefoilMotion>(obstacle.motion);
  Vec3 scale = motion.scale.cwiseProduct(Vec3(6, 5, 2));
  EXPECT_EQ(edges(obstacle), Vec3(0.8, 0.8, 0.8));
  for (double t = 0; t < 40; t += 1.7) {
    const Vec3 expected = launched_trefoil(motion.center, scale, t / motion.slower + motion.offset);
    EXPECT_LT((world::state_at(obstacle.motion, t).position - expected).norm(), 1e-9) << t;
  }
  return scale;
}

void expect_limits(const config::Scenario& scenario, double radius, double speed, double climb) {
  EXPECT_DOUBLE_EQ(scenario.vehicle.radius, radius);
  EXPECT_EQ(scenario.vehicle.max_speed, speed);
  EXPECT_EQ(scenario.vehicle.cruise_speed, speed);
  EXPECT_EQ(scenario.vehicle.max_climb, climb);
}

TEST(OthersFamilies, AreKnownByNameAndNotAmongTheUsual) {
  const std::set<std::string_view> usual(world_families().begin(), world_families().end());
  const std::set<std::string_view> others(others_families().begin(), others_families().end());
  EXPECT_EQ(others.size(), others_families().size());
  EXPECT_EQ(others.size(), 11U);
  for (const std::string_view family : others) {
    EXPECT_FALSE(usual.contains(family)) << family;
    EXPECT_FALSE(blocks_straight_line(family)) << family;
    const config::Scenario scenario = make_world(family, 3);
    EXPECT_EQ(scenario.map.empty(), !has_map(family)) << family;
    EXPECT_TRUE(world::World(scenario).inside(scenario.start)) << family;
    EXPECT_TRUE(world::World(scenario).inside(scenario.target)) << family;
  }
}

TEST(SandoLaunched, TwoThirdsMoveAndTheRestArePolesAndBeams) {
  struct Counts {
    int all, moving, poles, beams;
  };
  for (const Counts& expected : {Counts{50, 32, 7, 11}, Counts{100, 65, 13, 22}, Counts{200, 130, 25, 45}}) {
    for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
      const config::Scenario scenario = make_world("sando_launched_" + std::to_string(expected.all), seed);
      SCOPED_TRACE(scenario.name);
      const auto with = [&](const Vec3& size) {
        return std::count_if(scenario.obstacles.begin(), scenario.obstacles.end(),
                             [&](const config::Obstacle& one) { return edges(one) == size; });
      };
      EXPECT_EQ(std::ssize(scenario.obstacles), expected.all);
      EXPECT_EQ(with({0.8, 0.8, 0.8}), expected.moving);
      EXPECT_EQ(with({0.4, 0.4, 4.0}), expected.poles);
      EXPECT_EQ(with({0.4, 4.0, 0.4}), expected.beams);
      expect_limits(scenario, 0.1 * std::sqrt(3.0), 5.0, 5.0);
      EXPECT_EQ(scenario.start, Vec3(0, 0, 2));
      EXPECT_EQ(scenario.target, Vec3(105, 0, 2));
      EXPECT_EQ(scenario.time_limit, 100.0);
    }
  }
}

TEST(SandoLaunched, MovesByTheLaunchFilesFormula) {
  const planner::base::Box scales{Vec3::Constant(2.0 - 1e-12), Vec3::Constant(4.0 + 1e-12)};
  const planner::base::Box centers{{5, -6, 0.5}, {100, 6, 4.5}};
  for (const config::Obstacle& obstacle : make_world("sando_launched_200", 5).obstacles) {
    if (const auto* standing = std::get_if<config::LinearMotion>(&obstacle.motion)) {
      EXPECT_TRUE(standing->velocity.isZero(0.0));
      EXPECT_TRUE(centers.contains(standing->position));
      if (edges(obstacle).z() == 4.0) {
        EXPECT_EQ(standing->position.z(), 2.0);  // on the ground
      }
      continue;
    }
    EXPECT_TRUE(scales.contains(expect_launched_trefoil(obstacle)));
    const auto& motion = std::get<config::TrefoilMotion>(obstacle.motion);
    EXPECT_TRUE(centers.contains(motion.center));
    EXPECT_GE(motion.slower, 4.0);
    EXPECT_LE(motion.slower, 6.0);
    EXPECT_GE(motion.offset, 0.0);
    EXPECT_LE(motion.offset, 3.0);
  }
}

TEST(Panther, FiveTrefoilsInARow) {
  for (const auto& [family, slower] : {std::pair{"panther_slow", 2.3}, std::pair{"panther_fast", 1.2}}) {
    for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
      const config::Scenario scenario = make_world(family, seed);
      SCOPED_TRACE(scenario.name);
      ASSERT_EQ(scenario.obstacles.size(), 5U);
      expect_limits(scenario, 0.1, 2.6, 2.6);
      EXPECT_EQ(scenario.target, Vec3(40, 0, 1));
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_LT((expect_launched_trefoil(scenario.obstacles[i]) - Vec3(2, 2, 3)).norm(), 1e-12);
        const auto& motion = std::get<config::TrefoilMotion>(scenario.obstacles[i].motion);
        EXPECT_DOUBLE_EQ(motion.center.x(), 4.0 + 7.2 * static_cast<double>(i));
        EXPECT_LE(std::abs(motion.center.y()), 1.0);
        EXPECT_EQ(motion.center.z(), 1.0);
        EXPECT_EQ(motion.slower, slower);
        EXPECT_LE(std::abs(motion.offset), 2 * pi);
      }
    }
  }
}

TEST(Fapp, FiftyDriftAmongTwentyThatStand) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("fapp_50", seed);
    SCOPED_TRACE(scenario.name);
    expect_limits(scenario, 0.3, 3.5, 3.5);
    EXPECT_EQ(scenario.sensing.range, 8.0);
    ASSERT_EQ(scenario.obstacles.size(), 70U);
    int standing = 0;
    for (const config::Obstacle& obstacle : scenario.obstacles) {
      standing += std::holds_alternative<config::LinearMotion>(obstacle.motion) ? 1 : 0;
      const auto& column = std::get<config::CylinderShape>(obstacle.shape);
      EXPECT_GE(column.radius, 0.15);
      EXPECT_LE(column.radius, 1.05);
      EXPECT_EQ(column.height, 3.0);
      // 2.1 A with A up to 2 is 4.2 m/s along an axis.
      EXPECT_LE(world::speed_bound(obstacle.motion, 0.0, 60.0), std::hypot(4.2, 4.2) + 1e-9);
    }
    EXPECT_EQ(standing, 20);
  }
}

// Until it turns: x = x0 + A ((1 - cos ωt)/ω + 1.1 t). What is unknown, A and ω, follows from two places.
TEST(SandoHover, ThreeTrefoilsAboutTheVehicle) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("sando_hover", seed);
    expect_limits(scenario, 0.1 * std::sqrt(3.0), 5.0, 5.0);
    EXPECT_EQ(scenario.start, scenario.target);
    EXPECT_EQ(scenario.hold_time, 60.0);
    ASSERT_EQ(scenario.obstacles.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((expect_launched_trefoil(scenario.obstacles[i]) - Vec3(4, 4, 2)).norm(), 1e-12);
      const auto& motion = std::get<config::TrefoilMotion>(scenario.obstacles[i].motion);
      EXPECT_EQ(motion.slower, 2.0);
      EXPECT_DOUBLE_EQ(motion.offset, 2 * pi * static_cast<double>(i) / 3);
      EXPECT_NEAR((motion.center - scenario.start).norm(), 5.0, 1e-12);
      const auto& next = std::get<config::TrefoilMotion>(scenario.obstacles[(i + 1) % 3].motion);
      EXPECT_NEAR((motion.center - next.center).norm(), 5.0 * std::sqrt(3.0), 1e-12);
    }
  }
}

TEST(SandoChaser, ComesFromEightMetres) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("sando_chaser", seed);
    expect_limits(scenario, 0.1 * std::sqrt(3.0), 5.0, 5.0);
    EXPECT_EQ(scenario.start, scenario.target);
    ASSERT_EQ(scenario.obstacles.size(), 1U);
    const auto& motion = std::get<config::ChaseMotion>(scenario.obstacles[0].motion);
    EXPECT_EQ(motion.speed, 1.0);
    EXPECT_NEAR((motion.position - scenario.start).norm(), 8.0, 1e-12);
    EXPECT_EQ(motion.position.z(), 2.0);
  }
}

TEST(Fapp, DriftsByItsFormulaUntilItTurns) {
  int checked = 0;
  for (const config::Obstacle& obstacle : make_world("fapp_50", 2).obstacles) {
    if (!std::holds_alternative<config::WaypointsMotion>(obstacle.motion)) continue;
    const config::WaypointsMotion& motion = waypoints(obstacle);
    const auto x = [&](std::size_t i) { return motion.points[i].x() - motion.points[0].x(); };
    if (motion.points[0].x() > 0.0 || motion.points[0].y() > 0.0) continue;  // those that do not turn for 4 s
    ASSERT_DOUBLE_EQ(motion.times[40], 4.0);
    double best = planner::base::kInfinity;
    for (double omega = 0.001; omega <= 2.0; omega += 0.001) {
      const auto shape = [&](double t) { return (1 - std::cos(omega * t)) / omega + 1.1 * t; };
      const double amplitude = x(40) / shape(4.0);
      if (amplitude < 0.19 || amplitude > 2.01) continue;
      double off = 0.0;
      for (std::size_t i = 0; i <= 40; ++i)
        off = std::max(off, std::abs(x(i) - amplitude * shape(0.1 * static_cast<double>(i))));
      best = std::min(best, off);
    }
    EXPECT_LT(best, 0.05);  // summed up in steps of 0.02 s
    ++checked;
  }
  EXPECT_GT(checked, 5);
}

TEST(Fapp, NobodyLeavesTheSquareForLong) {
  int turned = 0;
  for (const config::Obstacle& obstacle : make_world("fapp_50", 4).obstacles) {
    const Vec3 begin = world::state_at(obstacle.motion, 0.0).position;
    bool turns = false;
    for (double t = 0; t <= 60; t += 0.05) {
      const world::ObstacleState now = world::state_at(obstacle.motion, t);
      EXPECT_LE(now.position.head<2>().cwiseAbs().maxCoeff(), 17.5 + 0.02 * 4.2 + 1e-9);
      EXPECT_EQ(now.position.z(), begin.z());
      turns = turns || now.velocity.x() < 0.0;
    }
    turned += turns ? 1 : 0;
  }
  EXPECT_GT(turned, 40);
}

TEST(CerlabCorridor, NinePeopleWalkBetweenTheirPlaces) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("cerlab_corridor", seed);
    SCOPED_TRACE(scenario.name);
    ASSERT_EQ(scenario.obstacles.size(), 9U);
    EXPECT_EQ(scenario.map.size(), 5U + 9U);  // four walls, the ceiling, the boxes
    for (const config::Obstacle& person : scenario.obstacles) {
      EXPECT_EQ(waypoints(person).times.front(), 0.0);
      EXPECT_GE(waypoints(person).times.back(), 107.0);
      EXPECT_NEAR(world::speed_bound(person.motion, 0.0, 60.0), 0.5, 1e-9);
    }
    // The last walks from x = 36 to 39 at y = -1.5, the third across from y = 1 to -1.
    const auto span = [&](std::size_t i, int axis) {
      double low = planner::base::kInfinity;
      double high = -planner::base::kInfinity;
      for (const Vec3& point : waypoints(scenario.obstacles[i]).points) {
        low = std::min(low, point[axis]);
        high = std::max(high, point[axis]);
      }
      return std::pair{low, high};
    };
    EXPECT_EQ(span(8, 0), (std::pair{36.0, 39.0}));
    EXPECT_EQ(span(8, 1), (std::pair{-1.5, -1.5}));
    EXPECT_EQ(span(2, 1), (std::pair{-1.0, 1.0}));
  }
}

class Fcp : public ::testing::TestWithParam<int> {};

TEST_P(Fcp, SmallSpheresInTheBox) {
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("fcp_" + std::to_string(GetParam()), seed);
    SCOPED_TRACE(scenario.name);
    expect_limits(scenario, 0.2, 3.0, 0.7);
    EXPECT_EQ(scenario.start, Vec3(0, 0, 1));
    EXPECT_EQ(scenario.target, Vec3(5, 5, 6.4));
    EXPECT_EQ(scenario.acceptance_radius, 0.8);
    EXPECT_EQ(scenario.time_limit, 25.0);
    EXPECT_EQ(scenario.world->min, Vec3(-3, -3, 0));
    EXPECT_EQ(scenario.world->max, Vec3(7, 7, 8));
    ASSERT_EQ(std::ssize(scenario.obstacles), GetParam());
    for (const config::Obstacle& obstacle : scenario.obstacles) {
      EXPECT_EQ(std::get<config::SphereShape>(obstacle.shape).radius, 0.1);
      ASSERT_EQ(waypoints(obstacle).times.size(), 251U);
      EXPECT_DOUBLE_EQ(waypoints(obstacle).times.back(), 25.0);
      for (const Vec3& point : waypoints(obstacle).points) EXPECT_TRUE(scenario.world->contains(point));
    }
  }
}

/// Of the steps' velocities from the first `from` on, `count` of them: the mean of their squares along an axis.
double mean_square(const config::WaypointsMotion& motion, int axis, std::size_t from, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = from; i < from + count; ++i) {
    const double v = (motion.points[i + 1][axis] - motion.points[i][axis]) / 0.1;
    sum += v * v;
  }
  return sum / static_cast<double>(count);
}

// In a step: a velocity of 0.5 m/s, standing for 0.6 of the time from the first switch on, and noise of 0.22 m/s.
TEST_P(Fcp, ThoseThatWanderHaveTheirSpread) {
  std::array<double, 3> before{};
  double later = 0.0;
  int movers = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const config::Scenario scenario = make_world("fcp_" + std::to_string(GetParam()), seed);
    for (std::size_t i = scenario.obstacles.size() / 2; i < scenario.obstacles.size(); ++i) {
      const config::WaypointsMotion& motion = waypoints(scenario.obstacles[i]);
      for (int axis = 0; axis < 3; ++axis) before[static_cast<std::size_t>(axis)] += mean_square(motion, axis, 0, 10);
      later += mean_square(motion, 0, 70, 180);
      ++movers;
    }
  }
  const double noise = 0.22 * 0.22;
  EXPECT_NEAR(before[0] / movers, 0.25 + noise, 0.03);
  EXPECT_NEAR(before[1] / movers, 0.25 + noise, 0.03);
  EXPECT_NEAR(before[2] / movers, 0.04 * (0.25 + noise), 0.03 * 0.04);
  EXPECT_NEAR(later / movers, 0.4 * 0.25 + noise, 0.03);
}

// Over 1 s their mean velocity has the speed of their own and little noise, unless they turn to another goal.
TEST_P(Fcp, TheOthersGoToTheirGoals) {
  int as_meant = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const config::Scenario scenario = make_world("fcp_" + std::to_string(GetParam()), seed);
    for (std::size_t i = 0; i < scenario.obstacles.size() / 2; ++i) {
      const config::WaypointsMotion& motion = waypoints(scenario.obstacles[i]);
      const double speed = (motion.points[10] - motion.points[0]).norm();
      as_meant += speed > 0.3 - 0.15 && speed < 0.7 + 0.15 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(as_meant, 0.9 * all);
}

INSTANTIATE_TEST_SUITE_P(Counts, Fcp, ::testing::Values(50, 280));

}  // namespace
}  // namespace jink::sim::families
