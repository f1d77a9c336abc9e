// SPDX-License-Identifier: BSD-3-Clause
#include "sim/mavlink/udp_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace jink::sim::mavlink {
namespace {

sockaddr_in to_sockaddr(const UdpAddress& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_addr.s_addr = htonl(address.ip);
  result.sin_port = htons(address.port);
  return result;
}

/// The sockets interface takes every address family through this one pointer type.
sockaddr* generic(sockaddr_in& address) {
  return std::bit_cast<sockaddr*>(&address);
}

std::runtime_error bind_error(std::uint16_t port, int code) {
  const std::string where = "UDP port " + std::to_string(port);
  if (code == EADDRINUSE) {
    return std::runtime_error(where + " is taken: another simulator or PX4 runs; stop it or take another instance");
  }
  return std::runtime_error(where + " cannot be opened (" + std::generic_category().message(code) +
                            "); take another instance or address");
}

}  // namespace

UdpAddress udp_address(const std::string& ip, std::uint16_t port) {
  in_addr parsed{};
  if (inet_pton(AF_INET, ip.c_str(), &parsed) != 1) throw std::invalid_argument("not an IPv4 address: " + ip);
  return {ntohl(parsed.s_addr), port};
}

UdpSocket::UdpSocket(const UdpAddress& local)
    : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (descriptor_ < 0) throw bind_error(local.port, errno);
  sockaddr_in address = to_sockaddr(local);
  socklen_t size = sizeof(address);
  if (::bind(descriptor_, generic(address), size) != 0 || ::getsockname(descriptor_, generic(address), &size) != 0) {
    const int code = errno;
    ::close(descriptor_);
    throw bind_error(local.port, code);
  }
  local_port_ = ntohs(address.sin_port);
}

UdpSocket::~UdpSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), local_port_(std::exchange(other.local_port_, 0)) {}

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(local_port_, other.local_port_);
  return *this;
}

bool UdpSocket::send(const UdpAddress& to, std::span<const std::uint8_t> datagram) {
  sockaddr_in address = to_sockaddr(to);
  const auto sent = ::sendto(descriptor_, datagram.data(), datagram.size(), 0, generic(address), sizeof(address));
  return sent == static_cast<ssize_t>(datagram.size());
}

std::optional<std::size_t> UdpSocket::receive(std::span<std::uint8_t> buffer, UdpAddress& from) {
  // A send to a port where nobody listens comes back as ECONNREFUSED here, once each: go on to the next datagram.
  constexpr int kMaxErrors = 100;
  for (int errors = 0; errors < kMaxErrors; ++errors) {
    sockaddr_in address{};
    socklen_t size = sizeof(address);
    const auto length = ::recvfrom(descriptor_, buffer.data(), buffer.size(), 0, generic(address), &size);
    if (length >= 0) {
      from = {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
      return static_cast<std::size_t>(length);
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace jink::sim::mavlink
