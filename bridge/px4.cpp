// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/px4.hpp"

#include <limits>
#include <string_view>
#include <utility>

namespace jink::bridge::px4 {

namespace {

constexpr double kUnspecified = std::numeric_limits<double>::quiet_NaN();
constexpr double kCustomModeEnabled = 1.0;  // MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: the mode stands in the next parameters
constexpr double kMainAuto = 4.0;           // PX4_CUSTOM_MAIN_MODE_AUTO
constexpr double kSubLoiter = 3.0;          // PX4_CUSTOM_SUB_MODE_AUTO_LOITER
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
  const auto add = [&text](std::string_view name) {
    if (!text.empty()) text += ", ";
    text += name;
  };
  for (const auto& [bit, name] : kHealthItems) {
    if (((failed >> bit) & 1U) != 0U) add(name);
  }
  // PX4 sets this bit in `health` alone, not in `present` or `enabled`.
  if ((health & kPrearmCheck) == 0U) add("pre-arm check");
  return text;
}

bool estimator_has_local_position(std::uint32_t flags) {
  constexpr std::uint32_t kVelocity = 2U | 4U;     // ESTIMATOR_VELOCITY_HORIZ, _VERT
  constexpr std::uint32_t kHorizontal = 8U | 16U;  // ESTIMATOR_POS_HORIZ_REL, _ABS: one of them
  constexpr std::uint32_t kVertical = 32U;         // ESTIMATOR_POS_VERT_ABS
  return (flags & kVelocity) == kVelocity && (flags & kHorizontal) != 0U && (flags & kVertical) != 0U;
}

bool in_air(int landed_state) {
  return landed_state >= 2 && landed_state <= 4;
}  // IN_AIR, TAKEOFF, LANDING

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
    case Command::kLand:  // here, with the present heading
      return {kNavLand, {0.0, 0.0, 0.0, kUnspecified, kUnspecified, kUnspecified, kUnspecified}};
  }
  return {};
}

CommandLong message_interval(std::uint32_t message_id, double rate_hz) {
  return {kSetMessageInterval, {static_cast<double>(message_id), 1e6 / rate_hz}};  // interval in microseconds
}

}  // namespace jink::bridge::px4
