// SPDX-License-Identifier: BSD-3-Clause
// A non-blocking IPv4 UDP socket. It knows nothing of what it carries.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace jink::sim::mavlink {

/// Host byte order.
struct UdpAddress {
  std::uint32_t ip = 0;
  std::uint16_t port = 0;
  bool operator==(const UdpAddress&) const = default;
};

/// Throws std::invalid_argument unless `ip` is a dotted IPv4 address.
[[nodiscard]] UdpAddress udp_address(const std::string& ip, std::uint16_t port);

/// Owns the socket. Movable; not thread-safe.
class UdpSocket {
 public:
  /// Binds to `local`; port 0 takes a free one. Throws std::runtime_error, one line that names the port and says what
  /// to do, when it is taken or cannot be bound.
  explicit UdpSocket(const UdpAddress& local);
  ~UdpSocket();
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&& other) noexcept;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  [[nodiscard]] std::uint16_t local_port() const { return local_port_; }

  /// Never blocks. False when the datagram was not taken: nobody listens, or the buffer is full.
  bool send(const UdpAddress& to, std::span<const std::uint8_t> datagram);

  /// The length of the next datagram, written to `buffer` (cut to its size), or none when nothing waits. Never blocks.
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::uint8_t> buffer, UdpAddress& from);

 private:
  int descriptor_ = -1;
  std::uint16_t local_port_ = 0;
};

}  // namespace jink::sim::mavlink
