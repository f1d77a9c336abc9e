// SPDX-License-Identifier: BSD-3-Clause
// The endpoint over real loopback sockets on free ports, in virtual time.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/mavlink_endpoint.hpp"
#include "tests/sim/mavlink_client.hpp"

namespace jink::sim {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint16_t kPositionOnly = 0x0DF8;
constexpr std::uint16_t kVelocityOnly = 0x0DC7;

/// An autopilot, its endpoint, a companion and a ground station.
class MavlinkEndpointTest : public testing::Test {
 protected:
  explicit MavlinkEndpointTest(bool airborne = false, double ready_delay = 0.0)
      : autopilot(autopilot_options(airborne, ready_delay)), endpoint(autopilot, endpoint_options()) {}

  static AutopilotOptions autopilot_options(bool airborne, double ready_delay) {
    AutopilotOptions options;
    options.airborne = airborne;
    options.ready_delay = ready_delay;
    if (airborne) options.position = {2, 1, 3};
    return options;
  }

  [[nodiscard]] EndpointOptions endpoint_options() const {
    EndpointOptions options;
    options.companion_local_port = options.ground_local_port = 0;
    options.companion_remote_port = companion.port();
    options.ground_remote_port = ground.port();
    return options;
  }

  /// Runs for `duration` and collects what each end hears.
  void run(double duration) {
    const double end = autopilot.time() + duration - VehicleModel::kStep / 2;
    while (autopilot.time() < end) {
      autopilot.step();
      poll();
    }
  }

  void poll() {
    endpoint.poll(autopilot.time());
    for (const auto& message : companion.drain()) heard.push_back(message);
    for (const auto& message : ground.drain()) heard_on_ground.push_back(message);
  }

  template <typename Payload>
  void tell(std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*, mavlink_message_t*, const Payload*),
            const Payload& payload) {
    companion.send(endpoint.companion_port(), encode, payload);
  }

  /// The results of the acknowledgements that a command gets.
  std::vector<int> command(std::uint16_t id, const std::vector<float>& parameters = {}, int system = 1,
                           int component = 1) {
    mavlink_command_long_t message{};
    message.command = id;
    message.target_system = static_cast<std::uint8_t>(system);
    message.target_component = static_cast<std::uint8_t>(component);
    std::array<float, 7> p{};
    std::copy(parameters.begin(), parameters.end(), p.begin());
    message.param1 = p[0];
    message.param2 = p[1];
    message.param3 = p[2];
    message.param4 = p[3];
    message.param5 = p[4];
    message.param6 = p[5];
    message.param7 = p[6];
    heard.clear();
    tell(mavlink_msg_command_long_encode_status, message);
    poll();
    return acknowledgements(id);
  }

  [[nodiscard]] std::vector<int> acknowledgements(std::uint16_t id) const {
    std::vector<int> results;
    for (const auto& message : heard) {
      if (message.msgid != MAVLINK_MSG_ID_COMMAND_ACK) continue;
      mavlink_command_ack_t ack;
      mavlink_msg_command_ack_decode(&message, &ack);
      EXPECT_EQ(ack.command, id);
      EXPECT_EQ(ack.target_system, kClientSystem);
      EXPECT_EQ(ack.target_component, kClientComponent);
      results.push_back(ack.result);
    }
    return results;
  }

  void setpoint(std::uint16_t mask, const Vec3& position_ned, const Vec3& velocity_ned, int frame = MAV_FRAME_LOCAL_NED,
                int system = 1, int component = 1) {
    mavlink_set_position_target_local_ned_t message{};
    message.target_system = static_cast<std::uint8_t>(system);
    message.target_component = static_cast<std::uint8_t>(component);
    message.coordinate_frame = static_cast<std::uint8_t>(frame);
    message.type_mask = mask;
    message.x = static_cast<float>(position_ned.x());
    message.y = static_cast<float>(position_ned.y());
    message.z = static_cast<float>(position_ned.z());
    message.vx = static_cast<float>(velocity_ned.x());
    message.vy = static_cast<float>(velocity_ned.y());
    message.vz = static_cast<float>(velocity_ned.z());
    tell(mavlink_msg_set_position_target_local_ned_encode_status, message);
  }

