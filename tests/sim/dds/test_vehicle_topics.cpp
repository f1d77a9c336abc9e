// SPDX-License-Identifier: BSD-3-Clause
// The simulator's DDS side against the bridge's, over real transports, in simulated time.
#include "sim/dds/vehicle_topics.hpp"

#include <gtest/gtest.h>

#include <string>

#include "Px4.h"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/px4_link.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::sim::dds {
namespace {

using bridge::dds::DdsParticipant;
using bridge::dds::DdsVehicleLink;
using bridge::dds::Payload;
using bridge::dds::PayloadWriter;
using bridge::testing::eventually;
using bridge::testing::ManualClock;
using bridge::testing::own_domain;
using bridge::vehicle::Setpoint;
using bridge::vehicle::VehicleState;
using vehicle::Autopilot;

TEST(EstimateJumpDetector, TellsAJumpFromMotion) {
  EstimateJumpDetector watch;
  vehicle::Motion motion;
  motion.velocity = {2.0, 0.0, 0.0};
  EXPECT_EQ(watch.update(255, motion, 0.1).newest, Vec3::Zero());
  motion.position = {0.2, 0.0, 0.0};
  EXPECT_EQ(watch.update(255, motion, 0.1).newest, Vec3::Zero());
  motion.position = {3.4, 0.0, -1.0};  // 0.2 m flown, 3 m jumped
  const EstimateJumps jumps = watch.update(0, motion, 0.1);
  EXPECT_EQ(jumps.horizontal, 0);
  EXPECT_EQ(jumps.vertical, 0);
  EXPECT_LT((jumps.newest - Vec3(3.0, 0.0, -1.0)).norm(), 1e-12);
  motion.position.x() += 0.2;
  EXPECT_EQ(watch.update(0, motion, 0.1).newest, jumps.newest);
}

TEST(YawAlignment, IsDoneAnewInEachFlightAboveTheGroundsMagnets) {
  YawAlignment yaw;
  EXPECT_FALSE(yaw.update(0.0, true, 0.0));
  EXPECT_FALSE(yaw.update(1.0, true, 3.0));  // a height that is not flown
  EXPECT_FALSE(yaw.update(2.0, false, 1.5));
  EXPECT_FALSE(yaw.update(3.0, false, 1.6));
  EXPECT_FALSE(yaw.update(4.0, false, 1.0));
  EXPECT_TRUE(yaw.update(4.1, false, 1.0));
  EXPECT_TRUE(yaw.update(5.0, true, 0.0));
  EXPECT_FALSE(yaw.update(6.0, false, 1.0));
}

class NoLink final : public bridge::vehicle::VehicleLink {
 public:
  VehicleState state() override { return {}; }
  bool send(const Setpoint& /*setpoint*/) override { return false; }
  void request(bridge::vehicle::Command /*command*/) override {}
  std::optional<bridge::vehicle::CommandReport> next_report() override { return std::nullopt; }
};

vehicle::AutopilotOptions airborne() {
  vehicle::AutopilotOptions options;
  options.position = {1.0, 2.0, 3.0};
  options.airborne = true;
  options.ready_delay = 0.0;
  return options;
}

class SimulatedDds : public ::testing::Test {
 protected:
  // One step of the simulator: 4 ms.
  void step(const EstimateJumps& jumps = {}) {
    dds_.step(autopilot_.time(), autopilot_, jumps);
    autopilot_.step();
  }
  // Steps until `condition`; real time passes for the transports.
  bool step_until(const std::function<bool()>& condition) {
    return eventually([&] {
      step();
      return condition();
    });
  }

