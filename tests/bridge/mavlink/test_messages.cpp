// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavlink/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace jink::bridge::mavlink {
namespace {

using jink::bridge::mavlink::decode;

template <typename T>
T decoded(const char* name, const std::string& json) {
  const auto message = decode(name, json);
  EXPECT_TRUE(message.has_value()) << name << ' ' << json;
  if (!message || !std::holds_alternative<T>(*message)) {
    ADD_FAILURE() << "not the message that was asked for";
    return {};
  }
  return std::get<T>(*message);
}

TEST(MavlinkMessages, ComeInTheProjectsFramesAndUnits) {
  const auto position =
      decoded<LocalPosition>("LOCAL_POSITION_NED", R"({"time_boot_ms":1500,"x":1,"y":2,"z":-3,"vx":4,"vy":5,"vz":-6})");
  EXPECT_EQ(position.boot_ms, 1500U);
  EXPECT_EQ(position.position, Vec3(2, 1, 3));
  EXPECT_EQ(position.velocity, Vec3(5, 4, 6));
  const auto attitude = decoded<Attitude>("ATTITUDE", R"({"time_boot_ms":1,"yaw":0.0})");
  EXPECT_DOUBLE_EQ(attitude.yaw, std::numbers::pi / 2);  // north
  const auto origin =
      decoded<Origin>("GPS_GLOBAL_ORIGIN", R"({"latitude":473977418,"longitude":85455939,"altitude":488000})");
  EXPECT_EQ(origin.place, (frames::Geodetic{47.3977418, 8.5455939, 488.0}));
  const auto aircraft = decoded<AdsbReport>(
      "ADSB_VEHICLE",
      R"({"ICAO_address":7,"lat":470000000,"lon":80000000,"altitude_type":1,"altitude":1500000,"heading":9000,)"
      R"("hor_velocity":5000,"ver_velocity":-200,"emitter_type":2,"tslc":3,"flags":143})");
  EXPECT_DOUBLE_EQ(aircraft.latitude_deg, 47.0);
  EXPECT_DOUBLE_EQ(aircraft.altitude_m, 1500.0);
  EXPECT_DOUBLE_EQ(aircraft.heading_deg, 90.0);
  EXPECT_DOUBLE_EQ(aircraft.horizontal_velocity, 50.0);
  EXPECT_DOUBLE_EQ(aircraft.vertical_velocity, -2.0);
}

std::string odometry(const std::string& child_frame, const std::string& q) {
  return R"({"time_usec":2000000,"frame_id":1,"child_frame_id":)" + child_frame + R"(,"x":1,"y":0,"z":0,"q":)" + q +
         R"(,"vx":1,"vy":0,"vz":0,"reset_counter":9})";
}

TEST(MavlinkMessages, OdometrysVelocityIsTurnedByItsAttitude) {
  const auto as_it_stands = decoded<Odometry>("ODOMETRY", odometry("1", "[0,0,0,0]"));
  EXPECT_EQ(as_it_stands.velocity, Vec3(0, 1, 0));
  EXPECT_EQ(as_it_stands.reset_counter, 9);
  EXPECT_DOUBLE_EQ(as_it_stands.time, 2.0);
  // Looking east (90 degrees clockwise from north): forward is east.
  const auto turned = decoded<Odometry>("ODOMETRY", odometry("12", "[0.70710678,0,0,0.70710678]"));
  EXPECT_NEAR((turned.velocity - Vec3(1, 0, 0)).norm(), 0.0, 1e-7);
  EXPECT_FALSE(decode("ODOMETRY", odometry("12", "[0,0,0,0]")));  // no attitude, so nobody knows whereto
  EXPECT_FALSE(decode("ODOMETRY", odometry("12", "[1,0,0]")));
  EXPECT_FALSE(decode("ODOMETRY", odometry("20", "[1,0,0,0]")));
}

TEST(MavlinkMessages, WhatIsMissingNotFiniteOrAbsurdIsRefused) {
  const std::vector<std::pair<const char*, std::string>> bad{
      {"NO_SUCH_MESSAGE", "{}"},
      {"", "{}"},
      {"HEARTBEAT", ""},
      {"HEARTBEAT", "[]"},
      {"HEARTBEAT", "{"},
      {"HEARTBEAT", "{}"},
      {"HEARTBEAT", R"({"autopilot":12,"base_mode":-1,"custom_mode":0,"system_status":3})"},
      {"HEARTBEAT", R"({"autopilot":"12","base_mode":0,"custom_mode":0,"system_status":3})"},
      {"LOCAL_POSITION_NED", R"({"time_boot_ms":1,"x":null,"y":0,"z":0,"vx":0,"vy":0,"vz":0})"},
      {"LOCAL_POSITION_NED", R"({"time_boot_ms":1,"x":2e5,"y":0,"z":0,"vx":0,"vy":0,"vz":0})"},
      {"LOCAL_POSITION_NED", R"({"time_boot_ms":1,"x":0,"y":0,"z":0,"vx":0,"vy":2e3,"vz":0})"},
      {"LOCAL_POSITION_NED", R"({"time_boot_ms":4294967296,"x":0,"y":0,"z":0,"vx":0,"vy":0,"vz":0})"},
      {"ATTITUDE", R"({"time_boot_ms":1,"yaw":1e30})"},
      {"ODOMETRY", R"({"time_usec":1,"frame_id":1,"child_frame_id":1,"x":1e30,"y":0,"z":0,"vx":0,"vy":0,"vz":0,)"
                   R"("reset_counter":0})"},
      {"ODOMETRY", R"({"time_usec":1,"frame_id":1,"child_frame_id":1,"x":0,"y":0,"z":0,"vx":0,"vy":0,"vz":0,)"
                   R"("reset_counter":256})"},
      {"GPS_GLOBAL_ORIGIN", R"({"latitude":910000000,"longitude":0,"altitude":0})"},
      {"GPS_GLOBAL_ORIGIN", R"({"latitude":0,"longitude":0,"altitude":1e30})"},
      {"COMMAND_ACK", R"({"command":65536,"result":0})"},
      {"COMMAND_ACK", R"({"command":400,"result":4000000000})"},
      {"BATTERY_STATUS", R"({"id":256})"},
      {"PARAM_VALUE", R"({"param_id":"","param_type":9,"param_value":1})"},
      {"PARAM_VALUE", R"({"param_id":"A","param_type":6,"param_value":1e300})"},
      {"PING", R"({"time_usec":1.5,"target_system":1})"},
      {"STATUSTEXT", R"({"text":"no severity"})"}};
  for (const auto& [name, json] : bad) EXPECT_FALSE(decode(name, json)) << name << ' ' << json;
}

TEST(MavlinkMessages, ExtensionFieldsMayBeAbsent) {
  EXPECT_EQ(decoded<BatteryStatus>("BATTERY_STATUS", R"({"id":1})").charge_state, 0U);
  EXPECT_EQ(decoded<CommandAck>("COMMAND_ACK", R"({"command":400,"result":0})").target_system, 0U);
  EXPECT_EQ(decoded<StatusText>("STATUSTEXT", R"({"severity":4,"text":"a"})").id, 0U);
  EXPECT_TRUE(
      std::isnan(decoded<ParamValue>("PARAM_VALUE", R"({"param_id":"A","param_type":6,"param_value":null})").field));
}

}  // namespace
}  // namespace jink::bridge::mavlink
