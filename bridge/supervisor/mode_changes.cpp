// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/mode_changes.hpp"

namespace jink::bridge::supervisor {
namespace {

// s: PX4 is back in OFFBOARD 0.4 s after the stream, a heartbeat may be 1 s old
constexpr double kFailsafePasses = 1.5;

}  // namespace

bool flies_by_itself(vehicle::FlightMode mode) {
  return mode == vehicle::FlightMode::kHold || mode == vehicle::FlightMode::kLand ||
         mode == vehicle::FlightMode::kReturn || mode == vehicle::FlightMode::kTakeoff ||
         mode == vehicle::FlightMode::kMission;
}

// Somebody chose the mode, whose word is the last one.
bool ModeChanges::chosen(bool left, const vehicle::VehicleState& state) const {
  const vehicle::FlightMode intended = state.intended_mode;
  if (intended != vehicle::FlightMode::kUnknown)
    return intended != vehicle::FlightMode::kOffboard && (left || intended != intended_before_);
  // Where a warning had the state CRITICAL before, it does not tell a failsafe from a pilot.
  return !state.failsafe || (left && critical_in_offboard_);
}

ModeChange ModeChanges::judge(double now, Phase phase, bool armed_before, const vehicle::VehicleState& state) {
  const bool airborne = phase == Phase::kClimbing || phase == Phase::kFlying;
  const bool asking = phase == Phase::kEngaging || phase == Phase::kStopping || phase == Phase::kHandover;
  const bool streaming = phase != Phase::kHandover && (airborne || asking);
  const bool offboard = state.mode == vehicle::FlightMode::kOffboard;
  if (asking && offboard) offboard_seen_ = true;
  if (offboard) critical_in_offboard_ = state.failsafe;
  if (streaming && armed_before && !state.armed) return ModeChange::kDisarmed;
  const bool left = streaming && offboard_seen_ && !offboard;
  const bool never_came = asking && !offboard_seen_ && state.mode != before_;
  if (!left && !never_came) {
    failsafe_since_.reset();
    return ModeChange::kNone;
  }
  if (chosen(left, state)) return ModeChange::kTakeover;
  if (phase == Phase::kEngaging) {
    if (flies_by_itself(state.mode)) return ModeChange::kFailsafe;
    offboard_seen_ = false;  // of a companion before us: our stream ends it
    return ModeChange::kNone;
  }
  if (!failsafe_since_) failsafe_since_ = now;
  const bool may_pass = airborne && now - *failsafe_since_ <= kFailsafePasses;
  return may_pass ? ModeChange::kFailsafePasses : ModeChange::kFailsafe;
}

}  // namespace jink::bridge::supervisor
