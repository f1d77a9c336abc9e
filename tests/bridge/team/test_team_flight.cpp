// SPDX-License-Identifier: BSD-3-Clause
// Vehicles of a team meet, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/bridge/team/team_flight.hpp"

namespace jink::bridge::team {
namespace {

constexpr double kClear = 0.2;  // m between the spheres: 0.35 is planned for, the rest is what tracking errors take

bool said(const Flown& flown, const std::string& name) {
  return std::any_of(flown.events.begin(), flown.events.end(), [&](const auto& event) { return event.first == name; });
}

void expect_clear(const std::vector<Vehicle>& vehicles, const Options& options, double in_time) {
  const Result result = fly(vehicles, {}, options);
  EXPECT_TRUE(result.all_reached()) << "seed " << options.seed;
  EXPECT_GT(result.least_clearance, kClear) << "seed " << options.seed << " at " << result.at;
  EXPECT_LT(result.last_arrival(), in_time) << "seed " << options.seed;
}

TEST(TeamFlight, TwoSwapPlaces) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_clear(swapping(), {.seed = seed}, 12.0);
}

TEST(TeamFlight, FourCrossACircle) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_clear(crossing(), {.seed = seed}, 12.0);
}

TEST(TeamFlight, SixCrossACircle) {
  expect_clear(crossing(6), {.seed = 1}, 14.0);
}

TEST(TeamFlight, MessagesMayBeLateAndLost) {
  const Options options{.seed = 1, .delay = 0.2, .jitter = 0.1, .loss = 0.2};
  expect_clear(swapping(), options, 12.0);
  expect_clear(crossing(), options, 12.0);
}

TEST(TeamFlight, ClocksMayBeAnHourApart) {
  const Options options{.seed = 1, .delay = 0.05, .jitter = 0.05, .loss = 0.1, .clock_offset = 3600.0};
  expect_clear(swapping(), options, 12.0);
  expect_clear(crossing(), options, 12.0);
}

TEST(TeamFlight, WithoutIntentsTheSameVehiclesCollide) {
  std::vector<Vehicle> vehicles = swapping();
  for (Vehicle& vehicle : vehicles) vehicle.intents = false;
  EXPECT_LT(fly(vehicles, {}, {}).least_clearance, 0.0);
}

TEST(TeamFlight, EachMayHaveAnOriginOfItsOwn) {
  std::vector<Vehicle> vehicles = swapping();
  vehicles[1].origin = {300.0, -200.0, 3.0};
  expect_clear(vehicles, {}, 12.0);
}

TEST(TeamFlight, APathThatCannotBePlacedIsReportedByTheOneWhoHearsIt) {
  std::vector<Vehicle> vehicles = swapping();
  vehicles[1].knows_origin = false;
  vehicles[1].target.y() = 6.0;  // apart: nobody can see the other
  vehicles[1].start.y() = 6.0;
  const Result result = fly(vehicles, {}, {});
  EXPECT_TRUE(result.all_reached());
  for (const Flown& flown : result.vehicles) {
    EXPECT_TRUE(said(flown, "team_unplaced"));
    EXPECT_FALSE(said(flown, "team_vehicle"));
  }
}

TEST(TeamFlight, TwoOfTheSameNameAreReportedAndAvoided) {
  std::vector<Vehicle> vehicles = swapping();
  vehicles[0].system_id = vehicles[1].system_id = 5;
  const Result result = fly(vehicles, {}, {});
  EXPECT_TRUE(result.all_reached());
  EXPECT_GT(result.least_clearance, 0.0);
  for (const Flown& flown : result.vehicles) EXPECT_TRUE(said(flown, "team_same_id"));
}

TEST(TeamFlight, OneWithTheRightOfWayAvoidsOneThatDoesNotGiveWay) {
  for (const std::size_t deaf : {0U, 1U}) {
    std::vector<Vehicle> vehicles = swapping();
    vehicles[deaf].listens = false;
    expect_clear(vehicles, {}, 12.0);
  }
}

TEST(TeamFlight, OneThatFallsSilentStaysOnItsPathAndThenGoes) {
  std::vector<Vehicle> vehicles = swapping();
  vehicles[0].silent_from = 2.5;  // they pass at 4
  vehicles[0].listens = false;
  const Result result = fly(vehicles, {}, {});
  EXPECT_TRUE(result.all_reached());
  EXPECT_GT(result.least_clearance, kClear);
  EXPECT_TRUE(said(result.vehicles[1], "team_lost"));
}

TEST(TeamFlight, RepeatsBitByBit) {
  const Options options{.seed = 3, .jitter = 0.1, .loss = 0.1};
  const Result once = fly(swapping(), {}, options);
  Options more = options;
  more.threads = 2;
  const Result again = fly(swapping(), {}, more);
  EXPECT_EQ(once.least_clearance, again.least_clearance);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(once.vehicles[i].summary.path_length, again.vehicles[i].summary.path_length);
    EXPECT_EQ(once.vehicles[i].arrived, again.vehicles[i].arrived);
  }
}

}  // namespace
}  // namespace jink::bridge::team
