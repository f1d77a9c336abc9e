// SPDX-License-Identifier: BSD-3-Clause
#include "config/scenario_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "config/error.hpp"
#include "tests/config/yaml_case.hpp"
#include "tests/support/same_scenario.hpp"

namespace jink::config {
namespace {

using testing_support::expect_same;

Scenario read_back(const Scenario& scenario) {
  const Folder folder;
  return load_scenario(folder.write("s.yaml", to_yaml(scenario)));
}

Scenario smallest() {
  Scenario scenario;
  scenario.name = "smallest";
  scenario.target = {1, 0, 0};
  scenario.time_limit = 10;
  scenario.vehicle_name = "ardrone2";
  return scenario;
}

/// A number that takes all 17 digits.
double awkward(int i) {
  return std::nextafter(0.1 * i, 1.0) + 1.0 / 3.0;
}

Vec3 awkward_vector(int i) {
  return {awkward(i), -awkward(i + 1), awkward(i + 2)};
}

TEST(ToYaml, EveryShippedScenarioReadsBack) {
  const std::filesystem::path folder = std::filesystem::path(JINK_SOURCE_DIR) / "config" / "scenarios";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    const Scenario scenario = load_scenario(entry.path());
    expect_same(scenario, read_back(scenario));
    ++count;
  }
  EXPECT_GE(count, 9);
}

TEST(ToYaml, EveryShapeAndMotionReadsBackBitForBit) {
  Scenario scenario = smallest();
  scenario.acceptance_radius = awkward(8);
  scenario.hold_time = awkward(7);
  const LinearMotion linear{awkward_vector(1), awkward_vector(2), awkward_vector(3)};
  const BounceMotion bounce{{0.5, 0, 1e-300}, awkward_vector(4), {0, -1, 0}, {1, 1, 1}};
  const SineMotion sine{awkward_vector(5), awkward_vector(6), {0, 1.0 / 3.0, 7}, awkward_vector(7)};
  scenario.obstacles = {{SphereShape{awkward(1)}, linear},
                        {BoxShape{{awkward(1), awkward(2), 3}},
                         TrefoilMotion{awkward_vector(1), awkward_vector(2), 1.1, -std::numbers::pi}},
                        {VertexShape{{awkward_vector(1), awkward_vector(2)}}, sine},
                        {CylinderShape{awkward(4), awkward(5)}, sine, awkward_vector(6), -awkward(7)},
                        {CapsuleShape{awkward(4), awkward_vector(5), awkward_vector(6)}, linear, {0, 0, awkward(8)}},
                        {SphereShape{12345678.0 / 1e5}, bounce},
                        {SphereShape{1}, WaypointsMotion{{0, awkward(3)}, {awkward_vector(8), awkward_vector(9)}}},
                        {SphereShape{1}, ChaseMotion{awkward_vector(3), awkward(2)}},
                        {SphereShape{1}, LinearMotion{{1, 2, -0.0}, {-0.0, 0, 0}}}};
  scenario.sensing.scan = Scan{awkward(9), awkward(9), 3, 4, awkward(9), awkward(9), 0.02, Unknown::kOccupied};
  const Scenario again = read_back(scenario);
  expect_same(scenario, again);
  const auto& last = std::get<LinearMotion>(again.obstacles.back().motion);
  EXPECT_TRUE(std::signbit(last.position.z()));
  EXPECT_TRUE(std::signbit(last.velocity.x()));
}

TEST(ToYaml, ConditionsAndFurtherVehiclesReadBack) {
  Scenario scenario = smallest();
  scenario.name = "\"quoted\" \\ # not a comment: {1}";
  scenario.world = planner::base::Box{{-10, -10, 0}, {awkward(100), 10, 10}};
  scenario.sensing = {7.0, 19.0, 0.1, awkward(1), 0.3, 0.05};
  scenario.wind = {awkward_vector(1), 0.5, 3.0};
  scenario.estimate = {false, 0.1, 0.2, 0.3, awkward(7)};
  ScenarioVehicle named{{5, 5, 1}, {-5, -5, 1}, "ardrone2", {}};
  ScenarioVehicle own{{-5, 5, 1}, {5, -5, 1}, "inline", {}};
  own.vehicle.max_speed = awkward(60);
  scenario.vehicles = {named, own};
  expect_same(scenario, read_back(scenario));
}

TEST(ToYaml, EveryFaultReadsBack) {
  Scenario scenario = smallest();
  for (int kind = 0; kind <= static_cast<int>(FaultKind::kRefuseOffboard); ++kind) {
    Fault fault;
    fault.kind = static_cast<FaultKind>(kind);
    fault.at = awkward(kind);
    if (!fault.instantaneous()) fault.duration = awkward(3);
    if (fault.of_vehicle()) fault.vehicle = 0;
    switch (fault.kind) {
      case FaultKind::kLinkLoss:
        fault.direction = LinkDirection::kUp;
        break;
      case FaultKind::kPacketLoss:
      case FaultKind::kReorder:
        fault.direction = LinkDirection::kDown;
        fault.rate = awkward(1);
        break;
      case FaultKind::kDelay:
        fault.seconds = awkward(2);
        break;
      case FaultKind::kEstimateJump:
        fault.by = awkward_vector(1);
        break;
      case FaultKind::kTrackNoise:
        fault.position = awkward(1);
        fault.velocity = awkward(2);
        break;
      case FaultKind::kTracksFlood:
        fault.count = 1234;
        break;
      case FaultKind::kTracksClock:
        fault.offset = -awkward(1);
        break;
      case FaultKind::kPilotMode:
        fault.mode = PilotMode::kReturn;
        break;
      case FaultKind::kLowBattery:
        fault.remaining = awkward(2);
        break;
      default:
        break;
    }
    scenario.faults.push_back(fault);
  }
  expect_same(scenario, read_back(scenario));
}

// A name whose file says other limits would change the scenario without a word.
TEST(ToYaml, LimitsThatAreNotTheNamedVehiclesAreWrittenOut) {
  Scenario scenario = smallest();
  scenario.vehicle.cruise_speed = 1.25;
  const Scenario again = read_back(scenario);
  EXPECT_EQ(again.vehicle.cruise_speed, 1.25);
  EXPECT_EQ(again.vehicle_name, "inline");
  scenario.vehicle_name = "../vehicles/ardrone2";
  EXPECT_EQ(read_back(scenario).vehicle_name, "inline");
}

TEST(ToYaml, WhatTheLoaderWouldRefuseIsRefusedByIt) {
  Scenario scenario = smallest();
  scenario.time_limit = -1;
  EXPECT_THROW(read_back(scenario), ConfigError);
}

}  // namespace
}  // namespace jink::config
