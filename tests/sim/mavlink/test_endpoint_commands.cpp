// SPDX-License-Identifier: BSD-3-Clause
// Commands and their acknowledgements.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

TEST_F(MavlinkEndpointTest, SetModeIsAnsweredTwiceTheSecondTimeTruly) {
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));  // disarmed
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 3}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 1}));  // armed, no stream
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kHold);
  setpoint(kPositionOnly, {0, 0, -3}, Vec3::Zero());
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 99}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 77}), (Results{0, 1}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 4}), (Results{0, 1}));  // armed, no mission
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, kNan}), (Results{0, 0}));
  EXPECT_TRUE(autopilot.offboard_active());
}

TEST_F(MavlinkEndpointTest, TheOldSetModeIsAnsweredOnce) {
  mavlink_set_mode_t message{};
  message.target_system = 1;
  message.base_mode = MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
  message.custom_mode = 0x00060000;
  tell(mavlink_msg_set_mode_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_DO_SET_MODE), (Results{0}));
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kOffboard);
  message.custom_mode = 0x4D040000;  // AUTO, and nothing known
  heard.clear();
  tell(mavlink_msg_set_mode_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_DO_SET_MODE), (Results{1}));
}

TEST_F(MavlinkEndpointTest, AnswersOnlyWhatIsMeantForIt) {
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}, 2, 1), Results{});
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}, 0, 0), Results{});
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}, 1, 154), Results{});
  EXPECT_FALSE(autopilot.armed());
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}, 1, 0), (Results{0}));
  EXPECT_TRUE(autopilot.armed());
}

TEST_F(AirborneEndpointTest, DisarmsInTheAirOnlyByForce) {
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {0}), (Results{1}));
  EXPECT_EQ(command(MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, {1}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {0, 21196}), (Results{0}));
  EXPECT_FALSE(autopilot.armed());
}

TEST_F(MavlinkEndpointTest, AnswersTheOtherCommandsAsPx4) {
  EXPECT_EQ(command(31999), (Results{3}));
  EXPECT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {11000}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {kNan}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {49}), (Results{0}));
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), 1U);
  EXPECT_EQ(command(MAV_CMD_DO_SET_HOME, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_HOME, {0, 0, 0, 0, 47, 8, 1e30F}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_HOME, {0, 0, 0, 0, kNan, 8, 490}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_NAV_LAND), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_NAV_TAKEOFF, {0, 0, 0, kNan, kNan, kNan, kNan}), (Results{0}));
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kTakeoff);
  EXPECT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {148}), (Results{0}));
  const auto capabilities = mavlink_msg_autopilot_version_get_capabilities(&last(MAVLINK_MSG_ID_AUTOPILOT_VERSION));
  for (const auto bit : {MAV_PROTOCOL_CAPABILITY_MAVLINK2, MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
                         MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE, MAV_PROTOCOL_CAPABILITY_MISSION_INT,
                         MAV_PROTOCOL_CAPABILITY_MISSION_FENCE, MAV_PROTOCOL_CAPABILITY_MISSION_RALLY}) {
    EXPECT_NE(capabilities & static_cast<std::uint64_t>(bit), 0U);
  }
}

TEST_F(MavlinkEndpointTest, TakesOffAndLandsByCommandInt) {
  mavlink_command_int_t message{};
  message.target_system = message.target_component = 1;
  message.command = MAV_CMD_NAV_TAKEOFF;
  message.x = message.y = 0x7FFFFFFF;
  message.z = 489.4F + 3.5F;  // above mean sea level
  tell(mavlink_msg_command_int_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_NAV_TAKEOFF), (Results{0}));
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  run(14.0);
  EXPECT_NEAR(autopilot.true_motion().position.z(), 3.5, 0.1);
  message.command = MAV_CMD_NAV_LAND;
  heard.clear();
  tell(mavlink_msg_command_int_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_NAV_LAND), (Results{0}));
  run(1.0);
  EXPECT_EQ(mavlink_msg_extended_sys_state_get_landed_state(&last(MAVLINK_MSG_ID_EXTENDED_SYS_STATE)), 4);
  run(20.0);
  EXPECT_FALSE(autopilot.armed());
}

