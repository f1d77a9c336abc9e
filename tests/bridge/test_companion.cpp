// SPDX-License-Identifier: BSD-3-Clause
// The loop with an autopilot, tracks and a planner that do as they are told: what goes on the wire, and what is said.
#include "bridge/companion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/bridge_fakes.hpp"

namespace jink::bridge {
namespace {

using testing::FakeLink;
using testing::FakePlanner;
using testing::FakeTracks;
using testing::Recorder;

constexpr double kTurn = 0.02;  // s

config::Mission mission() {
  config::Mission m;
  m.connection = "udpin://127.0.0.1:14540";
  m.takeoff_height = 2.0;
  m.min_height = 1.0;
  m.waypoints = {{20, 0, 2}};
  m.arrival = config::Arrival::kHold;
  m.geofence = {{-5, -10, 0}, {30, 10, 12}};
  return m;
}

/// The loop at 50 Hz around an autopilot that obeys and follows its setpoints exactly.
struct Loop {
  explicit Loop(const config::Mission& m = mission(), const config::Settings& settings = {})
      : companion(m, settings, {link, source, planner, {&recorder}}) {
    link.telemetry.mode = FlightMode::kHold;
    link.telemetry.armable = link.telemetry.local_position_ok = true;
  }

  bool turn() {
    VehicleState& state = link.telemetry;
    if (heartbeats) state.heartbeat_stamp = now;
    if (positions) state.position_stamp = now;
    if (tracks) source.messages.push_back({1, now, 0.0, seen, 0});
    const bool on = companion.step(now);
    if (obeys) obey();
    const bool flies = state.armed && state.mode == FlightMode::kOffboard && !link.sent.empty() && follows;
    if (flies) {
      state.position = link.sent.back().position;
      state.velocity = link.sent.back().velocity;
      state.in_air = state.in_air || state.position.z() > 0.2;
    }
    now += kTurn;
    return on;
  }
  void obey() {
    for (; obeyed < link.requests.size(); ++obeyed) {
      const Command command = link.requests[obeyed];
      if (command == Command::kOffboard) link.telemetry.mode = FlightMode::kOffboard;
      if (command == Command::kArm) link.telemetry.armed = true;
      if (command == Command::kHold) link.telemetry.mode = FlightMode::kHold;
      if (command == Command::kLand) link.telemetry.mode = FlightMode::kLand;
      if (command == Command::kHold || command == Command::kLand) link.telemetry.velocity.setZero();
    }
  }
  void run(double seconds) {
    for (const double end = now + seconds; now < end - 1e-9 && turn();) {
    }
  }
  Loop& airborne(const Vec3& position = {0, 0, 2}) {
    link.telemetry.in_air = link.telemetry.armed = true;
    link.telemetry.position = position;
    return *this;
  }
  /// Until plans are flown.
  Loop& fly() {
    while (recorder.plans == 0 && now < 20.0) turn();
    run(0.5);
    EXPECT_EQ(companion.supervisor().phase(), Phase::kFlying);
    return *this;
  }
  [[nodiscard]] const Setpoint& last() const { return link.sent.back(); }

  FakeLink link;
  FakeTracks source;
  FakePlanner planner;
  Recorder recorder;
  Companion companion;
  std::vector<planner::Track> seen;
  double now = 0.0;
  bool heartbeats = true, positions = true, tracks = true, obeys = true, follows = true;
  std::size_t obeyed = 0;
};

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

TEST(Companion, FliesAMissionFromTheGroundToHold) {
  Loop loop;
  loop.run(40.0);
  const FlightSummary summary = loop.companion.summary();
  EXPECT_EQ(summary.outcome, Outcome::kReached) << summary.reason;
  EXPECT_EQ(loop.link.requests, (std::vector{Command::kOffboard, Command::kArm, Command::kHold}));
  EXPECT_NEAR(summary.straight_length, 20.0, 0.5);
  EXPECT_NEAR(summary.path_length, 20.0, 0.6);
  EXPECT_NEAR(summary.flight_time, 10.0, 1.0);
  EXPECT_NEAR(summary.max_speed, 2.0, 0.1);
  EXPECT_GT(summary.plans, 80U);
  EXPECT_EQ(summary.plan_ms.size(), summary.plans);
  EXPECT_EQ(summary.deadline_misses, 0U);
  EXPECT_FALSE(summary.track_to_setpoint_ms.empty());
}

TEST(Companion, TakesOffAboveWhereItStands) {
  Loop loop;
  loop.follows = false;
  loop.link.telemetry.position = {3, 4, 0.5};
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), Phase::kClimbing);
  EXPECT_EQ(loop.last().position, Vec3(3, 4, 2.5));
  EXPECT_EQ(loop.last().velocity, Vec3::Zero());
}

