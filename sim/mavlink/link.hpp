// SPDX-License-Identifier: BSD-3-Clause
// One MAVLink 2 link of the endpoint over UDP: framing, sequence, stream pacing. Internal to the endpoint: what the
// messages mean is not its business.
#pragma once

#include <px4_events/mavlink.h>

#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "sim/faults/link_faults.hpp"
#include "sim/mavlink/udp_socket.hpp"

namespace jink::sim::mavlink {

/// When one message goes out on one link.
struct Stream {
  double interval = 0.0;  ///< s; 0: only on request
  double next_due = 0.0;  ///< s, endpoint time
  double sent = 0.0;      ///< s, endpoint time
};

class MavlinkLink {
 public:
  /// Throws as UdpSocket does. `seed` is that of what befalls packets while the link is impaired.
  MavlinkLink(const UdpAddress& local, const UdpAddress& remote, std::uint8_t system_id, std::uint64_t seed = 1);

  [[nodiscard]] std::uint16_t local_port() const { return socket_.local_port(); }

  /// How bad the link is from now on, both ways.
  void impair(const faults::LinkImpairment& impairment);
  /// Goes on to `now`, the endpoint's time: what was held back on its way out and is due goes out.
  void advance(double now);

  /// Frames `payload` with its generated encode function and sends it.
  template <typename Payload>
  void send(std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*, mavlink_message_t*, const Payload*),
            const Payload& payload) {
    mavlink_message_t message;
    encode(system_id_, MAV_COMP_ID_AUTOPILOT1, &transmit_, &message, &payload);
    send_frame(message);
  }

  /// Sends another one's message as it is.
  void pass(const mavlink_message_t& message) { send_frame(message); }

  /// Hands every message that has arrived to `handle`. Malformed bytes are dropped and counted. Whoever sends a valid
  /// message from the link's address becomes the one that is sent to.
  void receive(const std::function<void(const mavlink_message_t&)>& handle);

  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }
  /// SET_POSITION_TARGET_LOCAL_NED in what came from the socket, before any impairment, whoever it is for.
  [[nodiscard]] std::uint64_t setpoints() const { return setpoints_; }

  std::vector<Stream> streams;                                 ///< parallel to the endpoint's table of messages
  bool ground_station = false;                                 ///< a ground station's heartbeat has come
  std::set<std::pair<std::uint8_t, std::uint8_t>> components;  ///< systems and components that were heard
  std::size_t next_listed_parameter = 0;
  bool listing_parameters = false;

 private:
  /// A datagram on its way; `from` is of those that come in.
  struct Datagram {
    std::vector<std::uint8_t> bytes;
    UdpAddress from{};
  };

  void send_frame(const mavlink_message_t& message);
  void take(std::span<const std::uint8_t> datagram, const UdpAddress& from,
            const std::function<void(const mavlink_message_t&)>& handle);
  [[nodiscard]] std::size_t parse(std::span<const std::uint8_t> datagram,
                                  const std::function<void(const mavlink_message_t&)>& handle, bool& clean);

  UdpSocket socket_;
  UdpAddress remote_;
  std::uint8_t system_id_;
  double now_ = 0.0;
  faults::ImpairedChannel<Datagram> up_;
  faults::ImpairedChannel<Datagram> down_;
  mavlink_status_t transmit_{};
  mavlink_status_t parser_{};
  mavlink_message_t partial_{};
  std::array<std::uint8_t, 65536> buffer_{};
  std::uint64_t received_ = 0;
  std::uint64_t malformed_ = 0;
  std::uint64_t setpoints_ = 0;
};

}  // namespace jink::sim::mavlink
