// SPDX-License-Identifier: BSD-3-Clause
// What the endpoint sends by itself: rates, start-up, reboots, and the state of the flight in them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

TEST_F(MavlinkEndpointTest, StreamsAtPx4sRates) {
  constexpr double kDuration = 30.0;
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
                                              {MAVLINK_MSG_ID_VIBRATION, 0.5},
                                              {MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE, 1.0 / 3.0}};
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

// However often it is asked for: PX4 sends it when its vehicle_status is new.
TEST_F(MavlinkEndpointTest, SendsTheModeTwiceASecondAndSoonAfterAChange) {
  run(1.0);
  ASSERT_EQ(command(MAV_CMD_SET_MESSAGE_INTERVAL, {MAVLINK_MSG_ID_CURRENT_MODE, 100000}), (Results{0}));
  run(10.0);
  EXPECT_NEAR(static_cast<double>(count(heard, MAVLINK_MSG_ID_CURRENT_MODE)), 20.0, 1.0);
  heard.clear();
  autopilot.pilot_mode(vehicle::FlightMode::kPosition);
  run(0.11);
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_CURRENT_MODE), 1U);
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
    run(vehicle::VehicleModel::kStep);
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
  const vehicle::Motion& motion = autopilot.true_motion();
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

class SlowClockEndpointTest : public MavlinkEndpointTest {
 protected:
  SlowClockEndpointTest() : MavlinkEndpointTest(true, 0.0, kSitlClockRate) {}
};

TEST_F(SlowClockEndpointTest, StampsLagAsPx4SitlsDoAndNothingElse) {
  for (int i = 0; i < 1000; ++i) {
    setpoint(kVelocityOnly, Vec3::Zero(), {1.25, 0.0, 0.0});
    if (i == 10) {
      ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
    }
    run(0.02);
  }
  heard.clear();
  run(1.1);
  const auto near = [&](double seconds) { EXPECT_NEAR(seconds, kSitlClockRate * autopilot.time(), 0.03); };
  near(1e-3 * mavlink_msg_attitude_get_time_boot_ms(&last(MAVLINK_MSG_ID_ATTITUDE)));
  near(1e-6 * static_cast<double>(mavlink_msg_highres_imu_get_time_usec(&last(MAVLINK_MSG_ID_HIGHRES_IMU))));
  const auto& local = last(MAVLINK_MSG_ID_LOCAL_POSITION_NED);
  near(1e-3 * mavlink_msg_local_position_ned_get_time_boot_ms(&local));
  EXPECT_FLOAT_EQ(mavlink_msg_local_position_ned_get_vx(&local),
                  static_cast<float>(autopilot.true_motion().velocity.y()));
  EXPECT_NEAR(static_cast<double>(count(heard, MAVLINK_MSG_ID_ATTITUDE)), 110, 1);
  mavlink_system_time_t system_time;
  mavlink_msg_system_time_decode(&last(MAVLINK_MSG_ID_SYSTEM_TIME), &system_time);
  const double unix_time = 1e-6 * static_cast<double>(system_time.time_unix_usec - 1767225600000000);
  EXPECT_NEAR(1e-3 * system_time.time_boot_ms, kSitlClockRate * unix_time, 0.002);

  heard.clear();
  mavlink_timesync_t request{};
  request.ts1 = 5;
  tell(mavlink_msg_timesync_encode_status, request);
  poll();
  mavlink_timesync_t answer;
  mavlink_msg_timesync_decode(&last(MAVLINK_MSG_ID_TIMESYNC), &answer);
  near(1e-9 * static_cast<double>(answer.tc1));
}

}  // namespace
}  // namespace jink::sim::mavlink