  void ground_station_heartbeat() {
    mavlink_heartbeat_t heartbeat{};
    heartbeat.type = MAV_TYPE_GCS;
    heartbeat.autopilot = MAV_AUTOPILOT_INVALID;
    ground.send(endpoint.ground_port(), mavlink_msg_heartbeat_encode_status, heartbeat);
    poll();
  }

  static std::size_t count(const std::vector<mavlink_message_t>& messages, std::uint32_t id) {
    return static_cast<std::size_t>(
        std::count_if(messages.begin(), messages.end(), [&](const auto& m) { return m.msgid == id; }));
  }

  [[nodiscard]] const mavlink_message_t& last(std::uint32_t id) const {
    const auto found = std::find_if(heard.rbegin(), heard.rend(), [&](const auto& m) { return m.msgid == id; });
    if (found == heard.rend()) throw std::runtime_error("message not heard: " + std::to_string(id));
    return *found;
  }

  /// The texts that the ground station heard, chunks joined.
  [[nodiscard]] std::vector<std::string> texts() const {
    std::map<int, std::string> joined;
    for (const auto& message : heard_on_ground) {
      if (message.msgid != MAVLINK_MSG_ID_STATUSTEXT) continue;
      mavlink_statustext_t text;
      mavlink_msg_statustext_decode(&message, &text);
      joined[text.id] += std::string(text.text, strnlen(text.text, sizeof(text.text)));
    }
    std::vector<std::string> result;
    result.reserve(joined.size());
    for (const auto& [id, text] : joined) result.push_back(text);
    return result;
  }

  [[nodiscard]] std::size_t texts_with(const std::string& part) const {
    const auto all = texts();
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [&](const auto& t) { return t.find(part) != std::string::npos; }));
  }

  Client companion;
  Client ground;
  Autopilot autopilot;
  MavlinkEndpoint endpoint;
  std::vector<mavlink_message_t> heard;
  std::vector<mavlink_message_t> heard_on_ground;
};

class AirborneEndpointTest : public MavlinkEndpointTest {
 protected:
  AirborneEndpointTest() : MavlinkEndpointTest(true) {}
};

class BootingEndpointTest : public MavlinkEndpointTest {
 protected:
  BootingEndpointTest() : MavlinkEndpointTest(false, 4.3) {}
};

using Results = std::vector<int>;

TEST_F(MavlinkEndpointTest, StreamsAtPx4sRates) {
  constexpr double kDuration = 20.0;
  run(kDuration);
  const std::map<std::uint32_t, double> rates{{MAVLINK_MSG_ID_ATTITUDE, 99},
                                              {MAVLINK_MSG_ID_ATTITUDE_QUATERNION, 49},
                                              {MAVLINK_MSG_ID_GLOBAL_POSITION_INT, 49},
                                              {MAVLINK_MSG_ID_HIGHRES_IMU, 49},
                                              {MAVLINK_MSG_ID_LOCAL_POSITION_NED, 30},
                                              {MAVLINK_MSG_ID_ODOMETRY, 30},
                                              {MAVLINK_MSG_ID_ALTITUDE, 10},
                                              {MAVLINK_MSG_ID_ATTITUDE_TARGET, 10},
                                              {MAVLINK_MSG_ID_DISTANCE_SENSOR, 10},
                                              {MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED, 10},
                                              {MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, 10},
                                              {MAVLINK_MSG_ID_TIMESYNC, 10},
                                              {MAVLINK_MSG_ID_VFR_HUD, 10},
                                              {MAVLINK_MSG_ID_GPS_RAW_INT, 8},
                                              {MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 5},
                                              {MAVLINK_MSG_ID_SYS_STATUS, 5},
                                              {MAVLINK_MSG_ID_HEARTBEAT, 1},
                                              {MAVLINK_MSG_ID_ESTIMATOR_STATUS, 1},
                                              {MAVLINK_MSG_ID_PING, 1},
                                              {MAVLINK_MSG_ID_SYSTEM_TIME, 1},
                                              {MAVLINK_MSG_ID_SCALED_PRESSURE, 1},
                                              {MAVLINK_MSG_ID_BATTERY_STATUS, 0.5},
                                              {MAVLINK_MSG_ID_CURRENT_MODE, 0.5},
                                              {MAVLINK_MSG_ID_HOME_POSITION, 0.5},
                                              {MAVLINK_MSG_ID_VIBRATION, 0.5}};
  for (const auto& [id, rate] : rates) {
    const auto expected = rate * kDuration;
    EXPECT_NEAR(static_cast<double>(count(heard, id)), expected, 0.1 * expected) << "message " << id;
    EXPECT_EQ(count(heard, id), count(heard_on_ground, id)) << "message " << id;
  }
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), 1U);
  for (const auto& message : heard) {
    ASSERT_EQ(message.magic, MAVLINK_STX);
    ASSERT_EQ(message.sysid, 1);
    ASSERT_EQ(message.compid, 1);
    ASSERT_TRUE(rates.contains(message.msgid) || message.msgid == MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN ||
                message.msgid == MAVLINK_MSG_ID_MISSION_CURRENT)
        << message.msgid;
  }
}

