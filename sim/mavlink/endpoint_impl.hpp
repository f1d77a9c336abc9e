// SPDX-License-Identifier: BSD-3-Clause
// The endpoint's inside, shared by its sources: mavlink_endpoint.cpp (what comes in), mavlink_commands.cpp (commands),
// mavlink_streams.cpp (what goes out), mavlink_sensors.cpp, mavlink_events.cpp. No other file includes it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/mavlink/endpoint.hpp"
#include "sim/mavlink/link.hpp"
#include "sim/mavlink/mission_protocol.hpp"

namespace jink::sim::mavlink {

inline constexpr double kLinkUp = 0.3;  ///< s after PX4's start, when it begins to send and to listen

/// As most fields carry it.
[[nodiscard]] inline float real(double value) {
  return static_cast<float>(value);
}

/// What COMMAND_LONG and COMMAND_INT have in common.
struct Command {
  std::uint16_t id = 0;
  std::uint8_t sender_system = 0;
  std::uint8_t sender_component = 0;
  float param1 = 0;
  float param2 = 0;
  float param3 = 0;
  float param4 = 0;
  double latitude_deg = 0;   ///< or param5
  double longitude_deg = 0;  ///< or param6
  float param7 = 0;
};

/// In percent, as MAVLink has it; -1: not known.
[[nodiscard]] std::int8_t battery_percent(double remaining);

class MavlinkEndpoint::Impl {
 public:
  Impl(vehicle::Autopilot& autopilot, const EndpointOptions& options);
  void poll(double now);
  void impair(const faults::LinkImpairment& impairment) { links_.front().impair(impairment); }
  [[nodiscard]] const std::vector<MavlinkLink>& links() const { return links_; }

  /// One row of the table of what it can send.
  struct MessageKind {
    std::uint32_t id = 0;
    double rate_hz = 0.0;  ///< PX4's default; 0: on request
    double first_s = 0.0;  ///< after PX4's start, before which it is not streamed
    void (Impl::*send)(MavlinkLink&) = nullptr;
    double Impl::*news_at = nullptr;  ///< what has no news since is not sent
  };

 private:
  // mavlink_endpoint.cpp
  void handle(MavlinkLink& link, const mavlink_message_t& message);
  void forward(const MavlinkLink& from, const mavlink_message_t& message);
  void handle_heartbeat(MavlinkLink& link, const mavlink_message_t& message);
  void watch_companion();
  void watch_reboots();
  void watch_modes();
  void handle_position_target(const mavlink_message_t& message);
  void handle_parameter_read(MavlinkLink& link, const mavlink_message_t& message);
  void handle_parameter_set(const mavlink_message_t& message);
  void handle_parameter_list(MavlinkLink& link, const mavlink_message_t& message);
  void handle_timesync(MavlinkLink& link, const mavlink_message_t& message);
  void handle_ping(MavlinkLink& link, const mavlink_message_t& message);
  void send_parameter(MavlinkLink& link, std::size_t index);
  void send_listed_parameters(MavlinkLink& link);
  void send_status_texts();
  [[nodiscard]] bool for_us(std::uint8_t system, std::uint8_t component) const;

  // mavlink_commands.cpp
  void handle_command_long(MavlinkLink& link, const mavlink_message_t& message);
  void handle_command_int(MavlinkLink& link, const mavlink_message_t& message);
  void handle_set_mode(MavlinkLink& link, const mavlink_message_t& message);
  void run_command(MavlinkLink& link, const Command& command);
  vehicle::Result execute(MavlinkLink& link, const Command& command);
  vehicle::Result arm_or_disarm(const Command& command);
  vehicle::Result take_off(const Command& command);
  vehicle::Result reposition(const Command& command);
  vehicle::Result set_home(const Command& command);
  vehicle::Result set_message_interval(MavlinkLink& link, const Command& command);
  vehicle::Result get_message_interval(MavlinkLink& link, const Command& command);
  vehicle::Result request_message(MavlinkLink& link, std::uint32_t id);
  static void acknowledge(MavlinkLink& link, const Command& command, vehicle::Result result);

