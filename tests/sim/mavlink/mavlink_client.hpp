// SPDX-License-Identifier: BSD-3-Clause
// What talks to the simulator's endpoint in its tests.
#pragma once

#include <gtest/gtest.h>
#include <px4_events/mavlink.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/mavlink/udp_socket.hpp"

namespace jink::sim::mavlink {

inline constexpr std::uint8_t kClientSystem = 245;
inline constexpr std::uint8_t kClientComponent = 191;

/// The other end of a link: a socket and MAVLink's own parser.
class Client {
 public:
  Client() : socket_(udp_address("127.0.0.1", 0)) {}
  [[nodiscard]] std::uint16_t port() const { return socket_.local_port(); }

  template <typename Payload>
  void send(std::uint16_t to,
            std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*, mavlink_message_t*, const Payload*),
            const Payload& payload) {
    mavlink_message_t message;
    encode(kClientSystem, kClientComponent, &transmit_, &message, &payload);
    std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
    const auto length = mavlink_msg_to_send_buffer(frame.data(), &message);
    send_raw(to, std::span(frame.data(), length));
  }

  void send_raw(std::uint16_t to, std::span<const std::uint8_t> bytes) {
    ASSERT_TRUE(socket_.send(udp_address("127.0.0.1", to), bytes));
  }

  std::vector<mavlink_message_t> drain() {
    std::vector<mavlink_message_t> messages;
    std::array<std::uint8_t, 2048> buffer{};
    UdpAddress from;
    while (const auto length = socket_.receive(buffer, from)) {
      for (std::size_t i = 0; i < *length; ++i) {
        mavlink_message_t message;
        mavlink_status_t status;
        if (mavlink_frame_char_buffer(&partial_, &parser_, buffer[i], &message, &status) == MAVLINK_FRAMING_OK) {
          messages.push_back(message);
        }
      }
    }
    return messages;
  }

 private:
  UdpSocket socket_;
  mavlink_status_t transmit_{};
  mavlink_status_t parser_{};
  mavlink_message_t partial_{};
};

}  // namespace jink::sim::mavlink