TEST_F(MavlinkEndpointTest, NumbersItsPacketsWithoutGaps) {
  run(2.0);
  for (std::size_t i = 1; i < heard.size(); ++i) {
    ASSERT_EQ(heard[i].seq, static_cast<std::uint8_t>(heard[i - 1].seq + 1));
  }
}

TEST_F(BootingEndpointTest, StartsUpAsPx4Does) {
  std::map<std::uint32_t, double> first;
  double ready = 0.0;
  while (autopilot.time() < 6.0) {
    run(VehicleModel::kStep);
    for (const auto& message : heard) {
      first.emplace(message.msgid, autopilot.time());
      if (message.msgid != MAVLINK_MSG_ID_SYS_STATUS || ready > 0.0) continue;
      const auto health = mavlink_msg_sys_status_get_onboard_control_sensors_health(&message);
      if ((health & 0x10000000U) != 0) ready = autopilot.time();
    }
    heard.clear();
  }
  EXPECT_NEAR(first.begin()->second, first[MAVLINK_MSG_ID_SYS_STATUS], 2.5);
  EXPECT_NEAR(first[MAVLINK_MSG_ID_ATTITUDE], 0.3, 0.01);
  EXPECT_NEAR(first[MAVLINK_MSG_ID_HEARTBEAT], 1.3, 0.01);
  EXPECT_NEAR(first[MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN], 1.4, 0.01);
  EXPECT_NEAR(first[MAVLINK_MSG_ID_HOME_POSITION], 2.4, 0.01);
  EXPECT_NEAR(ready, 4.3, 0.21);
}

