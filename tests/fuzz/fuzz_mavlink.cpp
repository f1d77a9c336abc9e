// SPDX-License-Identifier: BSD-3-Clause
// Bytes on the simulator's MAVLink port, with an autopilot behind it: nothing that comes in may crash it, or make the
// vehicle's state anything but finite. The input is a sequence of
//   0 LENGTH BYTES          a datagram as it is
//   1 MESSAGE LENGTH BYTES  a datagram with one frame around these bytes of payload, with its checksum: the messages
//                           below, by their place in the list
//   2 TURNS                 so many turns of the simulator's loop (4 ms)
#include <array>
#include <memory>

#include "px4_events/mavlink.h"
#include "sim/mavlink/endpoint.hpp"
#include "sim/mavlink/udp_socket.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using jink::fuzz::Input;
using jink::fuzz::require;

constexpr std::array<std::uint32_t, 23> kMessages = {
    MAVLINK_MSG_ID_HEARTBEAT,          MAVLINK_MSG_ID_COMMAND_LONG,
    MAVLINK_MSG_ID_COMMAND_INT,        MAVLINK_MSG_ID_SET_MODE,
    MAVLINK_MSG_ID_PARAM_REQUEST_READ, MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
    MAVLINK_MSG_ID_PARAM_REQUEST_LIST, MAVLINK_MSG_ID_PARAM_SET,
    MAVLINK_MSG_ID_TIMESYNC,           MAVLINK_MSG_ID_PING,
    MAVLINK_MSG_ID_MISSION_COUNT,      MAVLINK_MSG_ID_MISSION_REQUEST_LIST,
    MAVLINK_MSG_ID_MANUAL_CONTROL,     MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT,
    MAVLINK_MSG_ID_LOG_REQUEST_LIST,   MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL,
    MAVLINK_MSG_ID_MISSION_ITEM_INT,   MAVLINK_MSG_ID_MISSION_ITEM,
    MAVLINK_MSG_ID_MISSION_ACK,        MAVLINK_MSG_ID_MISSION_REQUEST_INT,
    MAVLINK_MSG_ID_MISSION_REQUEST,    MAVLINK_MSG_ID_MISSION_SET_CURRENT,
    MAVLINK_MSG_ID_MISSION_CLEAR_ALL};

class Simulated {
 public:
  Simulated() : socket_(jink::sim::mavlink::udp_address("127.0.0.1", 0)), buffer_(65536) {
    jink::sim::vehicle::AutopilotOptions vehicle;
    vehicle.ready_delay = 0.0;
    autopilot_ = std::make_unique<jink::sim::vehicle::Autopilot>(vehicle);
    jink::sim::mavlink::EndpointOptions options;
    options.ground_link = false;
    options.companion_local_port = std::uint16_t{0};
    options.companion_remote_port = socket_.local_port();
    endpoint_ = std::make_unique<jink::sim::mavlink::MavlinkEndpoint>(*autopilot_, options);
    to_ = jink::sim::mavlink::udp_address("127.0.0.1", endpoint_->companion_port());
  }

  void send(std::span<const std::uint8_t> datagram) {
    if (!datagram.empty()) socket_.send(to_, datagram);
  }

  void send_frame(std::uint32_t id, std::span<const std::uint8_t> payload) {
    const mavlink_msg_entry_t* entry = mavlink_get_msg_entry(id);
    require(entry != nullptr, "a message that the dialect does not know");
    mavlink_message_t message{};
    message.msgid = id & 0xFFFFFFU;  // 24 bits
    std::copy_n(payload.begin(), std::min<std::size_t>(payload.size(), MAVLINK_MAX_PAYLOAD_LEN),
                reinterpret_cast<std::uint8_t*>(message.payload64));  // NOLINT: the C library's own way
    mavlink_finalize_message_buffer(&message, 255, 190, &status_, entry->min_msg_len, entry->max_msg_len,
                                    entry->crc_extra);
    std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
    send(std::span(frame.data(), mavlink_msg_to_send_buffer(frame.data(), &message)));
  }

  void turn() {
    endpoint_->poll(autopilot_->time());
    autopilot_->step();
    const jink::sim::vehicle::Motion& motion = autopilot_->true_motion();
    require(motion.position.allFinite() && motion.velocity.allFinite(), "the vehicle's motion is not finite");
    jink::sim::mavlink::UdpAddress from;
    while (socket_.receive(buffer_, from)) {
    }
  }

 private:
  jink::sim::mavlink::UdpSocket socket_;
  std::vector<std::uint8_t> buffer_;
  std::unique_ptr<jink::sim::vehicle::Autopilot> autopilot_;
  std::unique_ptr<jink::sim::mavlink::MavlinkEndpoint> endpoint_;
  jink::sim::mavlink::UdpAddress to_;
  mavlink_status_t status_{};
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Simulated simulated;
  int turns = 200;  // in all
  while (!input.empty() && turns > 0) {
    switch (input.byte() % 3) {
      case 0:
        simulated.send(input.bytes(input.byte()));
        break;
      case 1: {
        const std::uint32_t id = kMessages[input.byte() % kMessages.size()];
        simulated.send_frame(id, input.bytes(input.byte()));
        break;
      }
      default:
        for (int left = input.byte() % 50; left > 0 && turns > 0; --left, --turns) simulated.turn();
    }
  }
  simulated.turn();
  return 0;
}
