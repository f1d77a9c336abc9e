// SPDX-License-Identifier: BSD-3-Clause
// The simulator whole, over loopback sockets on free ports, in virtual time: several vehicles in one world.
#include "sim/simulator/simulator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/sim/examples.hpp"
#include "tests/sim/mavlink/loopback_companion.hpp"

namespace jink::sim::simulator {
namespace {

config::Scenario two_vehicles() {
  config::Scenario scenario;
  scenario.name = "two";
  scenario.start = {0, 0, 1.5};
  scenario.target = {6, 0, 1.5};
  scenario.vehicles.push_back({{0, 3, 1.5}, {6, 3, 1.5}, "inline", scenario.vehicle});
  return scenario;
}

/// What the simulator says, and a companion for each vehicle.
class Stage final : public SimulatorObserver {
 public:
  explicit Stage(const config::Scenario& scenario) : companions(1 + scenario.vehicles.size()) {
    SimulatorOptions options;
    for (std::size_t k = 0; k < companions.size(); ++k)
      options.endpoints.push_back(companions[k].endpoint(static_cast<int>(k)));
    const auto publish = [this](const world::TrackMessage& message, double now) {
      publications.push_back({now, message});
      return true;
    };
    simulator = std::make_unique<Simulator>(scenario, options, SimulatorParts{publish, {this}});
    for (std::size_t k = 0; k < companions.size(); ++k)
      companions[k].connect(simulator->endpoint(k).companion_port(), static_cast<int>(k) + 1);
  }

  void on_event(double, std::string_view name, const std::string& detail) override {
    events.push_back(std::string(name) + ": " + detail);
  }
  void on_truth(double, std::span<const world::VehicleTruth> vehicles, const world::World&) override {
    truths.emplace_back(vehicles.begin(), vehicles.end());
  }

  /// Steps for `seconds` or until `done`; each vehicle that has a place in `goals` is streamed it, armed and put in
  /// OFFBOARD. Whether it was done.
  bool run(double seconds, const std::vector<std::optional<Vec3>>& goals, const std::function<bool()>& done) {
    const auto steps = static_cast<int>(seconds / vehicle::VehicleModel::kStep);
    for (int step = 0; step < steps && !done(); ++step) {
      for (std::size_t k = 0; k < goals.size(); ++k) {
        if (!goals[k]) continue;
        if (step % 5 == 0) companions[k].setpoint(*goals[k]);
        if (step % 125 != 60) continue;
        if (simulator->autopilot(k).mode() != vehicle::FlightMode::kOffboard) companions[k].offboard();
        if (simulator->autopilot(k).ready() && !simulator->autopilot(k).armed()) companions[k].arm();
      }
      simulator->step();
    }
    return done();
  }
  [[nodiscard]] bool said(const std::string& begin) const {
    return std::any_of(events.begin(), events.end(), [&](const std::string& e) { return e.starts_with(begin); });
  }

