// SPDX-License-Identifier: BSD-3-Clause
// Where a mode change is judged: whether a pilot took the vehicle, or a failsafe of the autopilot, or it is still ours.
#pragma once

#include <optional>

#include "bridge/supervisor/flight_phases.hpp"
#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::supervisor {

enum class ModeChange {
  kNone,            ///< the mode is what it is to be
  kFailsafePasses,  ///< the autopilot's failsafe flies and may pass when the setpoints arrive again: a hazard
  kFailsafe,        ///< it stays
  kTakeover,        ///< somebody chose another mode: a pilot's word is the last one
  kDisarmed         ///< in flight
};

/// In HOLD, LAND, RETURN, ... the autopilot knows where to fly to; in the others it waits for the sticks, and sinks
/// without them.
[[nodiscard]] bool flies_by_itself(vehicle::FlightMode mode);

/// Judges step by step: by the mode that was asked for last, where the autopilot tells it (CURRENT_MODE's
/// intended_custom_mode), since a failsafe leaves that as it was; else by the heartbeat's CRITICAL. Pure logic.
class ModeChanges {
 public:
  /// From now on OFFBOARD is asked for.
  void engage(const vehicle::VehicleState& before) {
    before_ = before.mode;
    intended_before_ = before.intended_mode;
  }
  /// `armed_before`: OFFBOARD flight has begun, which takes armed motors.
  ModeChange judge(double now, Phase phase, bool armed_before, const vehicle::VehicleState& state);
  /// The autopilot's failsafe flies.
  [[nodiscard]] bool failsafe() const { return failsafe_since_.has_value(); }
  /// A heartbeat has confirmed OFFBOARD since it was asked for.
  [[nodiscard]] bool offboard_seen() const { return offboard_seen_; }

 private:
  [[nodiscard]] bool chosen(bool left, const vehicle::VehicleState& state) const;

  vehicle::FlightMode before_ = vehicle::FlightMode::kUnknown;
  vehicle::FlightMode intended_before_ = vehicle::FlightMode::kUnknown;
  bool offboard_seen_ = false;
  bool critical_in_offboard_ = false;  // a mere warning: so PX4 before 1.15 says
  std::optional<double> failsafe_since_;
};

}  // namespace jink::bridge::supervisor
