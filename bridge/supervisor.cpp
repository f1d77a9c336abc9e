// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace jink::bridge {
namespace {

constexpr double kHeartbeatTimeout = 3.0;  // s; PX4 sends one a second
constexpr double kAskAgain = 1.5;          // s; a confirming heartbeat takes up to one
constexpr int kMostTries = 5;
constexpr double kSettling = 0.3;         // s, within which a request acts; PX4 takes up to 15 ms
constexpr double kReadyAgain = 10.0;      // s, to become ready again between the first request and arming
constexpr double kClimbTimeout = 30.0;    // s
constexpr double kLandingTimeout = 90.0;  // s
constexpr double kShortestStop = 0.3;     // s, of braking before a hand-over
constexpr double kLongestStop = 4.0;      // s
constexpr double kUnsent = 0.2;           // s
constexpr double kFailsafePasses =
    1.5;  // s: PX4 is back in OFFBOARD 0.4 s after the stream, a heartbeat may be 1 s old
constexpr double kForgetting = 1.0 / 3.0;  // s of hazard forgotten in each second without one

using Motion = Decision::Motion;

std::string metres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f m", value);
  return text.data();
}

/// Modes in which the autopilot knows where to fly to; in the others it waits for the sticks, and sinks without them.
bool flies_by_itself(FlightMode mode) {
  return mode == FlightMode::kHold || mode == FlightMode::kLand || mode == FlightMode::kReturn ||
         mode == FlightMode::kTakeoff || mode == FlightMode::kMission;
}

}  // namespace

