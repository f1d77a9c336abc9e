// SPDX-License-Identifier: BSD-3-Clause
// The loop when something goes wrong, and what it says of a flight.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

TEST(Percentiles, AreOrderStatistics) {
  EXPECT_FALSE(percentiles({}));
  const auto one = percentiles({7.0});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->p50, 7.0);
  EXPECT_EQ(one->p99, 7.0);
  EXPECT_EQ(one->max, 7.0);
  std::vector<double> values;
  for (int i = 200; i >= 1; --i) values.push_back(i);
  const auto many = percentiles(values);
  EXPECT_EQ(many->p50, 100.0);
  EXPECT_EQ(many->p99, 198.0);
  EXPECT_EQ(many->max, 200.0);
  EXPECT_EQ(percentiles({1.0, 2.0})->p50, 1.0);
}

TEST(Companion, BrakesOnTheWireWhenTheTracksGoStaleAndFliesOnWhenTheyCome) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.tracks = false;
  loop.run(1.1);
  EXPECT_EQ(loop.recorder.count("hazard"), 1);
  const double speed = loop.last().velocity.norm();
  loop.run(0.5);
  EXPECT_NEAR(speed - loop.last().velocity.norm(), 1.0, 0.1);  // 2 m/s²
  loop.run(1.0);
  EXPECT_LT(loop.last().velocity.norm(), 0.02);
  loop.tracks = true;
  loop.run(0.5);
  EXPECT_EQ(loop.recorder.count("hazard_over"), 1);
  EXPECT_NEAR(loop.last().velocity.norm(), 2.0, 0.05);
  EXPECT_EQ(loop.recorder.count("hazard"), 1);
}

TEST(Companion, BrakesWhenThePlannerIsLateOrHasNoPath) {
  for (const bool silent : {true, false}) {
    SCOPED_TRACE(silent);
    Loop loop;
    loop.airborne().fly();
    (silent ? loop.planner.silent : loop.planner.valid) = silent;
    loop.run(2.5);
    EXPECT_EQ(loop.recorder.last("hazard"), "the planner is late");
    EXPECT_LT(loop.last().velocity.norm(), 0.02);
    loop.run(3.0);
    EXPECT_EQ(loop.companion.supervisor().outcome(), supervisor::Outcome::kAborted);
    EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
  }
}

TEST(Companion, APlannerThatBreaksDownEndsInHold) {
  for (const bool at_start : {false, true}) {
    SCOPED_TRACE(at_start);
    Loop loop;
    loop.airborne().fly();
    (at_start ? loop.planner.throws_at_start : loop.planner.throws) = true;
    EXPECT_NO_THROW(loop.run(5.0));
    EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
    EXPECT_EQ(loop.companion.supervisor().outcome(), supervisor::Outcome::kAborted);
    EXPECT_EQ(loop.companion.supervisor().reason(), "the planner failed: no memory");
    EXPECT_EQ(loop.recorder.count("planner_failed"), 1);
  }
}

TEST(Companion, TheStreamStopsAtATakeoverAndStaysStopped) {
  Loop loop;
  loop.airborne().fly();
  loop.link.telemetry.mode = vehicle::FlightMode::kPosition;
  const std::size_t sent = loop.link.sent.size();
  const std::size_t requests = loop.link.requests.size();
  EXPECT_FALSE(loop.turn());
  loop.link.telemetry.mode = vehicle::FlightMode::kOffboard;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(loop.turn());
  EXPECT_EQ(loop.link.sent.size(), sent);
  EXPECT_EQ(loop.link.requests.size(), requests);
  EXPECT_EQ(loop.recorder.count("phase"), 3);  // engaging, flying, done
}

TEST(Companion, AnInterruptBrakesThenHolds) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  loop.companion.interrupt(loop.now);
  loop.run(0.5);
  EXPECT_NEAR(loop.last().velocity.x(), 1.0, 0.1);
  loop.run(3.0);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
  EXPECT_TRUE(loop.companion.supervisor().done());
  EXPECT_EQ(loop.companion.summary().reason, "interrupted");
}

