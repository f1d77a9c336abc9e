// SPDX-License-Identifier: BSD-3-Clause
// Links, and what comes in besides commands: setpoints, parameters, time.
#include "sim/mavlink/endpoint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

// PX4's SITL.
constexpr int kMaxInstance = 9;
constexpr int kCompanionLocalPort = 14580;
constexpr int kCompanionRemotePort = 14540;
constexpr int kGroundLocalPort = 18570;
constexpr int kGroundRemotePort = 14550;

constexpr double kStatusPeriod = 0.5;      ///< s, of vehicle_status where nothing changes
constexpr double kReadyDelay = 4.3;        ///< s, of PX4's SITL: the measure of the start-up times
constexpr std::size_t kListedPerPoll = 2;  ///< parameters of a list: 500 a second, as a list at full rate
constexpr std::size_t kTextChunk = 50;     ///< characters that STATUSTEXT holds

/// A MAVLink name: at most `size` characters, without a terminating zero when it fills the field.
std::string field_text(const char* field, std::size_t size) {
  return {field, strnlen(field, size)};
}

/// With a target, which the generated function does not know. PX4 leaves it to what lay in memory: it is nobody.
std::uint16_t encode_timesync_answer(std::uint8_t system, std::uint8_t component, mavlink_status_t* status,
                                     mavlink_message_t* message, const mavlink_timesync_t* answer) {
  constexpr std::array<std::uint8_t, 2> kStrayTarget{0xa0, 0x20};  // as recorded
  char* const payload = _MAV_PAYLOAD_NON_CONST(message);
  std::memcpy(payload, answer, MAVLINK_MSG_ID_TIMESYNC_LEN);
  std::memcpy(payload + MAVLINK_MSG_ID_TIMESYNC_LEN, kStrayTarget.data(), kStrayTarget.size());
  message->msgid = MAVLINK_MSG_ID_TIMESYNC;
  return mavlink_finalize_message_buffer(message, system, component, status, MAVLINK_MSG_ID_TIMESYNC_MIN_LEN,
                                         MAVLINK_MSG_ID_TIMESYNC_LEN + kStrayTarget.size(),
                                         MAVLINK_MSG_ID_TIMESYNC_CRC);
}

const EndpointOptions& checked(const EndpointOptions& options) {
  if (options.instance < 0 || options.instance > kMaxInstance) {
    throw std::invalid_argument("instance must be 0 to " + std::to_string(kMaxInstance) + ", is " +
                                std::to_string(options.instance));
  }
  const bridge::frames::Geodetic& origin = options.origin;
  if (!(std::abs(origin.latitude_deg) <= 90.0) || !(std::abs(origin.longitude_deg) <= 180.0) ||
      !(std::abs(origin.altitude_m) <= 10000.0)) {
    throw std::invalid_argument("origin must be within 90 deg of latitude, 180 deg of longitude, 10 km of altitude");
  }
  if (!(options.clock_rate >= 0.9 && options.clock_rate <= 1.1)) {
    throw std::invalid_argument("clock_rate must be 0.9 to 1.1, is " + std::to_string(options.clock_rate));
  }
  return options;
}

std::uint16_t port_or(const std::optional<std::uint16_t>& given, int standard) {
  return given.value_or(static_cast<std::uint16_t>(standard));
}

}  // namespace

MavlinkEndpoint::MavlinkEndpoint(vehicle::Autopilot& autopilot, const EndpointOptions& options)
    : impl_(std::make_unique<Impl>(autopilot, options)) {}

MavlinkEndpoint::~MavlinkEndpoint() = default;

void MavlinkEndpoint::poll(double now) {
  impl_->poll(now);
}

void MavlinkEndpoint::impair(const faults::LinkImpairment& impairment) {
  impl_->impair(impairment);
}

std::uint16_t MavlinkEndpoint::companion_port() const {
  return impl_->links().front().local_port();
}

std::uint16_t MavlinkEndpoint::ground_port() const {
  return impl_->links().size() > 1 ? impl_->links().back().local_port() : std::uint16_t{0};
}

EndpointCounters MavlinkEndpoint::counters() const {
  EndpointCounters sum;
  for (const MavlinkLink& link : impl_->links()) {
    sum.received += link.received();
    sum.malformed += link.malformed();
  }
  sum.setpoints = impl_->links().front().setpoints();
  return sum;
}