  const int domain_ = own_domain();
  ManualClock clock_;
  NoLink under_;
  DdsParticipant vehicle_{domain_, "simulated autopilot"};
  DdsParticipant companion_{domain_};
  Autopilot autopilot_{airborne()};
  VehicleTopics dds_{vehicle_, "px4_3"};
};

TEST_F(SimulatedDds, FliesOnDdsAlone) {
  DdsVehicleLink link(under_, companion_, clock_, {.state = true, .setpoints = true, .name_space = "px4_3"});
  ASSERT_TRUE(step_until([&] { return link.state().local_position_ok; }));
  const VehicleState s = link.state();
  EXPECT_LT((s.motion.value.position - Vec3(1, 2, 3)).norm(), 0.01);
  EXPECT_NEAR(s.yaw, airborne().yaw, 1e-3);
  EXPECT_TRUE(s.origin);
  EXPECT_EQ(s.estimate_resets, 0U);
  const Setpoint setpoint{.position = {2, 2, 3}, .yaw = airborne().yaw};
  ASSERT_TRUE(step_until([&] { return link.send(setpoint) && dds_.setpoints() > 0; }));
  ASSERT_EQ(autopilot_.set_mode(6), vehicle::Result::kAccepted);
  EXPECT_TRUE(step_until([&] {
    return link.send(setpoint) && (link.state().motion.value.position - Vec3(2, 2, 3)).norm() < 0.1;
  })) << link.state().motion.value.position.transpose();
  EXPECT_EQ(dds_.malformed(), 0U);
}

TEST_F(SimulatedDds, TellsThePositionInEachReleasesLayout) {
  using jink::sim::vehicle::Px4Version;
  for (const Px4Version version : {Px4Version::k1_14, Px4Version::k1_16, Px4Version::k1_18}) {
    const std::string name = "px4_" + std::to_string(4 + static_cast<int>(version));
    VehicleTopics topics(vehicle_, name, version);
    DdsVehicleLink link(under_, companion_, clock_, {.state = true, .setpoints = false, .name_space = name});
    ASSERT_TRUE(eventually([&] {
      topics.step(autopilot_.time(), autopilot_);
      autopilot_.step();
      return link.state().local_position_ok;
    }));
    EXPECT_LT((link.state().motion.value.position - Vec3(1, 2, 3)).norm(), 0.01);
    EXPECT_NEAR(link.state().yaw, airborne().yaw, 1e-3);
    EXPECT_TRUE(link.state().origin);
    EXPECT_EQ(link.counts().malformed, 0U);
    const char* const topic =
        version < Px4Version::k1_17 ? "out/vehicle_local_position" : "out/vehicle_local_position_v1";
    jink::bridge::dds::PayloadReader reader(companion_, jink::bridge::dds::px4_topic(name, topic),
                                            jink::bridge::dds::kLocalPositionType,
                                            [](const Payload&, const bridge::dds::SampleWriter&) {});
    EXPECT_TRUE(eventually([&] { return reader.writers() == 1; })) << name;
  }
}

TEST_F(SimulatedDds, TellsOfJumps) {
  DdsVehicleLink link(under_, companion_, clock_, {.state = true, .setpoints = false, .name_space = "px4_3"});
  ASSERT_TRUE(step_until([&] { return link.state().local_position_ok; }));
  const EstimateJumps jumps{.horizontal = 1, .vertical = 0, .newest = {3.0, -1.0, 0.0}};
  ASSERT_TRUE(eventually([&] { return step(jumps), link.state().estimate_resets == 1; }));
  EXPECT_EQ(link.state().estimate_shift, Vec3(3.0, -1.0, 0.0));
}

TEST_F(SimulatedDds, TakesNoSetpointWithoutAControlMode) {
  PayloadWriter setpoints(companion_, "rt/px4_3/fmu/in/trajectory_setpoint", bridge::dds::kTrajectorySetpointType);
  PayloadWriter modes(companion_, "rt/px4_3/fmu/in/offboard_control_mode", bridge::dds::kOffboardControlModeType);
  ASSERT_TRUE(step_until([&] { return setpoints.readers() == 1 && modes.readers() == 1; }));
  // A reader that the writer knows may not know the writer yet: what is written then is lost.
  std::uint64_t malformed = 0;  // of both, written
  const auto is_heard = [&](PayloadWriter& writer) {
    return step_until([&, before = malformed] {
      malformed += writer.write(Payload{0, 1, 0, 0, 5}) ? 1 : 0;
      return dds_.malformed() > before;
    });
  };
  ASSERT_TRUE(is_heard(modes));
  ASSERT_TRUE(is_heard(setpoints));
  ASSERT_TRUE(setpoints.write_message(px4_msgs::msg::dds_::TrajectorySetpoint_()));
  ASSERT_TRUE(is_heard(setpoints));
  EXPECT_EQ(dds_.setpoints(), 0U);
  EXPECT_FALSE(autopilot_.stream_live());
  px4_msgs::msg::dds_::OffboardControlMode_ mode;
  mode.position(true);
  ASSERT_TRUE(modes.write_message(mode));
  EXPECT_TRUE(step_until([&] { return dds_.setpoints() == 1; }));
  EXPECT_TRUE(autopilot_.stream_live());
}

}  // namespace
}  // namespace jink::sim::dds