// The take-off point lies above: to hold that would be to go on climbing.
TEST(Companion, AnInterruptInTheClimbStopsTheClimb) {
  Loop loop;
  loop.follows = false;
  loop.run(1.0);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  loop.link.telemetry.motion.value.position = {0, 0, 0.8};
  loop.link.telemetry.motion.value.velocity = {0, 0, 0.6};
  loop.link.telemetry.in_air = true;
  loop.turn();
  EXPECT_EQ(loop.last().position.z(), 2.0);
  loop.companion.interrupt(loop.now);
  loop.run(0.4);
  EXPECT_LT(loop.last().position.z(), 0.95);
  EXPECT_GE(loop.last().position.z(), 0.8);
}

TEST(Companion, AClimbGoesOnAfterAHazard) {
  config::Mission mission = Loop::mission();
  mission.takeoff_height = 8.0;
  Loop loop(mission);
  loop.follows = false;
  loop.run(1.0);
  loop.link.telemetry.motion.value.position = {0, 0, 0.8};
  loop.link.telemetry.in_air = true;
  loop.run(0.2);
  loop.follows = true;
  EXPECT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kClimb);
  EXPECT_EQ(loop.recorder.count("reference_lost"), 0);  // what it climbs to is no reference yet
  loop.tracks = false;
  loop.run(3.0);
  const double height = loop.last().position.z();
  EXPECT_LT(height, 5.0);
  EXPECT_EQ(loop.last().velocity.z(), 0.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  loop.tracks = true;
  loop.run(0.5);
  EXPECT_GT(loop.last().position.z(), height + 0.2);
  EXPECT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kClimb);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(0, 0, 8));
}

TEST(Companion, BrakesAtTheVehicleWhereTrackingIsLost) {
  Loop loop;
  loop.airborne().fly();
  loop.follows = false;
  loop.planner.silent = true;
  loop.run(2.0);  // the reference has gone ahead meanwhile, and brakes there
  Loop lost;
  lost.airborne().fly();
  lost.follows = false;
  lost.link.telemetry.motion.value.position += Vec3(0, 2.5, 0);
  lost.companion.interrupt(lost.now);
  lost.run(0.2);
  EXPECT_NEAR(lost.last().position.y(), 2.5, 0.1);
}

TEST(Companion, AJumpOfTheEstimateShiftsThePlan) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  const vehicle::Setpoint before = loop.last();
  const Vec3 jump(-3, 1, 0.5);
  loop.link.telemetry.motion.value.position += jump;
  loop.link.telemetry.estimate_shift += jump;
  ++loop.link.telemetry.estimate_resets;
  loop.turn();
  EXPECT_LT((loop.last().position - before.position - jump).norm(), 0.1);
  EXPECT_LT((loop.last().velocity - before.velocity).norm(), 0.1);
  EXPECT_EQ(loop.recorder.count("estimate_reset"), 1);
  EXPECT_NE(loop.recorder.last("estimate_reset").find("3.20 m"), std::string::npos);
  loop.run(0.3);  // and so is the plan that was in the making
  for (std::size_t i = loop.link.sent.size() - 15; i + 1 < loop.link.sent.size(); ++i)
    EXPECT_LT((loop.link.sent[i + 1].position - loop.link.sent[i].position).norm(), 0.2);
  EXPECT_EQ(loop.recorder.count("reference_lost"), 0);
  EXPECT_EQ(loop.companion.summary().estimate_resets, 1U);
}

TEST(Companion, TheMarginGrowsWithWhatWasNotForeseenAndComesBack) {
  config::Mission mission = Loop::mission();
  mission.waypoints = {{90, 0, 2}};
  mission.geofence.max.x() = 100.0;
  Loop loop(mission);
  loop.airborne().fly();
  const double margin = config::Settings{}.horizon.margin;
  // What stays is foreseen, however far it is.
  for (; loop.beside.y() < 0.6; loop.beside.y() += 0.02) loop.run(0.1);
  loop.run(3.0);
  EXPECT_EQ(loop.planner.jobs.back().request.margin, margin);
  for (int i = 0; i < 3; ++i) {
    loop.beside.y() = i % 2 == 0 ? 0.0 : 0.6;
    loop.run(1.0);
  }
  EXPECT_NEAR(loop.planner.jobs.back().request.margin, 0.6, 0.05);
  EXPECT_EQ(loop.recorder.count("margin"), 1);
  EXPECT_NEAR(loop.companion.summary().largest_margin, 0.6, 0.05);
  loop.run(12.0);
  EXPECT_EQ(loop.planner.jobs.back().request.margin, margin);
  EXPECT_EQ(loop.recorder.last("margin"), "back to 0.35 m");
}

