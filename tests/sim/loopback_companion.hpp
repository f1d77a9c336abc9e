// SPDX-License-Identifier: BSD-3-Clause
// A companion of the simplest kind for tests of the simulator: MAVLink over a loopback socket, in the tester's time.
#pragma once

#include <development/mavlink.h>

#include <array>
#include <cstdint>
#include <vector>

#include "sim/mavlink_endpoint.hpp"
#include "sim/udp_socket.hpp"

namespace jink::sim {

/// Streams a position once it is told where to go, and asks for arming and OFFBOARD when told to.
class LoopbackCompanion {
 public:
  LoopbackCompanion() : socket_(udp_address("127.0.0.1", 0)) {}

  /// An endpoint's options that lead here: any free port of its own, no ground station.
  [[nodiscard]] EndpointOptions endpoint(int instance) const {
    EndpointOptions options;
    options.instance = instance;
    options.ground_link = false;
    options.companion_local_port = 0;
    options.companion_remote_port = socket_.local_port();
    return options;
  }

  /// To that port and system, from now on.
  void connect(std::uint16_t port, int system) {
    port_ = port;
    system_ = static_cast<std::uint8_t>(system);
  }

  void setpoint(const Vec3& enu) {
    mavlink_set_position_target_local_ned_t target{};
    target.target_system = system_;
    target.target_component = 1;
    target.coordinate_frame = MAV_FRAME_LOCAL_NED;
    target.type_mask = 0x0DF8;  // position alone
    target.x = static_cast<float>(enu.y());
    target.y = static_cast<float>(enu.x());
    target.z = static_cast<float>(-enu.z());
    send(mavlink_msg_set_position_target_local_ned_encode_status, target);
  }
  void arm() { command(MAV_CMD_COMPONENT_ARM_DISARM, 1.0F); }
  void offboard() { command(MAV_CMD_DO_SET_MODE, 1.0F, 6.0F); }

  /// What has arrived since the last call.
  std::vector<mavlink_message_t> drain() {
    std::vector<mavlink_message_t> messages;
    std::array<std::uint8_t, 2048> buffer{};
    UdpAddress from;
    while (const auto length = socket_.receive(buffer, from)) {
      for (std::size_t i = 0; i < *length; ++i) {
        mavlink_message_t message;
        mavlink_status_t status;
        if (mavlink_frame_char_buffer(&partial_, &parser_, buffer[i], &message, &status) == MAVLINK_FRAMING_OK)
          messages.push_back(message);
      }
    }
    return messages;
  }

 private:
  void command(std::uint16_t id, float param1, float param2 = 0.0F) {
    mavlink_command_long_t message{};
    message.command = id;
    message.target_system = system_;
    message.target_component = 1;
    message.param1 = param1;
    message.param2 = param2;
    send(mavlink_msg_command_long_encode_status, message);
  }

  template <typename Payload>
  void send(std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*, mavlink_message_t*, const Payload*),
            const Payload& payload) {
    mavlink_message_t message;
    encode(245, 191, &transmit_, &message, &payload);
    std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
    const auto length = mavlink_msg_to_send_buffer(frame.data(), &message);
    socket_.send(udp_address("127.0.0.1", port_), std::span(frame.data(), length));
  }

  UdpSocket socket_;
  std::uint16_t port_ = 0;
  std::uint8_t system_ = 0;
  mavlink_status_t transmit_{};
  mavlink_status_t parser_{};
  mavlink_message_t partial_{};
};

}  // namespace jink::sim
