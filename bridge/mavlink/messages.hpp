// SPDX-License-Identifier: BSD-3-Clause
// The MAVLink messages that the companion reads, from the text in which MAVSDK hands them over (a name, and the fields
// as JSON). Here non-finite and absurd values stop; what comes out is in the project's frames and units.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "bridge/frames/geodetic.hpp"
#include "bridge/mavlink/adsb_tracks.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::mavlink {

/// Beyond these an estimator has lost its mind, and its message is refused. Norms for vectors.
struct Limits {
  static constexpr double kPosition = 1e5;  ///< m, and of the origin's altitude
  static constexpr double kVelocity = 1e3;  ///< m/s
  static constexpr double kHeading = 10.0;  ///< rad, to either side of north
};

struct Heartbeat {
  std::uint32_t autopilot = 0;  ///< MAV_AUTOPILOT
  std::uint32_t base_mode = 0;
  std::uint32_t custom_mode = 0;
  std::uint32_t system_status = 0;  ///< MAV_STATE
};
/// What flies, and what was asked for last: a failsafe changes the first alone.
struct CurrentMode {
  std::uint32_t custom_mode = 0;
  std::uint32_t intended_custom_mode = 0;  ///< 0: not told
  bool operator==(const CurrentMode&) const = default;
};
/// LOCAL_POSITION_NED, in ENU.
struct LocalPosition {
  std::uint32_t boot_ms = 0;  ///< autopilot's time
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};
struct Attitude {
  std::uint32_t boot_ms = 0;
  double yaw = 0.0;    ///< counter-clockwise from east, rad
  double pitch = 0.0;  ///< nose up, rad
  double roll = 0.0;   ///< right side down, rad
};
/// ODOMETRY, in ENU.
struct Odometry {
  double time = 0.0;        ///< autopilot's, s
  bool local_frame = true;  ///< its frame is LOCAL_NED; where it is another, all below says nothing
  std::uint8_t reset_counter = 0;
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};
struct SysStatus {
  std::uint32_t present = 0;  ///< MAV_SYS_STATUS_SENSOR, this and the two below
  std::uint32_t enabled = 0;
  std::uint32_t health = 0;
  double battery_remaining_percent = std::numeric_limits<double>::quiet_NaN();  ///< -1 or NaN: not told
};
struct ExtendedSysState {
  std::uint32_t landed_state = 0;
};
struct EstimatorStatus {
  std::uint32_t flags = 0;
  double horizontal_accuracy = 0.0;  ///< m, standard deviation of the distance; NaN: not stated
  double vertical_accuracy = 0.0;    ///< m; likewise
};
struct BatteryStatus {
  std::uint32_t id = 0;
  std::uint32_t charge_state = 0;  ///< an extension field: 0 from older autopilots
};
/// GPS_GLOBAL_ORIGIN.
struct Origin {
  frames::Geodetic place;
};
/// HOME_POSITION, in the local frame.
struct Home {
  double height = 0.0;  ///< ENU z
};
struct CommandAck {
  std::uint16_t command = 0;
  int result = 0;                   ///< MAV_RESULT
  std::uint32_t target_system = 0;  ///< extension fields: 0 from autopilots that do not send them
  std::uint32_t target_component = 0;
};
struct AutopilotVersion {
  std::uint32_t flight_sw_version = 0;
};
/// An answer carries our own time and the target that we are; a request has the target 0.
struct Ping {
  std::int64_t time_us = 0;
  std::uint32_t target_system = 0;
  std::uint32_t target_component = 0;
};
struct ParamValue {
  std::string name;
  std::uint32_t type = 0;  ///< MAV_PARAM_TYPE
  double field = 0.0;      ///< as it stands, for px4::parameter(); NaN: bytes that are no number as a float
};
/// How many items a list on the autopilot has.
struct MissionCount {
  std::uint32_t count = 0;
  std::uint32_t mission_type = 0;      ///< MAV_MISSION_TYPE: 1 is the fence
  std::uint32_t target_component = 0;  ///< who asked; 0: all
};
/// MISSION_ITEM_INT, of a place on the earth.
struct MissionItem {
  std::uint32_t seq = 0;
  std::uint32_t command = 0;  ///< MAV_CMD
  double param1 = 0.0;        ///< of a fence's polygon the number of its corners, of a circle the radius, m
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  std::uint32_t mission_type = 0;
  std::uint32_t target_component = 0;
};
struct StatusText {
  std::uint32_t severity = 0;
  std::uint32_t id = 0;  ///< extension fields: a text in chunks
  std::uint32_t chunk = 0;
  std::string text;
};

/// AdsbReport: its time and sender are the caller's to fill in.
using Message = std::variant<Heartbeat, CurrentMode, LocalPosition, Attitude, Odometry, SysStatus, ExtendedSysState,
                             EstimatorStatus, BatteryStatus, Origin, Home, CommandAck, AutopilotVersion, Ping,
                             ParamValue, MissionCount, MissionItem, StatusText, AdsbReport>;

/// Decodes the message `name` (MAVLink's name) from `json`, an object with a member for each field. Nothing where the
/// name is none of these, the text is no such object, or a field that matters is missing, not finite or beyond Limits.
/// Pure; throws nothing but std::bad_alloc.
[[nodiscard]] std::optional<Message> decode(std::string_view name, std::string_view json);

}  // namespace jink::bridge::mavlink