TEST_F(AirborneEndpointTest, ReportsTheMotionInNedAndDegrees) {
  setpoint(kVelocityOnly, Vec3::Zero(), {1.0, 2.0, -0.5});
  poll();
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  for (int i = 0; i < 100; ++i) {
    setpoint(kVelocityOnly, Vec3::Zero(), {1.0, 2.0, -0.5});
    run(0.02);
  }
  const Motion& motion = autopilot.true_motion();
  ASSERT_GT(motion.velocity.y(), 0.4);  // 1 m/s to the north is ENU's y
  ASSERT_GT(motion.velocity.x(), 0.8);

  command(MAV_CMD_REQUEST_MESSAGE, {32.0F});
  mavlink_local_position_ned_t local;
  mavlink_msg_local_position_ned_decode(&last(MAVLINK_MSG_ID_LOCAL_POSITION_NED), &local);
  EXPECT_FLOAT_EQ(local.x, static_cast<float>(motion.position.y()));
  EXPECT_FLOAT_EQ(local.y, static_cast<float>(motion.position.x()));
  EXPECT_FLOAT_EQ(local.z, static_cast<float>(-motion.position.z()));
  EXPECT_FLOAT_EQ(local.vx, static_cast<float>(motion.velocity.y()));
  EXPECT_FLOAT_EQ(local.vz, static_cast<float>(-motion.velocity.z()));

  command(MAV_CMD_REQUEST_MESSAGE, {331.0F});
  mavlink_odometry_t odometry;
  mavlink_msg_odometry_decode(&last(MAVLINK_MSG_ID_ODOMETRY), &odometry);
  EXPECT_EQ(odometry.child_frame_id, MAV_FRAME_LOCAL_NED);
  EXPECT_FLOAT_EQ(odometry.vy, local.vy);

  command(MAV_CMD_REQUEST_MESSAGE, {33.0F});
  mavlink_global_position_int_t global;
  mavlink_msg_global_position_int_decode(&last(MAVLINK_MSG_ID_GLOBAL_POSITION_INT), &global);
  // A metre is 9.0e-6 deg of latitude and, at 47.4 deg, 1.326e-5 deg of longitude.
  EXPECT_NEAR(global.lat, 473977430 + motion.position.y() * 89.93, 3);
  EXPECT_NEAR(global.lon, 85455940 + motion.position.x() * 132.5, 5);
  EXPECT_NEAR(global.alt, 489400 + 1000 * motion.position.z(), 2);
  EXPECT_NEAR(global.relative_alt, 1000 * motion.position.z(), 2);
  EXPECT_EQ(global.hdg, 0);

  command(MAV_CMD_REQUEST_MESSAGE, {30.0F});
  mavlink_attitude_t attitude;
  mavlink_msg_attitude_decode(&last(MAVLINK_MSG_ID_ATTITUDE), &attitude);
  EXPECT_NEAR(attitude.yaw, 0.0, 1e-6);  // it heads north
  EXPECT_LT(attitude.pitch, -0.01F);     // nose down to go north
  EXPECT_GT(attitude.roll, 0.01F);       // right to go east

  command(MAV_CMD_REQUEST_MESSAGE, {105.0F});
  mavlink_highres_imu_t imu;
  mavlink_msg_highres_imu_decode(&last(MAVLINK_MSG_ID_HIGHRES_IMU), &imu);
  EXPECT_NEAR(std::hypot(imu.xacc, imu.yacc, imu.zacc), motion.specific_force.norm(), 1e-4);
  EXPECT_LT(imu.zacc, -9.0F);
}

TEST_F(MavlinkEndpointTest, SetModeIsAnsweredTwiceTheSecondTimeTruly) {
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));  // disarmed
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 3}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 1}));  // armed, no stream
  EXPECT_EQ(autopilot.mode(), FlightMode::kHold);
  setpoint(kPositionOnly, {0, 0, -3}, Vec3::Zero());
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 99}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 77}), (Results{0, 1}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 4}), (Results{0, 1}));
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
  EXPECT_EQ(autopilot.mode(), FlightMode::kOffboard);
  message.custom_mode = 0x04040000;
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
  EXPECT_EQ(autopilot.mode(), FlightMode::kTakeoff);
  EXPECT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {148}), (Results{0}));
  const auto capabilities = mavlink_msg_autopilot_version_get_capabilities(&last(MAVLINK_MSG_ID_AUTOPILOT_VERSION));
  for (const auto bit : {MAV_PROTOCOL_CAPABILITY_MAVLINK2, MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
                         MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE}) {
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
  message.x = 473977430 + 899;  // 10 m north
  message.y = 85455940;
  message.z = 489.4F + 5.0F;
  tell(mavlink_msg_command_int_encode_status, message);
  poll();
  EXPECT_EQ(acknowledgements(MAV_CMD_DO_REPOSITION), (Results{0}));
  run(20.0);
  EXPECT_LT((autopilot.true_motion().position - Vec3(0, 10, 5)).norm(), 0.15);
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
  setpoint(kPositionOnly, {planner::kInfinity, 0, -3}, Vec3::Zero());
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

TEST_F(AirborneEndpointTest, WithoutGpsPositionsStopAndTheHealthSaysWhy) {
  run(1.0);
  autopilot.set_gps(false);
  run(1.0);
  EXPECT_EQ(mavlink_msg_gps_raw_int_get_fix_type(&last(MAVLINK_MSG_ID_GPS_RAW_INT)), GPS_FIX_TYPE_NO_FIX);
  const auto health = mavlink_msg_sys_status_get_onboard_control_sensors_health(&last(MAVLINK_MSG_ID_SYS_STATUS));
  EXPECT_EQ(health & MAV_SYS_STATUS_SENSOR_GPS, 0U);
  EXPECT_GT(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED), 50U);
  run(4.1);
  heard.clear();
  run(2.0);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED), 0U);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_GLOBAL_POSITION_INT), 0U);
  const auto flags = mavlink_msg_estimator_status_get_flags(&last(MAVLINK_MSG_ID_ESTIMATOR_STATUS));
  EXPECT_EQ(flags & (ESTIMATOR_POS_HORIZ_ABS | ESTIMATOR_POS_HORIZ_REL), 0);
  EXPECT_NE(flags & ESTIMATOR_ATTITUDE, 0);
  EXPECT_EQ(mavlink_msg_heartbeat_get_system_status(&last(MAVLINK_MSG_ID_HEARTBEAT)), MAV_STATE_CRITICAL);
  autopilot.set_gps(true);
  run(1.0);
  EXPECT_GT(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED), 25U);
}

