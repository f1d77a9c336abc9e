// SPDX-License-Identifier: BSD-3-Clause
#include "sim/mavlink/link.hpp"

#include <algorithm>

namespace jink::sim::mavlink {
namespace {

/// How many SET_POSITION_TARGET_LOCAL_NED a datagram of whole MAVLink 2 frames holds, by their headers alone.
std::uint64_t count_setpoints(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t kHeader = 10;
  constexpr std::size_t kChecksum = 2;
  constexpr std::size_t kSignature = 13;
  std::uint64_t count = 0;
  while (datagram.size() >= kHeader && datagram[0] == MAVLINK_STX) {
    const unsigned id =
        datagram[7] | static_cast<unsigned>(datagram[8]) << 8U | static_cast<unsigned>(datagram[9]) << 16U;
    if (id == MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED) ++count;
    const bool is_signed = (datagram[2] & MAVLINK_IFLAG_SIGNED) != 0;
    const std::size_t length = kHeader + datagram[1] + kChecksum + (is_signed ? kSignature : 0);
    datagram = datagram.subspan(std::min(length, datagram.size()));
  }
  return count;
}

}  // namespace

MavlinkLink::MavlinkLink(const UdpAddress& local, const UdpAddress& remote, std::uint8_t system_id, std::uint64_t seed)
    : socket_(local),
      remote_(remote),
      system_id_(system_id),
      up_(seed, faults::link_stream(system_id, 0)),
      down_(seed, faults::link_stream(system_id, 1)) {}

void MavlinkLink::impair(const faults::LinkImpairment& impairment) {
  up_.set(impairment.up);
  down_.set(impairment.down);
}

void MavlinkLink::advance(double now) {
  now_ = now;
  Datagram datagram;
  while (down_.pop(now_, datagram)) socket_.send(remote_, datagram.bytes);
}

void MavlinkLink::send_frame(const mavlink_message_t& message) {
  std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
  const std::uint16_t length = mavlink_msg_to_send_buffer(frame.data(), &message);
  if (down_.clear()) {
    // A datagram that nobody takes is lost, as on any link.
    socket_.send(remote_, std::span(frame.data(), length));
    return;
  }
  down_.push(now_, {{frame.begin(), frame.begin() + length}});
  advance(now_);
}

void MavlinkLink::receive(const std::function<void(const mavlink_message_t&)>& handle) {
  UdpAddress from;
  while (const auto length = socket_.receive(buffer_, from)) {
    const std::span<const std::uint8_t> datagram(buffer_.data(), *length);
    setpoints_ += count_setpoints(datagram);
    if (up_.clear()) {
      take(datagram, from, handle);
    } else {
      up_.push(now_, {{datagram.begin(), datagram.end()}, from});
    }
  }
  Datagram datagram;
  while (up_.pop(now_, datagram)) take(datagram.bytes, datagram.from, handle);
}

void MavlinkLink::take(std::span<const std::uint8_t> datagram, const UdpAddress& from,
                       const std::function<void(const mavlink_message_t&)>& handle) {
  // No frame spans two datagrams: what the last one left unfinished must not swallow this one.
  parser_.parse_state = MAVLINK_PARSE_STATE_IDLE;
  bool clean = true;
  const auto answer_to = [&](const mavlink_message_t& message) {
    if (from.ip == remote_.ip) remote_ = from;
    handle(message);
  };
  const std::size_t messages = parse(datagram, answer_to, clean);
  received_ += messages;
  if (!clean || messages == 0) ++malformed_;
}

std::size_t MavlinkLink::parse(std::span<const std::uint8_t> datagram,
                               const std::function<void(const mavlink_message_t&)>& handle, bool& clean) {
  std::size_t messages = 0;
  mavlink_message_t message;
  mavlink_status_t status;
  for (const std::uint8_t byte : datagram) {
    const auto framing = mavlink_frame_char_buffer(&partial_, &parser_, byte, &message, &status);
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

}  // namespace jink::sim::mavlink
