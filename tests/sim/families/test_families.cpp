// SPDX-License-Identifier: BSD-3-Clause
#include "sim/families/families.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "config/scenario_writer.hpp"
#include "sim/world/world.hpp"
#include "tests/support/same_scenario.hpp"

namespace jink::sim::families {
namespace {

constexpr std::uint64_t kSeeds = 20;

class WorldFamily : public ::testing::TestWithParam<std::string_view> {};
/// All but the literature's corridors, for which see test_world_corridors.cpp.
class OwnFamily : public WorldFamily {};
/// Those blocked by an obstacle, not by another vehicle (likewise).
class BlockedFamily : public WorldFamily {};

std::vector<std::string_view> own_families() {
  std::vector<std::string_view> families(world_families().begin(), world_families().end());
  std::erase_if(families, [](std::string_view family) { return !blocks_straight_line(family); });
  return families;
}

std::vector<std::string_view> families_blocked_by_obstacles() {
  std::vector<std::string_view> families = own_families();
  std::erase_if(families, [](std::string_view family) { return !make_world(family, 1).vehicles.empty(); });
  return families;
}

/// All numbers of a world in one list, so that two worlds can be compared.
std::vector<double> numbers_of(const config::Scenario& scenario) {
  std::vector<double> numbers = {scenario.time_limit};
  const auto add = [&](const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); };
  add(scenario.start);
  add(scenario.target);
  if (scenario.world) {
    add(scenario.world->min);
    add(scenario.world->max);
  }
  const world::World world(scenario);
  for (int i = 0; i < world.obstacle_count(); ++i) {
    for (const double t : {0.0, 1.0, 7.5, 30.0}) {
      numbers.push_back(world.sphere(i, t).radius);
      add(world.sphere(i, t).center);
    }
  }
  return numbers;
}

// The straight flight's place, worked out apart from the code under test: the lesser of what speeding up from the
// start, braking to the target and the cruise speed allow is never exceeded, and one of them always holds.
double straight_speed(double along, double length, double cruise) {
  return std::min({cruise, std::sqrt(2 * kStraightAcceleration * along),
                   std::sqrt(2 * kStraightBraking * std::max(0.0, length - along))});
}

double straight_clearance(const world::World& world) {
  const config::Scenario& scenario = world.scenario();
  const Vec3 way = scenario.target - scenario.start;
  const double length = way.norm();
  const double steep = std::abs(way.z()) / length;
  const double cruise = std::min(scenario.vehicle.cruise_speed, scenario.vehicle.max_climb / std::max(steep, 1e-9));
  double nearest = planner::base::kInfinity;
  double t = 0;
  constexpr double kStep = 0.02;  // m
  for (double along = 0; along < length; along += kStep) {
    const double to = std::min(along + kStep, length);
    const double mean = 0.5 * (straight_speed(along, length, cruise) + straight_speed(to, length, cruise));
    const double next = t + (to - along) / mean;  // exact, as the acceleration is constant
    const Vec3 from_point = scenario.start + along / length * way;
    const Vec3 to_point = scenario.start + to / length * way;
    nearest = std::min(nearest, world.sweep(from_point, t, to_point, next).min_clearance);
    t = next;
  }
  return nearest;
}

TEST_P(WorldFamily, SameSeedSameWorld) {
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{77}, ~std::uint64_t{0}}) {
    EXPECT_EQ(numbers_of(make_world(GetParam(), seed)), numbers_of(make_world(GetParam(), seed)));
  }
}

TEST_P(WorldFamily, SeedsDiffer) {
  std::vector<std::vector<double>> worlds;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) worlds.push_back(numbers_of(make_world(GetParam(), seed)));
  std::sort(worlds.begin(), worlds.end());
  EXPECT_EQ(std::adjacent_find(worlds.begin(), worlds.end()), worlds.end());
}

TEST_P(WorldFamily, StartsAreClear) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    config::Scenario scenario = make_world(GetParam(), seed);
    scenario.map.clear();  // of which see test_places.cpp
    const world::World world(scenario);
    const std::vector<config::ScenarioVehicle> team = config::all_vehicles(world.scenario());
    for (std::size_t k = 0; k < team.size(); ++k) {
      EXPECT_GE(world.clearance(team[k].start, 0.0, team[k].vehicle.radius), kStartClearance) << seed;
      for (std::size_t j = 0; j < k; ++j)
        EXPECT_GE((team[k].start - team[j].start).norm(), kStartClearance + 2 * team[k].vehicle.radius) << seed;
    }
  }
}

