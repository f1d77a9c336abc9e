// SPDX-License-Identifier: BSD-3-Clause
// The loop when all goes well: what is planned, what goes on the wire.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "planner/base/trajectory.hpp"
#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

TEST(Companion, FliesAMissionFromTheGroundToHold) {
  Loop loop;
  loop.run(40.0);
  const FlightSummary summary = loop.companion.summary();
  EXPECT_EQ(summary.outcome, supervisor::Outcome::kReached) << summary.reason;
  EXPECT_EQ(loop.link.requests,
            (std::vector{vehicle::Command::kOffboard, vehicle::Command::kArm, vehicle::Command::kHold}));
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
  loop.link.telemetry.motion.value.position = {3, 4, 0.5};
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  EXPECT_EQ(loop.last().position, Vec3(3, 4, 2.5));
  EXPECT_EQ(loop.last().velocity, Vec3::Zero());
}

TEST(Companion, TakesOffToItsHeightBeforeItFliesOn) {
  Loop loop;
  loop.follows = false;
  loop.run(1.0);
  loop.link.telemetry.motion.value.position = {0, 0, 1.75};
  loop.link.telemetry.in_air = true;
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  loop.link.telemetry.motion.value.position.z() = 1.85;
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
}

TEST(Companion, FliesNotWithAnAutopilotThatCutsItsMotors) {
  Loop loop;
  loop.link.telemetry.failsafe_parameters.offboard_loss = 7.0;
  loop.run(5.0);
  EXPECT_TRUE(loop.link.requests.empty());
  EXPECT_TRUE(loop.companion.supervisor().done());
  EXPECT_NE(loop.companion.summary().reason.find("motors_cut"), std::string::npos);
  config::Mission m = Loop::mission();
  m.endings.motors_cut = true;
  Loop told(m);
  told.link.telemetry.failsafe_parameters.offboard_loss = 7.0;
  told.run(5.0);
  EXPECT_FALSE(told.link.requests.empty());
}

TEST(Companion, SaysThatTheAutopilotToldNoParameters) {
  Loop loop;
  loop.link.telemetry.failsafe_parameters = {};
  loop.run(5.0);
  EXPECT_FALSE(loop.link.requests.empty());
  EXPECT_EQ(loop.recorder.count("parameters"), 1);
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
  config::Mission m = Loop::mission();
  m.waypoints = {{5, 0, 0.2}, {20, 0, 3}};
  Loop loop(m);
  loop.airborne().fly();
  EXPECT_EQ(loop.recorder.count("raised"), 1);
  EXPECT_NE(loop.recorder.last("raised").find("0.2"), std::string::npos);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(5, 0, 1));
}

TEST(Companion, RaisesALowStartToMinHeightAndSaysSo) {
  Loop usual;
  usual.fly();
  EXPECT_EQ(usual.recorder.count("raised"), 0);

  config::Mission m = Loop::mission();
  m.takeoff_height = 0.4;
  Loop climbs(m);
  climbs.fly();
  EXPECT_EQ(climbs.recorder.count("raised"), 1);
  EXPECT_NE(climbs.recorder.last("raised").find("0.4"), std::string::npos) << climbs.recorder.last("raised");
  EXPECT_GE(climbs.last().position.z(), 1.0);

  Loop flies(m);  // whose take-off height does not matter
  flies.airborne({0, 0, 0.5}).fly();
  EXPECT_EQ(flies.recorder.count("raised"), 1);
  EXPECT_NE(flies.recorder.last("raised").find("0.5"), std::string::npos) << flies.recorder.last("raised");
}

TEST(Companion, AsksForPlansWithinGeofenceAndMinHeight) {
  Loop loop;
  loop.airborne().fly();
  const planner::horizon::PathRequest& request = loop.planner.jobs.back().request;
  // Tracking errors must not lead out of it: paths keep some of the margin.
  const double inset = 0.3 * planner::base::HorizonSettings{}.margin;
  EXPECT_TRUE(request.volume.min.isApprox(Vec3(-5, -10, 1) + Vec3::Constant(inset)));
  EXPECT_TRUE(request.volume.max.isApprox(Vec3(30, 10, 12) - Vec3::Constant(inset)));
  EXPECT_EQ(request.volume_clearance, 0.0);
  EXPECT_EQ(request.margin, planner::base::HorizonSettings{}.margin);
  EXPECT_EQ(request.track_acceleration, planner::base::HorizonSettings{}.track_acceleration);
  EXPECT_EQ(request.sudden_change, planner::base::HorizonSettings{}.sudden_change);
}

