// SPDX-License-Identifier: BSD-3-Clause
// Missions: the protocol on each link.
#include <limits>
#include <utility>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

struct Encoders {
  static auto of(const mavlink_mission_count_t&) { return mavlink_msg_mission_count_encode_status; }
  static auto of(const mavlink_mission_request_t&) { return mavlink_msg_mission_request_encode_status; }
  static auto of(const mavlink_mission_request_int_t&) { return mavlink_msg_mission_request_int_encode_status; }
  static auto of(const mavlink_mission_item_t&) { return mavlink_msg_mission_item_encode_status; }
  static auto of(const mavlink_mission_item_int_t&) { return mavlink_msg_mission_item_int_encode_status; }
  static auto of(const mavlink_mission_ack_t&) { return mavlink_msg_mission_ack_encode_status; }
};

}  // namespace

void MavlinkEndpoint::Impl::send_mission_messages(MavlinkLink& link, const std::vector<MissionMessage>& messages) {
  for (const MissionMessage& message : messages) {
    std::visit([&](const auto& payload) { link.send(Encoders::of(payload), payload); }, message);
  }
}

void MavlinkEndpoint::Impl::handle_mission(MavlinkLink& link, const mavlink_message_t& message) {
  const auto index = static_cast<std::size_t>(&link - links_.data());
  send_mission_messages(link, missions_[index].handle(message, 0, now_));
}

void MavlinkEndpoint::Impl::update_missions() {
  for (std::size_t i = 0; i < links_.size(); ++i) send_mission_messages(links_[i], missions_[i].update(now_));
  for (std::string& text : std::exchange(mission_lists_.texts, {})) {
    autopilot_.report(vehicle::Severity::kCritical, std::move(text));
  }
}

void MavlinkEndpoint::Impl::send_mission_current(MavlinkLink& link) {
  constexpr std::uint8_t kSuspended = 2;
  constexpr auto kNone = std::numeric_limits<std::uint16_t>::max();
  const auto total = static_cast<std::uint16_t>(mission_lists_.mission().size());
  mavlink_mission_current_t message{};
  message.total = total > 0 ? total : kNone;
  message.mission_state = total > 0 ? std::uint8_t{MISSION_STATE_NOT_STARTED} : std::uint8_t{MISSION_STATE_NO_MISSION};
  message.mission_mode = kSuspended;
  link.send(mavlink_msg_mission_current_encode_status, message);
}

}  // namespace jink::sim::mavlink
