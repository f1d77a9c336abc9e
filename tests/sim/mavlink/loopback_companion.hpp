// SPDX-License-Identifier: BSD-3-Clause
// A companion of the simplest kind for tests of the simulator: MAVLink over a loopback socket, in the tester's time.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/mavlink/endpoint.hpp"
#include "tests/sim/mavlink/mavlink_client.hpp"

namespace jink::sim::mavlink {

/// Streams a position once it is told where to go, and asks for arming and OFFBOARD when told to.
class LoopbackCompanion {
 public:
  /// An endpoint's options that lead here: any free port of its own, no ground station.
  [[nodiscard]] EndpointOptions endpoint(int instance) const {
    EndpointOptions options;
    options.instance = instance;
    options.ground_link = false;
    options.companion_local_port = 0;
    options.companion_remote_port = client_.port();
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
    client_.send(port_, mavlink_msg_set_position_target_local_ned_encode_status, target);
  }
  void arm() { command(MAV_CMD_COMPONENT_ARM_DISARM, 1.0F); }
  void offboard() { command(MAV_CMD_DO_SET_MODE, 1.0F, 6.0F); }

  /// What has arrived since the last call.
  std::vector<mavlink_message_t> drain() { return client_.drain(); }

 private:
  void command(std::uint16_t id, float param1, float param2 = 0.0F) {
    mavlink_command_long_t message{};
    message.command = id;
    message.target_system = system_;
    message.target_component = 1;
    message.param1 = param1;
    message.param2 = param2;
    client_.send(port_, mavlink_msg_command_long_encode_status, message);
  }

  Client client_;
  std::uint16_t port_ = 0;
  std::uint8_t system_ = 0;
};

}  // namespace jink::sim::mavlink