// From what an external tracker sees; with onboard perception the relative position is right.
TEST(Companion, KeepsWhatItsOwnEstimateIsOffByFromTracksOfTheWorld) {
  const double least = planner::base::HorizonSettings{}.margin;
  for (const bool world : {true, false}) {
    config::Mission m = Loop::mission();
    m.tracks.sensed_from = world ? config::SensedFrom::kWorld : config::SensedFrom::kVehicle;
    Loop loop(m);
    loop.link.telemetry.position_sigma = 0.4;
    loop.airborne().fly();
    EXPECT_DOUBLE_EQ(loop.planner.jobs.back().request.margin, world ? std::hypot(least, 0.4) : least);
    EXPECT_DOUBLE_EQ(loop.planner.jobs.back().request.volume_clearance, 1.5 * 0.4);  // its height is as wrong
  }
}

TEST(Companion, APathMayBeginWhereTheVehicleIsAlready) {
  Loop loop;
  loop.airborne({0, 11, 0.8}).fly();
  EXPECT_EQ(loop.planner.jobs.front().request.volume.max.y(), 11.0);
  EXPECT_EQ(loop.planner.jobs.front().request.volume.min.z(), 0.8);
  // By as much as it is out, it is led back in.
  const double inset = 0.3 * planner::base::HorizonSettings{}.margin;
  EXPECT_DOUBLE_EQ(loop.planner.jobs.front().request.volume_clearance, 1.0 + inset);
  loop.run(5.0);
  EXPECT_EQ(loop.planner.jobs.back().request.volume_clearance, 0.0);
  EXPECT_EQ(loop.planner.jobs.back().request.volume.max.y(), 10.0 - inset);
  EXPECT_GT(loop.planner.jobs.back().request.volume.min.z(), 0.9);
}

TEST(Companion, FliesByTheWaypointsOnTheWay) {
  config::Mission m = Loop::mission();
  m.waypoints = {{4, 0, 2}, {4, 4, 2}};
  Loop loop(m);
  loop.airborne().fly();
  EXPECT_EQ(loop.planner.jobs.front().request.target, Vec3(4, 0, 2));
  loop.run(20.0);
  EXPECT_EQ(loop.recorder.count("waypoint"), 1);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(4, 4, 2));
  EXPECT_EQ(loop.companion.supervisor().outcome(), supervisor::Outcome::kReached);
  // The plan to the waypoint before seeds none to the next.
  for (std::size_t i = 1; i < loop.planner.jobs.size(); ++i) {
    const bool changed = loop.planner.jobs[i].request.target != loop.planner.jobs[i - 1].request.target;
    EXPECT_EQ(loop.planner.jobs[i].previous.empty(), changed) << i;
  }
}

TEST(Companion, AppliesAPlanFromItsStart) {
  config::Settings settings;
  settings.companion.setpoint_lead = 0.0;
  Loop loop(Loop::mission(), settings);
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
  while (loop.last().velocity.x() == 0.0) loop.turn();
  EXPECT_NEAR(loop.last().velocity.x(), 2.0, 1e-9);
  EXPECT_NEAR(loop.last().position.x(), 2.0 * (loop.now - Loop::kTurn - start), 1e-6);
  EXPECT_EQ(loop.companion.summary().deadline_misses, 0U);
}

TEST(Companion, LooksForAWayRoundWhereItComesNoNearer) {
  Loop loop;
  loop.airborne();
  loop.planner.speed = 0.01;
  while (loop.planner.jobs.empty()) loop.turn();
  const double begun = loop.planner.jobs.front().begun;
  loop.run(6.0);
  const double moved = loop.now;
  loop.follows = false;
  loop.link.telemetry.motion.value.position.x() += 1.0;
  loop.run(1.0);
  for (const PlanJob& job : loop.planner.jobs) {
    EXPECT_EQ(job.request.stuck, job.begun > begun + 3.99 && job.begun < moved) << job.begun - begun;
    EXPECT_TRUE(!job.request.stuck || job.request.margin == planner::base::HorizonSettings{}.margin);
  }
  EXPECT_EQ(loop.recorder.count("stuck"), 2);
}

