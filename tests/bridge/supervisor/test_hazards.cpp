// SPDX-License-Identifier: BSD-3-Clause
// The table of hazards, row by row, and the patience with one that lasts.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "bridge/supervisor/hazards.hpp"

namespace jink::bridge::supervisor {
namespace {

constexpr double kNow = 20.0;

/// A flight in which nothing is wrong.
struct Calm {
  Calm() {
    state.heartbeat_stamp = state.motion.stamp = state.motion.received = kNow;
    state.local_position_ok = true;
    flight.newest_tracks = flight.newest_plan = kNow;
  }
  [[nodiscard]] Situation situation() const {
    return {kNow, state, flight, tracks, settings, failsafe, following_since};
  }
  [[nodiscard]] const Hazard* find(Hazard::Reaction reaction) const { return find_hazard(reaction, situation()); }

  vehicle::VehicleState state;
  FlightContext flight;
  config::TrackPolicy tracks;
  SupervisorSettings settings;
  bool failsafe = false;
  std::optional<double> following_since = 10.0;
};

struct Case {
  const char* what;
  std::function<void(Calm&)> begins;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"the battery is critical", [](Calm& c) { c.state.battery = vehicle::BatteryState::kCritical; }},
      {"the vehicle's position is stale",
       [](Calm& c) { c.state.motion.stamp = c.state.motion.received = kNow - 0.21; }},
      {"the vehicle's position comes too late", [](Calm& c) { c.state.motion.stamp = kNow - 0.51; }},
      {"the autopilot's heartbeat is missing", [](Calm& c) { c.state.heartbeat_stamp = kNow - 5.1; }},
      {"the autopilot's failsafe flies", [](Calm& c) { c.failsafe = true; }},
      {"the autopilot has lost its position", [](Calm& c) { c.state.local_position_ok = false; }},
      {"the autopilot has lost its GPS", [](Calm& c) { c.state.gps_lost = true; }},
      {"a crewed aircraft comes too near", [](Calm& c) { c.flight.aircraft_comes = true; }},
      {"the vehicle has left the geofence", [](Calm& c) { c.flight.outside = 1.1; }},
      {"the vehicle is above the geofence", [](Calm& c) { c.flight.above = 1.1; }},
      {"the vehicle cannot follow its setpoints", [](Calm& c) { c.flight.cannot_follow = true; }},
      {"the obstacle tracks are stale", [](Calm& c) { c.flight.newest_tracks = kNow - 1.1; }},
      {"a writer of obstacle tracks has fallen silent", [](Calm& c) { c.flight.lost_writers = 1; }},
      {"the clouds of points are stale", [](Calm& c) { c.flight.blind = true; }},
      {"setpoints cannot be sent", [](Calm& c) { c.flight.unsent_for = 0.21; }},
      {"the planner is late", [](Calm& c) { c.flight.newest_plan = kNow - 0.31; }},
  };
  return all;
}

TEST(Hazards, EachRowIsFoundInItsSituationAlone) {
  ASSERT_EQ(hazards().size(), cases().size());
  for (std::size_t i = 0; i < cases().size(); ++i) {
    SCOPED_TRACE(cases()[i].what);
    Calm calm;
    for (const Hazard& row : hazards()) EXPECT_FALSE(row.present(calm.situation())) << row.what;
    cases()[i].begins(calm);
    for (const Hazard& row : hazards())
      EXPECT_EQ(row.present(calm.situation()), row.what == cases()[i].what) << row.what;
    EXPECT_EQ(calm.find(hazards()[i].reaction), &hazards()[i]);
  }
}

TEST(Hazards, OnlyACriticalBatteryEndsTheFlightAtOnce) {
  const config::Endings defaults;
  for (const Hazard& row : hazards()) {
    const bool battery = row.what == "the battery is critical";
    const bool lands = battery || row.what == "a crewed aircraft comes too near";
    EXPECT_EQ(row.reaction == Hazard::Reaction::kStop, battery) << row.what;
    EXPECT_EQ(defaults.*row.ends_in, lands ? config::EndsIn::kLand : config::EndsIn::kHold) << row.what;
  }
}

// Each cause of the mission's endings is that of a hazard.
TEST(Hazards, EveryEndingOfAMissionIsOneOfAHazard) {
  using E = config::Endings;
  for (const auto member : {&E::tracks, &E::link, &E::position, &E::battery, &E::breach, &E::traffic, &E::planner}) {
    const auto rows = hazards();
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [&](const Hazard& row) { return row.ends_in == member; }));
  }
}

TEST(Hazards, OnlyWhatDoesNotWaitDecidesHowAStoppedFlightEnds) {
  for (std::size_t i = 0; i < cases().size(); ++i) {
    Calm calm;
    EXPECT_EQ(find_deciding(calm.situation()), nullptr);
    cases()[i].begins(calm);
    const bool decides =
        hazards()[i].what == "the battery is critical" || hazards()[i].what == "a crewed aircraft comes too near";
    EXPECT_EQ(find_deciding(calm.situation()), decides ? &hazards()[i] : nullptr);
  }
}

TEST(Hazards, TracksAreNoneWhereTheMissionDoesNotRequireThem) {
  Calm calm;
  calm.tracks.required = false;
  calm.flight.newest_tracks.reset();
  calm.flight.lost_writers = 1;
  EXPECT_EQ(calm.find(Hazard::Reaction::kBrake), nullptr);
  calm.tracks.required = true;
  EXPECT_EQ(calm.find(Hazard::Reaction::kBrake)->what, "the obstacle tracks are stale");
}

TEST(Hazards, APlanIsWaitedForOnlyWhereOneIsFollowed) {
  Calm calm;
  calm.flight.newest_plan.reset();
  EXPECT_EQ(calm.find(Hazard::Reaction::kBrake)->what, "the planner is late");
  calm.following_since = kNow - 0.2;  // the first has its time
  EXPECT_EQ(calm.find(Hazard::Reaction::kBrake), nullptr);
  calm.following_since.reset();
  EXPECT_EQ(calm.find(Hazard::Reaction::kBrake), nullptr);
}

TEST(HazardWatch, NamesTheFailsafesModeAndGivesUpAfterItsTime) {
  Calm calm;
  calm.failsafe = true;
  calm.state.mode = vehicle::FlightMode::kAltitude;
  HazardWatch watch;
  watch.advance(kNow);
  watch.see(calm.find(Hazard::Reaction::kBrake), calm.situation());
  EXPECT_EQ(watch.text(), "the autopilot's failsafe flies, mode altitude");
  EXPECT_EQ(watch.given_up(kNow + 3.0, 3.0), "");
  EXPECT_EQ(watch.given_up(kNow + 3.1, 3.0), watch.text());
  watch.see(nullptr, calm.situation());
  EXPECT_EQ(watch.text(), "");
  EXPECT_EQ(watch.given_up(kNow + 3.1, 3.0), "");
}

}  // namespace
}  // namespace jink::bridge::supervisor
