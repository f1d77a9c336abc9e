// SPDX-License-Identifier: BSD-3-Clause
// Strangers, noise and options that cannot be.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

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
    run(vehicle::VehicleModel::kStep);
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
  options.clock_rate = 1.2;
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
  options.clock_rate = std::nan("");
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
  options = endpoint_options();
  options.origin.latitude_deg = 91;
  EXPECT_THROW(MavlinkEndpoint(autopilot, options), std::invalid_argument);
}

}  // namespace
}  // namespace jink::sim::mavlink