// Until it is known how it moves, or for as long as is worth waiting.
TEST(Companion, CruisesSlowlyPastWhatItDoesNotUnderstand) {
  const double cruise = Loop::mission().vehicle.cruise_speed;
  for (const double distance : {6.0, 35.0}) {
    Loop loop;
    loop.airborne();
    for (double t = 0.0; t < 6.0; t += Loop::kTurn) {
      // A circle of 1 m once in 3 s about a place ahead.
      const double phase = 2.1 * loop.now;
      const Vec3 out(std::cos(phase), std::sin(phase), 0.0);
      const Vec3 along(-out.y(), out.x(), 0.0);
      loop.seen = {{.id = 3,
                    .position = Vec3(distance, 3, 2) + out,
                    .velocity = 2.1 * along,
                    .acceleration = -2.1 * 2.1 * out,
                    .radius = 0.4}};
      loop.turn();
    }
    std::vector<double> speeds;
    for (const PlanJob& job : loop.planner.jobs) speeds.push_back(job.request.vehicle.cruise_speed);
    ASSERT_GT(speeds.size(), 20U);
    EXPECT_EQ(speeds.front(), distance < 10.0 ? 0.3 * cruise : cruise) << distance;
    EXPECT_EQ(speeds.back(), cruise) << distance;
    EXPECT_EQ(loop.recorder.count("caution"), distance < 10.0 ? 2 : 0) << distance;
  }
}

TEST(Companion, PlansFromWhereTheVehicleWillBe) {
  Loop loop;
  loop.seen = {{.id = 3, .position = {5, 5, 2}, .velocity = {0, -1, 0}, .radius = 0.4}};
  loop.airborne().fly();
  const PlanJob& job = loop.planner.jobs.back();
  const PlanJob& before = loop.planner.jobs[loop.planner.jobs.size() - 2];
  EXPECT_NEAR((job.request.position - before.request.position).x(), 2.0 * (job.start - before.start), 1e-4);
  EXPECT_NEAR(job.request.velocity.x(), 2.0, 1e-3);
  ASSERT_FALSE(job.previous.empty());
  EXPECT_NEAR(job.previous.front().t, 0.0, 1e-9);
  ASSERT_EQ(job.tracks.size(), 1U);
  EXPECT_NEAR(job.tracks[0].position.y(), 5.0 - (job.start - job.newest_track.value()), 1e-9);
}

TEST(Companion, AVehicleBesideItsReferenceIsPlannedFromWhereItIsAndTheReferenceDoesNotJump) {
  Loop loop;
  loop.airborne().fly();
  const Vec3 beside(0, 0.6, 0.2);
  for (loop.beside = 0.1 * beside; loop.beside.norm() < beside.norm(); loop.beside += 0.1 * beside) loop.run(0.1);
  loop.run(0.5);
  const std::size_t sent = loop.link.sent.size();
  const PlanJob& job = loop.planner.jobs.back();
  EXPECT_LT(
      (job.request.position - loop.link.telemetry.motion.value.position - (job.start - loop.now) * loop.last().velocity)
          .norm(),
      0.15);
  EXPECT_LT((job.offset.offset - beside - Vec3(0.08, 0, 0)).norm(), 0.1);
  // The plan not to give up begins there too, and is back on the old one's way at its end.
  ASSERT_FALSE(job.previous.empty());
  EXPECT_LT((job.previous.front().position - job.request.position).norm(), 1e-9);
  EXPECT_EQ(job.previous.back().position, job.request.target);
  loop.run(1.0);
  for (std::size_t i = sent; i + 1 < loop.link.sent.size(); ++i)
    EXPECT_LT((loop.link.sent[i + 1].position - loop.link.sent[i].position).norm(), 0.06) << i;
}

// It lags behind a reference that dodges: what is planned from the reference's velocity is not what is flown.
TEST(Companion, APlanBeginsWithTheVehiclesVelocityAndOneThatIsKeptIsSoonRejoined) {
  Loop loop;
  loop.airborne().fly();
  loop.drift = {-0.4, 0.3, 0};
  loop.run(0.2);
  const PlanJob& job = loop.planner.jobs.back();
  EXPECT_LT((job.offset.rate - loop.drift).norm(), 0.01);
  ASSERT_FALSE(job.previous.empty());
  EXPECT_LT((job.previous.front().velocity - job.request.velocity).norm(), 1e-9);
  const PlanJob& before = *(loop.planner.jobs.end() - 2);
  const planner::base::TimedPath planned = loop.planner.straight(before.request);
  const auto beside = [&](double t) {
    return (planner::base::sample(job.previous, t).position -
            planner::base::sample(planned, t + job.start - before.start).position)
        .norm();
  };
  EXPECT_GT(beside(0.0), 0.005);
  EXPECT_LT(beside(2.0), 1e-6);
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
  config::Mission m = Loop::mission();
  m.tracks.required = false;
  Loop loop(m, settings);
  loop.airborne().fly();
  loop.tracks = false;
  loop.turn();
  const std::size_t before = loop.planner.jobs.size();
  loop.run(2.0);
  EXPECT_NEAR(static_cast<double>(loop.planner.jobs.size() - before), 20.0, 1.0);
  loop.tracks = true;  // in every turn
  const std::size_t sooner = loop.planner.jobs.size();
  loop.run(2.0);
  EXPECT_NEAR(static_cast<double>(loop.planner.jobs.size() - sooner), 40.0, 2.0);
  loop.planner.takes = 0.3;
  const std::size_t slow = loop.planner.jobs.size();
  loop.run(3.0);
  EXPECT_LE(loop.planner.jobs.size() - slow, 11U);
}