TEST(Companion, StreamsNothingWhileItWaits) {
  Loop loop;
  loop.tracks = false;
  loop.run(5.0);
  EXPECT_TRUE(loop.link.sent.empty());
  EXPECT_TRUE(loop.link.requests.empty());
  EXPECT_EQ(loop.recorder.count("waiting"), 1);
}

TEST(Companion, RaisesWaypointsToMinHeightAndSaysSo) {
  config::Mission m = mission();
  m.waypoints = {{5, 0, 0.2}, {20, 0, 3}};
  Loop loop(m);
  loop.airborne().fly();
  EXPECT_EQ(loop.recorder.count("raised"), 1);
  EXPECT_NE(loop.recorder.last("raised").find("0.2"), std::string::npos);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(5, 0, 1));
}

TEST(Companion, AsksForPlansWithinGeofenceAndMinHeight) {
  Loop loop;
  loop.airborne().fly();
  const planner::PathRequest& request = loop.planner.jobs.back().request;
  EXPECT_EQ(request.volume.min, Vec3(-5, -10, 1));
  EXPECT_EQ(request.volume.max, Vec3(30, 10, 12));
  EXPECT_EQ(request.margin, planner::HorizonSettings{}.margin);
  EXPECT_EQ(request.track_acceleration, planner::HorizonSettings{}.track_acceleration);
}

TEST(Companion, APathMayBeginWhereTheVehicleIsAlready) {
  Loop loop;
  loop.airborne({0, 11, 0.6}).fly();
  EXPECT_EQ(loop.planner.jobs.front().request.volume.max.y(), 11.0);
  EXPECT_EQ(loop.planner.jobs.front().request.volume.min.z(), 0.6);
  loop.run(5.0);
  EXPECT_EQ(loop.planner.jobs.back().request.volume.max.y(), 10.0);
  EXPECT_GT(loop.planner.jobs.back().request.volume.min.z(), 0.9);
}

TEST(Companion, FliesByTheWaypointsOnTheWay) {
  config::Mission m = mission();
  m.waypoints = {{4, 0, 2}, {4, 4, 2}};
  Loop loop(m);
  loop.airborne().fly();
  EXPECT_EQ(loop.planner.jobs.front().request.target, Vec3(4, 0, 2));
  loop.run(20.0);
  EXPECT_EQ(loop.recorder.count("waypoint"), 1);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(4, 4, 2));
  EXPECT_EQ(loop.companion.supervisor().outcome(), Outcome::kReached);
  // The plan to the waypoint before seeds none to the next.
  for (std::size_t i = 1; i < loop.planner.jobs.size(); ++i) {
    const bool changed = loop.planner.jobs[i].request.target != loop.planner.jobs[i - 1].request.target;
    EXPECT_EQ(loop.planner.jobs[i].previous.empty(), changed) << i;
  }
}

TEST(Companion, AppliesAPlanFromItsStart) {
  config::Settings settings;
  settings.companion.setpoint_lead = 0.0;
  Loop loop(mission(), settings);
  loop.planner.promised = 0.3;
  loop.planner.takes = 0.1;
  loop.airborne();
  while (loop.recorder.plans == 0) loop.turn();
  const double start = loop.planner.jobs.front().start;
  EXPECT_NEAR(start - loop.planner.jobs.front().begun, 0.3, 1e-9);
  while (loop.now < start) {
    loop.turn();
    EXPECT_EQ(loop.last().velocity, Vec3::Zero());
  }
  loop.run(0.1);
  EXPECT_NEAR(loop.last().velocity.x(), 2.0, 1e-9);
  EXPECT_NEAR(loop.last().position.x(), 2.0 * (loop.now - kTurn - start), 1e-6);
  EXPECT_EQ(loop.companion.summary().deadline_misses, 0U);
}

