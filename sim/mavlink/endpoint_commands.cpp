// SPDX-License-Identifier: BSD-3-Clause
// Commands and their acknowledgements, as PX4's SITL answers them.
#include <cmath>
#include <limits>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

constexpr float kForce = 21196.0F;    ///< param2 of MAV_CMD_COMPONENT_ARM_DISARM
constexpr float kMaxItem = 65535.0F;  ///< of a mission
constexpr double kMicroseconds = 1e6;
constexpr float kMaxIntervalUs = 2e9F;              ///< what MESSAGE_INTERVAL can tell
constexpr double kMaxAltitude = 10000.0;            ///< m, of anything that a command may name
constexpr std::int32_t kNoCoordinate = 0x7FFFFFFF;  ///< "not given" in COMMAND_INT

double coordinate(std::int32_t field) {
  return field == kNoCoordinate ? std::numeric_limits<double>::quiet_NaN() : field / kDegreesE7;
}

/// A parameter that carries a small whole number; anything else gives a number that nothing has.
std::uint32_t whole(float parameter) {
  constexpr float kMax = 16777215.0F;  // of message ids, and what a float holds exactly
  return parameter >= 0.0F && parameter <= kMax ? static_cast<std::uint32_t>(parameter) : 0xFFFFFFFFU;
}

}  // namespace

void MavlinkEndpoint::Impl::handle_command_long(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_command_long_t fields;
  mavlink_msg_command_long_decode(&message, &fields);
  if (!for_us(fields.target_system, fields.target_component)) return;
  run_command(
      link, {fields.command, message.sysid, message.compid, fields.param1, fields.param2, fields.param3, fields.param4,
             static_cast<double>(fields.param5), static_cast<double>(fields.param6), fields.param7});
}

void MavlinkEndpoint::Impl::handle_command_int(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_command_int_t fields;
  mavlink_msg_command_int_decode(&message, &fields);
  if (!for_us(fields.target_system, fields.target_component)) return;
  run_command(link, {fields.command, message.sysid, message.compid, fields.param1, fields.param2, fields.param3,
                     fields.param4, coordinate(fields.x), coordinate(fields.y), fields.z});
}

/// The old message for DO_SET_MODE: one acknowledgement, the true one.
void MavlinkEndpoint::Impl::handle_set_mode(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_set_mode_t fields;
  mavlink_msg_set_mode_decode(&message, &fields);
  if (fields.target_system != system_id_ || (fields.base_mode & MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) == 0) return;
  Command command;
  command.id = MAV_CMD_DO_SET_MODE;
  command.sender_system = message.sysid;
  command.sender_component = message.compid;
  acknowledge(link, command, autopilot_.set_mode(fields.custom_mode >> 16U & 0xFFU, fields.custom_mode >> 24U & 0xFFU));
}

void MavlinkEndpoint::Impl::run_command(MavlinkLink& link, const Command& command) {
  // PX4 takes note of the wish, then says how it went.
  if (command.id == MAV_CMD_DO_SET_MODE) acknowledge(link, command, vehicle::Result::kAccepted);
  const vehicle::Result result = execute(link, command);
  acknowledge(link, command, result);
  // Not without its answer.
  const bool reboots = command.id == MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN && command.param1 == 1.0F;
  if (reboots && result == vehicle::Result::kAccepted) autopilot_.reboot();
}

void MavlinkEndpoint::Impl::acknowledge(MavlinkLink& link, const Command& command, vehicle::Result result) {
  mavlink_command_ack_t ack{};
  ack.command = command.id;
  ack.result = static_cast<std::uint8_t>(result);
  ack.target_system = command.sender_system;
  ack.target_component = command.sender_component;
  link.send(mavlink_msg_command_ack_encode_status, ack);
}

vehicle::Result MavlinkEndpoint::Impl::execute(MavlinkLink& link, const Command& command) {
  switch (command.id) {
    case MAV_CMD_DO_SET_MODE:
      if ((whole(command.param1) & MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) == 0)
        return vehicle::Result::kTemporarilyRejected;
      return autopilot_.set_mode(whole(command.param2), whole(command.param3));
    case MAV_CMD_COMPONENT_ARM_DISARM:
      return arm_or_disarm(command);
    case MAV_CMD_NAV_TAKEOFF:
      return take_off(command);
    case MAV_CMD_NAV_LAND:
      return autopilot_.land();
    case MAV_CMD_NAV_LOITER_UNLIM:
      return autopilot_.hold();
    case MAV_CMD_NAV_RETURN_TO_LAUNCH:
      return autopilot_.return_home();
    case MAV_CMD_DO_REPOSITION:
      return reposition(command);
    case MAV_CMD_MISSION_START:
      if (!(std::abs(command.param1) <= kMaxItem)) return vehicle::Result::kDenied;  // NaN is not
      return autopilot_.start_mission(static_cast<int>(command.param1));
    case MAV_CMD_DO_SET_HOME:
      return set_home(command);
    case MAV_CMD_SET_MESSAGE_INTERVAL:
      return set_message_interval(link, command);
    case MAV_CMD_GET_MESSAGE_INTERVAL:
      return get_message_interval(link, command);
    case MAV_CMD_REQUEST_MESSAGE:
      return request_message(link, whole(command.param1));
    case MAV_CMD_GET_HOME_POSITION:
      return request_message(link, MAVLINK_MSG_ID_HOME_POSITION);
    case MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES:
      return request_message(link, MAVLINK_MSG_ID_AUTOPILOT_VERSION);
    case MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN:
      return autopilot_.landed() && !autopilot_.armed() ? vehicle::Result::kAccepted : vehicle::Result::kDenied;
    default:
      return vehicle::Result::kUnsupported;
  }
}