TEST(Companion, EngagingInTheAirDoesNotCallTheVehicleBack) {
  Loop loop;
  loop.airborne();
  loop.obeys = false;
  for (int i = 0; i < 50; ++i) {
    loop.link.telemetry.motion.value.position.x() = 4.0 * loop.now;  // a pilot flies it
    loop.turn();
  }
  EXPECT_NEAR(loop.last().position.x(), 4.0 * (loop.now - Loop::kTurn), 1e-9);
}

// A companion was killed and the vehicle sank: no path leads along the ground.
TEST(Companion, WhatIsTakenOverBelowTheLowestHeightClimbsBeforeItFliesOn) {
  Loop loop;
  loop.airborne({0, 0, 0.4});
  loop.follows = false;
  loop.run(1.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kClimbing);
  EXPECT_EQ(loop.last().position, Vec3(0, 0, 1));
  ASSERT_FALSE(loop.planner.jobs.empty());
  for (const PlanJob& job : loop.planner.jobs) {
    EXPECT_EQ(job.goal, Goal::Kind::kClimb);
    EXPECT_EQ(job.request.target, Vec3(0, 0, 1));
  }
  loop.link.telemetry.motion.value.position.z() = 0.9;
  loop.run(0.5);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
  EXPECT_EQ(loop.planner.jobs.back().request.target, Vec3(20, 0, 2));
}

TEST(Companion, TurnsTheHeadingToTheWaypointAtABoundedRate) {
  config::Mission m = Loop::mission();
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
  EXPECT_NEAR(fastest, 1.5 * Loop::kTurn, 1e-9);
  EXPECT_NEAR(loop.last().yaw, std::numbers::pi / 2.0, 1e-6);
}

TEST(Companion, PlansFromTheVehicleWhereTrackingIsLostAndSaysItOnce) {
  Loop loop;
  loop.airborne().fly();
  loop.follows = false;
  loop.link.telemetry.motion.value.position += Vec3(0, 2.5, 0);
  loop.link.telemetry.motion.value.velocity = {0.5, 0.5, 0};
  const std::size_t jobs = loop.planner.jobs.size();
  while (loop.planner.jobs.size() == jobs) loop.turn();
  const PlanJob& job = loop.planner.jobs.back();
  const Vec3 then =
      loop.link.telemetry.motion.value.position + (job.start - job.begun) * loop.link.telemetry.motion.value.velocity;
  EXPECT_LT((job.request.position - then).norm(), 0.05);  // where it will be when the plan starts
  EXPECT_EQ(job.request.velocity, Vec3(0.5, 0.5, 0));
  EXPECT_TRUE(job.previous.empty());
  EXPECT_EQ(loop.recorder.count("reference_lost"), 1);
  for (int i = 0; i < 25; ++i) {  // it drifts off ahead of every plan
    loop.link.telemetry.motion.value.position += Vec3(0, 0.3, 0);
    loop.turn();
  }
  EXPECT_GT(loop.planner.jobs.size(), jobs + 3);
  EXPECT_EQ(loop.recorder.count("reference_lost"), 1);
}

