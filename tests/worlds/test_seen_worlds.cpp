// SPDX-License-Identifier: BSD-3-Clause
// Worlds that nobody was told of: what stands is found by a depth camera or a lidar.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "sim/families/families.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/worlds/way_through.hpp"

namespace jink::worlds {
namespace {

config::Scenario unseen(const std::string& sensing, const std::string& more) {
  const support::Folder folder;
  return config::load_scenario(folder.write("s.yaml",
                                            "format: jink-scenario/1\n"
                                            "name: unseen\n"
                                            "start: [0, 0, 1.5]\n"
                                            "target: [20, 0, 1.5]\n"
                                            "vehicle: ardrone2\n"
                                            "world: {min: [-2, -12, 0.3], max: [24, 12, 4]}\n"
                                            "estimate: none\n"
                                            "time_limit: 90\n"
                                            "sensing: {" +
                                                sensing + "}\n" + more));
}

const std::string kWallWithADoor =
    "obstacles: []\n"
    "map:\n"
    "- {box: [0.2, 15, 6], position: [10, -4.5, 3]}\n"
    "- {box: [0.2, 7.2, 6], position: [10, 8.4, 3]}\n";

/// Told of a map, where `blind` does not leave that out.
sim::flight::ClosedLoopResult flown_with(const config::Scenario& scenario, int threads, std::size_t& most_boxes,
                                         bool blind = false) {
  /// How much was seen.
  struct Boxes final : bridge::companion::FlightObserver {
    std::size_t most = 0;
    void on_plan(double, const bridge::companion::PlanResult& result) override {
      if (result.job.map.seen != nullptr) most = std::max(most, result.job.map.seen->boxes.size());
    }
  } boxes;
  sim::flight::ClosedLoopOptions options;
  options.threads = threads;
  options.flight_observers = {&boxes};
  if (blind) options.planner = blind_planner;
  auto result = sim::flight::fly_closed_loop(scenario, config::Settings(), options);
  most_boxes = boxes.most;
  return result;
}

// The same bits at any number of threads; whoever does not look hits the wall.
TEST(SeenWorlds, AWallWithADoorIsFoundByACamera) {
  const config::Scenario scenario = unseen("scan: camera", kWallWithADoor);
  std::size_t boxes = 0;
  const auto result = flown_with(scenario, 1, boxes);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
  EXPECT_LT(result.min_clearance, 1.0) << "by the door";
  EXPECT_GT(boxes, 1U);
  EXPECT_LT(boxes, 100U) << "a wall is few boxes";
  const auto again = flown_with(scenario, 3, boxes);
  EXPECT_EQ(again.min_clearance, result.min_clearance);
  EXPECT_EQ(again.flight.path_length, result.flight.path_length);
  const auto blind = flown_with(scenario, 1, boxes, true);
  EXPECT_EQ(blind.flight.outcome, bridge::supervisor::Outcome::kCollision) << blind.flight.reason;
}

TEST(SeenWorlds, AWallWithADoorIsFoundByALidar) {
  expect_flown_through(unseen("scan: lidar", kWallWithADoor));
}

// Lamp posts beside a street that the vehicle does not look at when it begins; a ceiling that it never looks at.
TEST(SeenWorlds, NothingIsFlownIntoThatIsOutOfView) {
  for (const auto& [family, seed] : {std::pair("street", 1485606872U), {"office", 3682989115U}}) {
    config::Scenario scenario = sim::families::make_world(family, seed);
    sim::families::set_tier(scenario, sim::families::Tier::kCamera);
    scenario.obstacles.clear();
    std::size_t boxes = 0;
    const auto result = flown_with(scenario, 2, boxes);
    EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << family << ": " << result.flight.reason;
    EXPECT_GT(result.min_clearance, 0.0) << family;
  }
}

// It once looked at the target behind the wall, and not at the door in the other direction: so slow was it that it got
// nowhere within the time it looked ahead, and therefore flew as slowly as one that sees nothing, in 7 of 10 plans.
TEST(SeenWorlds, WhoFliesSlowlyLooksWhereHeFliesAllTheSame) {
  struct Slow final : bridge::companion::FlightObserver {
    int plans = 0, slow = 0;
    void on_plan(double, const bridge::companion::PlanResult& result) override {
      constexpr double kUnseeing = 0.3;  // m/s
      ++plans;
      slow += result.job.request.vehicle.cruise_speed <= kUnseeing ? 1 : 0;
    }
  } plans;
  config::Scenario scenario = sim::families::make_world("office", 1457262407);
  sim::families::set_tier(scenario, sim::families::Tier::kCamera);
  scenario.obstacles.clear();
  scenario.time_limit = 8.0;  // until it is in the door
  sim::flight::ClosedLoopOptions options;
  options.flight_observers = {&plans};
  (void)sim::flight::fly_closed_loop(scenario, config::Settings(), options);
  EXPECT_GT(plans.plans, 100);
  EXPECT_LT(plans.slow, 0.64 * plans.plans);
}

// A hall whose walls and ceiling are in range: what is behind the door is seen from the door.
TEST(SeenWorlds, WhoFliesOnlyWhereItWasSeenFindsTheDoorOfAHall) {
  const std::string hall = kWallWithADoor +
                           "- {box: [26, 24, 0.2], position: [11, 0, 4.2]}\n"
                           "- {box: [26, 0.2, 6], position: [11, 12.1, 3]}\n"
                           "- {box: [26, 0.2, 6], position: [11, -12.1, 3]}\n"
                           "- {box: [0.2, 24, 6], position: [-2.1, 0, 3]}\n"
                           "- {box: [0.2, 24, 6], position: [24.1, 0, 3]}\n";
  expect_flown_through(unseen("scan: {kind: camera, range: 25, unknown: occupied}", hall));
}

// Rays that meet nothing tell nothing: who flies only where it was seen stays in the room at the start.
TEST(SeenWorlds, WhoFliesOnlyWhereItWasSeenStaysWhereNothingIsSeen) {
  for (const char* unknown : {"free", "occupied"}) {
    config::Scenario scenario =
        unseen("scan: {kind: camera, unknown: " + std::string(unknown) + "}", "obstacles: []\n");
    scenario.time_limit = 20.0;
    const auto result = flown(scenario);
    const bool free = scenario.sensing.scan->unknown == config::Unknown::kFree;
    using bridge::supervisor::Outcome;
    EXPECT_EQ(result.flight.outcome, free ? Outcome::kReached : Outcome::kTimeout) << result.flight.reason;
    EXPECT_TRUE(free || result.flight.path_length < 3.0) << result.flight.path_length;
  }
}

}  // namespace
}  // namespace jink::worlds