vehicle::Result MavlinkEndpoint::Impl::arm_or_disarm(const Command& command) {
  const bool force = command.param2 == kForce;
  if (command.param1 == 1.0F) return autopilot_.arm(force);
  if (command.param1 == 0.0F) return autopilot_.disarm(force);
  return vehicle::Result::kUnsupported;
}

vehicle::Result MavlinkEndpoint::Impl::take_off(const Command& command) {
  if (!std::isfinite(command.param7)) return autopilot_.takeoff();
  if (std::abs(static_cast<double>(command.param7)) > kMaxAltitude) return vehicle::Result::kDenied;
  return autopilot_.takeoff(static_cast<double>(command.param7) - to_global(Vec3::Zero()).altitude_m);
}

/// What is NaN stays as it is. A change of mode has to be asked for: PX4 repositions in HOLD alone.
vehicle::Result MavlinkEndpoint::Impl::reposition(const Command& command) {
  if (whole(command.param2) != MAV_DO_REPOSITION_FLAGS_CHANGE_MODE) return vehicle::Result::kUnsupported;
  const bool has_place = std::isfinite(command.latitude_deg) && std::isfinite(command.longitude_deg);
  if (has_place && (std::abs(command.latitude_deg) > 90.0 || std::abs(command.longitude_deg) > 180.0)) {
    return vehicle::Result::kDenied;
  }
  if (std::abs(static_cast<double>(command.param7)) > kMaxAltitude) return vehicle::Result::kDenied;
  bridge::frames::Geodetic target = global_position();
  if (has_place) {
    target.latitude_deg = command.latitude_deg;
    target.longitude_deg = command.longitude_deg;
  }
  const bool has_altitude = std::isfinite(command.param7);
  if (has_altitude) target.altitude_m = static_cast<double>(command.param7);
  Vec3 position = to_local(target);
  if (!has_place) position.head<2>().setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!has_altitude) position.z() = std::numeric_limits<double>::quiet_NaN();
  const auto yaw_ned = static_cast<double>(command.param4);
  return autopilot_.reposition(position, std::isfinite(yaw_ned) ? vehicle::swap_yaw(yaw_ned) : yaw_ned,
                               static_cast<double>(command.param1));
}

vehicle::Result MavlinkEndpoint::Impl::set_home(const Command& command) {
  if (command.param1 == 1.0F) return autopilot_.set_home(autopilot_.estimated_motion().position);
  // Written so that NaN is refused too.
  if (!(std::abs(command.latitude_deg) <= 90.0) || !(std::abs(command.longitude_deg) <= 180.0) ||
      !(std::abs(static_cast<double>(command.param7)) <= kMaxAltitude)) {
    return vehicle::Result::kDenied;
  }
  return autopilot_.set_home(
      to_local({command.latitude_deg, command.longitude_deg, static_cast<double>(command.param7)}));
}

vehicle::Result MavlinkEndpoint::Impl::set_message_interval(MavlinkLink& link, const Command& command) {
  const auto index = find_kind(whole(command.param1));
  const bool usable = std::abs(command.param2) <= kMaxIntervalUs;  // NaN is not
  if (!index || message_kinds()[*index].id == MAVLINK_MSG_ID_HEARTBEAT || !usable) {
    return vehicle::Result::kFailed;
  }
  Stream& stream = link.streams[*index];
  const double rate = message_kinds()[*index].rate_hz;
  stream.interval = static_cast<double>(command.param2) / kMicroseconds;
  if (command.param2 == 0.0F) stream.interval = rate > 0.0 ? 1.0 / rate : 0.0;
  if (command.param2 < 0.0F) stream.interval = 0.0;
  stream.next_due = now_;
  return vehicle::Result::kAccepted;
}

vehicle::Result MavlinkEndpoint::Impl::get_message_interval(MavlinkLink& link, const Command& command) {
  const auto index = find_kind(whole(command.param1));
  mavlink_message_interval_t answer{};
  answer.message_id = static_cast<std::uint16_t>(whole(command.param1));
  // 0: not known here; -1: not streamed.
  if (index) {
    const double interval = link.streams[*index].interval;
    answer.interval_us = interval > 0.0 ? static_cast<std::int32_t>(std::lround(interval * kMicroseconds)) : -1;
  }
  link.send(mavlink_msg_message_interval_encode_status, answer);
  return vehicle::Result::kAccepted;
}

vehicle::Result MavlinkEndpoint::Impl::request_message(MavlinkLink& link, std::uint32_t id) {
  const auto index = find_kind(id);
  if (!index) return vehicle::Result::kDenied;
  (this->*message_kinds()[*index].send)(link);
  return vehicle::Result::kAccepted;
}

}  // namespace jink::sim::mavlink