TEST(Companion, AfterAShortStallItGoesOnAfterALongOneItHolds) {
  for (const double stall : {0.5, 1.5}) {
    SCOPED_TRACE(stall);
    Loop loop;
    loop.airborne().fly();
    loop.now += stall;
    loop.run(3.0);
    EXPECT_EQ(loop.recorder.count("stalled"), 1);
    const FlightSummary summary = loop.companion.summary();
    ASSERT_FALSE(summary.hazards.empty());
    EXPECT_NEAR(summary.hazards[0].duration, stall, 0.05);
    if (stall < 1.0) {
      EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
    } else {
      EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
      EXPECT_EQ(summary.reason, "this program did not run for 1.5 s");
    }
  }
}

TEST(Companion, AnAutopilotThatBeginsAnewWhileItEngagesEndsTheFlight) {
  Loop loop;
  loop.obeys = false;
  loop.run(0.5);
  ASSERT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kEngaging);
  ++loop.link.telemetry.reboots;
  loop.run(1.0);
  EXPECT_TRUE(loop.companion.supervisor().reason().starts_with("the autopilot began anew"))
      << loop.companion.supervisor().reason();
}

TEST(Companion, TheSummaryHoldsEachHazardAndHowLongItLasted) {
  Loop loop;
  loop.airborne().fly();
  for (int i = 0; i < 2; ++i) {
    loop.tracks = false;
    loop.run(1.5);
    loop.tracks = true;
    loop.run(1.0);
  }
  const auto hazards = loop.companion.summary().hazards;
  ASSERT_EQ(hazards.size(), 2U);
  for (const HazardRecord& hazard : hazards) {
    EXPECT_EQ(hazard.what, "the obstacle tracks are stale");
    EXPECT_NEAR(hazard.duration, 0.5, 0.05);
  }
}

TEST(Companion, SaysNothingTwice) {
  Loop loop;
  loop.airborne().fly();
  loop.link.works = false;
  loop.run(1.0);
  EXPECT_EQ(loop.recorder.count("send_failed"), 1);
  loop.link.works = true;
  loop.run(1.0);
  EXPECT_EQ(loop.recorder.count("send_works"), 1);
  EXPECT_EQ(loop.recorder.count("plan_status"), 1);
  EXPECT_EQ(loop.recorder.count("request"), 1);
  EXPECT_EQ(loop.recorder.count("phase"), 2);
}

TEST(Companion, ReportsRefusedTracksOnceASecond) {
  Loop loop;
  loop.airborne().fly();
  loop.source.told.last_refusal = "radius is not positive";
  const double begun = loop.now;
  while (loop.now < begun + 5.0) {
    ++loop.source.told.dropped_tracks;
    loop.turn();
  }
  EXPECT_GE(loop.recorder.count("tracks_refused"), 4);
  EXPECT_LE(loop.recorder.count("tracks_refused"), 6);
  EXPECT_EQ(loop.recorder.last("tracks_refused"), "radius is not positive");
  EXPECT_EQ(loop.companion.summary().dropped_tracks, loop.source.told.dropped_tracks);
  const int before = loop.recorder.count("tracks_refused");
  loop.run(1.05);  // what is left to say
  const int settled = loop.recorder.count("tracks_refused");
  EXPECT_LE(settled, before + 1);
  loop.run(3.0);
  EXPECT_EQ(loop.recorder.count("tracks_refused"), settled);
}

