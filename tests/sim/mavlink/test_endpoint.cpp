// SPDX-License-Identifier: BSD-3-Clause
// What comes in besides commands: setpoints, heartbeats, parameters, time, missions; and the texts that follow.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

TEST_F(AirborneEndpointTest, TakesPositionSetpointsInNed) {
  setpoint(kPositionOnly, {6, -4, -5}, Vec3::Zero());
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  for (int i = 0; i < 750; ++i) {
    setpoint(kPositionOnly, {6, -4, -5}, Vec3::Zero(), MAV_FRAME_LOCAL_NED, i % 2 == 0 ? 1 : 0, i % 2 == 0 ? 1 : 0);
    run(0.02);
  }
  EXPECT_LT((autopilot.true_motion().position - Vec3(-4, 6, 5)).norm(), 0.2);
  mavlink_position_target_local_ned_t target;
  mavlink_msg_position_target_local_ned_decode(&last(MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED), &target);
  EXPECT_FLOAT_EQ(target.x, 6);
  EXPECT_FLOAT_EQ(target.z, -5);
}

TEST_F(AirborneEndpointTest, TurnsBodyVelocitiesByItsAttitude) {
  mavlink_set_position_target_local_ned_t message{};
  message.target_system = message.target_component = 1;
  message.coordinate_frame = MAV_FRAME_BODY_NED;
  message.type_mask = kVelocityOnly & static_cast<std::uint16_t>(~0x0400U);  // velocity and yaw
  message.vx = 2.0F;                                                         // ahead
  message.yaw = 1.5707963F;                                                  // east
  tell(mavlink_msg_set_position_target_local_ned_encode_status, message);
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  for (int i = 0; i < 300; ++i) {
    tell(mavlink_msg_set_position_target_local_ned_encode_status, message);
    run(0.02);
  }
  EXPECT_GT(autopilot.true_motion().velocity.x(), 1.3);
  EXPECT_LT(std::abs(autopilot.true_motion().velocity.y()), 0.5);
  EXPECT_NEAR(mavlink_msg_attitude_get_yaw(&last(MAVLINK_MSG_ID_ATTITUDE)), 1.5708, 0.05);
}

TEST_F(AirborneEndpointTest, UnusableSetpointsGetATextEachAndAreNoStream) {
  ground_station_heartbeat();
  setpoint(kPositionOnly, {0, 0, -3}, Vec3::Zero(), 7);
  setpoint(0x0FFF, {0, 0, -3}, Vec3::Zero());
  setpoint(kPositionOnly, {std::numeric_limits<double>::quiet_NaN(), 0, -3}, Vec3::Zero());
  setpoint(kPositionOnly, {planner::base::kInfinity, 0, -3}, Vec3::Zero());
  poll();
  EXPECT_EQ(texts_with("coordinate frame 7 unsupported"), 1U);
  EXPECT_EQ(texts_with("SET_POSITION_TARGET_LOCAL_NED invalid"), 3U);
  setpoint(kPositionOnly, {0, 0, -3}, Vec3::Zero(), MAV_FRAME_LOCAL_NED, 2, 1);  // another vehicle's
  poll();
  EXPECT_FALSE(autopilot.stream_live());
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 1}));
}

TEST_F(MavlinkEndpointTest, TextsGoToGroundStationsAloneInChunksEndingInATab) {
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  EXPECT_EQ(count(heard_on_ground, MAVLINK_MSG_ID_STATUSTEXT), 0U);  // no heartbeat yet
  ground_station_heartbeat();
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_STATUSTEXT), 0U);
  EXPECT_EQ(count(heard_on_ground, MAVLINK_MSG_ID_STATUSTEXT), 2U);
  EXPECT_EQ(texts(), (std::vector<std::string>{"Arming denied: Resolve system health failures first\t"}));
}