TEST(Companion, PlansFromWhereTheReferenceWillBe) {
  Loop loop;
  loop.seen = {{.id = 3, .position = {5, 5, 2}, .velocity = {0, -1, 0}, .radius = 0.4}};
  loop.airborne().fly();
  const PlanJob& job = loop.planner.jobs.back();
  const PlanJob& before = loop.planner.jobs[loop.planner.jobs.size() - 2];
  EXPECT_NEAR((job.request.position - before.request.position).x(), 2.0 * (job.start - before.start), 1e-6);
  EXPECT_NEAR(job.request.velocity.x(), 2.0, 1e-9);
  ASSERT_FALSE(job.previous.empty());
  EXPECT_NEAR(job.previous.front().t, 0.0, 1e-9);
  ASSERT_EQ(job.tracks.size(), 1U);
  EXPECT_NEAR(job.tracks[0].position.y(), 5.0 - (job.start - job.newest_track), 1e-9);
}

TEST(Companion, CountsALatePlanAsAMiss) {
  Loop loop;
  loop.airborne().fly();
  loop.planner.takes = 0.3;  // the present plan's commitment ends after 0.2 s
  const auto before = loop.companion.summary();
  loop.run(1.0);
  const auto after = loop.companion.summary();
  EXPECT_GT(after.deadline_misses, before.deadline_misses);
  EXPECT_LE(after.deadline_misses, after.plans - before.plans);
}

TEST(Companion, PlansAtTheStatedRateAndOneAtATime) {
  config::Settings settings;
  settings.companion.replan_rate_hz = 10.0;
  settings.companion.largest_replan_rate_hz = 20.0;
  config::Mission m = mission();
  m.tracks.required = false;
  Loop loop(m, settings);
  loop.airborne().fly();
  loop.tracks = false;
  loop.turn();
  const std::size_t before = loop.planner.jobs.size();
  loop.run(2.0);
  EXPECT_NEAR(static_cast<double>(loop.planner.jobs.size() - before), 20.0, 1.0);
  loop.tracks = true;  // in every turn: plans at the largest rate, to within a turn
  const std::size_t sooner = loop.planner.jobs.size();
  loop.run(2.0);
  EXPECT_NEAR(static_cast<double>(loop.planner.jobs.size() - sooner), 2.0 / 0.06, 2.0);
  loop.planner.takes = 0.3;
  const std::size_t slow = loop.planner.jobs.size();
  loop.run(3.0);
  EXPECT_LE(loop.planner.jobs.size() - slow, 11U);
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
  EXPECT_EQ(loop.last().velocity, Vec3::Zero());
  loop.tracks = true;
  loop.run(0.5);
  EXPECT_EQ(loop.recorder.count("hazard_over"), 1);
  EXPECT_NEAR(loop.last().velocity.norm(), 2.0, 1e-6);
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
    EXPECT_EQ(loop.last().velocity, Vec3::Zero());
    loop.run(3.0);
    EXPECT_EQ(loop.companion.supervisor().outcome(), Outcome::kAborted);
    EXPECT_EQ(loop.link.requests.back(), Command::kHold);
  }
}

TEST(Companion, APlannerThatBreaksDownEndsInHold) {
  for (const bool at_start : {false, true}) {
    SCOPED_TRACE(at_start);
    Loop loop;
    loop.airborne().fly();
    (at_start ? loop.planner.throws_at_start : loop.planner.throws) = true;
    EXPECT_NO_THROW(loop.run(5.0));
    EXPECT_EQ(loop.link.requests.back(), Command::kHold);
    EXPECT_EQ(loop.companion.supervisor().outcome(), Outcome::kAborted);
    EXPECT_EQ(loop.companion.supervisor().reason(), "the planner failed: no memory");
    EXPECT_EQ(loop.recorder.count("planner_failed"), 1);
  }
}

TEST(Companion, TheStreamStopsAtATakeoverAndStaysStopped) {
  Loop loop;
  loop.airborne().fly();
  loop.link.telemetry.mode = FlightMode::kPosition;
  const std::size_t sent = loop.link.sent.size();
  const std::size_t requests = loop.link.requests.size();
  EXPECT_FALSE(loop.turn());
  loop.link.telemetry.mode = FlightMode::kOffboard;
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
  EXPECT_EQ(loop.link.requests.back(), Command::kHold);
  EXPECT_TRUE(loop.companion.supervisor().done());
  EXPECT_EQ(loop.companion.summary().reason, "interrupted");
}

