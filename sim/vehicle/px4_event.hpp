// SPDX-License-Identifier: BSD-3-Clause
// What PX4 tells on its events interface, beside its texts and without a ground station having to listen. Only what its
// recordings show: what they do not, is not told here either.
#pragma once

#include <cstdint>

namespace jink::sim::vehicle {

enum class EventKind : std::uint8_t {
  kArmingRefused,
  kArmed,
  kDisarmed,
  kTakeoffDetected,
  kLanding,  ///< NAV_LAND was accepted
  kLandingDetected,
  kFailsafe,
  kChecks,  ///< the report of the arming checks has changed: an offboard stream or a mission came or went
};

/// Why it is armed or not, in PX4's numbers.
enum class ArmingReason : std::uint8_t { kCommand = 4, kLanding = 6 };

/// What a failsafe does, in PX4's numbers.
enum class FailsafeAction : std::uint8_t { kPosition = 2, kHold = 5 };

/// What the report of the arming checks found.
inline constexpr std::uint8_t kWithStream = 1;
inline constexpr std::uint8_t kWithMission = 2;

struct FlightEvent {
  EventKind kind = EventKind::kArmed;
  double boot_time = 0.0;           ///< s since the autopilot booted
  std::uint32_t intended_mode = 0;  ///< HEARTBEAT's custom_mode of the mode last asked for
  std::uint8_t detail = 0;          ///< an ArmingReason, a FailsafeAction, or of kChecks: the bits below
};

}  // namespace jink::sim::vehicle
