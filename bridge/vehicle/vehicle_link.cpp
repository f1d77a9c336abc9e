// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::vehicle {

std::string_view to_string(FlightMode mode) {
  switch (mode) {
    case FlightMode::kUnknown:
      return "unknown";
    case FlightMode::kManual:
      return "manual";
    case FlightMode::kAltitude:
      return "altitude";
    case FlightMode::kPosition:
      return "position";
    case FlightMode::kHold:
      return "hold";
    case FlightMode::kTakeoff:
      return "takeoff";
    case FlightMode::kLand:
      return "land";
    case FlightMode::kReturn:
      return "return";
    case FlightMode::kMission:
      return "mission";
    case FlightMode::kOffboard:
      return "offboard";
    case FlightMode::kOther:
      return "other";
  }
  return "unknown";
}

std::string_view to_string(BatteryState state) {
  switch (state) {
    case BatteryState::kUnknown:
      return "unknown";
    case BatteryState::kOk:
      return "ok";
    case BatteryState::kLow:
      return "low";
    case BatteryState::kCritical:
      return "critical";
  }
  return "unknown";
}

std::string_view to_string(Command command) {
  switch (command) {
    case Command::kArm:
      return "arm";
    case Command::kDisarm:
      return "disarm";
    case Command::kOffboard:
      return "offboard";
    case Command::kHold:
      return "hold";
    case Command::kLand:
      return "land";
    case Command::kReturn:
      return "return";
  }
  return "unknown";
}

}  // namespace jink::bridge::vehicle