// The take-off point lies above: to hold that would be to go on climbing.
TEST(Companion, AnInterruptInTheClimbStopsTheClimb) {
  Loop loop;
  loop.follows = false;
  loop.run(1.0);
  ASSERT_EQ(loop.companion.supervisor().phase(), Phase::kClimbing);
  loop.link.telemetry.position = {0, 0, 0.8};
  loop.link.telemetry.velocity = {0, 0, 0.6};
  loop.link.telemetry.in_air = true;
  loop.turn();
  EXPECT_EQ(loop.last().position.z(), 2.0);
  loop.companion.interrupt(loop.now);
  loop.run(0.4);
  EXPECT_LT(loop.last().position.z(), 0.95);
  EXPECT_GE(loop.last().position.z(), 0.8);
}

TEST(Companion, AClimbGoesOnAfterAHazard) {
  Loop loop;
  loop.follows = false;
  loop.run(1.0);
  loop.link.telemetry.position = {0, 0, 0.8};
  loop.link.telemetry.in_air = true;
  loop.tracks = false;
  loop.run(1.5);
  EXPECT_NEAR(loop.last().position.z(), 0.8, 1e-9);
  loop.tracks = true;
  loop.run(0.1);
  EXPECT_EQ(loop.last().position, Vec3(0, 0, 2));
}

TEST(Companion, EngagingInTheAirDoesNotCallTheVehicleBack) {
  Loop loop;
  loop.airborne();
  loop.obeys = false;
  for (int i = 0; i < 50; ++i) {
    loop.link.telemetry.position.x() = 4.0 * loop.now;  // a pilot flies it
    loop.turn();
  }
  EXPECT_NEAR(loop.last().position.x(), 4.0 * (loop.now - kTurn), 1e-9);
}

TEST(Companion, TurnsTheHeadingToTheWaypointAtABoundedRate) {
  config::Mission m = mission();
  m.waypoints = {{0, 8, 2}};
  Loop loop(m);
  loop.link.telemetry.yaw = -2.5;
  loop.airborne().fly();
  loop.run(4.0);
  double fastest = 0.0;
  for (std::size_t i = 1; i < loop.link.sent.size(); ++i) {
    const double change = std::remainder(loop.link.sent[i].yaw - loop.link.sent[i - 1].yaw, 2.0 * std::numbers::pi);
    fastest = std::max(fastest, std::abs(change));
  }
  EXPECT_EQ(loop.link.sent.front().yaw, -2.5);
  EXPECT_NEAR(fastest, 1.5 * kTurn, 1e-9);
  EXPECT_NEAR(loop.last().yaw, std::numbers::pi / 2.0, 1e-6);
}

TEST(Companion, PlansFromTheVehicleWhereTrackingIsLostAndSaysItOnce) {
  Loop loop;
  loop.airborne().fly();
  loop.follows = false;
  loop.link.telemetry.position += Vec3(0, 2.5, 0);
  loop.link.telemetry.velocity = {0.5, 0.5, 0};
  const std::size_t jobs = loop.planner.jobs.size();
  while (loop.planner.jobs.size() == jobs) loop.turn();
  const PlanJob& job = loop.planner.jobs.back();
  const Vec3 then = loop.link.telemetry.position + (job.start - job.begun) * loop.link.telemetry.velocity;
  EXPECT_LT((job.request.position - then).norm(), 0.05);  // where it will be when the plan starts
  EXPECT_EQ(job.request.velocity, Vec3(0.5, 0.5, 0));
  EXPECT_TRUE(job.previous.empty());
  EXPECT_EQ(loop.recorder.count("reference_lost"), 1);
  for (int i = 0; i < 25; ++i) {  // it drifts off ahead of every plan
    loop.link.telemetry.position += Vec3(0, 0.3, 0);
    loop.turn();
  }
  EXPECT_GT(loop.planner.jobs.size(), jobs + 3);
  EXPECT_EQ(loop.recorder.count("reference_lost"), 1);
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
  lost.link.telemetry.position += Vec3(0, 2.5, 0);
  lost.companion.interrupt(lost.now);
  lost.run(0.2);
  EXPECT_NEAR(lost.last().position.y(), 2.5, 0.1);
}

