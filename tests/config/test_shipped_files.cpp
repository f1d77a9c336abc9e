// SPDX-License-Identifier: BSD-3-Clause
// Every YAML file of config/ loads, says what the paper says, and the default scenario is what its comment promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "config/mission.hpp"
#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "config/vehicle.hpp"
#include "tests/config/yaml_case.hpp"
#include "tests/support/same_scenario.hpp"

namespace jink::config {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(JINK_SOURCE_DIR) / "config";

std::vector<std::filesystem::path> files_in(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig / folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Scenario scenario(const std::string& name) {
  return load_scenario(kConfig / "scenarios" / (name + ".yaml"));
}

TEST(ShippedFiles, EveryVehicleLoads) {
  const auto files = files_in("vehicles");
  EXPECT_GE(files.size(), 2U);
  for (const auto& file : files) EXPECT_NO_THROW(static_cast<void>(load_vehicle(file))) << file;
}

TEST(ShippedFiles, EveryScenarioLoadsAndIsNamedAsItsFile) {
  const auto files = files_in("scenarios");
  EXPECT_GE(files.size(), 9U);
  for (const auto& file : files) EXPECT_EQ(load_scenario(file).name, file.stem().string());
}

TEST(ShippedFiles, EveryMissionLoadsAndIsNamedAsItsFile) {
  const auto files = files_in("missions");
  EXPECT_GE(files.size(), 2U);
  for (const auto& file : files) EXPECT_EQ(load_mission(file).name, file.stem().string());
}

TEST(ShippedFiles, ArDroneIsTheDefaultVehicle) {
  testing_support::expect_same(load_vehicle(kConfig / "vehicles" / "ardrone2.yaml"), planner::base::VehicleLimits{});
}

TEST(ShippedFiles, ConfigFolderIsTheSourceTrees) {
  EXPECT_TRUE(std::filesystem::equivalent(config_folder(), kConfig)) << config_folder();
}

/// A cell of the paper's tables, read by other means (cut and awk) than the files were made with: the sums of the x, y
/// and z components, and the sum of all components in reading order, each times its place, which notices a swap.
struct Cell {
  Vec3 sum;
  double weighted;
};

struct TableRow {
  std::string name;
  std::size_t obstacles;
  Vec3 start;
  Vec3 target;
  Cell positions;
  Cell speeds;
};

Cell summarise(const std::vector<Vec3>& vectors) {
  Cell cell{Vec3::Zero(), 0.0};
  int place = 0;
  for (const Vec3& v : vectors) {
    cell.sum += v;
    for (const double component : v) cell.weighted += ++place * component;
  }
  return cell;
}

void expect_cell(const Cell& actual, const Cell& expected) {
  constexpr double kRounding = 1e-9;  // of the sums; the tables have one decimal
  EXPECT_LT((actual.sum - expected.sum).norm(), kRounding) << actual.sum.transpose();
  EXPECT_NEAR(actual.weighted, expected.weighted, kRounding);
}

TEST(ShippedFiles, PaperScenariosHoldThePapersNumbers) {
  const std::vector<TableRow> rows = {
      {"table2-1", 5, {0, 0, 0}, {9, 8, 0}, {{21, 14, 8}, 307}, {{10, 2, 1}, 89}},
      {"table2-2", 9, {1, 2, 0}, {10, 10, 0}, {{56, 44, 18}, 1893}, {{13.5, -1, 6}, 235}},
      {"table2-3", 12, {1, 2, 0}, {13, 10, 0}, {{77, 57, 24}, 3395}, {{12.2, 13.5, 18}, 877.1}},
      {"table2-4", 15, {2, 4, 0}, {16, 13, 0}, {{86, 76, 32}, 5449}, {{16, 15, 16.5}, 1049.5}},
      {"table2-5", 20, {0, 0, 0}, {16, 15, 0}, {{184, 149, 40}, 11378}, {{28, 18.5, 21}, 1593.5}},
      {"table12-1", 5, {0, 0, 0}, {8, 8, 0}, {{15.5, 14.5, 6.5}, 229}, {{12, 0, 3.5}, 132}},
      {"table12-2", 5, {0, 0, 0}, {8, 8, 0}, {{17, 15, 5}, 230}, {{5, 6, 4}, 131}},
      {"table12-3", 5, {0, 0, 0}, {8, 8, 0}, {{17.5, 12.5, 5}, 246.5}, {{6, -1, 3}, 58}},
  };
  for (const TableRow& row : rows) {
    SCOPED_TRACE(row.name);
    const Scenario s = scenario(row.name);
    EXPECT_EQ(s.obstacles.size(), row.obstacles);
    EXPECT_EQ(s.start, row.start);
    EXPECT_EQ(s.target, row.target);
    EXPECT_EQ(s.vehicle_name, "ardrone2");
    EXPECT_FALSE(s.world.has_value());
    std::vector<Vec3> positions;
    std::vector<Vec3> speeds;
    for (const Obstacle& obstacle : s.obstacles) {
      EXPECT_EQ(std::get<SphereShape>(obstacle.shape).radius, 0.5);
      const auto motion = std::get<LinearMotion>(obstacle.motion);
      EXPECT_EQ(motion.acceleration, Vec3(0, 0, 0));
      positions.push_back(motion.position);
      speeds.push_back(motion.velocity);
    }
    expect_cell(summarise(positions), row.positions);
    expect_cell(summarise(speeds), row.speeds);
  }
}

TEST(ShippedFiles, SecondScenarioReadsThePapersMisprint) {
  EXPECT_EQ(std::get<LinearMotion>(scenario("table2-2").obstacles.at(1).motion).velocity, Vec3(3, -3, 1));
}

TEST(ShippedFiles, MissionsFlyToTheTargetsOfTheirScenarios) {
  const Mission sitl = load_mission(kConfig / "missions" / "sitl.yaml");
  const Scenario crossing = scenario("crossing");
  EXPECT_EQ(sitl.waypoints.back(), crossing.target);
  EXPECT_EQ(sitl.takeoff_height, crossing.start.z());
  EXPECT_EQ(sitl.vehicle_name, crossing.vehicle_name);
  const Mission table = load_mission(kConfig / "missions" / "table2-1.yaml");
  EXPECT_EQ(table.waypoints.back(), scenario("table2-1").target);
}

// The motions as scenario.hpp defines them, written down once more for the shapes and motions of crossing.yaml; the
// simulator's own are tested against these definitions in tests/sim.
double reflected(double position, double velocity, double min, double max, double t) {
  if (min == max) return position;
  const double width = max - min;
  const double travelled = position - min + velocity * t;
  const double folded = travelled - 2.0 * width * std::floor(travelled / (2.0 * width));
  return min + (folded <= width ? folded : 2.0 * width - folded);
}

Vec3 position_at(const Motion& motion, double t) {
  if (const auto* const linear = std::get_if<LinearMotion>(&motion)) {
    return linear->position + linear->velocity * t + 0.5 * linear->acceleration * t * t;
  }
  if (const auto* const sine = std::get_if<SineMotion>(&motion)) {
    const Eigen::Array3d angle = 2.0 * std::numbers::pi * t * sine->frequency_hz.array() + sine->phase.array();
    return sine->center + (sine->amplitude.array() * angle.sin()).matrix();
  }
  const auto& bounce = std::get<BounceMotion>(motion);
  Vec3 p;
  for (Eigen::Index i = 0; i < 3; ++i) {
    p[i] = reflected(bounce.position[i], bounce.velocity[i], bounce.min[i], bounce.max[i], t);
  }
  return p;
}

double gap_at(const Scenario& s, const Obstacle& obstacle, const Vec3& vehicle, double t) {
  const double radii = std::get<SphereShape>(obstacle.shape).radius + s.vehicle.radius;
  return (position_at(obstacle.motion, t) - vehicle).norm() - radii;
}

/// The smallest gap between a vehicle that stays at `p` from t = from to t = to and any obstacle.
double gap_while_still(const Scenario& s, const Vec3& p, double from, double to) {
  double smallest = planner::base::kInfinity;
  for (double t = from; t <= to; t += 0.01) {
    for (const Obstacle& obstacle : s.obstacles) smallest = std::min(smallest, gap_at(s, obstacle, p, t));
  }
  return smallest;
}

/// The obstacles that a vehicle meets which flies straight from start to target, from rest at `acceleration`.
std::size_t hits_on_straight_line(const Scenario& s, double speed, double acceleration) {
  const Vec3 along = s.target - s.start;
  const double length = along.norm();
  const double ramp = speed / acceleration;  // 0 for an infinite acceleration: constant speed
  std::set<std::size_t> hit;
  for (double t = 0.0;; t += 0.005) {
    const double way = t < ramp ? 0.5 * acceleration * t * t : speed * (t - 0.5 * ramp);
    if (way > length) return hit.size();
    const Vec3 p = s.start + along * (way / length);
    for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
      if (gap_at(s, s.obstacles[i], p, t) < 0.0) hit.insert(i);
    }
  }
}

TEST(CrossingScenario, HitsWhoeverFliesStraight) {
  const Scenario s = scenario("crossing");
  EXPECT_EQ(s.obstacles.size(), 8U);
  for (const double speed : {1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0}) {
    EXPECT_GE(hits_on_straight_line(s, speed, planner::base::kInfinity), 3U) << speed;
    EXPECT_GE(hits_on_straight_line(s, speed, s.vehicle.max_acceleration), 3U) << speed << " from rest";
  }
}

TEST(CrossingScenario, LeavesStartAndTargetFree) {
  const Scenario s = scenario("crossing");
  EXPECT_GT(gap_while_still(s, s.start, 0.0, 2.0), 1.5);
  EXPECT_GT(gap_while_still(s, s.target, 4.0, s.time_limit + 60.0), 1.2);
}

// Up, over everything at 4.5 m with the target's height again at the end: well clear all the way, so that a planner
// that fails here has no excuse.
TEST(CrossingScenario, HasAFreeWayOver) {
  const Scenario s = scenario("crossing");
  const std::vector<Vec3> way = {s.start, {3, 0, 4.5}, {18, 0, 4.5}, s.target};
  double t = 0.0;
  double smallest = planner::base::kInfinity;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vec3 leg = way[i] - way[i - 1];
    const double speed = std::min(s.vehicle.cruise_speed, s.vehicle.max_climb * leg.norm() / std::abs(leg.z()));
    const double duration = leg.norm() / speed;
    for (double u = 0.0; u <= duration; u += 0.01) {
      for (const Obstacle& obstacle : s.obstacles) {
        smallest = std::min(smallest, gap_at(s, obstacle, way[i - 1] + leg * (u / duration), t + u));
      }
    }
    t += duration;
  }
  EXPECT_GT(smallest, 0.6);
  EXPECT_LT(t, s.time_limit);
}

TEST(CrossingScenario, KeepsItsObstaclesInTheWorldUntilTheyHaveCrossed) {
  const Scenario s = scenario("crossing");
  ASSERT_TRUE(s.world.has_value());
  for (const Obstacle& obstacle : s.obstacles) {
    const bool passing = std::holds_alternative<LinearMotion>(obstacle.motion);
    for (double t = 0.0; t <= (passing ? 10.0 : s.time_limit); t += 0.05) {
      EXPECT_TRUE(s.world->contains(position_at(obstacle.motion, t))) << t;
    }
  }
}

}  // namespace
}  // namespace jink::config