// What it could not follow it is not asked for again, for a while.
TEST(Companion, AVehicleThatLosesItsReferenceIsAskedForLess) {
  config::Mission m = Loop::mission();
  m.waypoints = {{900, 0, 2}};
  m.geofence.max.x() = 1000;
  m.time_limit = 300.0;
  Loop loop(m);
  loop.airborne().fly();
  const auto asked = [&] { return loop.planner.jobs.back().request.vehicle; };
  const planner::base::VehicleLimits all = asked();
  double expected = 1.0;
  for (int losses = 1; losses <= 4; ++losses) {
    SCOPED_TRACE(losses);
    loop.follows = false;
    loop.link.telemetry.motion.value.position += Vec3(0, 1.5, 0);
    loop.run(0.3);
    loop.follows = true;
    loop.run(0.3);
    expected = std::max(0.25, 0.7 * expected);
    EXPECT_NEAR(asked().cruise_speed / all.cruise_speed, expected, 0.03);
    EXPECT_NEAR(asked().max_acceleration / all.max_acceleration, expected, 0.03);
    EXPECT_EQ(loop.recorder.count("reference_lost"), losses);
  }
  loop.run(40.0);
  EXPECT_NEAR(asked().cruise_speed / all.cruise_speed, 0.65, 0.03);
  loop.run(40.0);
  EXPECT_EQ(asked().cruise_speed, all.cruise_speed);
  EXPECT_EQ(asked().max_acceleration, all.max_acceleration);
}

// PX4's simulator (drag 1/s) was asked for 10 m/s, could not follow, and gave up: the drag leaves no tilt for that.
TEST(Companion, NoSpeedIsAskedForThatTheDragDoesNotLeave) {
  const auto asked = [](double drag, double max_speed) {
    config::Mission m = Loop::mission();
    m.vehicle.drag = drag;
    m.vehicle.max_speed = max_speed;
    m.vehicle.cruise_speed = 5.0;
    m.vehicle.max_acceleration = 5.0;
    Loop loop(m);
    loop.airborne().fly();
    return loop.planner.jobs.front().request.vehicle.max_speed;  // before it has learned anything
  };
  EXPECT_NEAR(asked(1.0, 12.0), 7.5, 1e-9);  // 10 m/s² of a tilt of 45 degrees, less the 2.5 of plans
  EXPECT_EQ(asked(1.0, 6.0), 6.0);
  EXPECT_EQ(asked(0.0, 12.0), 12.0);
  EXPECT_EQ(asked(2.0, 12.0), 5.0);  // what the mission wants is asked for
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
  const double woken = loop.now - Loop::kTurn + 0.006;
  loop.source.messages.push_back({{1, woken, 0.0}, {}, 0});
  loop.companion.step(woken);
  ASSERT_EQ(loop.planner.jobs.size(), jobs + 1);
  EXPECT_EQ(loop.link.sent.size(), sent);  // no setpoint out of turn without a reason
  loop.companion.step(woken + 0.005);
  EXPECT_EQ(loop.link.sent.size(), sent + 1);
  EXPECT_NEAR(loop.companion.summary().track_to_setpoint_ms.back(), 5.0, 1e-6);
}

// Messages every 50 ms; one is late, and the next is not made to wait for that.
TEST(Companion, ATrackInTimeAfterALateOneDoesNotWait) {
  Loop loop;
  loop.airborne().fly();
  loop.tracks = false;
  loop.planner.takes = 0.005;
  loop.run(0.3);
  const double begin = loop.now;
  const std::size_t counted = loop.companion.summary().track_to_setpoint_ms.size();
  for (const double came : {0.0, 0.05, 0.14, 0.15, 0.20}) {
    loop.link.telemetry.motion.stamp = loop.link.telemetry.motion.received = loop.link.telemetry.heartbeat_stamp =
        begin + came;
    loop.source.messages.push_back({{1, begin + came, 0.0}, {}, 0});
    for (const double later : {0.0, 0.006}) loop.companion.step(begin + came + later);
  }
  const std::vector<double>& ms = loop.companion.summary().track_to_setpoint_ms;
  ASSERT_EQ(ms.size(), counted + 5);
  for (std::size_t i = counted; i < ms.size(); ++i) EXPECT_NEAR(ms[i], 6.0, 1e-6) << i;
}

// What was there before the flight, and what was planned for already, waited for nothing.
TEST(Companion, OnlyATrackThatAPlanBeganForIsTimed) {
  Loop loop;
  loop.airborne().fly();
  loop.tracks = false;
  loop.run(0.06);
  EXPECT_EQ(loop.companion.summary().track_to_setpoint_ms.size(), loop.planner.jobs.size() - 1);
  loop.run(0.04);
  const std::size_t counted = loop.companion.summary().track_to_setpoint_ms.size();
  const std::size_t jobs = loop.planner.jobs.size();
  loop.run(0.4);
  EXPECT_GE(loop.planner.jobs.size(), jobs + 3);
  EXPECT_EQ(loop.companion.summary().track_to_setpoint_ms.size(), counted);
}