// The loop is woken by a track and by the plan that it leads to, between two turns.
TEST(Companion, ANewTrackStartsAPlanAtOnceWhichGoesOnTheWireAtOnce) {
  Loop loop;
  loop.airborne().fly();
  loop.tracks = false;
  loop.planner.takes = 0.005;
  loop.run(0.04);
  const std::size_t jobs = loop.planner.jobs.size();
  const std::size_t sent = loop.link.sent.size();
  const double woken = loop.now - kTurn + 0.006;
  loop.source.messages.push_back({1, woken, 0.0, {}, 0});
  loop.companion.step(woken);
  ASSERT_EQ(loop.planner.jobs.size(), jobs + 1);
  EXPECT_EQ(loop.link.sent.size(), sent);  // no setpoint out of turn without a reason
  loop.companion.step(woken + 0.005);
  EXPECT_EQ(loop.link.sent.size(), sent + 1);
  EXPECT_NEAR(loop.companion.summary().track_to_setpoint_ms.back(), 5.0, 1e-6);
}

TEST(Companion, AJumpOfTheEstimateShiftsThePlan) {
  Loop loop;
  loop.airborne().fly();
  loop.run(1.0);
  const Setpoint before = loop.last();
  const Vec3 jump(-3, 1, 0.5);
  loop.link.telemetry.position += jump;
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

TEST(Companion, TheMarginGrowsWithTheTrackingErrorAndComesBack) {
  Loop loop;
  loop.airborne().fly();
  EXPECT_EQ(loop.planner.jobs.back().request.margin, config::Settings{}.horizon.margin);
  loop.follows = false;
  loop.link.telemetry.position = loop.last().position + Vec3(0, 0.6, 0);
  loop.link.telemetry.velocity = loop.last().velocity;
  loop.turn();
  loop.follows = true;
  loop.run(0.2);
  EXPECT_NEAR(loop.planner.jobs.back().request.margin, 0.6, 0.05);
  EXPECT_EQ(loop.recorder.count("margin"), 1);
  EXPECT_NEAR(loop.companion.summary().largest_margin, 0.6, 0.05);
  loop.run(5.0);
  EXPECT_EQ(loop.planner.jobs.back().request.margin, config::Settings{}.horizon.margin);
  EXPECT_EQ(loop.recorder.last("margin"), "back to 0.35 m");
}

TEST(Companion, DoesNotFleeFromItsOwnTrack) {
  Loop loop;
  loop.airborne().fly();
  for (int i = 0; i < 100; ++i) {
    planner::Track own;
    own.id = 9;
    own.radius = 0.3;
    own.position = loop.link.telemetry.position + Vec3(0.05, 0, 0);
    own.velocity = loop.link.telemetry.velocity;
    loop.seen = {own};
    loop.turn();
  }
  EXPECT_TRUE(loop.planner.jobs.back().tracks.empty());
  EXPECT_EQ(loop.recorder.last("tracks_self"), "1 tracks are taken for this vehicle itself");
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

TEST(Companion, SaysThatAWritersClockIsOff) {
  Loop loop;
  loop.tracks = false;
  loop.airborne();
  for (int i = 0; i < 100; ++i) {
    loop.source.messages.push_back({1, loop.now, -3600.0, {}, 0});
    loop.turn();
  }
  EXPECT_EQ(loop.recorder.count("tracks_clock"), 1);
}

TEST(Companion, TellsTheAutopilotsAnswers) {
  Loop loop;
  loop.obeys = false;
  loop.run(0.1);
  loop.link.reports.push_back({Command::kOffboard, false, "temporarily rejected"});
  loop.turn();
  EXPECT_EQ(loop.recorder.last("refused"), "offboard: temporarily rejected");
  loop.link.reports.push_back({Command::kOffboard, true, ""});
  loop.turn();
  EXPECT_EQ(loop.recorder.last("accepted"), "offboard");
}

TEST(Companion, LandsWhereTheMissionSaysSo) {
  config::Mission m = mission();
  m.arrival = config::Arrival::kLand;
  m.waypoints = {{3, 0, 2}};
  Loop loop(m);
  loop.airborne().fly();
  loop.run(3.0);
  EXPECT_EQ(loop.link.requests.back(), Command::kLand);
  const std::size_t sent = loop.link.sent.size();
  loop.run(2.0);
  EXPECT_EQ(loop.link.sent.size(), sent);
  loop.link.telemetry.armed = loop.link.telemetry.in_air = false;
  loop.turn();
  EXPECT_EQ(loop.companion.summary().outcome, Outcome::kReached);
}

}  // namespace
}  // namespace jink::bridge
