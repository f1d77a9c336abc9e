// SPDX-License-Identifier: BSD-3-Clause
// What is known beforehand: a yard with a house, zones in the way, and a map of thousands of cubes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/worlds/way_through.hpp"

namespace jink::worlds {
namespace {

config::Scenario yard(const std::string& more) {
  const support::Folder folder;
  return config::load_scenario(folder.write("s.yaml",
                                            "format: jink-scenario/1\n"
                                            "name: yard\n"
                                            "start: [0, 0, 1.5]\n"
                                            "target: [20, 0, 1.5]\n"
                                            "vehicle: ardrone2\n"
                                            "world: {min: [-2, -12, 0.3], max: [22, 12, 8]}\n"
                                            "estimate: none\n"
                                            "time_limit: 40\n" +
                                                more));
}

void expect_flown_beside(const config::Scenario& scenario) {
  EXPECT_LT(expect_flown_through(scenario).min_clearance, 3.0) << "the judge knows the map";
}

const std::string kHouse =
    "map:\n"
    "- {box: [6, 8, 6], position: [10, 1, 3]}\n"
    "- {box: [6.4, 9, 0.3], position: [10, 1, 6.2]}\n"
    "- {cylinder: {radius: 0.3, height: 8}, position: [5, -3.5, 4]}\n"
    "- {box: [60, 60, 0.2], position: [10, 0, -0.1]}\n"  // the ground, which is none of it
    "obstacles: []\n";

TEST(StaticWorlds, AHouseIsFlownAround) {
  expect_flown_beside(yard(kHouse));
  expect_planned_through(yard(kHouse), 1e-6);
}

TEST(StaticWorlds, WhoIsNotToldOfTheHouseHitsIt) {
  config::Scenario scenario = yard(kHouse);
  sim::flight::ClosedLoopOptions options;
  options.threads = 1;
  options.planner = blind_planner;
  const auto result = sim::flight::fly_closed_loop(scenario, config::Settings(), options);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kCollision);
  EXPECT_TRUE(result.flight.reason.starts_with("hit map solid 1")) << result.flight.reason;
}

TEST(StaticWorlds, ZonesAreFlownAround) {
  const std::string zones =
      "no_fly:\n"
      "- {polygon: [[7, -6], [9, -6], [9, 2], [13, 2], [13, 4], [7, 4]], min: 0, max: 20}\n"
      "- {polygon: [[15, -12], [16, -12], [16, -2], [15, -2]], min: -5, max: 20}\n"
      "obstacles: [{radius: 0.4, position: [5, -4, 1.5], velocity: [0, 0.8, 0]}]\n";
  expect_flown_beside(yard(zones));
  expect_planned_through(yard(zones), 1e-6);
}

TEST(StaticWorlds, AStartInTheMapIsBlocked) {
  const auto result = flown(yard("map: [{box: [1, 1, 9], position: [0.4, 0, 4]}]\nobstacles: []\n"));
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kStartBlocked);
}

// As a tree of cubes is: most of them are too far away to matter.
TEST(StaticWorlds, ThousandsOfCubesAreBearable) {
  config::Scenario scenario = yard("obstacles: []\n");
  for (double x = -60; x < 60; x += 1.0) {
    for (double z = 0.5; z < 60; z += 1.0) {
      if (z < 7.0 && x > 8 && x < 12) continue;  // its gate
      scenario.map.push_back({config::BoxShape{{0.9, 0.3, 0.9}}, config::LinearMotion{{x, 13, z}}});
      scenario.map.push_back({config::BoxShape{{0.3, 0.9, 0.9}}, config::LinearMotion{{10, x, z + 4}}});
    }
  }
  EXPECT_GT(scenario.map.size(), 13'000U);
  expect_flown_beside(scenario);
}

}  // namespace
}  // namespace jink::worlds
