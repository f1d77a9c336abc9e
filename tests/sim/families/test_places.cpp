// SPDX-License-Identifier: BSD-3-Clause
// The families of known places: what stands leaves room, and what moves runs into nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/families/families.hpp"
#include "sim/world/obstacle_models.hpp"
#include "sim/world/shapes.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

constexpr std::uint64_t kPlaces = 12;

class KnownPlace : public ::testing::TestWithParam<std::string_view> {};

config::Scenario without_map(config::Scenario scenario) {
  scenario.map.clear();
  return scenario;
}
config::Scenario map_alone(config::Scenario scenario) {
  scenario.obstacles.clear();
  return scenario;
}

/// Points on and in a shape, relative to its reference point along its own axes, near one another.
std::vector<Vec3> points_of(const config::Shape& shape) {
  std::vector<Vec3> points;
  const auto steps = [](double length) { return 1 + static_cast<int>(std::ceil(length / 0.5)); };
  if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
    const std::array<int, 3> n = {steps(box->edges.x()), steps(box->edges.y()), steps(box->edges.z())};
    for (int i = 0; i <= n[0]; ++i)
      for (int j = 0; j <= n[1]; ++j)
        for (int k = 0; k <= n[2]; ++k)
          points.emplace_back((Vec3(1.0 * i / n[0], 1.0 * j / n[1], 1.0 * k / n[2]).array() - 0.5) *
                              box->edges.array());
  } else if (const auto* cylinder = std::get_if<config::CylinderShape>(&shape)) {
    const int n = steps(cylinder->height);
    for (int i = 0; i <= n; ++i)
      for (double angle = 0.0; angle < 6.2; angle += 0.4)
        points.emplace_back(cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle),
                            cylinder->height * (1.0 * i / n - 0.5));
  } else if (const auto* capsule = std::get_if<config::CapsuleShape>(&shape)) {
    const int n = steps((capsule->b - capsule->a).norm());
    for (int i = 0; i <= n; ++i) points.emplace_back(capsule->a + 1.0 * i / n * (capsule->b - capsule->a));
  } else {
    points.emplace_back(Vec3::Zero());
  }
  return points;
}

/// The least distance of an obstacle's points from another's surface, negative: one is in the other.
double overlap(const config::Obstacle& a, const config::Obstacle& b, double t) {
  const Vec3 at_a = world::state_at(a.motion, t).position;
  const Vec3 at_b = world::state_at(b.motion, t).position;
  const double reach = world::bounding_sphere(a).radius + world::bounding_sphere(b).radius;
  if ((at_a - at_b).norm() > reach) return 1.0;
  double least = 1.0;
  for (const Vec3& point : points_of(a.shape)) {
    const Vec3 place = at_a + world::axes_at(a, t) * point;
    least = std::min(least, world::distance(b.shape, Vec3::Zero(), world::axes_at(b, t).transpose() * (place - at_b)));
  }
  return least;
}

TEST_P(KnownPlace, StandsWhereTheMapSays) {
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    const config::Scenario scenario = make_world(GetParam(), seed);
    EXPECT_FALSE(scenario.map.empty()) << seed;
    for (const config::Obstacle& solid : scenario.map) {
      EXPECT_EQ(world::speed_bound(solid.motion, 0.0, 200.0), 0.0) << seed;
      EXPECT_EQ(solid.yaw_rate, 0.0) << seed;
    }
    ASSERT_TRUE(scenario.world.has_value());
  }
}

TEST_P(KnownPlace, LeavesRoomAtStartAndTarget) {
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    const config::Scenario scenario = make_world(GetParam(), seed);
    const world::World map(map_alone(scenario));
    EXPECT_GE(map.clearance(scenario.start, 0.0), kMapClearance) << seed;
    EXPECT_GE(map.clearance(scenario.target, 0.0), kMapClearance) << seed;
  }
}

// Not for ever, at least: somebody could arrive there.
TEST_P(KnownPlace, TheTargetIsLeft) {
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    const config::Scenario scenario = make_world(GetParam(), seed);
    const world::World movers(without_map(scenario));
    int free = 0;
    for (double t = 0.0; t < scenario.time_limit; t += 0.5) free += movers.clearance(scenario.target, t) > 0.4 ? 1 : 0;
    EXPECT_GT(0.5 * free, 0.5 * scenario.time_limit) << seed;
  }
}