TEST_F(MavlinkEndpointTest, PassesOnWhatIsNotForItAlone) {
  const auto passed = [&] { return count(heard_on_ground, MAVLINK_MSG_ID_STATUSTEXT); };
  mavlink_statustext_t text{};
  text.severity = MAV_SEVERITY_WARNING;
  std::strncpy(text.text, "from the companion", sizeof(text.text));
  tell(mavlink_msg_statustext_encode_status, text);
  poll();
  poll();
  EXPECT_EQ(passed(), 0U);  // nobody was heard there
  ground_station_heartbeat();
  poll();
  EXPECT_EQ(std::count_if(heard.begin(), heard.end(), [](const auto& m) { return m.sysid == kClientSystem; }), 1);
  tell(mavlink_msg_statustext_encode_status, text);
  poll();
  poll();
  ASSERT_EQ(passed(), 1U);
  const auto found = std::find_if(heard_on_ground.begin(), heard_on_ground.end(),
                                  [](const auto& m) { return m.msgid == MAVLINK_MSG_ID_STATUSTEXT; });
  EXPECT_EQ(found->sysid, kClientSystem);
  EXPECT_EQ(found->compid, kClientComponent);

  const auto parameter_requests = [&](std::uint8_t system, std::uint8_t component) {
    heard_on_ground.clear();
    mavlink_param_request_list_t request{};
    request.target_system = system;
    request.target_component = component;
    tell(mavlink_msg_param_request_list_encode_status, request);
    poll();
    poll();
    return count(heard_on_ground, MAVLINK_MSG_ID_PARAM_REQUEST_LIST);
  };
  EXPECT_EQ(parameter_requests(1, MAV_COMP_ID_AUTOPILOT1), 0U);
  EXPECT_EQ(parameter_requests(77, 1), 0U);
  EXPECT_EQ(parameter_requests(kClientSystem, kClientComponent), 1U);
  EXPECT_EQ(parameter_requests(0, 0), 1U);
}

TEST_F(AirborneEndpointTest, TheCompanionsHeartbeatAloneIsMissedInATextAndNoMore) {
  ground_station_heartbeat();
  mavlink_heartbeat_t heartbeat{};
  heartbeat.type = MAV_TYPE_ONBOARD_CONTROLLER;
  const auto stream = [&](double duration, bool alive) {
    const double end = autopilot.time() + duration;
    for (int i = 0; autopilot.time() < end; ++i) {
      if (alive && i % 50 == 0) tell(mavlink_msg_heartbeat_encode_status, heartbeat);
      setpoint(kPositionOnly, {1, 2, -3}, Vec3::Zero());
      run(0.02);
    }
  };
  stream(1.0, true);
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  stream(3.0, true);
  stream(4.0, false);
  EXPECT_EQ(texts_with("Connection to mission computer lost"), 0U);
  stream(3.0, false);
  EXPECT_EQ(texts_with("Connection to mission computer lost"), 1U);
  EXPECT_TRUE(autopilot.offboard_active());
  stream(1.0, true);
  EXPECT_EQ(texts_with("Onboard controller regained"), 1U);
}

mavlink_param_set_t param_set(const std::string& name, float value, int type) {
  mavlink_param_set_t message{};
  message.target_system = message.target_component = 1;
  std::copy(name.begin(), name.end(), message.param_id);
  message.param_value = value;
  message.param_type = static_cast<std::uint8_t>(type);
  return message;
}

TEST_F(MavlinkEndpointTest, ListsAllParameters) {
  mavlink_param_request_list_t request{};
  request.target_system = request.target_component = 1;
  tell(mavlink_msg_param_request_list_encode_status, request);
  run(1.0);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_PARAM_VALUE), autopilot.parameters().size());
  EXPECT_EQ(count(heard_on_ground, MAVLINK_MSG_ID_PARAM_VALUE), 0U);
}