// An aircraft of 60 m/s, 40 s away, at the vehicle's height: it waits on the ground, and lands in the air.
TEST(Companion, KeepsWellClearOfCrewedAircraft) {
  const auto aircraft = [](Loop& loop, const Vec3& position) {
    tracking::TrackMessage message{{9, loop.now, 0.0}, {}};
    message.placed = true;
    message.sends_when_empty = false;
    tracking::Aircraft a;
    a.icao_address = 0x3C6666;
    a.stamp = loop.now;
    a.position = position;
    a.velocity = {-60, 0, 0};
    message.aircraft = {a};
    loop.source.messages.push_back(message);
  };
  Loop grounded;
  for (int i = 0; i < 150; ++i) {
    aircraft(grounded, {2900, 0, 50});
    grounded.turn();
  }
  EXPECT_TRUE(grounded.link.requests.empty());
  EXPECT_EQ(grounded.companion.supervisor().waiting_for(), "a crewed aircraft to pass");
  EXPECT_TRUE(grounded.recorder.last("aircraft").starts_with("3C6666 comes to less than well clear"));
  for (int i = 0; i < 150; ++i) {
    aircraft(grounded, {-2900, 0, 50});
    grounded.turn();
  }
  EXPECT_FALSE(grounded.link.requests.empty());

  Loop airborne;
  airborne.airborne().fly();
  for (int i = 0; i < 500 && !airborne.companion.supervisor().done(); ++i) {
    aircraft(airborne, {2900, 0, 50});
    airborne.turn();
  }
  EXPECT_EQ(airborne.recorder.last("hazard"), "a crewed aircraft comes too near");
  EXPECT_EQ(airborne.link.requests.back(), vehicle::Command::kLand);
}

// A metric grid's coordinates, say: what cannot be right satisfies nobody.
TEST(Companion, TracksOfAnotherFrameAreRefusedAndNotFlownWith) {
  Loop loop;
  planner::base::Track far;
  far.position = {465'000, 5'250'000, 3};
  far.radius = 0.5;
  loop.seen = {far};
  loop.run(5.0);
  EXPECT_TRUE(loop.link.requests.empty());
  EXPECT_NE(loop.companion.supervisor().waiting_for().find("obstacle tracks"), std::string::npos);
  EXPECT_GE(loop.recorder.count("tracks_refused"), 1);
  EXPECT_NE(loop.recorder.last("tracks_refused").find("another frame"), std::string::npos);
  far.position = {20, 8, 3};
  loop.seen.push_back(far);  // one that can be right
  loop.run(1.0);
  EXPECT_FALSE(loop.link.requests.empty());
}

TEST(Companion, WaitsForTheWritersThatTheMissionNamesAndStopsWithoutOne) {
  config::Mission m = Loop::mission();
  m.tracks.writers = {{config::TrackTopic::kJink, "front"}, {config::TrackTopic::kJink, "rear"}};
  Loop loop(m);
  loop.airborne().tracks = false;
  bool rear = false;
  const auto fly = [&](double seconds) {
    for (const double end = loop.now + seconds; loop.now < end;) {
      for (const std::uint64_t writer : {1U, 2U}) {
        if (writer == 2 && !rear) continue;
        tracking::TrackMessage message{{writer, loop.now, 0.0}, {}, 0};
        message.named = writer;
        loop.source.messages.push_back(message);
      }
      loop.turn();
    }
  };
  fly(2.0);
  EXPECT_EQ(loop.companion.supervisor().waiting_for(), "obstacle tracks of 'rear' on DDS domain 0");
  rear = true;
  fly(2.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
  rear = false;
  fly(1.5);
  EXPECT_EQ(loop.recorder.last("hazard"), "the obstacle tracks are stale");
}

TEST(Companion, SaysThatAWritersClockIsOff) {
  Loop loop;
  loop.tracks = false;
  loop.airborne();
  for (int i = 0; i < 100; ++i) {
    loop.source.messages.push_back({{1, loop.now, -3600.0}, {}, 0});
    loop.turn();
  }
  EXPECT_EQ(loop.recorder.count("tracks_clock"), 1);
}

TEST(Companion, TellsTheAutopilotsAnswers) {
  Loop loop;
  loop.obeys = false;
  loop.run(0.1);
  loop.link.reports.push_back({vehicle::Command::kOffboard, false, "temporarily rejected"});
  loop.turn();
  EXPECT_EQ(loop.recorder.last("refused"), "offboard: temporarily rejected");
  loop.link.reports.push_back({vehicle::Command::kOffboard, true, ""});
  loop.turn();
  EXPECT_EQ(loop.recorder.last("accepted"), "offboard");
}

}  // namespace
}  // namespace jink::bridge::companion
