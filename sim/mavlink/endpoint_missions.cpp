// SPDX-License-Identifier: BSD-3-Clause
// Missions: the protocol on each link, what the autopilot gets of it, and what it tells of its progress.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

constexpr double kLastItem = 65535.0;     ///< that a sequence number can name
constexpr int kReachedRepeats = 10;       ///< PX4 says it again, in case it got lost
constexpr double kReachedInterval = 1.0;  ///< s

/// A parameter that means something from 0 on.
double not_negative(float parameter) {
  return parameter > 0.0F ? static_cast<double>(parameter) : 0.0;  // NaN is not
}

int whole_number(float parameter) {
  return std::abs(parameter) < 1e6F ? static_cast<int>(parameter) : 0;  // NaN is not
}

/// What a command means for the vehicle; what it does not know has no effect.
vehicle::MissionItem flown(const ListItem& item) {
  using Kind = vehicle::MissionItem::Kind;
  vehicle::MissionItem result;
  const auto yaw_deg = static_cast<double>(item.param4);
  const double yaw = std::isfinite(yaw_deg) ? vehicle::swap_yaw(yaw_deg * vehicle::kDegree) : yaw_deg;
  result.autocontinue = item.autocontinue != 0;
  switch (item.command) {
    case MAV_CMD_NAV_WAYPOINT:
      result.kind = Kind::kWaypoint;
      result.hold = not_negative(item.param1);
      result.radius = not_negative(item.param2);
      result.yaw = yaw;
      break;
    case MAV_CMD_NAV_LOITER_TIME:
      result.kind = Kind::kWaypoint;
      result.hold = not_negative(item.param1);
      break;
    case MAV_CMD_NAV_LOITER_TO_ALT:
      result.kind = Kind::kWaypoint;
      break;
    case MAV_CMD_NAV_LOITER_UNLIM:
      result.kind = Kind::kLoiter;
      result.yaw = yaw;
      break;
    case MAV_CMD_NAV_TAKEOFF:
      result.kind = Kind::kTakeoff;
      result.yaw = yaw;
      break;
    case MAV_CMD_NAV_LAND:
      result.kind = Kind::kLand;
      break;
    case MAV_CMD_NAV_RETURN_TO_LAUNCH:
      result.kind = Kind::kReturn;
      break;
    case MAV_CMD_NAV_DELAY:
      result.kind = Kind::kDelay;
      result.hold = not_negative(item.param1);
      break;
    case MAV_CMD_DO_CHANGE_SPEED:
      result.kind = Kind::kSpeed;
      result.speed = not_negative(item.param2);
      break;
    case MAV_CMD_DO_JUMP:
      result.kind = Kind::kJump;
      result.jump_to = static_cast<std::size_t>(std::min(not_negative(item.param1), kLastItem));
      result.repeats = whole_number(item.param2);
      break;
    default:
      break;
  }
  return result;
}

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
  const auto current = static_cast<int>(autopilot_.mission().current());
  send_mission_messages(link, missions_[index].handle(message, current, now_));
  const auto wanted = std::exchange(mission_lists_.wanted_current, std::nullopt);
  if (std::exchange(mission_lists_.mission_replaced, false)) {
    autopilot_.set_mission(flown_mission(), wanted);
  } else if (wanted) {
    autopilot_.set_mission_current(*wanted);
  }
}

std::vector<vehicle::MissionItem> MavlinkEndpoint::Impl::flown_mission() const {
  std::vector<vehicle::MissionItem> items;
  for (const ListItem& item : mission_lists_.mission()) {
    vehicle::MissionItem& result = items.emplace_back(flown(item));
    if (item.frame == MAV_FRAME_MISSION) continue;
    result.above_home = item.frame == MAV_FRAME_GLOBAL_RELATIVE_ALT_INT;
    const auto height = static_cast<double>(item.z);
    const bridge::frames::Geodetic place{item.x / kDegreesE7, item.y / kDegreesE7,
                                         result.above_home ? options_.origin.altitude_m : height};
    result.position = frame_.to_enu(place);
    if (result.above_home) result.position.z() = height;
  }
  return items;
}

void MavlinkEndpoint::Impl::update_missions() {
  for (std::size_t i = 0; i < links_.size(); ++i) send_mission_messages(links_[i], missions_[i].update(now_));
  for (std::string& text : std::exchange(mission_lists_.texts, {})) {
    autopilot_.report(vehicle::Severity::kCritical, std::move(text));
  }
  const vehicle::Mission& mission = autopilot_.mission();
  if (std::exchange(told_current_, mission.current()) != mission.current()) {
    for (MavlinkLink& link : links_) send_mission_current(link);
  }
  if (std::exchange(told_reached_, mission.reached()) != mission.reached()) {
    reached_repeats_ = kReachedRepeats + 1;
    next_reached_ = now_;
  }
  if (!told_reached_ || reached_repeats_ == 0 || now_ < next_reached_) return;
  --reached_repeats_;
  next_reached_ = now_ + kReachedInterval;
  mavlink_mission_item_reached_t message{};
  message.seq = static_cast<std::uint16_t>(*told_reached_);
  for (MavlinkLink& link : links_) link.send(mavlink_msg_mission_item_reached_encode_status, message);
}

void MavlinkEndpoint::Impl::send_mission_current(MavlinkLink& link) {
  constexpr std::uint8_t kActive = 1;
  constexpr std::uint8_t kSuspended = 2;
  constexpr auto kNone = std::numeric_limits<std::uint16_t>::max();
  const vehicle::Mission& mission = autopilot_.mission();
  const bool active = autopilot_.mode() == vehicle::FlightMode::kMission;
  mavlink_mission_current_t message{};
  message.seq = static_cast<std::uint16_t>(mission.current());
  message.total = mission.available() ? static_cast<std::uint16_t>(mission.size()) : kNone;
  message.mission_mode = active ? kActive : kSuspended;
  message.mission_state = MISSION_STATE_NOT_STARTED;
  if (mission.begun()) message.mission_state = active ? MISSION_STATE_ACTIVE : MISSION_STATE_PAUSED;
  if (mission.finished()) message.mission_state = MISSION_STATE_COMPLETE;
  if (!mission.available()) message.mission_state = MISSION_STATE_NO_MISSION;
  link.send(mavlink_msg_mission_current_encode_status, message);
}

}  // namespace jink::sim::mavlink
