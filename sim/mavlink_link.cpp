// SPDX-License-Identifier: BSD-3-Clause
#include "sim/mavlink_link.hpp"

namespace jink::sim {

MavlinkLink::MavlinkLink(const UdpAddress& local, const UdpAddress& remote, std::uint8_t system_id)
    : socket_(local), remote_(remote), system_id_(system_id) {}

void MavlinkLink::send_frame(const mavlink_message_t& message) {
  std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
  const std::uint16_t length = mavlink_msg_to_send_buffer(frame.data(), &message);
  // A datagram that nobody takes is lost, as on any link.
  socket_.send(remote_, std::span(frame.data(), length));
}

void MavlinkLink::receive(const std::function<void(const mavlink_message_t&)>& handle) {
  UdpAddress from;
  while (const auto length = socket_.receive(buffer_, from)) {
    // No frame spans two datagrams: what the last one left unfinished must not swallow this one.
    parser_.parse_state = MAVLINK_PARSE_STATE_IDLE;
    bool clean = true;
    const auto answer_to = [&](const mavlink_message_t& message) {
      if (from.ip == remote_.ip) remote_ = from;
      handle(message);
    };
    const std::size_t messages = parse(*length, answer_to, clean);
    received_ += messages;
    if (!clean || messages == 0) ++malformed_;
  }
}

std::size_t MavlinkLink::parse(std::size_t length, const std::function<void(const mavlink_message_t&)>& handle,
                               bool& clean) {
  std::size_t messages = 0;
  mavlink_message_t message;
  mavlink_status_t status;
  for (std::size_t i = 0; i < length; ++i) {
    const auto framing = mavlink_frame_char_buffer(&partial_, &parser_, buffer_[i], &message, &status);
    if (framing == MAVLINK_FRAMING_OK) {
      ++messages;
      handle(message);
    } else if (framing != MAVLINK_FRAMING_INCOMPLETE) {
      clean = false;
    }
  }
  if (parser_.parse_state > MAVLINK_PARSE_STATE_IDLE) clean = false;
  return messages;
}

}  // namespace jink::sim