  // mavlink_streams.cpp
  [[nodiscard]] static std::span<const MessageKind> message_kinds();
  [[nodiscard]] static std::optional<std::size_t> find_kind(std::uint32_t id);
  void reset_streams(MavlinkLink& link) const;
  void send_streams(MavlinkLink& link);
  [[nodiscard]] std::uint32_t boot_ms() const;
  [[nodiscard]] std::uint64_t boot_us() const { return boot_us(autopilot_.boot_time()); }
  [[nodiscard]] std::uint64_t boot_us(double boot_time) const;
  /// Of a point in the autopilot's local frame, and back.
  [[nodiscard]] bridge::frames::Geodetic to_global(const Vec3& local) const;
  [[nodiscard]] Vec3 to_local(const bridge::frames::Geodetic& place) const;
  [[nodiscard]] bridge::frames::Geodetic global_position() const;

  void send_heartbeat(MavlinkLink& link);
  void send_sys_status(MavlinkLink& link);
  void send_extended_sys_state(MavlinkLink& link);
  void send_current_mode(MavlinkLink& link);
  void send_attitude(MavlinkLink& link);
  void send_attitude_quaternion(MavlinkLink& link);
  void send_local_position(MavlinkLink& link);
  void send_global_position(MavlinkLink& link);
  void send_odometry(MavlinkLink& link);
  void send_altitude(MavlinkLink& link);
  void send_vfr_hud(MavlinkLink& link);
  void send_position_target(MavlinkLink& link);
  void send_attitude_target(MavlinkLink& link);
  void send_gps_origin(MavlinkLink& link);
  void send_home(MavlinkLink& link);
  void send_system_time(MavlinkLink& link);
  void send_timesync(MavlinkLink& link);
  void send_ping(MavlinkLink& link);
  void send_estimator_status(MavlinkLink& link);
  void send_autopilot_version(MavlinkLink& link);

  // mavlink_events.cpp
  void send_events();
  void send_event_sequence(MavlinkLink& link);
  [[nodiscard]] bool ground_station_heard() const;

  // endpoint_files.cpp
  void handle_file_transfer(MavlinkLink& link, const mavlink_message_t& message);
  void handle_log_list(MavlinkLink& link, const mavlink_message_t& message);

  // endpoint_missions.cpp
  void handle_mission(MavlinkLink& link, const mavlink_message_t& message);
  void update_missions();
  [[nodiscard]] std::vector<vehicle::MissionItem> flown_mission() const;
  void send_mission_current(MavlinkLink& link);
  static void send_mission_messages(MavlinkLink& link, const std::vector<MissionMessage>& messages);

  // mavlink_sensors.cpp
  void send_highres_imu(MavlinkLink& link);
  void send_gps_raw(MavlinkLink& link);
  void send_scaled_pressure(MavlinkLink& link);
  void send_battery(MavlinkLink& link);
  void send_vibration(MavlinkLink& link);
  void send_servos(MavlinkLink& link);
  void send_distance_sensor(MavlinkLink& link);
  /// Of full thrust: 0 with the motors off, about a half in hover.
  [[nodiscard]] double throttle() const;

  vehicle::Autopilot& autopilot_;
  EndpointOptions options_;
  bridge::frames::LocalFrame frame_;
  std::uint8_t system_id_;
  double now_ = 0.0;
  double boot_ = 0.0;                      ///< when the autopilot booted, on the clock of `now_`
  int reboots_ = 0;                        ///< that the links know of
  std::optional<double> companion_heard_;  ///< its last heartbeat
  bool companion_lost_ = false;
  std::array<vehicle::FlightMode, 2> modes_{};  ///< that flies, that was asked for last
  double modes_at_ = 0.0;                       ///< when they were news: PX4's vehicle_status
  double start_factor_;                         ///< of PX4's start-up times: less when the autopilot is ready sooner
  std::uint16_t next_text_id_ = 1;
  std::uint32_t next_ping_ = 0;
  std::uint16_t event_sequence_ = 0;  ///< of the newest event
  bool events_sent_ = false;          ///< since the boot
  std::vector<MavlinkLink> links_;
  MissionLists mission_lists_;
  std::vector<MissionProtocol> missions_;  ///< parallel to links_
  std::size_t told_current_ = 0;           ///< item, by the last MISSION_CURRENT
  std::optional<std::size_t> told_reached_{};
  int reached_repeats_ = 0;  ///< of MISSION_ITEM_REACHED, left
  double next_reached_ = 0.0;
};

}  // namespace jink::sim::mavlink