TEST_F(MavlinkEndpointTest, ReadsAndSetsParametersBytewise) {
  mavlink_param_request_read_t request{};
  request.target_system = request.target_component = 1;
  request.param_index = -1;
  std::memcpy(request.param_id, "COM_RC_IN_MODE", 14);
  tell(mavlink_msg_param_request_read_encode_status, request);
  poll();
  const auto& answer = last(MAVLINK_MSG_ID_PARAM_VALUE);
  EXPECT_EQ(mavlink_msg_param_value_get_param_type(&answer), MAV_PARAM_TYPE_INT32);
  EXPECT_EQ(std::bit_cast<std::int32_t>(mavlink_msg_param_value_get_param_value(&answer)), 1);

  tell(mavlink_msg_param_set_encode_status,
       param_set("COM_OBL_RC_ACT", std::bit_cast<float>(std::int32_t{4}), MAV_PARAM_TYPE_INT32));
  tell(mavlink_msg_param_set_encode_status, param_set("COM_OF_LOSS_T", 0.5F, MAV_PARAM_TYPE_REAL32));
  heard.clear();
  poll();
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_PARAM_VALUE), 2U);
  EXPECT_EQ(autopilot.parameters().integer("COM_OBL_RC_ACT"), 4);
  EXPECT_EQ(autopilot.parameters().real("COM_OF_LOSS_T"), 0.5);
}

TEST_F(MavlinkEndpointTest, UnknownOrWronglyTypedParametersGetNoReply) {
  tell(mavlink_msg_param_set_encode_status, param_set("NO_SUCH_THING", 1.0F, MAV_PARAM_TYPE_REAL32));
  tell(mavlink_msg_param_set_encode_status, param_set("COM_OBL_RC_ACT", 4.0F, MAV_PARAM_TYPE_REAL32));
  tell(mavlink_msg_param_set_encode_status, param_set("COM_OF_LOSS_T", 1.0F, MAV_PARAM_TYPE_UINT8));
  mavlink_param_request_read_t request{};
  request.target_system = request.target_component = 1;
  request.param_index = 9999;
  tell(mavlink_msg_param_request_read_encode_status, request);
  run(0.5);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_PARAM_VALUE), 0U);
  EXPECT_EQ(autopilot.parameters().integer("COM_OBL_RC_ACT"), 0);
}

TEST_F(MavlinkEndpointTest, AnswersTimesyncPingAndMissionRequests) {
  run(0.5);
  heard.clear();
  mavlink_timesync_t timesync{};
  timesync.ts1 = 123456789;
  tell(mavlink_msg_timesync_encode_status, timesync);
  mavlink_ping_t ping{};
  ping.seq = 77;
  tell(mavlink_msg_ping_encode_status, ping);
  mavlink_mission_request_list_t list{};
  list.target_system = list.target_component = 1;
  tell(mavlink_msg_mission_request_list_encode_status, list);
  mavlink_mission_ack_t done{};
  done.target_system = done.target_component = 1;
  tell(mavlink_msg_mission_ack_encode_status, done);
  mavlink_mission_count_t upload{};
  upload.target_system = upload.target_component = 1;
  upload.count = 3;
  tell(mavlink_msg_mission_count_encode_status, upload);
  poll();
  mavlink_timesync_t answer;
  mavlink_msg_timesync_decode(&last(MAVLINK_MSG_ID_TIMESYNC), &answer);
  const auto first = std::find_if(heard.begin(), heard.end(), [](const auto& m) { return m.msgid == 111; });
  mavlink_msg_timesync_decode(&*first, &answer);
  EXPECT_EQ(answer.ts1, 123456789);
  EXPECT_EQ(first->len, MAVLINK_MSG_ID_TIMESYNC_LEN + 2);  // with a target, which PX4 leaves to chance
  EXPECT_NEAR(static_cast<double>(answer.tc1) * 1e-9, autopilot.time(), 1e-6);
  EXPECT_EQ(mavlink_msg_ping_get_seq(&last(MAVLINK_MSG_ID_PING)), 77U);
  EXPECT_EQ(mavlink_msg_ping_get_target_system(&last(MAVLINK_MSG_ID_PING)), kClientSystem);
  EXPECT_EQ(mavlink_msg_mission_count_get_count(&last(MAVLINK_MSG_ID_MISSION_COUNT)), 0);
  EXPECT_EQ(mavlink_msg_mission_request_get_seq(&last(MAVLINK_MSG_ID_MISSION_REQUEST)), 0);
}

}  // namespace
}  // namespace jink::sim::mavlink
