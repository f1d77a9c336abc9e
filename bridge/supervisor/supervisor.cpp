// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/supervisor.hpp"

#include <algorithm>
#include <utility>

#include "bridge/base/text.hpp"

namespace jink::bridge::supervisor {
namespace {

constexpr double kAskAgain = 1.5;  // s; a confirming heartbeat takes up to one
constexpr int kMostTries = 5;
constexpr double kSettling = 0.3;          // s, within which a request acts; PX4 takes up to 15 ms
constexpr double kReadyAgain = 10.0;       // s, to become ready again between the first request and arming
constexpr double kClimbTimeout = 30.0;     // s
constexpr double kShortestStop = 0.3;      // s, of braking before a hand-over
constexpr double kLongestStop = 4.0;       // s
constexpr double kUnsent = 0.2;            // s
constexpr double kForgetting = 1.0 / 3.0;  // s of hazard forgotten in each second without one

using Motion = Decision::Motion;

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
std::optional<vehicle::Command> Supervisor::ask(vehicle::Command command, double now,
                                                const vehicle::VehicleState& state) {
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
bool Supervisor::exhausted(double now, const vehicle::VehicleState& state) const {
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

Decision Supervisor::update(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
  if (began_ < 0.0) {
    began_ = absent_since_ = now;
    entered_ = now;
  }
  if (picture.report && !picture.report->accepted) {
    refusal_ = std::string(vehicle::to_string(picture.report->command)) + " refused: " + picture.report->detail;
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

// What a flight cannot begin without, into waiting_for_; empty: nothing.
void Supervisor::find_missing(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
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
  } else if (state.battery == vehicle::BatteryState::kLow || state.battery == vehicle::BatteryState::kCritical) {
    waiting_for_ = "a charged battery: it is " + std::string(vehicle::to_string(state.battery));
  }
}

Decision Supervisor::wait(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
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
bool Supervisor::outside_fence(const vehicle::VehicleState& state) {
  const auto across = [](const planner::base::Box& box, const Vec3& p) {
    return p.x() < box.min.x() || p.x() > box.max.x() || p.y() < box.min.y() || p.y() > box.max.y();
  };
  if (!across(mission_.geofence, state.position)) return false;
  finish(Outcome::kAborted, "the vehicle stands outside the geofence, at east " + base::metres(state.position.x(), 1) +
                                ", north " + base::metres(state.position.y(), 1));
  return true;
}

Decision Supervisor::engage(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
  Decision decision{state.in_air ? Motion::kStay : Motion::kTakeoffPoint, {}};
  if (state.mode == vehicle::FlightMode::kOffboard && state.armed) {
    waiting_for_.clear();
    flight_began_ = now;
    enter(state.in_air ? Phase::kFlying : Phase::kClimbing, now);
    return decision;
  }
  if (exhausted(now, state)) {
    stop(now, Outcome::kAborted,
         refusal_.empty() ? "the autopilot did not follow the request: " + std::string(vehicle::to_string(*asked_for_))
                          : refusal_);
    return decision;
  }
  if (picture.report && picture.report->command == vehicle::Command::kOffboard && picture.report->accepted)
    granted_ = now;
  if (state.mode != vehicle::FlightMode::kOffboard) {
    // It was there, by the autopilot's word, and is no more: somebody took it back.
    if (state.armed && granted_ >= 0.0 && state.heartbeat_stamp > granted_ + kSettling && !state.failsafe) {
      finish(Outcome::kAborted,
             "OFFBOARD was granted and taken back: mode " + std::string(vehicle::to_string(state.mode)));
      return {};
    }
    decision.request = ask(vehicle::Command::kOffboard, now, state);
    return decision;
  }
  // What was there when it was waited for may be gone again.
  find_missing(now, state, picture);
  if (waiting_for_.empty()) {
    not_ready_since_ = -1.0;
    decision.request = ask(vehicle::Command::kArm, now, state);
    return decision;
  }
  if (not_ready_since_ < 0.0) not_ready_since_ = now;
  if (now - not_ready_since_ > kReadyAgain) stop(now, Outcome::kAborted, "waited in vain for " + waiting_for_);
  return decision;
}

Decision Supervisor::climb(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
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

void Supervisor::find_hazard(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
  hazard_.clear();
  if (now - state.position_stamp > settings_.stale_state) {
    hazard_ = "the vehicle's position is stale";
  } else if (now - state.heartbeat_stamp > kHeartbeatLost) {
    hazard_ = "the autopilot's heartbeat is missing";
  } else if (failsafe_since_ >= 0.0) {
    hazard_ = "the autopilot's failsafe flies, mode " + std::string(vehicle::to_string(state.mode));
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

Decision Supervisor::fly(double now, const vehicle::VehicleState& state, const FlightPicture& picture) {
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

}  // namespace jink::bridge::supervisor