MavlinkEndpoint::Impl::Impl(vehicle::Autopilot& autopilot, const EndpointOptions& options)
    : autopilot_(autopilot),
      options_(checked(options)),
      frame_(options.origin),
      system_id_(static_cast<std::uint8_t>(options.instance + 1)),
      start_factor_(std::clamp(autopilot.options().ready_delay / kReadyDelay, 0.0, 1.0)) {
  const auto open = [&](std::uint16_t local, std::uint16_t remote) {
    links_.emplace_back(udp_address(options_.address, local), udp_address(options_.address, remote), system_id_,
                        options_.seed);
    missions_.emplace_back(mission_lists_, system_id_);
    reset_streams(links_.back());
  };
  open(port_or(options_.companion_local_port, kCompanionLocalPort + options_.instance),
       port_or(options_.companion_remote_port, kCompanionRemotePort + options_.instance));
  if (!options_.ground_link) return;
  open(port_or(options_.ground_local_port, kGroundLocalPort + options_.instance),
       port_or(options_.ground_remote_port, kGroundRemotePort));
}

void MavlinkEndpoint::Impl::poll(double now) {
  now_ = now;
  watch_reboots();
  const bool link_up = reboots_ == 0 || now_ - boot_ >= kLinkUp * start_factor_;
  for (MavlinkLink& link : links_) {
    link.advance(now_);
    link.receive([&](const mavlink_message_t& message) {
      if (!link_up) return;
      handle(link, message);
      forward(link, message);
    });
  }
  watch_reboots();  // a command may ask for one
  watch_companion();
  watch_modes();
  update_missions();
  for (MavlinkLink& link : links_) {
    send_streams(link);
    send_listed_parameters(link);
  }
  send_status_texts();
  send_events();
}

/// vehicle_status is published when it changes, and twice a second.
void MavlinkEndpoint::Impl::watch_modes() {
  const std::array modes{autopilot_.mode(), autopilot_.intended_mode()};
  if (modes == modes_ && now_ - modes_at_ < kStatusPeriod) return;
  modes_ = modes;
  modes_at_ = now_;
}

/// After a reboot everything begins anew, rates and clocks too.
void MavlinkEndpoint::Impl::watch_reboots() {
  if (reboots_ == autopilot_.reboots()) return;
  reboots_ = autopilot_.reboots();
  boot_ = now_;
  companion_heard_.reset();
  companion_lost_ = events_sent_ = false;
  event_sequence_ = 0;
  for (MavlinkLink& link : links_) {
    reset_streams(link);
    link.ground_station = link.listing_parameters = false;
    link.components.clear();
  }
  for (MissionProtocol& mission : missions_) mission.reset();
}

/// To the other links, unless it is for the autopilot alone: to those on which its target was heard, or anybody where
/// it is for all. All links of PX4's SITL do so.
void MavlinkEndpoint::Impl::forward(const MavlinkLink& from, const mavlink_message_t& message) {
  const mavlink_msg_entry_t* const entry = mavlink_get_msg_entry(message.msgid);
  if (entry == nullptr) return;
  const auto target = [&](unsigned flag, std::uint8_t offset) {
    return (entry->flags & flag) != 0U ? static_cast<std::uint8_t>(_MAV_PAYLOAD(&message)[offset]) : std::uint8_t{0};
  };
  const std::uint8_t system = target(MAV_MSG_ENTRY_FLAG_HAVE_TARGET_SYSTEM, entry->target_system_ofs);
  const std::uint8_t component = target(MAV_MSG_ENTRY_FLAG_HAVE_TARGET_COMPONENT, entry->target_component_ofs);
  if (system == system_id_ && component == MAV_COMP_ID_AUTOPILOT1) return;
  const auto meant = [&](const std::pair<std::uint8_t, std::uint8_t>& heard) {
    return system == 0 || (heard.first == system && (component == 0 || heard.second == component));
  };
  for (MavlinkLink& link : links_) {
    if (&link != &from && std::any_of(link.components.begin(), link.components.end(), meant)) link.pass(message);
  }
}

void MavlinkEndpoint::Impl::handle_heartbeat(MavlinkLink& link, const mavlink_message_t& message) {
  const auto type = mavlink_msg_heartbeat_get_type(&message);
  if (type == MAV_TYPE_GCS) link.ground_station = true;
  if (type != MAV_TYPE_ONBOARD_CONTROLLER) return;
  companion_heard_ = now_;
  if (companion_lost_) autopilot_.report(vehicle::Severity::kInfo, "Onboard controller regained");
  companion_lost_ = false;
}