TEST_F(AirborneEndpointTest, RepositionTakesGlobalCoordinates) {
  mavlink_command_int_t message{};
  message.target_system = message.target_component = 1;
  message.command = MAV_CMD_DO_REPOSITION;
  message.param2 = MAV_DO_REPOSITION_FLAGS_CHANGE_MODE;
  message.param4 = 1.0F;        // rad from north
  message.x = 473977430 + 899;  // 10 m north
  message.y = 85455940;
  message.z = 489.4F + 5.0F;
  tell(mavlink_msg_command_int_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_DO_REPOSITION), (Results{0}));
  run(20.0);
  EXPECT_LT((autopilot.true_motion().position - Vec3(0, 10, 5)).norm(), 0.15);
  EXPECT_NEAR(vehicle::swap_yaw(autopilot.true_motion().yaw), 1.0, 0.02);
  // NaN keeps: first all but the height, then all.
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {kNan, 1, 0, kNan, kNan, kNan, 489.4F + 8.0F}), (Results{0}));
  run(10.0);
  EXPECT_LT((autopilot.true_motion().position - Vec3(0, 10, 8)).norm(), 0.15);
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {kNan, 1, 0, kNan, kNan, kNan, kNan}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {kNan, 0, 0, kNan, 47.4F, 8.5F, 500}), (Results{3}));  // no change of mode
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {kNan, 1, 0, kNan, 91, 8.5F, 500}), (Results{2}));
}

TEST_F(AirborneEndpointTest, RepositionKeepsToTheSpeedAskedFor) {
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {1.0F, 1, 0, kNan, 47.39832F, 8.545594F, 489.4F + 3.0F}), (Results{0}));
  double fastest = 0.0;
  for (int i = 0; i < 20; ++i) {
    run(0.5);
    fastest = std::max(fastest, autopilot.true_motion().velocity.head<2>().norm());
  }
  EXPECT_NEAR(fastest, 1.0, 0.1);
}

TEST_F(MavlinkEndpointTest, RepositionOnTheGroundIsHold) {
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_DO_REPOSITION, {-1, 1, 0, kNan, 47.4F, 8.5F, 500}), (Results{0}));
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kHold);
  EXPECT_TRUE(autopilot.landed());
}

TEST_F(MavlinkEndpointTest, MessageIntervalsCanBeChangedAskedForAndReset) {
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {30, 20000}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {32, -1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {49, 500000}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {11000, 20000}), (Results{4}));
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {0, 20000}), (Results{4}));  // the heartbeat's
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {30, kNan}), (Results{4}));
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {30, 1e30F}), (Results{4}));
  heard.clear();
  heard_on_ground.clear();
  run(4.0);
  EXPECT_NEAR(static_cast<double>(count(heard, MAVLINK_MSG_ID_ATTITUDE)), 200, 2);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED), 0U);
  EXPECT_NEAR(static_cast<double>(count(heard, MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)), 8, 1);
  EXPECT_NEAR(static_cast<double>(count(heard_on_ground, MAVLINK_MSG_ID_ATTITUDE)), 400, 4);  // another link
  EXPECT_EQ(command(MAV_CMD_GET_MESSAGE_INTERVAL, {30}), (Results{0}));
  EXPECT_EQ(mavlink_msg_message_interval_get_interval_us(&last(MAVLINK_MSG_ID_MESSAGE_INTERVAL)), 20000);
  EXPECT_EQ(command(MAV_CMD_GET_MESSAGE_INTERVAL, {32}), (Results{0}));
  EXPECT_EQ(mavlink_msg_message_interval_get_interval_us(&last(MAVLINK_MSG_ID_MESSAGE_INTERVAL)), -1);
  EXPECT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {32, 0}), (Results{0}));
  heard.clear();
  run(4.0);
  EXPECT_NEAR(static_cast<double>(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED)), 120, 3);
}

}  // namespace
}  // namespace jink::sim::mavlink