std::string_view to_string(Phase phase) {
  switch (phase) {
    case Phase::kWaiting:
      return "waiting";
    case Phase::kEngaging:
      return "engaging";
    case Phase::kClimbing:
      return "climbing";
    case Phase::kFlying:
      return "flying";
    case Phase::kStopping:
      return "stopping";
    case Phase::kHandover:
      return "handover";
    case Phase::kLanding:
      return "landing";
    case Phase::kDone:
      return "done";
  }
  return "done";
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNone:
      return "none";
    case Outcome::kReached:
      return "reached";
    case Outcome::kCollision:
      return "collision";
    case Outcome::kTimeout:
      return "timeout";
    case Outcome::kLeftWorld:
      return "left_world";
    case Outcome::kStartBlocked:
      return "start_blocked";
    case Outcome::kAborted:
      return "aborted";
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

// Asks once, and again where a heartbeat since then shows no effect: on an old one the vehicle may be a pilot's by now.
// Nothing when it was asked too often or just now.
std::optional<Command> Supervisor::ask(Command command, double now, const VehicleState& state) {
  if (asked_for_ == command && (now - asked_ < kAskAgain || state.heartbeat_stamp <= asked_)) return std::nullopt;
  if (asked_for_ != command) {
    tries_ = 0;
    refusal_.clear();  // of another request
  }
  ++tries_;
  asked_for_ = command;
  asked_ = now;
  return command;
}

// Asked often enough, and the last request has had its time too; or no heartbeat has come in that time to ask again on.
bool Supervisor::exhausted(double now, const VehicleState& state) const {
  if (tries_ >= kMostTries) return now - asked_ >= kAskAgain;
  return tries_ > 0 && state.heartbeat_stamp <= asked_ && now - asked_ >= kMostTries * kAskAgain;
}

void Supervisor::stop(double now, Outcome outcome, std::string reason) {
  if (phase_ == Phase::kDone || phase_ == Phase::kStopping || phase_ == Phase::kHandover) return;
  if (phase_ == Phase::kLanding && land_) {  // a landing that must be: once it has begun it goes on without us
    if (!leave_landing_) reason_ += "; " + reason + ", the landing goes on";
    leave_landing_ = true;
    return;
  }
  reason_ = std::move(reason);
  pending_outcome_ = outcome;
  waiting_for_.clear();
  hazard_.clear();
  if (phase_ == Phase::kLanding) {
    landing_interrupted_ = true;
    enter(Phase::kHandover, now);
    return;
  }
  if (phase_ == Phase::kEngaging && asked_for_) unsettled_until_ = asked_ + kSettling;
  const bool never_flew = phase_ == Phase::kWaiting;
  if (never_flew) {
    finish(outcome, {});
  } else {
    enter(Phase::kStopping, now);
  }
}

Decision Supervisor::update(double now, const VehicleState& state, const FlightPicture& picture) {
  if (began_ < 0.0) {
    began_ = absent_since_ = now;
    entered_ = now;
  }
  if (picture.report && !picture.report->accepted) {
    refusal_ = std::string(to_string(picture.report->command)) + " refused: " + picture.report->detail;
  }
  const double elapsed = updated_ < 0.0 ? 0.0 : now - updated_;
  updated_ = now;
  hazard_time_ = std::max(0.0, hazard_time_ + (hazard_.empty() ? -kForgetting : 1.0) * elapsed);
  if (taken_over(now, state)) return {};
  flee_battery(now, state);
  switch (phase_) {
    case Phase::kWaiting:
      return wait(now, state, picture);
    case Phase::kEngaging:
      return engage(now, state, picture);
    case Phase::kClimbing:
      return climb(now, state, picture);
    case Phase::kFlying:
      return fly(now, state, picture);
    case Phase::kStopping: {
      const double stopping = now - entered_;
      if (!state.in_air || stopping > kLongestStop || (picture.at_rest && stopping > kShortestStop)) {
        enter(land_ && state.armed ? Phase::kLanding : Phase::kHandover, now);
      }
      return {Motion::kBrake, {}};
    }
    case Phase::kHandover:
      return hand_over(now, state);
    case Phase::kLanding:
      return land(now, state);
    case Phase::kDone:
      return {};
  }
  return {};
}

// True, and the flight is over, where somebody else changed the mode or the motors went off.
bool Supervisor::taken_over(double now, const VehicleState& state) {
  const bool asked = phase_ == Phase::kEngaging || phase_ == Phase::kStopping || phase_ == Phase::kHandover;
  const bool ours = phase_ == Phase::kEngaging || phase_ == Phase::kClimbing || phase_ == Phase::kFlying ||
                    phase_ == Phase::kStopping;
  if (asked && state.mode == FlightMode::kOffboard) offboard_seen_ = true;
  std::string what;
  if (ours && flight_began_ >= 0.0 && !state.armed) {
    what = "the autopilot disarmed in flight";
  } else if ((ours && offboard_seen_ && state.mode != FlightMode::kOffboard) ||
             (asked && !offboard_seen_ && state.mode != mode_before_)) {
    if (state.failsafe && phase_ == Phase::kEngaging) {  // of a companion before us: our stream ends it
      offboard_seen_ = false;
      return false;
    }
    if (state.failsafe) return failsafe_took_over(now, state);
    what = "the mode was changed to " + std::string(to_string(state.mode)) + " by pilot or autopilot";
  } else {
    failsafe_since_ = -1.0;
    return false;
  }
  if (!reason_.empty()) reason_ += "; then " + what;
  finish(pending_outcome_ == Outcome::kNone ? Outcome::kAborted : pending_outcome_, what);
  return true;
}

// The autopilot's failsafe flies. True where it is left the vehicle for good.
bool Supervisor::failsafe_took_over(double now, const VehicleState& state) {
  if (failsafe_since_ < 0.0) failsafe_since_ = now;
  if ((phase_ == Phase::kFlying || phase_ == Phase::kClimbing) && now - failsafe_since_ <= kFailsafePasses)
    return false;
  const std::string what = "the autopilot's failsafe took over, mode " + std::string(to_string(state.mode));
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
void Supervisor::flee_battery(double now, const VehicleState& state) {
  if (state.battery != BatteryState::kCritical) return;
  if (phase_ == Phase::kClimbing || phase_ == Phase::kFlying) stop(now, Outcome::kAborted, "the battery is critical");
  if (phase_ == Phase::kStopping) land_ = true;
}

// What a flight cannot begin without, into waiting_for_; empty: nothing.
void Supervisor::find_missing(double now, const VehicleState& state, const FlightPicture& picture) {
  const bool autopilot = state.heartbeat_stamp >= 0.0 && now - state.heartbeat_stamp < kHeartbeatTimeout;
  const bool tracks = !mission_.tracks.required ||
                      (picture.newest_tracks >= 0.0 && now - picture.newest_tracks < mission_.tracks.timeout_s);
  const bool position = state.position_stamp >= 0.0 && now - state.position_stamp < settings_.stale_state;
  const bool ready = position && state.local_position_ok && state.landed_state_known && (state.armed || state.armable);
  waiting_for_.clear();
  absent_ = MissingPeer::kNone;
  if (!autopilot) {
    waiting_for_ = "an autopilot's heartbeat on " + mission_.connection;
    absent_ = MissingPeer::kAutopilot;
  } else if (!tracks) {
    waiting_for_ = "obstacle tracks on DDS domain " + std::to_string(mission_.dds_domain);
    absent_ = MissingPeer::kTracks;
  } else if (!ready) {
    waiting_for_ = "the autopilot to be ready: " +
                   (!state.health.empty() ? state.health
                                          : std::string(state.landed_state_known ? "local position" : "landed state"));
  } else if (state.battery == BatteryState::kLow || state.battery == BatteryState::kCritical) {
    waiting_for_ = "a charged battery: it is " + std::string(to_string(state.battery));
  }
}

Decision Supervisor::wait(double now, const VehicleState& state, const FlightPicture& picture) {
  find_missing(now, state, picture);
  if (waiting_for_.empty()) {
    if (!state.in_air && outside_fence(state)) return {};
    mode_before_ = state.mode;
    enter(Phase::kEngaging, now);
    return {Motion::kStay, {}};
  }
  const bool peer = absent_ != MissingPeer::kNone;
  if (absent_ != absent_before_) absent_since_ = now;
  absent_before_ = absent_;
  if (now - absent_since_ > (peer ? settings_.peer_timeout : settings_.health_timeout)) {
    missing_peer_ = absent_;
    finish(Outcome::kAborted, "waited in vain for " + waiting_for_);
  }
  return {};
}

// True, and the flight is over before it began, where the vehicle stands beside the volume that it may fly in.
bool Supervisor::outside_fence(const VehicleState& state) {
  const auto across = [](const planner::Box& box, const Vec3& p) {
    return p.x() < box.min.x() || p.x() > box.max.x() || p.y() < box.min.y() || p.y() > box.max.y();
  };
  if (!across(mission_.geofence, state.position)) return false;
  finish(Outcome::kAborted, "the vehicle stands outside the geofence, at east " + metres(state.position.x()) +
                                ", north " + metres(state.position.y()));
  return true;
}

Decision Supervisor::engage(double now, const VehicleState& state, const FlightPicture& picture) {
  Decision decision{state.in_air ? Motion::kStay : Motion::kTakeoffPoint, {}};
  if (state.mode == FlightMode::kOffboard && state.armed) {
    waiting_for_.clear();
    flight_began_ = now;
    enter(state.in_air ? Phase::kFlying : Phase::kClimbing, now);
    return decision;
  }
  if (exhausted(now, state)) {
    stop(now, Outcome::kAborted,
         refusal_.empty() ? "the autopilot did not follow the request: " + std::string(to_string(*asked_for_))
                          : refusal_);
    return decision;
  }
  if (picture.report && picture.report->command == Command::kOffboard && picture.report->accepted) granted_ = now;
  if (state.mode != FlightMode::kOffboard) {
    // It was there, by the autopilot's word, and is no more: somebody took it back.
    if (state.armed && granted_ >= 0.0 && state.heartbeat_stamp > granted_ + kSettling && !state.failsafe) {
      finish(Outcome::kAborted, "OFFBOARD was granted and taken back: mode " + std::string(to_string(state.mode)));
      return {};
    }
    decision.request = ask(Command::kOffboard, now, state);
    return decision;
  }
  // What was there when it was waited for may be gone again.
  find_missing(now, state, picture);
  if (waiting_for_.empty()) {
    not_ready_since_ = -1.0;
    decision.request = ask(Command::kArm, now, state);
    return decision;
  }
  if (not_ready_since_ < 0.0) not_ready_since_ = now;
  if (now - not_ready_since_ > kReadyAgain) stop(now, Outcome::kAborted, "waited in vain for " + waiting_for_);
  return decision;
}

Decision Supervisor::climb(double now, const VehicleState& state, const FlightPicture& picture) {
  find_hazard(now, state, picture);
  if (!hazard_.empty()) return fall_back(now);
  hazard_since_ = -1.0;
  if (state.in_air && picture.at_takeoff_height) {
    enter(Phase::kFlying, now);
    return {Motion::kFollow, {}};
  }
  if (now - entered_ > kClimbTimeout) {
    stop(now, Outcome::kAborted, "the take-off height was not reached");
    return {Motion::kBrake, {}};
  }
  return {Motion::kTakeoffPoint, {}};
}

// Brakes while a hazard lasts, and ends the flight where it does not pass or comes again and again.
Decision Supervisor::fall_back(double now) {
  if (hazard_since_ < 0.0) hazard_since_ = now;
  if (now - hazard_since_ > settings_.give_up) {
    stop(now, Outcome::kAborted, std::string(hazard_));
  } else if (hazard_time_ > 2.0 * settings_.give_up) {
    stop(now, Outcome::kAborted, hazard_ + ", again and again");
  }
  return {Motion::kBrake, {}};
}

void Supervisor::find_hazard(double now, const VehicleState& state, const FlightPicture& picture) {
  hazard_.clear();
  if (now - state.position_stamp > settings_.stale_state) {
    hazard_ = "the vehicle's position is stale";
  } else if (now - state.heartbeat_stamp > kHeartbeatTimeout) {
    hazard_ = "the autopilot's heartbeat is missing";
  } else if (failsafe_since_ >= 0.0) {
    hazard_ = "the autopilot's failsafe flies, mode " + std::string(to_string(state.mode));
  } else if (!state.local_position_ok) {
    hazard_ = "the autopilot has lost its position";
  } else if (state.gps_lost) {
    hazard_ = "the autopilot has lost its GPS";
  } else if (mission_.tracks.required && now - picture.newest_tracks > mission_.tracks.timeout_s) {
    hazard_ = "the obstacle tracks are stale";
  } else if (mission_.tracks.required && picture.lost_writers > 0) {
    hazard_ = "a writer of obstacle tracks has fallen silent";
  } else if (picture.unsent_for > kUnsent) {
    hazard_ = "setpoints cannot be sent";
  } else if (phase_ == Phase::kFlying && now - std::max(picture.newest_plan, entered_) > settings_.stale_plan) {
    hazard_ = "the planner is late";
  }
}

Decision Supervisor::fly(double now, const VehicleState& state, const FlightPicture& picture) {
  // Where the vehicle was is no proof of where it is.
  if (picture.at_target && now - state.position_stamp <= settings_.stale_state && failsafe_since_ < 0.0) {
    hazard_.clear();
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
  return fall_back(now);
}

// Out of a failsafe that only sinks. Without a position HOLD cannot be flown, and the failsafe is what is left.
Decision Supervisor::rescue(double now, const VehicleState& state) {
  if (state.mode == FlightMode::kOffboard) {  // it went back by itself: the stream was still on its way
    rescue_ = false;
    return {Motion::kBrake, ask(Command::kHold, now, state)};
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
    return {Motion::kNone, ask(Command::kHold, now, state)};
  }
  return {};
}

Decision Supervisor::hand_over(double now, const VehicleState& state) {
  if (rescue_) return rescue(now, state);
  const bool offboard = state.mode == FlightMode::kOffboard;
  const bool landing = landing_interrupted_ && state.mode == FlightMode::kLand;
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
    reason_ += "; then the autopilot's failsafe took over, mode " + std::string(to_string(state.mode));
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
  return {motion, ask(Command::kHold, now, state)};
}

Decision Supervisor::land(double now, const VehicleState& state) {
  if (!state.armed && !state.in_air) {
    finish(pending_outcome_, {});
    return {};
  }
  const auto fail = [&](const std::string& what) {
    reason_ += ", but " + what;
    pending_outcome_ = Outcome::kAborted;
  };
  if (state.mode != FlightMode::kOffboard && state.mode != FlightMode::kLand) {
    fail("the landing was taken over: mode " + std::string(to_string(state.mode)));
    finish(pending_outcome_, {});
    return {};
  }
  if (state.mode == FlightMode::kLand) {
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
    return {Motion::kBrake, ask(Command::kHold, now, state)};
  }
  return {land_ ? Motion::kBrake : Motion::kFollow, ask(Command::kLand, now, state)};
}

}  // namespace jink::bridge