/// A text, and nothing else: the flight depends on the setpoints alone.
void MavlinkEndpoint::Impl::watch_companion() {
  if (!companion_heard_ || companion_lost_) return;
  constexpr double kFixedLoss = 5.0;  // s, of PX4 1.18, which has no parameter for it
  const bool fixed = !autopilot_.parameters().find("COM_OBC_LOSS_T");
  if (now_ - *companion_heard_ < (fixed ? kFixedLoss : autopilot_.parameters().real("COM_OBC_LOSS_T"))) return;
  companion_lost_ = true;
  autopilot_.report(vehicle::Severity::kCritical, "Connection to mission computer lost");
}

/// Commands and parameters are for one system; a component of 0 means all of its components.
bool MavlinkEndpoint::Impl::for_us(std::uint8_t system, std::uint8_t component) const {
  return system == system_id_ && (component == MAV_COMP_ID_AUTOPILOT1 || component == MAV_COMP_ID_ALL);
}

void MavlinkEndpoint::Impl::handle(MavlinkLink& link, const mavlink_message_t& message) {
  link.components.emplace(message.sysid, message.compid);
  switch (message.msgid) {
    case MAVLINK_MSG_ID_HEARTBEAT:
      return handle_heartbeat(link, message);
    case MAVLINK_MSG_ID_COMMAND_LONG:
      return handle_command_long(link, message);
    case MAVLINK_MSG_ID_COMMAND_INT:
      return handle_command_int(link, message);
    case MAVLINK_MSG_ID_SET_MODE:
      return handle_set_mode(link, message);
    case MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED:
      return handle_position_target(message);
    case MAVLINK_MSG_ID_PARAM_REQUEST_READ:
      return handle_parameter_read(link, message);
    case MAVLINK_MSG_ID_PARAM_REQUEST_LIST:
      return handle_parameter_list(link, message);
    case MAVLINK_MSG_ID_PARAM_SET:
      return handle_parameter_set(message);
    case MAVLINK_MSG_ID_TIMESYNC:
      return handle_timesync(link, message);
    case MAVLINK_MSG_ID_PING:
      return handle_ping(link, message);
    case MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL:
      return handle_file_transfer(link, message);
    case MAVLINK_MSG_ID_LOG_REQUEST_LIST:
      return handle_log_list(link, message);
    default:
      return handle_mission(link, message);
  }
}