TEST(Companion, DoesNotFleeFromItsOwnTrack) {
  Loop loop;
  loop.airborne().fly();
  for (int i = 0; i < 100; ++i) {
    planner::base::Track own;
    own.id = 9;
    own.radius = 0.3;
    own.position = loop.link.telemetry.motion.value.position + Vec3(0.05, 0, 0);
    own.velocity = loop.link.telemetry.motion.value.velocity;
    loop.seen = {own};
    loop.turn();
  }
  EXPECT_TRUE(loop.planner.jobs.back().tracks.empty());
  EXPECT_EQ(loop.recorder.last("tracks_self"), "1 tracks are taken for this vehicle itself");
}

TEST(Companion, HoldsClearOfATargetUntilItStaysFree) {
  config::Mission m = Loop::mission();
  m.waypoints = {{1, 0, 2}};
  Loop loop(m);
  loop.planner.speed = 0.4;
  loop.planner.status = planner::verify::PlanStatus::kProgresses;
  loop.airborne().fly();
  EXPECT_TRUE(loop.planner.jobs.back().request.visit);
  EXPECT_FALSE(loop.planner.jobs.back().request.holds);
  loop.run(8.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
  EXPECT_EQ(loop.recorder.count("arrived"), 1);
  EXPECT_FALSE(loop.planner.jobs.back().request.visit);
  EXPECT_TRUE(loop.planner.jobs.back().request.holds);
  EXPECT_FALSE(loop.planner.jobs.back().request.stuck);  // it is where it is to be
  EXPECT_LT(loop.companion.summary().flight_time, 3.0);  // to the target
  loop.planner.status = planner::verify::PlanStatus::kReaches;
  loop.run(0.5);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
  EXPECT_EQ(loop.companion.summary().outcome, supervisor::Outcome::kReached);
  EXPECT_TRUE(loop.companion.summary().reason.starts_with("target reached, free after 6."))
      << loop.companion.summary().reason;
}

// The target itself stays free; however long the plan that ends there is.
TEST(Companion, DoesNotLandOnWhatIsBelow) {
  for (const double stays : {0.0, 5.5}) {
    SCOPED_TRACE(stays);
    config::Mission m = Loop::mission();
    m.arrival = config::Arrival::kLand;
    m.min_height = stays > 0.0 ? 2.0 : 1.0;  // no plan leads further down
    m.waypoints = {{1, 0, 2}};
    Loop loop(m);
    loop.planner.speed = 0.4;
    loop.planner.stays = stays;
    loop.seen = {{.id = 3, .position = {1, 0, 0.5}, .radius = 0.4}};
    loop.airborne().fly();
    loop.run(8.0);
    EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kFlying);
    EXPECT_EQ(loop.recorder.count("arrived"), 1);
    loop.seen = {{.id = 3, .position = {1, 5, 0.5}, .radius = 0.4}};
    loop.run(2.0);
    EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
  }
}

TEST(Companion, ComesDownToLandOnceTheHoldTimeIsOver) {
  config::Mission m = Loop::mission();
  m.arrival = config::Arrival::kLand;
  m.waypoints = {{3, 0, 4}};
  m.hold_time = 4.0;
  Loop loop(m);
  loop.airborne({0, 0, 4}).fly();
  while (loop.recorder.count("holding") == 0 && loop.now < 20.0) loop.turn();
  EXPECT_EQ(loop.recorder.last("holding"), "for 4.0 s, out of the way of what comes");
  loop.run(3.5);
  EXPECT_NEAR(loop.last().position.z(), 4.0, 0.05);
  EXPECT_EQ(loop.recorder.count("arrived"), 0);
  loop.run(6.0);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
  EXPECT_LT(loop.last().position.z(), 1.4);
}

TEST(Companion, LandsWhereTheMissionSaysSo) {
  config::Mission m = Loop::mission();
  m.arrival = config::Arrival::kLand;
  m.waypoints = {{3, 0, 2}};
  Loop loop(m);
  loop.airborne().fly();
  loop.run(3.0);
  EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kLand);
  const std::size_t sent = loop.link.sent.size();
  loop.run(2.0);
  EXPECT_EQ(loop.link.sent.size(), sent);
  loop.link.telemetry.armed = loop.link.telemetry.in_air = false;
  loop.turn();
  EXPECT_EQ(loop.companion.summary().outcome, supervisor::Outcome::kReached);
}

}  // namespace
}  // namespace jink::bridge::companion