TEST_P(KnownPlace, NothingRunsIntoAnything) {
  int moved = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const config::Scenario scenario = make_world(GetParam(), seed);
    for (double t = 0.0; t < scenario.time_limit; t += 0.7) {
      for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {
        const config::Obstacle& mover = scenario.obstacles[i];
        moved += world::state_at(mover.motion, t).velocity.isZero() ? 0 : 1;
        for (const config::Obstacle& solid : scenario.map) {
          ASSERT_GT(overlap(mover, solid, t), -1e-9) << seed << ": " << i << " at " << t;
          ASSERT_GT(overlap(solid, mover, t), -1e-9) << seed << ": " << i << " at " << t;
        }
        for (std::size_t j = 0; j < scenario.obstacles.size(); ++j) {
          if (j == i) continue;
          ASSERT_GT(overlap(mover, scenario.obstacles[j], t), -1e-9) << seed << ": " << i << ", " << j << " at " << t;
        }
      }
    }
  }
  EXPECT_GT(moved, 0);
}

TEST_P(KnownPlace, PeopleWalkOnTheGround) {
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    for (const config::Obstacle& obstacle : make_world(GetParam(), seed).obstacles) {
      const auto* person = std::get_if<config::CylinderShape>(&obstacle.shape);
      if (person == nullptr) continue;
      EXPECT_NEAR(world::state_at(obstacle.motion, 0.0).position.z(), 0.5 * person->height, 1e-12) << seed;
      EXPECT_LE(world::speed_bound(obstacle.motion, 0.0, 120.0), 1.8 + 1e-9) << seed;
      EXPECT_GE(world::speed_bound(obstacle.motion, 0.0, 120.0), 0.8 - 1e-9) << seed;
    }
  }
}

std::vector<std::string_view> places() {
  std::vector<std::string_view> families(world_families().begin(), world_families().end());
  std::erase_if(families, [](std::string_view family) { return !has_map(family); });
  return families;
}

INSTANTIATE_TEST_SUITE_P(All, KnownPlace, ::testing::ValuesIn(places()),
                         [](const auto& place) { return std::string(place.param); });

TEST(KnownPlaces, AreThoseThatHaveAMap) {
  EXPECT_EQ(places(), (std::vector<std::string_view>{"street", "office", "forest", "truck", "lift_door", "racks",
                                                     "sliding_gate", "wires"}));
  for (const std::string_view family : world_families())
    EXPECT_EQ(make_world(family, 1).map.empty(), !has_map(family)) << family;
}

/// How many worlds of a family have a mover of that kind.
template <typename Shape, typename Motion>
std::uint64_t worlds_with(std::string_view family) {
  std::uint64_t count = 0;
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    const config::Scenario scenario = make_world(family, seed);
    count += std::any_of(scenario.obstacles.begin(), scenario.obstacles.end(),
                         [](const config::Obstacle& obstacle) {
                           return std::holds_alternative<Shape>(obstacle.shape) &&
                                  std::holds_alternative<Motion>(obstacle.motion);
                         })
                 ? 1U
                 : 0U;
  }
  return count;
}

TEST(KnownPlaces, HaveWhatTheyAreNamedAfter) {
  using config::BoxShape, config::CylinderShape, config::LinearMotion, config::WaypointsMotion;
  EXPECT_EQ((worlds_with<BoxShape, LinearMotion>("street")), kPlaces);
  EXPECT_EQ((worlds_with<BoxShape, LinearMotion>("truck")), kPlaces);
  EXPECT_EQ((worlds_with<BoxShape, WaypointsMotion>("lift_door")), kPlaces);
  EXPECT_EQ((worlds_with<BoxShape, WaypointsMotion>("sliding_gate")), kPlaces);
  EXPECT_EQ((worlds_with<BoxShape, WaypointsMotion>("racks")), kPlaces);
  EXPECT_GE((worlds_with<CylinderShape, WaypointsMotion>("office")), 10U);
  EXPECT_GE((worlds_with<CylinderShape, WaypointsMotion>("street")), 10U);
}

TEST(KnownPlaces, TrunksOfTheForestAreApartAndOfTheirSize) {
  for (std::uint64_t seed = 1; seed <= kPlaces; ++seed) {
    std::vector<Vec3> feet;
    for (const config::Obstacle& solid : make_world("forest", seed).map) {
      const auto* trunk = std::get_if<config::CylinderShape>(&solid.shape);
      if (trunk == nullptr) continue;
      EXPECT_GE(2 * trunk->radius, 0.3);
      EXPECT_LE(2 * trunk->radius, 0.8);
      const Vec3 middle = world::state_at(solid.motion, 0.0).position;
      const Vec3 foot = middle - 0.5 * trunk->height * world::axes_at(solid, 0.0).col(2);
      EXPECT_NEAR(foot.z(), 0.0, 1e-9);
      for (const Vec3& other : feet) EXPECT_GE((foot - other).norm(), 2.4 - 1e-9) << seed;
      feet.push_back(foot);
    }
    EXPECT_GT(feet.size(), 30U) << seed;
  }
}

}  // namespace
}  // namespace jink::sim::families