TEST_F(AirborneEndpointTest, AJumpIsSeenInThePositionAndTheResetCounter) {
  command(MAV_CMD_REQUEST_MESSAGE, {331.0F});
  mavlink_odometry_t before;
  mavlink_msg_odometry_decode(&last(MAVLINK_MSG_ID_ODOMETRY), &before);
  autopilot.jump_estimate({1.0, 2.0, 0.5});
  command(MAV_CMD_REQUEST_MESSAGE, {331.0F});
  mavlink_odometry_t after;
  mavlink_msg_odometry_decode(&last(MAVLINK_MSG_ID_ODOMETRY), &after);
  EXPECT_EQ(after.reset_counter, before.reset_counter + 1);
  EXPECT_FLOAT_EQ(after.x - before.x, 2.0F);
  EXPECT_FLOAT_EQ(after.y - before.y, 1.0F);
  EXPECT_FLOAT_EQ(after.z - before.z, -0.5F);
}

TEST_F(AirborneEndpointTest, TellsOfTheBattery) {
  struct Row {
    double remaining;
    int percent;
    int state;
  };
  for (const Row& row :
       {Row{1.0, 100, 1}, Row{0.12, 12, 2}, Row{0.06, 6, 3}, Row{0.02, 2, 4}, Row{std::nan(""), -1, 0}}) {
    autopilot.set_battery(row.remaining);
    run(2.1);
    mavlink_battery_status_t battery;
    mavlink_msg_battery_status_decode(&last(MAVLINK_MSG_ID_BATTERY_STATUS), &battery);
    EXPECT_EQ(battery.battery_remaining, row.percent);
    EXPECT_EQ(battery.charge_state, row.state);
    EXPECT_EQ(mavlink_msg_sys_status_get_battery_remaining(&last(MAVLINK_MSG_ID_SYS_STATUS)), row.percent);
  }
}

TEST_F(BootingEndpointTest, ARebootOnCommandStartsEverythingAnew) {
  run(6.0);
  ground_station_heartbeat();
  ASSERT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {32, -1}), (Results{0}));
  ASSERT_EQ(command(MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, {1}), (Results{0}));
  EXPECT_EQ(autopilot.reboots(), 1);
  run(0.2);
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), Results{});  // nobody listens yet
  heard.clear();
  heard_on_ground.clear();
  run(0.9);
  EXPECT_GT(count(heard, MAVLINK_MSG_ID_LOCAL_POSITION_NED), 20U);  // its rates are the default ones again
  EXPECT_LT(mavlink_msg_attitude_get_time_boot_ms(&last(MAVLINK_MSG_ID_ATTITUDE)), 1200U);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_HEARTBEAT), 0U);
  run(1.0);
  EXPECT_EQ(mavlink_msg_heartbeat_get_system_status(&last(MAVLINK_MSG_ID_HEARTBEAT)), MAV_STATE_UNINIT);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), 1U);
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  EXPECT_EQ(count(heard_on_ground, MAVLINK_MSG_ID_STATUSTEXT), 0U);  // it knows of no ground station any more
  run(3.0);
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
}

