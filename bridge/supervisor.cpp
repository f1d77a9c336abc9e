// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor.hpp"

#include <cmath>
#include <utility>

namespace jink::bridge {
namespace {

constexpr double kHeartbeatTimeout = 3.0;  // s; PX4 sends one a second
constexpr double kAskAgain = 1.5;          // s; a confirming heartbeat takes up to one
constexpr int kMostTries = 5;
constexpr double kClimbTimeout = 30.0;    // s
constexpr double kLandingTimeout = 90.0;  // s
constexpr double kShortestStop = 0.3;     // s, of braking before a hand-over
constexpr double kLongestStop = 4.0;      // s

using Motion = Decision::Motion;

}  // namespace

std::string_view to_string(Phase phase) {
  switch (phase) {
    case Phase::kWaiting: return "waiting";
    case Phase::kEngaging: return "engaging";
    case Phase::kClimbing: return "climbing";
    case Phase::kFlying: return "flying";
    case Phase::kStopping: return "stopping";
    case Phase::kHandover: return "handover";
    case Phase::kLanding: return "landing";
    case Phase::kDone: return "done";
  }
  return "done";
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNone: return "none";
    case Outcome::kReached: return "reached";
    case Outcome::kCollision: return "collision";
    case Outcome::kTimeout: return "timeout";
    case Outcome::kLeftWorld: return "left_world";
    case Outcome::kStartBlocked: return "start_blocked";
    case Outcome::kAborted: return "aborted";
  }
  return "none";
}

void Supervisor::enter(Phase phase, double now) {
  phase_ = phase;
  entered_ = now;
  asked_for_.reset();
  tries_ = 0;
}

void Supervisor::finish(Outcome outcome, std::string reason) {
  phase_ = Phase::kDone;
  outcome_ = outcome;
  if (reason_.empty()) reason_ = std::move(reason);
}

// Asks once, and again where the heartbeat shows no effect. Nothing when it was asked too often or just now.
std::optional<Command> Supervisor::ask(Command command, double now) {
  if (asked_for_ == command && now - asked_ < kAskAgain) return std::nullopt;
  if (asked_for_ != command) tries_ = 0;
  ++tries_;
  asked_for_ = command;
  asked_ = now;
  return command;
}

void Supervisor::stop(double now, Outcome outcome, std::string reason) {
  if (phase_ == Phase::kDone || phase_ == Phase::kStopping || phase_ == Phase::kHandover) return;
  reason_ = std::move(reason);
  pending_outcome_ = outcome;
  const bool never_flew = phase_ == Phase::kWaiting;
  if (never_flew) {
    finish(outcome, {});
  } else {
    enter(Phase::kStopping, now);
  }
}

Decision Supervisor::update(double now, const VehicleState& state, const FlightPicture& picture) {
  if (began_ < 0.0) {
    began_ = now;
    entered_ = now;
  }
  if (picture.report && !picture.report->accepted) {
    refusal_ = std::string(to_string(picture.report->command)) + " refused: " + picture.report->detail;
  }
  if (taken_over(state)) return {};
  switch (phase_) {
    case Phase::kWaiting: return wait(now, state, picture);
    case Phase::kEngaging: return engage(now, state);
    case Phase::kClimbing: return climb(now, state, picture);
    case Phase::kFlying: return fly(now, state, picture);
    case Phase::kStopping: {
      const double stopping = now - entered_;
      if (!state.in_air || stopping > kLongestStop || (picture.at_rest && stopping > kShortestStop)) {
        enter(Phase::kHandover, now);
      }
      return {Motion::kBrake, {}};
    }
    case Phase::kHandover: return hand_over(now, state);
    case Phase::kLanding: return land(now, state);
    case Phase::kDone: return {};
  }
  return {};
}

// True, and the flight is over, where somebody else changed the mode or the motors went off.
bool Supervisor::taken_over(const VehicleState& state) {
  const bool ours = phase_ == Phase::kClimbing || phase_ == Phase::kFlying || phase_ == Phase::kStopping;
  if (!ours || !offboard_seen_) return false;
  if (!state.armed) {
    finish(Outcome::kAborted, "the autopilot disarmed in flight");
    return true;
  }
  if (state.mode == FlightMode::kOffboard) return false;
  finish(Outcome::kAborted, "the mode was changed to " + std::string(to_string(state.mode)) + " by pilot or autopilot");
  return true;
}

Decision Supervisor::wait(double now, const VehicleState& state, const FlightPicture& picture) {
  const bool autopilot = state.heartbeat_stamp >= 0.0 && now - state.heartbeat_stamp < kHeartbeatTimeout;
  const bool tracks =
      !mission_.tracks.required || (picture.newest_tracks >= 0.0 && now - picture.newest_tracks < mission_.tracks.timeout_s);
  const bool position = state.position_stamp >= 0.0 && now - state.position_stamp < settings_.stale_state;
  const bool ready = position && state.local_position_ok && (state.armed || state.armable);
  waiting_for_.clear();
  if (!autopilot) {
    waiting_for_ = "an autopilot's heartbeat on " + mission_.connection;
  } else if (!tracks) {
    waiting_for_ = "obstacle tracks on DDS domain " + std::to_string(mission_.dds_domain);
  } else if (!ready) {
    waiting_for_ = "the autopilot to be ready: " + (state.health.empty() ? std::string("local position") : state.health);
  } else {
    enter(Phase::kEngaging, now);
    return {Motion::kStay, {}};
  }
  const double waited = now - began_;
  if (!autopilot || !tracks) {
    if (waited > settings_.peer_timeout) {
      missing_peer_ = autopilot ? MissingPeer::kTracks : MissingPeer::kAutopilot;
      finish(Outcome::kAborted, "waited in vain for " + waiting_for_);
    }
  } else if (waited > settings_.health_timeout) {
    finish(Outcome::kAborted, "waited in vain for " + waiting_for_);
  }
  return {};
}

