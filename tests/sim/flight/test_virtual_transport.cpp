// SPDX-License-Identifier: BSD-3-Clause
// The link and the tracks of virtual time under each fault.
#include "sim/flight/virtual_transport.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "bridge/tracking/track_inbox.hpp"
#include "sim/faults/vehicle_faults.hpp"

namespace jink::sim::flight {
namespace {

vehicle::AutopilotOptions airborne() {
  vehicle::AutopilotOptions options;
  options.position = {0, 0, 10};
  options.airborne = true;
  options.ready_delay = 0.0;
  return options;
}

/// An autopilot in the air at its link, stepped together; telemetry at 50 Hz.
class VirtualLinkTest : public testing::Test {
 protected:
  void run(double seconds, bool stream = false) {
    const double end = autopilot.time() + seconds;
    for (; autopilot.time() < end - 1e-9; ++step) {
      link.advance(autopilot.time());
      if (step % 5 == 0) {
        link.send_telemetry();
        const bool sent = !stream || link.send(setpoint);
        EXPECT_TRUE(sent);
      }
      autopilot.step();
    }
  }
  std::vector<bridge::vehicle::CommandReport> reports() {
    std::vector<bridge::vehicle::CommandReport> all;
    while (auto report = link.next_report()) all.push_back(*report);
    return all;
  }

  vehicle::Autopilot autopilot{airborne()};
  VirtualLink link{autopilot, 1};
  bridge::vehicle::Setpoint setpoint{{0, 0, 10}, Vec3::Zero(), Vec3::Zero(), 0.0};
  int step = 0;
};

TEST_F(VirtualLinkTest, TellsWhatTheAutopilotKnows) {
  EXPECT_LT(link.state().heartbeat_stamp, 0.0);
  run(0.02);
  const bridge::vehicle::VehicleState state = link.state();
  EXPECT_EQ(state.heartbeat_stamp, 0.0);
  EXPECT_TRUE(state.armed);
  EXPECT_EQ(state.mode, bridge::vehicle::FlightMode::kHold);
  EXPECT_EQ(state.motion.value.position, Vec3(0, 0, 10));
  EXPECT_EQ(state.battery, bridge::vehicle::BatteryState::kOk);
  EXPECT_EQ(state.system_id, 1U);
  EXPECT_FALSE(state.failsafe);
  EXPECT_TRUE(state.local_position_ok);
  ASSERT_TRUE(state.origin);
  EXPECT_NEAR(state.origin->latitude_deg, vehicle::kSitlOrigin.latitude_deg, 1e-9);
  EXPECT_NEAR(state.origin->altitude_m, vehicle::kSitlOrigin.altitude_m, 1e-6);
}

TEST_F(VirtualLinkTest, BatteryFailsafeAndGpsAreTold) {
  autopilot.set_battery(0.12);
  run(0.1);
  EXPECT_EQ(link.state().battery, bridge::vehicle::BatteryState::kLow);
  autopilot.set_battery(0.06);
  run(0.1);
  EXPECT_EQ(link.state().battery, bridge::vehicle::BatteryState::kCritical);
  autopilot.set_battery(1.0);
  autopilot.set_gps(false);
  run(8.0);
  EXPECT_FALSE(link.state().local_position_ok);
  EXPECT_FALSE(link.state().health.empty());
}

TEST_F(VirtualLinkTest, AFailsafeIsTold) {
  run(0.2, true);
  link.request(bridge::vehicle::Command::kOffboard);
  run(0.5, true);
  EXPECT_EQ(link.state().mode, bridge::vehicle::FlightMode::kOffboard);
  EXPECT_FALSE(link.state().failsafe);
  run(1.5);  // the stream stops
  EXPECT_TRUE(link.state().failsafe);
}

TEST_F(VirtualLinkTest, AJumpOfTheEstimateIsCountedWithItsShift) {
  run(0.1);
  EXPECT_EQ(link.state().estimate_resets, 0U);
  autopilot.jump_estimate({3, 0, 1});
  link.note_reset({3, 0, 1});
  run(0.02);
  EXPECT_EQ(link.state().estimate_resets, 1U);
  EXPECT_EQ(link.state().estimate_shift, Vec3(3, 0, 1));
  EXPECT_NEAR(link.state().motion.value.position.x(), 3.0, 0.1);
}

TEST_F(VirtualLinkTest, TelemetryStopsWhereTheLinkIsLostDownwards) {
  run(0.1);
  link.impair({.down = {.loss = 1.0}});
  run(0.5, true);
  EXPECT_NEAR(link.state().motion.stamp, 0.08, 1e-9);
  EXPECT_TRUE(autopilot.stream_live());  // upwards it works
  link.impair({});
  run(0.1);
  EXPECT_GT(link.state().motion.stamp, 0.6);
}

TEST_F(VirtualLinkTest, SetpointsStopWhereTheLinkIsLostUpwards) {
  run(0.2, true);
  EXPECT_TRUE(autopilot.stream_live());
  link.impair({.up = {.loss = 1.0}});
  run(1.5, true);
  EXPECT_FALSE(autopilot.stream_live());
  EXPECT_GT(link.state().motion.stamp, 1.6);
}

TEST_F(VirtualLinkTest, DelayedTelemetryTellsOfThePast) {
  run(0.1);
  link.impair({.down = {.delay = 0.2}});
  run(1.0);
  autopilot.set_battery(0.12);
  run(0.18);
  EXPECT_EQ(link.state().battery, bridge::vehicle::BatteryState::kOk);
  run(0.1);
  EXPECT_EQ(link.state().battery, bridge::vehicle::BatteryState::kLow);
}

TEST_F(VirtualLinkTest, ACommandIsAnsweredAtOnceOnAGoodLink) {
  link.request(bridge::vehicle::Command::kLand);
  const auto answers = reports();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_TRUE(answers[0].accepted);
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kLand);
}

// Whoever asks decides whether to ask again: what is lost may be wrong by then.
TEST_F(VirtualLinkTest, ALostCommandIsNotSentAgain) {
  link.impair({.up = {.loss = 1.0}});
  link.request(bridge::vehicle::Command::kLand);
  run(0.3);
  EXPECT_TRUE(reports().empty());
  link.impair({});
  run(1.0);
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kHold);
  const auto answers = reports();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_FALSE(answers[0].accepted);
}