  struct Publication {
    double now;
    world::TrackMessage message;
  };
  std::vector<mavlink::LoopbackCompanion> companions;
  std::vector<std::string> events;
  std::vector<Publication> publications;
  std::vector<std::vector<world::VehicleTruth>> truths;
  std::unique_ptr<Simulator> simulator;
};

TEST(Simulator, EachVehicleIsAnInstanceOfItsOwnInTheSameFrame) {
  Stage stage(two_vehicles());
  ASSERT_EQ(stage.simulator->vehicle_count(), 2U);
  for (int step = 0; step < 1000; ++step) stage.simulator->step();
  for (std::size_t k = 0; k < 2; ++k) {
    bool position = false;
    for (const mavlink_message_t& message : stage.companions[k].drain()) {
      EXPECT_EQ(message.sysid, k + 1);
      if (message.msgid != MAVLINK_MSG_ID_LOCAL_POSITION_NED) continue;
      position = true;
      EXPECT_NEAR(mavlink_msg_local_position_ned_get_x(&message), 3.0 * static_cast<double>(k), 0.5);
    }
    EXPECT_TRUE(position) << k;
  }
  ASSERT_FALSE(stage.truths.empty());
  ASSERT_EQ(stage.truths.back().size(), 2U);
  EXPECT_EQ(stage.truths.back()[1].position, Vec3(0, 3, 0));
}

TEST(Simulator, TheClockWaitsForEveryVehicle) {
  config::Scenario scenario = two_vehicles();
  scenario.obstacles = {ball(0.5, {3, -8, 1.5}, {0, 1, 0})};
  Stage stage(scenario);
  const auto at_start = [&](std::size_t k) {
    return (stage.simulator->autopilot(k).true_motion().position - stage.simulator->vehicle(k).start).norm() < 0.4;
  };
  EXPECT_TRUE(stage.run(40.0, {scenario.start, std::nullopt}, [&] { return at_start(0); }));
  EXPECT_FALSE(stage.run(2.0, {scenario.start, std::nullopt}, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_EQ(stage.publications.back().message.tracks.at(0).position, Vec3(3, -8, 1.5));
  EXPECT_EQ(stage.simulator->reports()[0].flight.reason, "another vehicle never came to its start in OFFBOARD");
  EXPECT_EQ(stage.simulator->reports()[1].flight.reason, "the vehicle never came to the start in OFFBOARD");
  // The first need not wait at its start for the second.
  const Vec3 ahead = scenario.start + Vec3(2, 0, 0);
  EXPECT_TRUE(stage.run(40.0, {ahead, scenario.vehicles[0].start}, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_TRUE(stage.said("clock: "));
  EXPECT_FALSE(stage.run(1.0, {ahead, scenario.vehicles[0].start}, [] { return false; }));
  EXPECT_GT(stage.publications.back().message.tracks.at(0).position.y(), -7.5);
}

// What a companion can fly by is the estimate: the vehicle itself may pass its start a metre beside it.
TEST(Simulator, TheClockStartsWhereTheVehicleBelievesToBeAtItsStart) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles.clear();
  scenario.estimate = {.px4 = false, .drift = 2.0};
  Stage stage(scenario);
  const vehicle::Autopilot& autopilot = stage.simulator->autopilot(0);
  const auto away = [&](const vehicle::Motion& motion) { return (motion.position - scenario.start).norm(); };
  double nearest = away(autopilot.true_motion());
  EXPECT_TRUE(stage.run(60.0, {scenario.start}, [&] {
    if (autopilot.mode() == vehicle::FlightMode::kOffboard) nearest = std::min(nearest, away(autopilot.true_motion()));
    return stage.simulator->clock_runs();
  }));
  EXPECT_GT(nearest, Simulator::kAtStart);
  EXPECT_LE(away(autopilot.estimated_motion()), Simulator::kAtStart + 0.01);
}

TEST(Simulator, WhatChasesAVehicleComesOnceTheClockRuns) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles.clear();
  scenario.obstacles = {{config::SphereShape{0.3}, config::ChaseMotion{{0, 9, 1.5}, 2.0}}};
  Stage stage(scenario);
  EXPECT_TRUE(stage.run(40.0, {scenario.start}, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_EQ(stage.publications.back().message.tracks.at(0).position, Vec3(0, 9, 1.5));
  EXPECT_FALSE(stage.run(2.0, {scenario.start}, [] { return false; }));
  const planner::base::Track& seen = stage.publications.back().message.tracks.at(0);
  EXPECT_NEAR(seen.position.y(), 5.1, 0.3);
  EXPECT_NEAR(seen.velocity.y(), -2.0, 0.1);
}

TEST(Simulator, SaysThatAFlightNeverCameToItsStart) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles.clear();
  scenario.obstacles = {ball(0.5, {3, -8, 1.5})};
  Stage stage(scenario);
  const Vec3 elsewhere = scenario.start + Vec3(2, 0, 0);
  EXPECT_FALSE(stage.run(10.0, {elsewhere}, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_FALSE(stage.said("clock: "));
  EXPECT_FALSE(stage.run(20.0, {elsewhere}, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_TRUE(stage.said("clock: flies, but has not been within 0.5 m of its start"));
}

TEST(Simulator, VehiclesThatCollideFallAndBothHaveFailed) {
  const config::Scenario scenario = two_vehicles();
  Stage stage(scenario);
  const std::vector<std::optional<Vec3>> starts{scenario.start, scenario.vehicles[0].start};
  ASSERT_TRUE(stage.run(40.0, starts, [&] { return stage.simulator->clock_runs(); }));
  EXPECT_FALSE(stage.simulator->failed());
  ASSERT_TRUE(stage.run(20.0, {Vec3(0, 1.5, 1.5), Vec3(0, 1.5, 1.5)}, [&] { return stage.simulator->failed(); }));
  const std::vector<flight::VehicleReport> reports = stage.simulator->reports();
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(reports[k].flight.outcome, bridge::supervisor::Outcome::kCollision);
    EXPECT_LT(reports[k].min_clearance, 0.0);
    EXPECT_TRUE(stage.simulator->autopilot(k).crashed());
  }
  EXPECT_TRUE(stage.said("collision: COLLISION: vehicle 0: hit vehicle 1")) << stage.events.back();
  EXPECT_TRUE(stage.said("collision: COLLISION: vehicle 1: hit vehicle 0"));
  EXPECT_EQ(flight::worst(reports), bridge::supervisor::Outcome::kCollision);
}

TEST(Simulator, OneVehicleMayReachWhileAnotherIsHit) {
  config::Scenario scenario = two_vehicles();
  scenario.obstacles = {ball(0.6, {3, 3, 1.5})};
  Stage stage(scenario);
  const std::vector<std::optional<Vec3>> starts{scenario.start, scenario.vehicles[0].start};
  ASSERT_TRUE(stage.run(40.0, starts, [&] { return stage.simulator->clock_runs(); }));
  stage.run(12.0, {scenario.target, scenario.vehicles[0].target}, [] { return false; });
  const std::vector<flight::VehicleReport> reports = stage.simulator->reports();
  EXPECT_EQ(reports[0].flight.outcome, bridge::supervisor::Outcome::kReached) << reports[0].flight.reason;
  EXPECT_EQ(reports[1].flight.outcome, bridge::supervisor::Outcome::kCollision) << reports[1].flight.reason;
  EXPECT_FALSE(stage.simulator->autopilot(0).crashed());
  EXPECT_TRUE(stage.simulator->autopilot(1).crashed());
  EXPECT_GT(reports[0].min_clearance, 1.0);
}

TEST(Simulator, TracksArePublishedOnceWithinRangeOfAnyVehicle) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles[0].start = {0, 30, 1.5};
  scenario.sensing.range = 5.0;
  scenario.obstacles = {ball(0.5, {0, 3, 1.5}), ball(0.5, {0, 27, 1.5}), ball(0.5, {0, 15, 1.5})};
  Stage stage(scenario);
  for (int step = 0; step < 251; ++step) stage.simulator->step();
  EXPECT_EQ(stage.publications.size(), 21U);  // 20 Hz from t = 0 to 1
  std::vector<std::uint64_t> ids;
  for (const planner::base::Track& track : stage.publications.back().message.tracks) ids.push_back(track.id);
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{1, 2}));
}

TEST(Simulator, WithoutVehiclesTheObstaclesMoveAtOnce) {
  config::Scenario scenario = two_vehicles();
  scenario.obstacles = {ball(0.5, {3, -8, 1.5}, {0, 1, 0})};
  std::vector<world::TrackMessage> messages;
  SimulatorOptions options;
  options.vehicles = false;
  Simulator simulator(scenario, options,
                      {[&](const world::TrackMessage& message, double) {
                         messages.push_back(message);
                         return true;
                       },
                       {}});
  for (int step = 0; step < 251; ++step) simulator.step();
  EXPECT_TRUE(simulator.clock_runs());
  EXPECT_TRUE(simulator.reports().empty());
  ASSERT_FALSE(messages.empty());
  EXPECT_NEAR(messages.back().tracks.at(0).position.y(), -7.0, 1e-9);
}

/// How many messages came to each companion in `seconds`.
std::vector<std::size_t> heard(Stage& stage, double seconds) {
  for (mavlink::LoopbackCompanion& companion : stage.companions) companion.drain();
  std::vector<std::size_t> counts(stage.companions.size());
  for (int step = 0; step < static_cast<int>(seconds / vehicle::VehicleModel::kStep); ++step) {
    stage.simulator->step();
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += stage.companions[k].drain().size();
  }
  return counts;
}

// `at: 0` is in force from the start, while the scenario's clock stands.
TEST(Simulator, ALinkIsLostDownwardsForTheVehicleThatIsNamed) {
  config::Scenario scenario = two_vehicles();
  scenario.faults = {fault(config::FaultKind::kLinkLoss, 0)};
  scenario.faults[0].direction = config::LinkDirection::kDown;
  scenario.faults[0].vehicle = 1;
  Stage stage(scenario);
  const auto counts = heard(stage, 5.0);
  EXPECT_GT(counts[0], 500U);
  EXPECT_EQ(counts[1], 0U);
  EXPECT_TRUE(stage.said("fault: fault: link_loss, down, vehicle 1 begins"));
  // Upwards it works.
  stage.companions[1].setpoint({0, 3, 1.5});
  stage.simulator->step();
  EXPECT_TRUE(stage.simulator->autopilot(1).stream_live());
}

TEST(Simulator, ALinkIsLostUpwards) {
  config::Scenario scenario = two_vehicles();
  scenario.faults = {fault(config::FaultKind::kLinkLoss, 0)};
  scenario.faults[0].direction = config::LinkDirection::kUp;
  Stage stage(scenario);
  EXPECT_GT(heard(stage, 5.0)[0], 500U);
  stage.companions[0].setpoint({0, 0, 1.5});
  stage.simulator->step();
  EXPECT_FALSE(stage.simulator->autopilot(0).stream_live());
}

TEST(Simulator, PacketsAreLostAtTheirRate) {
  const auto count = [](double rate) {
    config::Scenario scenario = two_vehicles();
    scenario.faults = {fault(config::FaultKind::kPacketLoss, 0)};
    scenario.faults[0].rate = rate;
    Stage stage(scenario);
    return static_cast<double>(heard(stage, 8.0)[0]);
  };
  const double all = count(0.0);
  EXPECT_NEAR(count(0.2) / all, 0.8, 0.05);
}

TEST(Simulator, PacketsAreLateBothWays) {
  config::Scenario scenario = two_vehicles();
  scenario.faults = {fault(config::FaultKind::kDelay, 0)};
  scenario.faults[0].seconds = 0.2;
  Stage stage(scenario);
  stage.simulator->step();
  stage.companions[0].setpoint({0, 0, 1.5});
  for (int step = 0; step < 48; ++step) stage.simulator->step();
  EXPECT_FALSE(stage.simulator->autopilot(0).stream_live());
  for (int step = 0; step < 5; ++step) stage.simulator->step();
  EXPECT_TRUE(stage.simulator->autopilot(0).stream_live());
  // What the vehicle says of itself is 0.2 s old.
  stage.companions[0].drain();
  heard(stage, 3.0);
  bool seen = false;
  for (int step = 0; step < 100; ++step) {
    stage.simulator->step();
    for (const mavlink_message_t& message : stage.companions[0].drain()) {
      if (message.msgid != MAVLINK_MSG_ID_LOCAL_POSITION_NED) continue;
      const double told = 1e-3 * mavlink_msg_local_position_ned_get_time_boot_ms(&message);
      EXPECT_NEAR(stage.simulator->now() - told, 0.2, 0.01);
      seen = true;
    }
  }
  EXPECT_TRUE(seen);
}

TEST(Simulator, PacketsComeOutOfOrder) {
  const auto disorder = [](double rate) {
    config::Scenario scenario = two_vehicles();
    scenario.faults = {fault(config::FaultKind::kReorder, 0)};
    scenario.faults[0].rate = rate;
    Stage stage(scenario);
    int count = 0;
    int last = -1;
    for (int step = 0; step < 1500; ++step) {
      stage.simulator->step();
      for (const mavlink_message_t& message : stage.companions[0].drain()) {
        const int ahead = last < 0 ? 1 : (message.seq - last + 256) % 256;
        count += ahead > 128;
        last = message.seq;
      }
    }
    return count;
  };
  EXPECT_EQ(disorder(0.0), 0);
  EXPECT_GT(disorder(0.1), 50);
}

TEST(Simulator, TracksStopOnceTheScenarioClockSaysSo) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles.clear();
  scenario.obstacles = {ball(0.5, {3, -8, 1.5})};
  scenario.faults = {fault(config::FaultKind::kTracksStop, 1, 2)};
  Stage stage(scenario);
  for (int step = 0; step < 1250; ++step) stage.simulator->step();
  EXPECT_EQ(stage.publications.size(), 100U);  // the clock stands: no fault yet
  ASSERT_TRUE(stage.run(40.0, {scenario.start}, [&] { return stage.simulator->clock_runs(); }));
  const double begun = stage.simulator->now();
  stage.run(5.0, {scenario.start}, [] { return false; });
  const auto within = [&](double from, double to) {
    return std::count_if(stage.publications.begin(), stage.publications.end(),
                         [&](const auto& p) { return p.now > begun + from + 0.01 && p.now < begun + to - 0.01; });
  };
  EXPECT_GE(within(0, 1), 18);
  EXPECT_EQ(within(1, 3), 0);
  EXPECT_GE(within(3, 5), 37);
  EXPECT_TRUE(stage.said("fault: fault: tracks_stop, for 2 s begins"));
  EXPECT_TRUE(stage.said("fault: fault: tracks_stop, for 2 s ends"));
}

TEST(Simulator, FaultsBefallTheAutopilotThatIsNamed) {
  config::Scenario scenario = two_vehicles();
  scenario.faults = {fault(config::FaultKind::kLowBattery, 0), fault(config::FaultKind::kReboot, 0)};
  scenario.faults[0].remaining = 0.3;
  scenario.faults[0].vehicle = 0;
  scenario.faults[1].vehicle = 1;
  Stage stage(scenario);
  stage.simulator->step();
  EXPECT_EQ(stage.simulator->autopilot(0).battery(), 0.3);
  EXPECT_EQ(stage.simulator->autopilot(1).battery(), 1.0);
  EXPECT_EQ(stage.simulator->autopilot(0).reboots(), 0);
  EXPECT_EQ(stage.simulator->autopilot(1).reboots(), 1);
}

TEST(Simulator, InLockstepEveryCompanionInOffboardOwesASetpoint) {
  const config::Scenario scenario = two_vehicles();
  Stage stage(scenario);
  Simulator& simulator = *stage.simulator;
  simulator.begin_turn();
  EXPECT_TRUE(simulator.answered());  // nobody is in OFFBOARD
  const std::vector<std::optional<Vec3>> starts{scenario.start, scenario.vehicles[0].start};
  ASSERT_TRUE(stage.run(40.0, starts, [&] { return simulator.clock_runs(); }));
  simulator.begin_turn();
  EXPECT_FALSE(simulator.answered());
  stage.companions[0].setpoint(scenario.start);
  const double before = simulator.now();
  simulator.poll();
  EXPECT_FALSE(simulator.answered());  // one of two
  stage.companions[1].setpoint(scenario.vehicles[0].start);
  simulator.poll();
  EXPECT_TRUE(simulator.answered());
  EXPECT_EQ(simulator.now(), before);  // time has not gone on

  simulator.begin_turn();
  EXPECT_FALSE(simulator.answered());
  EXPECT_EQ(simulator.give_up(), 2);
  EXPECT_TRUE(simulator.answered());
  simulator.begin_turn();
  EXPECT_TRUE(simulator.answered());  // still given up
  EXPECT_EQ(simulator.give_up(), 0);
  stage.companions[0].setpoint(scenario.start);
  simulator.poll();
  simulator.begin_turn();
  EXPECT_FALSE(simulator.answered());  // waited for again
}

// An answer counts when it is sent: a link that holds it back must not hold time back too.
TEST(Simulator, InLockstepALateSetpointIsAnAnswer) {
  config::Scenario scenario = two_vehicles();
  scenario.vehicles.clear();
  scenario.faults = {fault(config::FaultKind::kDelay, 0.1)};
  scenario.faults[0].seconds = 0.5;
  Stage stage(scenario);
  ASSERT_TRUE(stage.run(40.0, {scenario.start}, [&] { return stage.simulator->clock_runs(); }));
  stage.run(0.5, {scenario.start}, [] { return false; });
  stage.simulator->begin_turn();
  EXPECT_FALSE(stage.simulator->answered());
  stage.companions[0].setpoint(scenario.start);
  stage.simulator->poll();
  EXPECT_TRUE(stage.simulator->answered());
}

}  // namespace
}  // namespace jink::sim::simulator