Decision Supervisor::engage(double now, const VehicleState& state) {
  Decision decision{state.in_air ? Motion::kStay : Motion::kTakeoffPoint, {}};
  if (tries_ > kMostTries) {
    finish(Outcome::kAborted, refusal_.empty() ? "the autopilot did not answer " + std::string(to_string(*asked_for_)) : refusal_);
    return {};
  }
  if (state.mode != FlightMode::kOffboard) {
    decision.request = ask(Command::kOffboard, now);
  } else if (!state.armed) {
    decision.request = ask(Command::kArm, now);
  } else {
    offboard_seen_ = true;
    flight_began_ = now;
    enter(state.in_air ? Phase::kFlying : Phase::kClimbing, now);
  }
  return decision;
}

Decision Supervisor::climb(double now, const VehicleState& state, const FlightPicture& picture) {
  const bool stale = now - state.position_stamp > settings_.stale_state;
  if (!stale && state.in_air && picture.at_takeoff_height) {
    enter(Phase::kFlying, now);
    return {Motion::kFollow, {}};
  }
  if (stale) {
    stop(now, Outcome::kAborted, "the vehicle's position is stale during take-off");
  } else if (now - entered_ > kClimbTimeout) {
    stop(now, Outcome::kAborted, "the take-off height was not reached");
  }
  return {Motion::kTakeoffPoint, {}};
}

void Supervisor::find_hazard(double now, const VehicleState& state, const FlightPicture& picture) {
  hazard_.clear();
  if (now - state.position_stamp > settings_.stale_state) {
    hazard_ = "the vehicle's position is stale";
  } else if (now - state.heartbeat_stamp > kHeartbeatTimeout) {
    hazard_ = "the autopilot's heartbeat is missing";
  } else if (mission_.tracks.required && now - picture.newest_tracks > mission_.tracks.timeout_s) {
    hazard_ = "the obstacle tracks are stale";
  } else if (now - std::max(picture.newest_plan, entered_) > settings_.stale_plan) {
    hazard_ = "the planner is late";
  }
}

Decision Supervisor::fly(double now, const VehicleState& state, const FlightPicture& picture) {
  if (picture.at_target) {
    pending_outcome_ = Outcome::kReached;
    reason_ = "target reached";
    enter(mission_.arrival == config::Arrival::kLand ? Phase::kLanding : Phase::kHandover, now);
    return {Motion::kFollow, {}};
  }
  if (now - flight_began_ > mission_.time_limit) {
    stop(now, Outcome::kTimeout, "the time limit passed before the target was reached");
    return {Motion::kBrake, {}};
  }
  find_hazard(now, state, picture);
  if (hazard_.empty()) {
    hazard_since_ = -1.0;
    return {Motion::kFollow, {}};
  }
  if (hazard_since_ < 0.0) hazard_since_ = now;
  if (now - hazard_since_ > settings_.give_up) stop(now, Outcome::kAborted, hazard_);
  return {Motion::kBrake, {}};
}

Decision Supervisor::hand_over(double now, const VehicleState& state) {
  // HOLD is there; or somebody chose another mode, and that stands.
  if (state.mode != FlightMode::kOffboard || (!state.armed && !state.in_air)) {
    finish(pending_outcome_, {});
    return {};
  }
  if (tries_ > kMostTries) {
    finish(pending_outcome_ == Outcome::kReached ? Outcome::kAborted : pending_outcome_, {});
    reason_ += "; HOLD was never confirmed, the autopilot's own failsafe has the vehicle";
    return {};
  }
  // The stream goes on until HOLD is confirmed, so that the vehicle is never without an order.
  return {pending_outcome_ == Outcome::kReached ? Motion::kFollow : Motion::kBrake, ask(Command::kHold, now)};
}

Decision Supervisor::land(double now, const VehicleState& state) {
  if (!state.armed && !state.in_air) {
    finish(Outcome::kReached, {});
    return {};
  }
  if (state.mode != FlightMode::kOffboard && state.mode != FlightMode::kLand) {
    reason_ = "target reached, but the landing was taken over: mode " + std::string(to_string(state.mode));
    finish(Outcome::kAborted, {});
    return {};
  }
  if (state.mode == FlightMode::kLand) {
    if (now - entered_ > kLandingTimeout) {
      reason_ = "target reached, but the landing did not end";
      finish(Outcome::kAborted, {});
    }
    return {};
  }
  if (tries_ > kMostTries) {
    pending_outcome_ = Outcome::kAborted;
    reason_ = "target reached, but the autopilot does not land";
    enter(Phase::kHandover, now);
  }
  return {Motion::kFollow, ask(Command::kLand, now)};
}

}  // namespace jink::bridge