TEST_F(VirtualLinkTest, ACommandThatIsNeverAnsweredIsReportedAsThat) {
  link.impair({.down = {.loss = 1.0}});
  link.request(bridge::vehicle::Command::kLand);
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kLand);  // it came through; the answer did not
  run(0.9);
  EXPECT_TRUE(reports().empty());
  run(0.3);
  const auto answers = reports();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_FALSE(answers[0].accepted);
  EXPECT_EQ(answers[0].detail, "no answer");
}

TEST_F(VirtualLinkTest, ARebootIsSilenceThenADisarmedVehicle) {
  run(0.1);
  autopilot.reboot();
  run(1.0, true);
  EXPECT_NEAR(link.state().heartbeat_stamp, 0.08, 1e-9);
  EXPECT_TRUE(link.state().armed);  // the last that was heard
  EXPECT_EQ(link.state().reboots, 0U);
  run(0.5, true);
  EXPECT_FALSE(link.state().armed);
  EXPECT_EQ(link.state().reboots, 1U);
}

// As over MAVLink: PX4 sends none then.
TEST_F(VirtualLinkTest, AnAutopilotThatDoesNotKnowWhereItIsTellsNoPosition) {
  autopilot.set_gps(false);
  run(4.0, true);
  EXPECT_NEAR(link.state().motion.received, 3.98, 1e-9);
  run(4.0, true);
  EXPECT_FALSE(link.state().local_position_ok);
  EXPECT_NEAR(link.state().motion.received, 5.0, 0.03);
  EXPECT_GT(link.state().heartbeat_stamp, 7.9);
}

