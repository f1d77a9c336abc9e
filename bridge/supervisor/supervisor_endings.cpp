// SPDX-License-Identifier: BSD-3-Clause
// How a flight ends that had begun: taken over by a pilot or a failsafe, handed over in HOLD, landed.
#include <string>

#include "bridge/supervisor/supervisor.hpp"

namespace jink::bridge::supervisor {
namespace {

constexpr double kLandingTimeout = 90.0;  // s
constexpr double kFailsafePasses =
    1.5;  // s: PX4 is back in OFFBOARD 0.4 s after the stream, a heartbeat may be 1 s old

using Motion = Decision::Motion;

// Modes in which the autopilot knows where to fly to; in the others it waits for the sticks, and sinks without them.
bool flies_by_itself(vehicle::FlightMode mode) {
  return mode == vehicle::FlightMode::kHold || mode == vehicle::FlightMode::kLand ||
         mode == vehicle::FlightMode::kReturn || mode == vehicle::FlightMode::kTakeoff ||
         mode == vehicle::FlightMode::kMission;
}

}  // namespace

// True, and the flight is over, where somebody else changed the mode or the motors went off.
bool Supervisor::taken_over(double now, const vehicle::VehicleState& state) {
  const bool asked = phase_ == Phase::kEngaging || phase_ == Phase::kStopping || phase_ == Phase::kHandover;
  const bool ours = phase_ == Phase::kEngaging || phase_ == Phase::kClimbing || phase_ == Phase::kFlying ||
                    phase_ == Phase::kStopping;
  if (asked && state.mode == vehicle::FlightMode::kOffboard) offboard_seen_ = true;
  std::string what;
  if (ours && flight_began_ >= 0.0 && !state.armed) {
    what = "the autopilot disarmed in flight";
  } else if ((ours && offboard_seen_ && state.mode != vehicle::FlightMode::kOffboard) ||
             (asked && !offboard_seen_ && state.mode != mode_before_)) {
    if (state.failsafe && phase_ == Phase::kEngaging) {  // of a companion before us: our stream ends it
      offboard_seen_ = false;
      return false;
    }
    if (state.failsafe) return failsafe_took_over(now, state);
    what = "the mode was changed to " + std::string(vehicle::to_string(state.mode)) + " by pilot or autopilot";
  } else {
    failsafe_since_ = -1.0;
    return false;
  }
  if (!reason_.empty()) reason_ += "; then " + what;
  finish(pending_outcome_ == Outcome::kNone ? Outcome::kAborted : pending_outcome_, what);
  return true;
}

// The autopilot's failsafe flies. True where it is left the vehicle for good.
bool Supervisor::failsafe_took_over(double now, const vehicle::VehicleState& state) {
  if (failsafe_since_ < 0.0) failsafe_since_ = now;
  if ((phase_ == Phase::kFlying || phase_ == Phase::kClimbing) && now - failsafe_since_ <= kFailsafePasses)
    return false;
  const std::string what = "the autopilot's failsafe took over, mode " + std::string(vehicle::to_string(state.mode));
  reason_ += (reason_.empty() ? "" : "; then ") + what;
  if (pending_outcome_ == Outcome::kNone) pending_outcome_ = Outcome::kAborted;
  hazard_.clear();
  if (flies_by_itself(state.mode)) {
    finish(pending_outcome_, {});
    return true;
  }
  rescue_ = true;
  enter(Phase::kHandover, now);
  return false;
}

// Where the battery ends, the flight ends on the ground.
void Supervisor::flee_battery(double now, const vehicle::VehicleState& state) {
  if (state.battery != vehicle::BatteryState::kCritical) return;
  if (phase_ == Phase::kClimbing || phase_ == Phase::kFlying) stop(now, Outcome::kAborted, "the battery is critical");
  if (phase_ == Phase::kStopping) land_ = true;
}

// Out of a failsafe that only sinks. Without a position HOLD cannot be flown, and the failsafe is what is left.
Decision Supervisor::rescue(double now, const vehicle::VehicleState& state) {
  if (state.mode == vehicle::FlightMode::kOffboard) {  // it went back by itself: the stream was still on its way
    rescue_ = false;
    return {Motion::kBrake, ask(vehicle::Command::kHold, now, state)};
  }
  if (!state.failsafe || flies_by_itself(state.mode) || (!state.armed && !state.in_air)) {
    finish(pending_outcome_, {});
  } else if (!state.local_position_ok) {
    reason_ += "; without a position there is no HOLD, the failsafe has the vehicle";
    finish(pending_outcome_, {});
  } else if (exhausted(now, state)) {
    reason_ +=
        "; HOLD was not to be had" + (refusal_.empty() ? "" : " (" + refusal_ + ")") + ", the failsafe has the vehicle";
    finish(pending_outcome_, {});
  } else {
    return {Motion::kNone, ask(vehicle::Command::kHold, now, state)};
  }
  return {};
}

Decision Supervisor::hand_over(double now, const vehicle::VehicleState& state) {
  if (rescue_) return rescue(now, state);
  const bool offboard = state.mode == vehicle::FlightMode::kOffboard;
  const bool landing = landing_interrupted_ && state.mode == vehicle::FlightMode::kLand;
  const bool grounded = !state.armed && !state.in_air;
  const Motion motion = landing                                 ? Motion::kNone
                        : pending_outcome_ == Outcome::kReached ? Motion::kFollow
                                                                : Motion::kBrake;
  // Stopped while OFFBOARD or arming was asked for: whether that acted, only a newer heartbeat tells.
  if (state.heartbeat_stamp <= unsettled_until_ && (offboard ? grounded : !offboard_seen_)) {
    if (now - entered_ <= kHeartbeatTimeout) return {motion, {}};
    reason_ += "; the autopilot's heartbeat is missing, whether it is in OFFBOARD is not known";
    finish(pending_outcome_, {});
    return {};
  }
  if (state.failsafe && !offboard && !flies_by_itself(state.mode)) {
    reason_ += "; then the autopilot's failsafe took over, mode " + std::string(vehicle::to_string(state.mode));
    pending_outcome_ = Outcome::kAborted;
    rescue_ = true;
    return rescue(now, state);
  }
  // HOLD is there; or somebody chose another mode, and that stands.
  if ((!offboard && !landing) || grounded) {
    finish(pending_outcome_, {});
    return {};
  }
  if (exhausted(now, state)) {
    finish(pending_outcome_ == Outcome::kReached ? Outcome::kAborted : pending_outcome_, {});
    reason_ += "; HOLD was never confirmed, the autopilot's own failsafe has the vehicle";
    return {};
  }
  // The stream goes on until HOLD is confirmed, so that the vehicle is never without an order.
  return {motion, ask(vehicle::Command::kHold, now, state)};
}

Decision Supervisor::land(double now, const vehicle::VehicleState& state) {
  if (!state.armed && !state.in_air) {
    finish(pending_outcome_, {});
    return {};
  }
  const auto fail = [&](const std::string& what) {
    reason_ += ", but " + what;
    pending_outcome_ = Outcome::kAborted;
  };
  if (state.mode != vehicle::FlightMode::kOffboard && state.mode != vehicle::FlightMode::kLand) {
    fail("the landing was taken over: mode " + std::string(vehicle::to_string(state.mode)));
    finish(pending_outcome_, {});
    return {};
  }
  if (state.mode == vehicle::FlightMode::kLand) {
    if (leave_landing_) {
      finish(pending_outcome_, {});
    } else if (now - entered_ > kLandingTimeout) {
      fail("the landing did not end");
      finish(pending_outcome_, {});
    }
    return {};
  }
  if (exhausted(now, state)) {
    fail("the autopilot does not land" + (refusal_.empty() ? "" : ": " + refusal_));
    enter(Phase::kHandover, now);
    return {Motion::kBrake, ask(vehicle::Command::kHold, now, state)};
  }
  return {land_ ? Motion::kBrake : Motion::kFollow, ask(vehicle::Command::kLand, now, state)};
}

}  // namespace jink::bridge::supervisor