TEST_P(OwnFamily, MissionIsInTheWorldAndOfItsLength) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const config::Scenario scenario = make_world(GetParam(), seed);
    const world::World world(scenario);
    EXPECT_TRUE(world.inside(scenario.start)) << seed;
    EXPECT_TRUE(world.inside(scenario.target)) << seed;
    EXPECT_GE(std::min(scenario.start.z(), scenario.target.z()), 1.0) << seed;
    const double length = (scenario.target - scenario.start).norm();
    EXPECT_GE(length, 15.0 - 1e-9) << seed;
    EXPECT_LE(length, 40.0 + 1e-9) << seed;
    EXPECT_DOUBLE_EQ(scenario.time_limit, 10 * length / scenario.vehicle.max_speed + 30) << seed;
    EXPECT_EQ(scenario.vehicle_name, "ardrone2");
    EXPECT_EQ(scenario.name, std::string(GetParam()) + "-" + std::to_string(seed));
  }
}

TEST_P(BlockedFamily, StraightFlightIsHit) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    EXPECT_LT(straight_clearance(world::World(make_world(GetParam(), seed))), -kStraightOverlap) << seed;
  }
}

TEST_P(WorldFamily, MotionIsAsDeclared) {
  bool all_linear = !make_world(GetParam(), 1).obstacles.empty();
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    for (const config::Obstacle& obstacle : make_world(GetParam(), seed).obstacles) {
      const auto* motion = std::get_if<config::LinearMotion>(&obstacle.motion);
      all_linear = all_linear && motion != nullptr && motion->acceleration.isZero(0.0);
      EXPECT_LE(world::speed_bound(obstacle.motion, 0.0, 100.0), 9.0 + 1e-9) << seed;
      if (const auto* bounce = std::get_if<config::BounceMotion>(&obstacle.motion)) {
        EXPECT_TRUE((planner::base::Box{bounce->min, bounce->max}).contains(bounce->position)) << seed;
      }
    }
  }
  EXPECT_EQ(all_linear, is_linear(GetParam()));
}

// As a failed flight's world is kept, so that it can be flown again.
TEST_P(WorldFamily, ReadsBackFromYamlInEachTier) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) /
                                     ("jink_" + std::string(GetParam()) + "_" + std::to_string(getpid()) + ".yaml");
  // Of these a file has each step of each mover, which takes seconds to read.
  const bool long_file = GetParam().starts_with("fcp_") || GetParam().starts_with("fapp_");
  const auto tiers = long_file
                         ? std::vector{Tier::kField}
                         : std::vector{Tier::kCamera, Tier::kField, Tier::kLidar, Tier::kPerfect, Tier::kRealistic};
  for (const Tier tier : tiers) {
    for (std::uint64_t seed = 1; seed <= (long_file ? 1 : 3); ++seed) {
      config::Scenario scenario = make_world(GetParam(), seed);
      set_tier(scenario, tier, seed);
      std::ofstream(file) << config::to_yaml(scenario);
      testing_support::expect_same(scenario, config::load_scenario(file));
    }
  }
  std::filesystem::remove(file);
}

TEST_P(WorldFamily, IsMadeWithPerfectSensing) {
  const config::Scenario scenario = make_world(GetParam(), 1);
  config::Scenario perfect = scenario;
  set_tier(perfect, Tier::kPerfect);
  EXPECT_EQ(scenario.sensing, perfect.sensing);
  const std::map<std::string_view, double> ranges{{"late", 7.0}, {"fapp_50", 8.0}};
  EXPECT_EQ(scenario.sensing.range, ranges.contains(GetParam()) ? ranges.at(GetParam()) : planner::base::kInfinity);
}

std::string name_of(const ::testing::TestParamInfo<std::string_view>& family) {
  return std::string(family.param);
}