TEST_F(AirborneEndpointTest, AfterARebootElsewhereTheOriginIsThere) {
  autopilot.reboot();
  run(5.0);
  ASSERT_TRUE(autopilot.landed());
  ASSERT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {49.0F}), (Results{0}));
  mavlink_gps_global_origin_t origin;
  mavlink_msg_gps_global_origin_decode(&last(MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), &origin);
  EXPECT_NEAR(origin.latitude, 473977430 + 90, 3);   // 1 m north
  EXPECT_NEAR(origin.longitude, 85455940 + 265, 5);  // 2 m east
  ASSERT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {33.0F}), (Results{0}));
  EXPECT_EQ(mavlink_msg_global_position_int_get_lat(&last(MAVLINK_MSG_ID_GLOBAL_POSITION_INT)), origin.latitude);
  ASSERT_EQ(command(MAV_CMD_REQUEST_MESSAGE, {32.0F}), (Results{0}));
  EXPECT_NEAR(mavlink_msg_local_position_ned_get_x(&last(MAVLINK_MSG_ID_LOCAL_POSITION_NED)), 0.0, 1e-6);
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
  EXPECT_NEAR(static_cast<double>(answer.tc1) * 1e-9, autopilot.time(), 1e-6);
  EXPECT_EQ(mavlink_msg_ping_get_seq(&last(MAVLINK_MSG_ID_PING)), 77U);
  EXPECT_EQ(mavlink_msg_ping_get_target_system(&last(MAVLINK_MSG_ID_PING)), kClientSystem);
  EXPECT_EQ(mavlink_msg_mission_count_get_count(&last(MAVLINK_MSG_ID_MISSION_COUNT)), 0);
  EXPECT_EQ(mavlink_msg_mission_ack_get_type(&last(MAVLINK_MSG_ID_MISSION_ACK)), MAV_MISSION_UNSUPPORTED);
}

TEST_F(MavlinkEndpointTest, AnswersWhoeverTalksToItFromItsAddress) {
  Client other;
  mavlink_heartbeat_t heartbeat{};
  heartbeat.type = MAV_TYPE_ONBOARD_CONTROLLER;
  other.send_raw(endpoint.companion_port(), std::vector<std::uint8_t>(40, 0xFD));
  run(0.5);
  EXPECT_TRUE(other.drain().empty());  // noise is no reason to turn to it
  other.send(endpoint.companion_port(), mavlink_msg_heartbeat_encode_status, heartbeat);
  heard.clear();
  run(1.0);
  EXPECT_GT(other.drain().size(), 100U);
  EXPECT_LT(heard.size(), 2U);
}

TEST_F(MavlinkEndpointTest, SurvivesGarbageAndCountsIt) {
  std::mt19937_64 generator(3);
  std::uint64_t sent = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> bytes(generator() % 300 + 1);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(generator());
    if (i % 2 == 0) bytes[0] = MAVLINK_STX;
    companion.send_raw(endpoint.companion_port(), bytes);
    ++sent;
    if (i % 50 == 0) poll();
  }
  companion.send_raw(endpoint.companion_port(), {});
  poll();
  EXPECT_EQ(endpoint.counters().received, 0U);
  EXPECT_GE(endpoint.counters().malformed, sent);
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));  // and goes on
  EXPECT_EQ(endpoint.counters().received, 1U);
}

