// SPDX-License-Identifier: BSD-3-Clause
// The endpoint over real loopback sockets on free ports, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/mavlink/endpoint.hpp"
#include "tests/sim/mavlink/mavlink_client.hpp"

namespace jink::sim::mavlink {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr std::uint16_t kPositionOnly = 0x0DF8;
inline constexpr std::uint16_t kVelocityOnly = 0x0DC7;

/// What acknowledgements say, in order.
using Results = std::vector<int>;

/// An autopilot, its endpoint, a companion and a ground station.
class MavlinkEndpointTest : public testing::Test {
 protected:
  explicit MavlinkEndpointTest(bool airborne = false, double ready_delay = 0.0, double clock_rate = 1.0)
      : autopilot(autopilot_options(airborne, ready_delay)), endpoint(autopilot, endpoint_options(clock_rate)) {}

  static vehicle::AutopilotOptions autopilot_options(bool airborne, double ready_delay) {
    vehicle::AutopilotOptions options;
    options.airborne = airborne;
    options.ready_delay = ready_delay;
    if (airborne) options.position = {2, 1, 3};
    return options;
  }

  [[nodiscard]] EndpointOptions endpoint_options(double clock_rate = 1.0) const {
    EndpointOptions options;
    options.clock_rate = clock_rate;
    options.companion_local_port = options.ground_local_port = 0;
    options.companion_remote_port = companion.port();
    options.ground_remote_port = ground.port();
    return options;
  }

  /// Runs for `duration` and collects what each end hears.
  void run(double duration) {
    const double end = autopilot.time() + duration - vehicle::VehicleModel::kStep / 2;
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
  vehicle::Autopilot autopilot;
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

}  // namespace jink::sim::mavlink