void MavlinkEndpoint::Impl::handle_position_target(const mavlink_message_t& message) {
  mavlink_set_position_target_local_ned_t target;
  mavlink_msg_set_position_target_local_ned_decode(&message, &target);
  const bool broadcast = target.target_system == 0 && target.target_component == MAV_COMP_ID_ALL;
  if (!broadcast && !for_us(target.target_system, target.target_component)) return;
  const bool body = target.coordinate_frame == MAV_FRAME_BODY_NED;
  if (!body && target.coordinate_frame != MAV_FRAME_LOCAL_NED) {
    autopilot_.report(vehicle::Severity::kCritical, "SET_POSITION_TARGET_LOCAL_NED coordinate frame " +
                                                        std::to_string(target.coordinate_frame) + " unsupported");
    return;
  }
  // Three bits each for position, velocity and acceleration, then (after one for force) yaw and yaw rate.
  bool finite = true;
  const auto given = [&](unsigned bit, float value) {
    if ((target.type_mask & 1U << bit) != 0) return std::numeric_limits<double>::quiet_NaN();
    finite = finite && std::isfinite(value);
    return static_cast<double>(value);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Vec3 position_ned(given(0, target.x), given(1, target.y), given(2, target.z));
  Vec3 velocity_ned(given(3, target.vx), given(4, target.vy), given(5, target.vz));
  Vec3 acceleration_ned(given(6, target.afx), given(7, target.afy), given(8, target.afz));
  const double yaw_ned = given(10, target.yaw);
  const double yaw_rate_ned = given(11, target.yaw_rate);
  if (body) {  // as PX4: turned by the attitude, and a position means nothing there
    const Eigen::Quaterniond attitude = vehicle::attitude_ned(autopilot_.estimated_motion().attitude);
    position_ned.setConstant(nan);
    velocity_ned = attitude * velocity_ned;
    acceleration_ned = attitude * acceleration_ned;
  }
  vehicle::Setpoint setpoint;
  setpoint.position = vehicle::swap_enu_ned(position_ned);
  setpoint.velocity = vehicle::swap_enu_ned(velocity_ned);
  setpoint.acceleration = vehicle::swap_enu_ned(acceleration_ned);
  setpoint.yaw = std::isnan(yaw_ned) ? nan : vehicle::swap_yaw(yaw_ned);
  setpoint.yaw_rate = -yaw_rate_ned;
  if (!finite || autopilot_.offboard_setpoint(setpoint) != vehicle::Result::kAccepted) {
    autopilot_.report(vehicle::Severity::kCritical, "SET_POSITION_TARGET_LOCAL_NED invalid");
  }
}

void MavlinkEndpoint::Impl::send_parameter(MavlinkLink& link, std::size_t index) {
  const vehicle::Parameter& parameter = autopilot_.parameters().at(index);
  mavlink_param_value_t message{};
  // No terminating zero when the name fills the field: that is MAVLink's way.
  std::copy_n(parameter.name.begin(), std::min(parameter.name.size(), sizeof(message.param_id)), message.param_id);
  message.param_value = vehicle::encode_bytewise(parameter.value);
  message.param_type = std::holds_alternative<float>(parameter.value) ? MAV_PARAM_TYPE_REAL32 : MAV_PARAM_TYPE_INT32;
  message.param_count = static_cast<std::uint16_t>(autopilot_.parameters().size());
  message.param_index = static_cast<std::uint16_t>(index);
  link.send(mavlink_msg_param_value_encode_status, message);
}

void MavlinkEndpoint::Impl::handle_parameter_read(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_param_request_read_t request;
  mavlink_msg_param_request_read_decode(&message, &request);
  if (!for_us(request.target_system, request.target_component)) return;
  std::optional<std::size_t> index;
  if (request.param_index >= 0) {
    index = static_cast<std::size_t>(request.param_index);
  } else {
    index = autopilot_.parameters().find(field_text(request.param_id, sizeof(request.param_id)));
  }
  if (index && *index < autopilot_.parameters().size()) send_parameter(link, *index);
}

void MavlinkEndpoint::Impl::handle_parameter_list(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_param_request_list_t request;
  mavlink_msg_param_request_list_decode(&message, &request);
  if (!for_us(request.target_system, request.target_component)) return;
  link.next_listed_parameter = 0;
  link.listing_parameters = true;
}

void MavlinkEndpoint::Impl::send_listed_parameters(MavlinkLink& link) {
  for (std::size_t i = 0; i < kListedPerPoll && link.listing_parameters; ++i) {
    send_parameter(link, link.next_listed_parameter++);
    link.listing_parameters = link.next_listed_parameter < autopilot_.parameters().size();
  }
}

void MavlinkEndpoint::Impl::handle_parameter_set(const mavlink_message_t& message) {
  mavlink_param_set_t request;
  mavlink_msg_param_set_decode(&message, &request);
  if (!for_us(request.target_system, request.target_component)) return;
  const std::string name = field_text(request.param_id, sizeof(request.param_id));
  vehicle::ParameterValue value = request.param_value;
  if (request.param_type == MAV_PARAM_TYPE_INT32) {
    value = vehicle::decode_bytewise(request.param_value);
  } else if (request.param_type != MAV_PARAM_TYPE_REAL32) {
    return;
  }
  if (!autopilot_.parameters().set(name, value)) return;
  const auto index = autopilot_.parameters().find(name);
  for (MavlinkLink& link : links_) send_parameter(link, *index);
}

void MavlinkEndpoint::Impl::handle_timesync(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_timesync_t request;
  mavlink_msg_timesync_decode(&message, &request);
  if (request.tc1 != 0) return;  // an answer to ours
  mavlink_timesync_t reply{};
  reply.tc1 = static_cast<std::int64_t>(boot_us()) * 1000;
  reply.ts1 = request.ts1;
  link.send(encode_timesync_answer, reply);
}

void MavlinkEndpoint::Impl::handle_ping(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_ping_t ping;
  mavlink_msg_ping_decode(&message, &ping);
  if (ping.target_system != 0 || ping.target_component != 0) return;  // an answer
  ping.target_system = message.sysid;
  ping.target_component = message.compid;
  link.send(mavlink_msg_ping_encode_status, ping);
}

/// To ground stations alone, and, as PX4's, ending in a tab and cut in chunks.
void MavlinkEndpoint::Impl::send_status_texts() {
  for (const vehicle::StatusText& entry : autopilot_.take_status_texts()) {
    const std::string text = entry.text + '\t';
    mavlink_statustext_t message{};
    message.severity = static_cast<std::uint8_t>(entry.severity);
    message.id = next_text_id_++;
    for (std::size_t begin = 0; begin < text.size(); begin += kTextChunk, ++message.chunk_seq) {
      const std::string chunk = text.substr(begin, kTextChunk);
      std::fill(std::begin(message.text), std::end(message.text), '\0');
      std::copy(chunk.begin(), chunk.end(), std::begin(message.text));
      for (MavlinkLink& link : links_) {
        if (link.ground_station) link.send(mavlink_msg_statustext_encode_status, message);
      }
    }
  }
}

}  // namespace jink::sim::mavlink
