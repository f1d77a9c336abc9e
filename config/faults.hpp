// SPDX-License-Identifier: BSD-3-Clause
// The `faults` of a scenario: what goes wrong, when. Plain values, checked. What each does is sim/faults and its
// neighbours.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "planner/base/types.hpp"

namespace jink::config {

enum class FaultKind {
  kLinkLoss,       ///< nothing comes through
  kPacketLoss,     ///< `rate` of the packets do not come through
  kDelay,          ///< packets come `seconds` later, in order
  kReorder,        ///< `rate` of the packets are overtaken by those behind them
  kGpsLoss,        ///< no satellite navigation
  kEstimateJump,   ///< the position estimate moves `by`, the vehicle does not
  kTracksStop,     ///< no track messages
  kTracksFreeze,   ///< the last tracks again and again, under fresh stamps
  kTrackNoise,     ///< noise of `position` and `velocity` that the tracks do not own up to
  kIdSwap,         ///< the ids of pairs of tracks change places
  kTracksGarbage,  ///< some tracks are not finite, absurd or of negative size
  kTracksFlood,    ///< `count` further tracks far away
  kTracksSelf,     ///< a track where the vehicle itself is
  kTracksClock,    ///< the stamps are off by `offset`
  kReboot,         ///< of the autopilot
  kPilotMode,      ///< a pilot switches to `mode`
  kLowBattery,     ///< `remaining` of it
  kRefuseArming,   ///< the autopilot does not let itself be armed
  kRefuseOffboard  ///< nor switched to OFFBOARD
};
/// As the file names it: "link_loss".
[[nodiscard]] std::string_view to_string(FaultKind kind);

/// Up is to the autopilot: setpoints and commands. Down is from it: telemetry and answers.
enum class LinkDirection { kBoth, kUp, kDown };

enum class PilotMode { kHold, kPosition, kAltitude, kLand, kReturn, kManual };

/// One fault. Of the fields after `vehicle`, those that its kind names are used.
struct Fault {
  FaultKind kind = FaultKind::kLinkLoss;
  double at = 0.0;                 ///< s, scenario time at which it begins; 0: from the simulator's start
  std::optional<double> duration;  ///< s; none: for good, or happening at once
  std::optional<int> vehicle;      ///< the number of the one that it befalls; none: all

  LinkDirection direction = LinkDirection::kBoth;  ///< the four of the link
  double rate = 0.0;                               ///< packet_loss, reorder: 0 to 1
  double seconds = 0.0;                            ///< delay
  Vec3 by = Vec3::Zero();                          ///< estimate_jump: m, ENU
  double position = 0.0;                           ///< track_noise: standard deviation per axis, m
  double velocity = 0.0;                           ///< track_noise: m/s
  int count = 0;                                   ///< tracks_flood
  double offset = 0.0;                             ///< tracks_clock: s, added to the stamps
  PilotMode mode = PilotMode::kHold;               ///< pilot_mode
  double remaining = 1.0;                          ///< low_battery: 0 to 1

  /// It happens at once and has no end: estimate_jump, reboot, pilot_mode.
  [[nodiscard]] bool instantaneous() const;
  /// It befalls a vehicle or its link; false: the tracks, which all vehicles share (tracks_self does both).
  [[nodiscard]] bool of_vehicle() const;
  [[nodiscard]] bool befalls(int number) const { return !vehicle || *vehicle == number; }
  /// For events: "packet_loss, rate 0.2, up, for 3 s, vehicle 1".
  [[nodiscard]] std::string text() const;
  bool operator==(const Fault&) const = default;
};

}  // namespace jink::config