TEST_F(MavlinkEndpointTest, SurvivesValidFramesWithRandomContents) {
  std::mt19937_64 generator(5);
  const std::vector<std::uint32_t> ids{0, 4, 11, 20, 21, 23, 43, 44, 75, 76, 84, 111};
  Client wild;
  std::uint64_t sent = 0;
  for (int i = 0; i < 6000; ++i) {
    mavlink_message_t message{};
    message.msgid = ids[generator() % ids.size()] & 0xFFFFFFU;
    const auto* entry = mavlink_get_msg_entry(message.msgid);
    for (std::uint8_t b = 0; b < entry->max_msg_len; ++b) {
      _MAV_PAYLOAD_NON_CONST(&message)[b] = static_cast<char>(generator());
    }
    // Half of them with a target that may be this system's.
    if (generator() % 2 == 0 && (entry->flags & MAV_MSG_ENTRY_FLAG_HAVE_TARGET_SYSTEM) != 0) {
      _MAV_PAYLOAD_NON_CONST(&message)[entry->target_system_ofs] = 1;
      if ((entry->flags & MAV_MSG_ENTRY_FLAG_HAVE_TARGET_COMPONENT) != 0) {
        _MAV_PAYLOAD_NON_CONST(&message)[entry->target_component_ofs] = 1;
      }
    }
    mavlink_status_t status{};
    mavlink_finalize_message_buffer(&message, 9, 9, &status, entry->min_msg_len, entry->max_msg_len, entry->crc_extra);
    std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
    wild.send_raw(endpoint.companion_port(),
                  std::span(frame.data(), mavlink_msg_to_send_buffer(frame.data(), &message)));
    ++sent;
    run(VehicleModel::kStep);
    wild.drain();
    ASSERT_TRUE(autopilot.true_motion().position.allFinite());
  }
  EXPECT_EQ(endpoint.counters().received, sent);
}

TEST_F(MavlinkEndpointTest, ATakenPortIsOneClearLine) {
  EndpointOptions options = endpoint_options();
  options.companion_local_port = endpoint.companion_port();
  try {
    MavlinkEndpoint second(autopilot, options);
    FAIL() << "bound twice";
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(std::to_string(endpoint.companion_port())), std::string::npos) << text;
    EXPECT_NE(text.find("another instance"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST_F(MavlinkEndpointTest, RejectsOptionsOutOfRange) {
  EndpointOptions options = endpoint_options();
  options.instance = 10;
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
  options = endpoint_options();
  options.address = "localhost";
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
  options = endpoint_options();
  options.origin.latitude_deg = 91;
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
}

TEST(LocalFrame, IsItsOwnInverse) {
  const LocalFrame frame(kSitlOrigin);
  const Vec3 position(120.0, -340.0, 25.0);
  EXPECT_LT((frame.to_enu(frame.to_geodetic(position)) - position).norm(), 1e-6);
  EXPECT_LT(frame.to_enu(kSitlOrigin).norm(), 1e-6);
  EXPECT_EQ(swap_enu_ned(Vec3(1, 2, 3)), Vec3(2, 1, -3));
  EXPECT_NEAR(swap_yaw(0.0), 1.5707963267948966, 1e-15);
}

TEST(LocalFrame, TurnsAttitudesIntoNedAndFrd) {
  // Heading east in ENU is yaw 0 there and 90 deg in NED; level stays level.
  const RollPitchYaw east = roll_pitch_yaw(attitude_ned(attitude_along(Vec3(0, 0, 9.8), 0.0)));
  EXPECT_NEAR(east.yaw, 1.5707963267948966, 1e-12);
  EXPECT_NEAR(east.roll, 0.0, 1e-12);
  EXPECT_NEAR(east.pitch, 0.0, 1e-12);
  // Heading north with the thrust leaning north: nose down.
  const RollPitchYaw north = roll_pitch_yaw(attitude_ned(attitude_along(Vec3(0, 1, 1), 1.5707963267948966)));
  EXPECT_NEAR(north.pitch, -0.7853981633974483, 1e-12);
  EXPECT_NEAR(north.yaw, 0.0, 1e-12);
}

}  // namespace
}  // namespace jink::sim