INSTANTIATE_TEST_SUITE_P(All, WorldFamily, ::testing::ValuesIn(world_families().begin(), world_families().end()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Others, WorldFamily, ::testing::ValuesIn(others_families().begin(), others_families().end()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(All, OwnFamily, ::testing::ValuesIn(own_families()), name_of);
INSTANTIATE_TEST_SUITE_P(All, BlockedFamily, ::testing::ValuesIn(families_blocked_by_obstacles()), name_of);

TEST(WorldFamilies, DistinctNames) {
  const std::vector<std::string_view> names(world_families().begin(), world_families().end());
  EXPECT_GE(names.size(), 25U);
  for (const std::string_view name : names) EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}

TEST(WorldFamilies, UnknownNameThrows) {
  EXPECT_THROW((void)make_world("crossings", 1), std::invalid_argument);
  EXPECT_THROW((void)make_world("", 1), std::invalid_argument);
  EXPECT_FALSE(is_linear("crossings"));
  EXPECT_FALSE(blocks_straight_line("crossings"));
  EXPECT_FALSE(has_map("crossings"));
}

TEST(Tiers, RealisticIsTheIssuesAndKeepsASmallerRange) {
  config::Scenario scenario = make_world("crossing", 1);
  set_tier(scenario, Tier::kRealistic);
  EXPECT_EQ(scenario.sensing, (config::Sensing{12.0, 20.0, 0.1, 0.1, 0.3, 0.05}));
  config::Scenario late = make_world("late", 1);
  set_tier(late, Tier::kRealistic);
  EXPECT_EQ(late.sensing, (config::Sensing{7.0, 20.0, 0.1, 0.1, 0.3, 0.05}));
  set_tier(late, Tier::kPerfect);
  EXPECT_EQ(late.sensing, (config::Sensing{7.0, 20.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(late.estimate, config::EstimateErrors{.px4 = false});
  EXPECT_EQ(to_string(Tier::kCamera), "camera");
  EXPECT_EQ(to_string(Tier::kField), "field");
  EXPECT_EQ(to_string(Tier::kLidar), "lidar");
  EXPECT_EQ(to_string(Tier::kPerfect), "perfect");
  EXPECT_EQ(to_string(Tier::kRealistic), "realistic");
}

TEST(Tiers, ACameraOrALidarIsToFindTheMap) {
  config::Scenario scenario = make_world("office", 1);
  config::Sensing expected;
  set_tier(scenario, Tier::kCamera);
  expected.scan = config::depth_camera();
  EXPECT_EQ(scenario.sensing, expected);
  set_tier(scenario, Tier::kLidar);
  expected.scan = config::lidar();
  EXPECT_EQ(scenario.sensing, expected);
  EXPECT_EQ(scenario.estimate, config::EstimateErrors{.px4 = false});
}

TEST(Tiers, FieldHasPx4sEstimateOnboardSensingAndWindFromAnywhere) {
  config::Scenario scenario = make_world("crossing", 1);
  set_tier(scenario, Tier::kField, 1);
  config::Sensing expected{12.0, 20.0, 0.1, 0.1, 0.3, 0.05};
  expected.sensed_from = config::SensedFrom::kVehicle;
  EXPECT_EQ(scenario.sensing, expected);
  EXPECT_TRUE(scenario.estimate.px4);
  EXPECT_NEAR(scenario.wind.mean.norm(), 3.0, 1e-12);
  EXPECT_NEAR(scenario.wind.gust * std::sqrt(3.0), 1.0, 1e-12);
  const Vec3 wind = scenario.wind.mean;
  set_tier(scenario, Tier::kField, 2);
  EXPECT_GT((scenario.wind.mean - wind).norm(), 0.1);
  set_tier(scenario, Tier::kPerfect, 2);
  EXPECT_EQ(scenario.wind, config::Wind{});
  EXPECT_EQ(scenario.estimate, config::EstimateErrors{.px4 = false});
  // Vehicles that share the tracks get an external tracker's.
  config::Scenario team = make_world("antipodal", 1);
  set_tier(team, Tier::kField, 1);
  EXPECT_EQ(team.sensing.sensed_from, config::SensedFrom::kWorld);
}

}  // namespace
}  // namespace jink::sim::families
