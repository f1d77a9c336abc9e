// SPDX-License-Identifier: BSD-3-Clause
// What PX4 means by the numbers that MAVLink carries: modes, health bits, results, and the commands that jink gives.
// Pure functions, no transport; safe from any thread. Facts: docs of PX4 (px4_custom_mode.h), MAVLink common.xml, and
// recordings of PX4 1.17.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::vehicle::px4 {

inline constexpr std::uint8_t kAutopilotPx4 = 12;          ///< MAV_AUTOPILOT_PX4
inline constexpr std::uint8_t kAutopilotInvalid = 8;       ///< MAV_AUTOPILOT_INVALID: a component that is no autopilot
inline constexpr std::uint8_t kArmedFlag = 0x80;           ///< MAV_MODE_FLAG_SAFETY_ARMED of HEARTBEAT.base_mode
inline constexpr std::uint32_t kPrearmCheck = 0x10000000;  ///< MAV_SYS_STATUS_PREARM_CHECK of SYS_STATUS

inline constexpr std::uint32_t kGps = 0x20;  ///< MAV_SYS_STATUS_SENSOR_GPS

inline constexpr std::uint16_t kNavLand = 21;              ///< MAV_CMD_NAV_LAND
inline constexpr std::uint16_t kDoSetMode = 176;           ///< MAV_CMD_DO_SET_MODE
inline constexpr std::uint16_t kArmDisarm = 400;           ///< MAV_CMD_COMPONENT_ARM_DISARM
inline constexpr std::uint16_t kSetMessageInterval = 511;  ///< MAV_CMD_SET_MESSAGE_INTERVAL
inline constexpr std::uint16_t kRequestMessage = 512;      ///< MAV_CMD_REQUEST_MESSAGE

inline constexpr std::uint32_t kStateCritical = 5;  ///< MAV_STATE_CRITICAL of HEARTBEAT.system_status: PX4's failsafe

inline constexpr int kResultAccepted = 0;    ///< MAV_RESULT_ACCEPTED
inline constexpr int kResultInProgress = 5;  ///< MAV_RESULT_IN_PROGRESS: the final answer is still to come

/// The mode in a heartbeat; kOther for a mode without a name here and for any mode of an autopilot that is not PX4.
[[nodiscard]] FlightMode flight_mode(std::uint8_t autopilot, std::uint32_t custom_mode);

/// The items of SYS_STATUS that are present, enabled and not healthy, and the pre-arm check where it fails, by name,
/// joined with ", "; empty when nothing is missing.
[[nodiscard]] std::string failed_health(std::uint32_t present, std::uint32_t enabled, std::uint32_t health);

/// Whether ESTIMATOR_STATUS.flags hold a position (absolute or relative) and velocity, horizontal and vertical.
[[nodiscard]] bool estimator_has_local_position(std::uint32_t flags);

/// VehicleState.position_sigma, of what ESTIMATOR_STATUS states: PX4's horizontal accuracy is that of both axes
/// together (the root of the sum of their variances). What is not finite or below zero is not stated.
[[nodiscard]] double position_sigma(double horizontal_accuracy, double vertical_accuracy);

/// What is missing in ESTIMATOR_STATUS.flags for a flight (position and velocity, horizontal and vertical, attitude),
/// and what the estimator itself complains of (GPS glitch, accelerometer error), joined with ", "; empty: nothing.
[[nodiscard]] std::string estimator_complaints(std::uint32_t flags);

/// BATTERY_STATUS.charge_state; kUnknown where it says nothing (0) or is no MAV_BATTERY_CHARGE_STATE.
[[nodiscard]] BatteryState battery_state(std::uint32_t charge_state);
/// SYS_STATUS.battery_remaining in percent, by PX4's defaults: low from 15 % down, critical from 7 %; kUnknown for what
/// is no percentage (-1: not known).
[[nodiscard]] BatteryState battery_state_from_remaining(double remaining_percent);

/// AUTOPILOT_VERSION.flight_sw_version.
struct Version {
  int major = 0;
  int minor = 0;
  int patch = 0;
  int type = 0;  ///< FIRMWARE_VERSION_TYPE: 0 development, 64 alpha, 128 beta, 192 candidate, 255 release
};
[[nodiscard]] Version version(std::uint32_t flight_sw_version);
/// "1.17.0 alpha"; a release has no word behind it.
[[nodiscard]] std::string to_string(const Version& version);

/// A parameter as the autopilot tells it.
struct Parameter {
  std::string name;
  bool integer = false;
  double value = 0.0;  ///< NaN: an integer whose bytes are no number as a float, which are those below 0
};
/// PARAM_VALUE: `field` carries a number, or the bytes of an integer as PX4 has it (`bytewise`). `param_type`:
/// MAV_PARAM_TYPE.
[[nodiscard]] Parameter parameter(std::string name, std::uint32_t param_type, double field, bool bytewise);

/// Whether EXTENDED_SYS_STATE.landed_state is in the air, taking off or landing.
[[nodiscard]] bool in_air(int landed_state);

/// MAV_RESULT in words.
[[nodiscard]] std::string result_text(int result);

/// A COMMAND_LONG: MAV_CMD and its seven parameters; NaN is MAVLink's "unspecified".
struct CommandLong {
  std::uint16_t id = 0;
  std::array<double, 7> params{};
};
[[nodiscard]] CommandLong command_long(Command command);
/// Asks for a message at a rate. `rate_hz` > 0.
[[nodiscard]] CommandLong message_interval(std::uint32_t message_id, double rate_hz);
/// Asks for a message once.
[[nodiscard]] CommandLong request_message(std::uint32_t message_id);

}  // namespace jink::bridge::vehicle::px4
