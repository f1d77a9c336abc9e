// SPDX-License-Identifier: BSD-3-Clause
// The link over loopback UDP against tests/bridge/mavsdk/px4_peer.py, which shares no code with it (pymavlink) and
// answers as PX4 does.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/mavsdk/link.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::testing {

using nlohmann::json;

inline int free_udp_port() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  const bool ok = bind(fd, generic, size) == 0 && getsockname(fd, generic, &size) == 0;
  close(fd);
  if (!ok) throw std::runtime_error("no free UDP port");
  return ntohs(address.sin_port);
}

class MavsdkLinkTest : public ::testing::Test {
 protected:
  // A link that listens and a peer that speaks to it.
  void connect(const std::vector<std::string>& peer_options = {}) {
    open(peer_options);
    ASSERT_TRUE(link_->wait_for_autopilot(30.0));
  }

  void open(const std::vector<std::string>& peer_options = {}, std::uint32_t wanted_system = 0) {
    const std::string port = std::to_string(free_udp_port());
    link_ = std::make_unique<mavsdk::MavsdkLink>("udpin://127.0.0.1:" + port, clock_, wanted_system);
    const std::string root = JINK_SOURCE_DIR;
    std::vector<std::string> arguments{root + "/.venv/bin/python", root + "/tests/bridge/mavsdk/px4_peer.py", "--port",
                                       port};
    arguments.insert(arguments.end(), peer_options.begin(), peer_options.end());
    peer_ = std::make_unique<ChildProcess>(arguments);
  }

  bool state_becomes(const std::function<bool(const vehicle::VehicleState&)>& condition) {
    return eventually([&] { return condition(link_->state()); });
  }

  vehicle::CommandReport next_report() {
    std::optional<vehicle::CommandReport> report;
    EXPECT_TRUE(eventually([&] { return (report = link_->next_report()).has_value(); }));
    return report.value_or(vehicle::CommandReport{});
  }

  std::vector<json> heard(const std::string& type) {
    std::vector<json> messages;
    for (const std::string& line : peer_->lines()) {
      json message = json::parse(line);
      if (message["type"] == type) messages.push_back(std::move(message));
    }
    return messages;
  }

  // The peer's record of the last command with this MAV_CMD.
  json heard_command(int id) {
    json found;
    EXPECT_TRUE(eventually([&] {
      for (const json& message : heard("command")) {
        if (message["command"] == id) found = message;
      }
      return !found.is_null();
    })) << "command "
        << id;
    return found;
  }

  base::SteadyClock clock_;
  std::unique_ptr<mavsdk::MavsdkLink> link_;
  std::unique_ptr<ChildProcess> peer_;
};

}  // namespace jink::bridge::testing