TEST_F(VirtualLinkTest, SaysWhatKeepsItFromBeingArmed) {
  run(0.1);
  EXPECT_EQ(link.state().health, "");
  vehicle::AutopilotOptions options;
  options.ready_delay = 1.0;
  vehicle::Autopilot starting(options);
  VirtualLink its(starting, 1);
  its.send_telemetry();
  EXPECT_FALSE(its.state().armable);
  EXPECT_EQ(its.state().health, "pre-arm check");
}

class VirtualTracksTest : public testing::Test {
 protected:
  static world::World world_with_two() {
    config::Scenario scenario;
    for (const double x : {5.0, 9.0})
      scenario.obstacles.push_back(
          {config::SphereShape{0.5}, config::LinearMotion{{x, 0, 1}, {0, 1, 0}, Vec3::Zero()}});
    return world::World(std::move(scenario));
  }
  /// The messages from now to `t` under one fault from the start.
  std::vector<bridge::tracking::TrackMessage> under(config::Fault fault, double t) {
    faults::FaultTimeline timeline({fault});
    VirtualTracks tracks(world, timeline, 1);
    std::vector<bridge::tracking::TrackMessage> all;
    for (int step = 0; 0.004 * step <= t; ++step) {
      timeline.advance(0.004 * step);
      tracks.advance(0.004 * step, world::VehicleTruth{});
      for (bridge::tracking::TrackMessage message; tracks.poll(message);) all.push_back(message);
    }
    status = tracks.status();
    return all;
  }
  static config::Fault of(config::FaultKind kind) {
    config::Fault fault;
    fault.kind = kind;
    return fault;
  }
  world::World world = world_with_two();
  bridge::tracking::TrackSourceStatus status;
};

TEST_F(VirtualTracksTest, GarbageIsDroppedAndCountedAndTheRestKept) {
  const auto messages = under(of(config::FaultKind::kTracksGarbage), 1.0);
  ASSERT_EQ(messages.size(), 21U);
  std::uint64_t dropped = 0;
  std::size_t kept = 0;
  for (const bridge::tracking::TrackMessage& message : messages) {
    dropped += message.dropped;
    kept += message.tracks.size();
    for (const planner::base::Track& track : message.tracks) {
      EXPECT_TRUE(track.position.allFinite());
      EXPECT_GT(track.radius, 0.0);
      EXPECT_LE(track.position.norm(), 1e3);
    }
  }
  EXPECT_GE(dropped, 4U * 21U);
  EXPECT_EQ(dropped, status.dropped_tracks);
  EXPECT_EQ(dropped + kept, 6U * 21U);
  EXPECT_GT(kept, 0U);
  EXPECT_FALSE(status.last_refusal.empty());
}

TEST_F(VirtualTracksTest, AMessageHoldsNoMoreThanTheReaderTakes) {
  config::Fault fault = of(config::FaultKind::kTracksFlood);
  fault.count = 20000;
  const auto messages = under(fault, 0.0);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].tracks.size(), bridge::tracking::TrackLimits::kTracksPerMessage);
  EXPECT_EQ(messages[0].tracks[0].id, 1U);
  EXPECT_EQ(messages[0].dropped, 20002U - bridge::tracking::TrackLimits::kTracksPerMessage);
}

TEST_F(VirtualTracksTest, AWrongClockShowsInTheAge) {
  config::Fault fault = of(config::FaultKind::kTracksClock);
  fault.offset = 3600.0;
  for (const bridge::tracking::TrackMessage& message : under(fault, 0.5)) EXPECT_NEAR(message.stamp_age, -3600.0, 0.01);
  fault.offset = 0.0;
  for (const bridge::tracking::TrackMessage& message : under(fault, 0.5)) EXPECT_NEAR(message.stamp_age, 0.0, 0.01);
}

TEST_F(VirtualTracksTest, StoppedTracksAreSilenceFromALivingWriter) {
  EXPECT_TRUE(under(of(config::FaultKind::kTracksStop), 1.0).empty());
  EXPECT_EQ(status.writers, 1);
  EXPECT_EQ(status.messages, 0U);
}

}  // namespace
}  // namespace jink::sim::flight
