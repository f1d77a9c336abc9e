// SPDX-License-Identifier: BSD-3-Clause
// The timeline, the bad link, and what befalls an autopilot.
#include "sim/faults/fault_timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/faults/link_faults.hpp"
#include "sim/faults/vehicle_faults.hpp"
#include "tests/sim/examples.hpp"

namespace jink::sim::faults {
namespace {

using config::Fault;
using config::FaultKind;
using config::LinkDirection;

std::vector<std::string> texts(FaultTimeline& timeline, double t) {
  std::vector<std::string> all;
  for (const FaultChange& change : timeline.advance(t)) all.push_back(timeline.describe(change));
  return all;
}

TEST(FaultTimeline, TellsEachBeginningAndEndOnceInOrderOfTime) {
  FaultTimeline timeline({fault(FaultKind::kTracksStop, 5, 1), fault(FaultKind::kGpsLoss, 0, 2),
                          fault(FaultKind::kReboot, 2), fault(FaultKind::kIdSwap, 6)});
  using Texts = std::vector<std::string>;
  EXPECT_EQ(texts(timeline, 0.0), (Texts{"gps_loss, for 2 s begins"}));
  EXPECT_TRUE(timeline.active(FaultKind::kGpsLoss));
  EXPECT_EQ(texts(timeline, 1.999), Texts{});
  EXPECT_EQ(texts(timeline, 2.0), (Texts{"gps_loss, for 2 s ends", "reboot"}));
  EXPECT_FALSE(timeline.active(FaultKind::kGpsLoss));
  EXPECT_FALSE(timeline.active(FaultKind::kReboot));
  // Nothing in between is left out, and an end comes before a beginning at the same time.
  EXPECT_EQ(texts(timeline, 6.0),
            (Texts{"tracks_stop, for 1 s begins", "tracks_stop, for 1 s ends", "id_swap begins"}));
  EXPECT_TRUE(timeline.active(FaultKind::kIdSwap));
  EXPECT_EQ(texts(timeline, 1e6), Texts{});
  EXPECT_TRUE(timeline.active(FaultKind::kIdSwap));  // for good
}

TEST(FaultTimeline, KnowsWhichVehicleAFaultBefalls) {
  Fault one = fault(FaultKind::kLowBattery, 0);
  one.vehicle = 1;
  one.remaining = 0.2;
  FaultTimeline timeline({one});
  timeline.advance(0);
  EXPECT_FALSE(timeline.active(FaultKind::kLowBattery, 0));
  ASSERT_NE(timeline.find(FaultKind::kLowBattery, 1), nullptr);
  EXPECT_EQ(timeline.find(FaultKind::kLowBattery, 1)->remaining, 0.2);
}

TEST(FaultTimeline, CombinesWhatIsWrongWithALink) {
  Fault loss = fault(FaultKind::kPacketLoss, 0);
  loss.rate = 0.5;
  Fault more = loss;
  more.direction = LinkDirection::kUp;
  Fault delay = fault(FaultKind::kDelay, 0, 2);
  delay.seconds = 0.2;
  delay.direction = LinkDirection::kDown;
  Fault longer = delay;
  longer.seconds = 0.1;
  Fault reorder = fault(FaultKind::kReorder, 0);
  reorder.rate = 0.25;
  reorder.vehicle = 1;
  Fault cut = fault(FaultKind::kLinkLoss, 3, 1);
  cut.direction = LinkDirection::kDown;
  FaultTimeline timeline({loss, more, delay, longer, reorder, cut});
  timeline.advance(0);
  EXPECT_EQ(timeline.link(0).up, (Impairment{.loss = 0.75}));
  EXPECT_EQ(timeline.link(0).down.loss, 0.5);
  EXPECT_NEAR(timeline.link(0).down.delay, 0.3, 1e-12);
  EXPECT_EQ(timeline.link(0).up.reorder, 0.0);
  EXPECT_EQ(timeline.link(1).up.reorder, 0.25);
  timeline.advance(3);
  EXPECT_EQ(timeline.link(0).down, (Impairment{.loss = 1.0}));
  EXPECT_EQ(timeline.link(0).up.loss, 0.75);
  timeline.advance(4);
  EXPECT_EQ(timeline.link(0).down, (Impairment{.loss = 0.5}));
}

/// What comes out of a channel into which number i goes at i * 20 ms, with the time.
std::vector<std::pair<int, double>> through(const Impairment& impairment, int count, std::uint64_t seed = 1) {
  ImpairedChannel<int> channel(seed, 0);
  channel.set(impairment);
  std::vector<std::pair<int, double>> out;
  for (int step = 0; step < 5 * count + 500; ++step) {
    const double now = 0.004 * step;
    if (step % 5 == 0 && step / 5 < count) channel.push(now, step / 5);
    for (int packet = 0; channel.pop(now, packet);) out.emplace_back(packet, now);
  }
  return out;
}

TEST(ImpairedChannel, LetsEverythingThroughAtOnceWhereNothingIsWrong) {
  const auto out = through({}, 100);
  ASSERT_EQ(out.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], std::pair(i, 0.004 * 5 * i));
}

TEST(ImpairedChannel, LosesItsShareOfPackets) {
  EXPECT_TRUE(through({.loss = 1.0}, 100).empty());
  const auto kept = through({.loss = 0.2}, 5000).size();
  EXPECT_GT(kept, 3900U);
  EXPECT_LT(kept, 4100U);
}

TEST(ImpairedChannel, DelaysWithoutDisorder) {
  const auto out = through({.delay = 0.2}, 100);
  ASSERT_EQ(out.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(out[static_cast<std::size_t>(i)].first, i);
    EXPECT_NEAR(out[static_cast<std::size_t>(i)].second, 0.02 * i + 0.2, 1e-9);
  }
}

TEST(ImpairedChannel, ReordersSomeAndLosesNone) {
  const auto out = through({.reorder = 0.1}, 2000);
  ASSERT_EQ(out.size(), 2000U);
  int overtaken = 0;
  for (std::size_t i = 1; i < out.size(); ++i) overtaken += out[i].first < out[i - 1].first;
  EXPECT_GT(overtaken, 100);
  EXPECT_LT(overtaken, 250);
}

TEST(ImpairedChannel, KeepsTheOrderWhenTheDelayEnds) {
  ImpairedChannel<int> channel(1, 0);
  channel.set({.delay = 0.2});
  channel.push(0.0, 1);
  channel.set({});
  EXPECT_FALSE(channel.clear());  // one is still on its way
  channel.push(0.1, 2);
  int packet = 0;
  EXPECT_FALSE(channel.pop(0.1, packet));
  ASSERT_TRUE(channel.pop(0.2, packet));
  EXPECT_EQ(packet, 1);
  ASSERT_TRUE(channel.pop(0.2, packet));
  EXPECT_EQ(packet, 2);
  EXPECT_TRUE(channel.clear());
}

TEST(ImpairedChannel, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Impairment bad{.loss = 0.3, .delay = 0.01, .reorder = 0.3};
  EXPECT_EQ(through(bad, 300, 7), through(bad, 300, 7));
  EXPECT_NE(through(bad, 300, 7), through(bad, 300, 8));
}

vehicle::AutopilotOptions airborne() {
  vehicle::AutopilotOptions options;
  options.position = {0, 0, 10};
  options.airborne = true;
  options.ready_delay = 0.0;
  return options;
}

/// Vehicle 0 in the air, at the times of the faults.
class Befallen {
 public:
  explicit Befallen(std::vector<Fault> faults) : timeline(std::move(faults)), autopilot(airborne()) {}
  void to(double t) {
    for (const FaultChange& change : timeline.advance(t)) apply(timeline, change, 0, autopilot);
  }
  FaultTimeline timeline;
  vehicle::Autopilot autopilot;
};

TEST(VehicleFaults, GpsComesBackOnlyWhenNoFaultIsLeft) {
  Befallen one({fault(FaultKind::kGpsLoss, 1, 2), fault(FaultKind::kGpsLoss, 2, 3)});
  one.to(0);
  EXPECT_TRUE(one.autopilot.estimator().gps());
  one.to(1);
  EXPECT_FALSE(one.autopilot.estimator().gps());
  one.to(3);
  EXPECT_FALSE(one.autopilot.estimator().gps());
  one.to(5);
  EXPECT_TRUE(one.autopilot.estimator().gps());
}

TEST(VehicleFaults, TheEstimateJumpsOnce) {
  Fault jump = fault(FaultKind::kEstimateJump, 1);
  jump.by = {3, 0, 0};
  Befallen one({jump});
  one.to(1);
  one.to(2);
  EXPECT_NEAR((one.autopilot.estimated_motion().position - Vec3(3, 0, 10)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((one.autopilot.true_motion().position - Vec3(0, 0, 10)).norm(), 0.0, 1e-12);
}

TEST(VehicleFaults, ABatteryIsLowForAsLongAsTheFaultLasts) {
  Fault low = fault(FaultKind::kLowBattery, 1, 2);
  low.remaining = 0.04;
  Befallen one({low});
  one.to(0);
  EXPECT_EQ(one.autopilot.battery(), 1.0);
  one.to(1);
  EXPECT_EQ(one.autopilot.battery(), 0.04);
  one.to(3);
  EXPECT_EQ(one.autopilot.battery(), 1.0);
}

TEST(VehicleFaults, APilotSwitchesTheMode) {
  Fault pilot = fault(FaultKind::kPilotMode, 1);
  pilot.mode = config::PilotMode::kAltitude;
  Befallen one({pilot});
  EXPECT_EQ(one.autopilot.mode(), vehicle::FlightMode::kHold);
  one.to(1);
  EXPECT_EQ(one.autopilot.mode(), vehicle::FlightMode::kAltitude);
}

TEST(VehicleFaults, ARebootStopsTheMotors) {
  Befallen one({fault(FaultKind::kReboot, 1)});
  one.to(1);
  EXPECT_EQ(one.autopilot.reboots(), 1);
  EXPECT_FALSE(one.autopilot.armed());
}

TEST(VehicleFaults, RefusalsLastAsLongAsTheFault) {
  Befallen one({fault(FaultKind::kRefuseOffboard, 1, 1)});
  const auto offboard = [&] {
    vehicle::Setpoint setpoint;
    setpoint.position = {0, 0, 10};
    one.autopilot.offboard_setpoint(setpoint);
    one.autopilot.step();
    one.autopilot.hold();
    return one.autopilot.set_mode(6);
  };
  one.to(1);
  EXPECT_NE(offboard(), vehicle::Result::kAccepted);
  one.to(2);
  EXPECT_EQ(offboard(), vehicle::Result::kAccepted);

  vehicle::AutopilotOptions grounded = airborne();
  grounded.airborne = false;
  vehicle::Autopilot autopilot(grounded);
  FaultTimeline timeline({fault(FaultKind::kRefuseArming, 1, 1)});
  for (const FaultChange& change : timeline.advance(1)) apply(timeline, change, 0, autopilot);
  EXPECT_NE(autopilot.arm(), vehicle::Result::kAccepted);
  for (const FaultChange& change : timeline.advance(2)) apply(timeline, change, 0, autopilot);
  EXPECT_EQ(autopilot.arm(), vehicle::Result::kAccepted);
}

TEST(VehicleFaults, BefallOnlyTheirVehicle) {
  Fault low = fault(FaultKind::kLowBattery, 0);
  low.remaining = 0.1;
  low.vehicle = 1;
  Befallen one({low});
  one.to(0);
  EXPECT_EQ(one.autopilot.battery(), 1.0);
}

TEST(VehicleFaults, ConditionsAreTheScenariosAndEachVehiclesOwn) {
  config::Scenario scenario;
  scenario.wind = {{1, 2, 3}, 0.5, 4.0};
  scenario.estimate = {false, 0.1, 0.2, 0.3, 5.0};
  vehicle::AutopilotOptions first;
  vehicle::AutopilotOptions second;
  set_conditions(scenario, 1, 0, first);
  set_conditions(scenario, 1, 1, second);
  EXPECT_EQ(first.wind.mean, Vec3(1, 2, 3));
  EXPECT_EQ(first.wind.gust, 0.5);
  EXPECT_EQ(first.wind.gust_time, 4.0);
  EXPECT_EQ(first.estimate.position_noise, 0.1);
  EXPECT_EQ(first.estimate.velocity_noise, 0.2);
  EXPECT_EQ(first.estimate.drift, 0.3);
  EXPECT_EQ(first.estimate.drift_time, 5.0);
  EXPECT_NE(first.seed, second.seed);
}

}  // namespace
}  // namespace jink::sim::faults
