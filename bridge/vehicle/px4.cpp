// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/vehicle/px4.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

namespace jink::bridge::vehicle::px4 {

namespace {

constexpr double kUnspecified = std::numeric_limits<double>::quiet_NaN();
constexpr double kCustomModeEnabled = 1.0;  // MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: the mode stands in the next parameters
constexpr double kMainAuto = 4.0;           // PX4_CUSTOM_MAIN_MODE_AUTO
constexpr double kSubLoiter = 3.0;          // PX4_CUSTOM_SUB_MODE_AUTO_LOITER
constexpr double kSubReturn = 5.0;          // PX4_CUSTOM_SUB_MODE_AUTO_RTL
constexpr double kMainOffboard = 6.0;       // PX4_CUSTOM_MAIN_MODE_OFFBOARD

FlightMode auto_mode(std::uint32_t sub) {
  switch (sub) {
    case 2:
      return FlightMode::kTakeoff;
    case 3:
      return FlightMode::kHold;
    case 4:
      return FlightMode::kMission;
    case 5:
      return FlightMode::kReturn;
    case 6:
      return FlightMode::kLand;
    default:
      return FlightMode::kOther;  // ready, follow, precision landing, ...
  }
}

// MAV_SYS_STATUS_SENSOR, by bit; the pre-arm check (bit 28) is no sensor and is treated apart.
constexpr std::array<std::pair<unsigned, std::string_view>, 28> kHealthItems{{
    {0, "gyroscope"},
    {1, "accelerometer"},
    {2, "magnetometer"},
    {3, "barometer"},
    {4, "airspeed sensor"},
    {5, "GPS"},
    {6, "optical flow"},
    {7, "vision position"},
    {8, "laser position"},
    {9, "external ground truth"},
    {10, "rate control"},
    {11, "attitude control"},
    {12, "yaw control"},
    {13, "altitude control"},
    {14, "position control"},
    {15, "motor outputs"},
    {16, "RC receiver"},
    {17, "second gyroscope"},
    {18, "second accelerometer"},
    {19, "second magnetometer"},
    {20, "geofence"},
    {21, "attitude estimate"},
    {22, "terrain"},
    {24, "logging"},
    {25, "battery"},
    {26, "proximity sensor"},
    {29, "obstacle avoidance"},
    {30, "propulsion"},
}};

void append(std::string& list, std::string_view item) {
  if (!list.empty()) list += ", ";
  list += item;
}

}  // namespace

FlightMode flight_mode(std::uint8_t autopilot, std::uint32_t custom_mode) {
  if (autopilot != kAutopilotPx4) return FlightMode::kOther;
  switch ((custom_mode >> 16U) & 0xffU) {
    case 1:  // manual
    case 5:  // acro
    case 7:  // stabilized
      return FlightMode::kManual;
    case 2:
      return FlightMode::kAltitude;
    case 3:
      return FlightMode::kPosition;
    case 4:
      return auto_mode(custom_mode >> 24U);
    case 6:
      return FlightMode::kOffboard;
    default:
      return FlightMode::kOther;
  }
}

std::string failed_health(std::uint32_t present, std::uint32_t enabled, std::uint32_t health) {
  const std::uint32_t failed = present & enabled & ~health;
  std::string text;
  for (const auto& [bit, name] : kHealthItems) {
    if (((failed >> bit) & 1U) != 0U) append(text, name);
  }
  // PX4 sets this bit in `health` alone, not in `present` or `enabled`.
  if ((health & kPrearmCheck) == 0U) append(text, "pre-arm check");
  return text;
}

double position_sigma(double horizontal_accuracy, double vertical_accuracy) {
  const auto stated = [](double value) { return std::isfinite(value) ? std::max(value, 0.0) : 0.0; };
  return std::max(stated(horizontal_accuracy) / std::numbers::sqrt2, stated(vertical_accuracy));
}

bool estimator_has_local_position(std::uint32_t flags) {
  constexpr std::uint32_t kVelocity = 2U | 4U;     // ESTIMATOR_VELOCITY_HORIZ, _VERT
  constexpr std::uint32_t kHorizontal = 8U | 16U;  // ESTIMATOR_POS_HORIZ_REL, _ABS: one of them
  constexpr std::uint32_t kVertical = 32U;         // ESTIMATOR_POS_VERT_ABS
  return (flags & kVelocity) == kVelocity && (flags & kHorizontal) != 0U && (flags & kVertical) != 0U;
}

std::string estimator_complaints(std::uint32_t flags) {
  constexpr std::array<std::pair<std::uint32_t, std::string_view>, 4> kNeeded{
      {{1U, "no attitude"}, {2U, "no horizontal velocity"}, {4U, "no vertical velocity"}, {32U, "no height"}}};
  constexpr std::array<std::pair<std::uint32_t, std::string_view>, 2> kFaults{
      {{1024U, "GPS glitch"}, {2048U, "accelerometer error"}}};
  constexpr std::uint32_t kHorizontal = 8U | 16U;
  std::string text;
  for (const auto& [bit, name] : kNeeded) {
    if ((flags & bit) == 0U) append(text, name);
  }
  if ((flags & kHorizontal) == 0U) append(text, "no horizontal position");
  for (const auto& [bit, name] : kFaults) {
    if ((flags & bit) != 0U) append(text, name);
  }
  return text;
}

BatteryState battery_state(std::uint32_t charge_state) {
  switch (charge_state) {
    case 1:  // OK
    case 7:  // CHARGING
      return BatteryState::kOk;
    case 2:
      return BatteryState::kLow;
    case 3:  // CRITICAL
    case 4:  // EMERGENCY
    case 5:  // FAILED
    case 6:  // UNHEALTHY
      return BatteryState::kCritical;
    default:
      return BatteryState::kUnknown;
  }
}

BatteryState battery_state_from_remaining(double remaining_percent) {
  constexpr double kLow = 15.0;      // BAT_LOW_THR
  constexpr double kCritical = 7.0;  // BAT_CRIT_THR
  if (!(remaining_percent >= 0.0 && remaining_percent <= 100.0)) return BatteryState::kUnknown;
  if (remaining_percent <= kCritical) return BatteryState::kCritical;
  return remaining_percent <= kLow ? BatteryState::kLow : BatteryState::kOk;
}

Version version(std::uint32_t flight_sw_version) {
  const auto byte = [&](unsigned shift) { return static_cast<int>((flight_sw_version >> shift) & 0xffU); };
  return {byte(24), byte(16), byte(8), byte(0)};
}

std::string to_string(const Version& version) {
  std::string text =
      std::to_string(version.major) + '.' + std::to_string(version.minor) + '.' + std::to_string(version.patch);
  if (version.type == 0) return text + " development";
  if (version.type < 128) return text + " alpha";
  if (version.type < 192) return text + " beta";
  return version.type < 255 ? text + " candidate" : text;
}

Parameter parameter(std::string name, std::uint32_t param_type, double field, bool bytewise) {
  constexpr std::uint32_t kFirstReal = 9;  // MAV_PARAM_TYPE_REAL32; below stand the integers, 1 (UINT8) to 8 (INT64)
  constexpr std::uint32_t kInt32 = 6;
  Parameter result{std::move(name), param_type >= 1 && param_type < kFirstReal, field};
  if (bytewise && param_type == kInt32 && std::isfinite(field)) {
    result.value = std::bit_cast<std::int32_t>(static_cast<float>(field));
  }
  return result;
}

// IN_AIR, TAKEOFF, LANDING.
bool in_air(int landed_state) {
  return landed_state >= 2 && landed_state <= 4;
}

std::string result_text(int result) {
  switch (result) {
    case 0:
      return "accepted";
    case 1:
      return "temporarily rejected";
    case 2:
      return "denied";
    case 3:
      return "unsupported";
    case 4:
      return "failed";
    case 5:
      return "in progress";
    case 6:
      return "cancelled";
    default:
      return "result " + std::to_string(result);
  }
}

CommandLong command_long(Command command) {
  switch (command) {
    case Command::kArm:
      return {kArmDisarm, {1.0}};
    case Command::kDisarm:
      return {kArmDisarm, {0.0}};
    case Command::kOffboard:
      return {kDoSetMode, {kCustomModeEnabled, kMainOffboard}};
    case Command::kHold:
      return {kDoSetMode, {kCustomModeEnabled, kMainAuto, kSubLoiter}};
    case Command::kReturn:
      return {kDoSetMode, {kCustomModeEnabled, kMainAuto, kSubReturn}};
    case Command::kLand:  // here, with the present heading
      return {kNavLand, {0.0, 0.0, 0.0, kUnspecified, kUnspecified, kUnspecified, kUnspecified}};
  }
  return {};
}

CommandLong message_interval(std::uint32_t message_id, double rate_hz) {
  return {kSetMessageInterval, {static_cast<double>(message_id), 1e6 / rate_hz}};  // interval in microseconds
}

CommandLong request_message(std::uint32_t message_id) {
  return {kRequestMessage, {static_cast<double>(message_id)}};
}

}  // namespace jink::bridge::vehicle::px4
