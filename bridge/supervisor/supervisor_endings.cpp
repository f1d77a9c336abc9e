// SPDX-License-Identifier: BSD-3-Clause
// How a flight ends that had begun: taken over by a pilot or a failsafe, handed over in HOLD, landed.
#include <string>
#include <utility>

#include "bridge/supervisor/supervisor.hpp"

namespace jink::bridge::supervisor {
namespace {

constexpr double kShortestStop = 0.3;     // s, of braking before a hand-over
constexpr double kLongestStop = 4.0;      // s
constexpr double kLandingTimeout = 90.0;  // s

using Motion = Decision::Motion;

bool grounded(const vehicle::VehicleState& state) {
  return !state.armed && !state.in_air;
}

std::string named(vehicle::FlightMode mode) {
  return "mode " + std::string(vehicle::to_string(mode));
}

// The heartbeat that says CRITICAL may come a second after the mode that was not asked for.
bool failsafe_flies(const vehicle::VehicleState& state) {
  using vehicle::FlightMode;
  return state.failsafe || (state.intended_mode == FlightMode::kOffboard && state.mode != FlightMode::kOffboard);
}

// Into a mode that waits for the sticks, and there are some, or that somebody asked for who is not jink.
bool pilots(const vehicle::VehicleState& state) {
  const vehicle::FlightMode intended = state.intended_mode;
  const bool ours = intended == vehicle::FlightMode::kUnknown || intended == vehicle::FlightMode::kOffboard ||
                    intended == vehicle::FlightMode::kHold || intended == vehicle::FlightMode::kLand ||
                    intended == vehicle::FlightMode::kReturn;
  return !flies_by_itself(state.mode) && (state.remote_control || !ours);
}

// It is in a mode that was not asked for, by nobody's wish but the autopilot's own.
bool by_failsafe(const vehicle::VehicleState& state) {
  const bool told = state.intended_mode != vehicle::FlightMode::kUnknown;
  return told ? state.intended_mode != state.mode : state.failsafe;
}

std::string failsafe_words(const vehicle::VehicleState& state) {
  return "the autopilot's failsafe took over, " + named(state.mode) + (pilots(state) ? ", and left to the pilot" : "");
}

std::string takeover_words(const vehicle::VehicleState& state) {
  return "the mode was changed to " + std::string(vehicle::to_string(state.mode)) + " by pilot or autopilot";
}

// With what it has come to instead of what was asked for.
Ending ended_in(Ending ending, bool returns, const vehicle::VehicleState& state) {
  if (state.mode == (returns ? vehicle::FlightMode::kReturn : vehicle::FlightMode::kHold)) return ending;
  ending.reason += "; then " + (by_failsafe(state) ? failsafe_words(state) : takeover_words(state));
  if (by_failsafe(state)) ending.outcome = Outcome::kAborted;
  return ending;
}

}  // namespace

Ending Supervisor::ending_with(const std::string& what) const {
  const Ending* begun = ending_of(phase_);
  if (begun == nullptr) return {Outcome::kAborted, what, {}};
  Ending ending = *begun;
  ending.reason += (ending.reason.empty() ? "" : "; then ") + what;
  return ending;
}

bool Supervisor::ended_by_mode(const Input& in) {
  switch (mode_changes_.judge(in.now, phase(), flight_began_.has_value(), in.state)) {
    case ModeChange::kNone:
    case ModeChange::kFailsafePasses:
      return false;
    case ModeChange::kFailsafe:
      return left_to_failsafe(in);
    case ModeChange::kTakeover:
      finish(ending_with(takeover_words(in.state)));
      return true;
    case ModeChange::kDisarmed:
      finish(ending_with("the autopilot disarmed in flight"));
      return true;
  }
  return false;
}

// True where the failsafe has the vehicle for good; otherwise HOLD is asked for.
bool Supervisor::left_to_failsafe(const Input& in) {
  Ending ending = ending_with(failsafe_words(in.state));
  hazard_.clear();
  if (pilots(in.state) || flies_by_itself(in.state.mode)) {
    finish(std::move(ending));
    return true;
  }
  const auto* before = std::get_if<Handover>(&phase_);
  const bool landing_interrupted = before != nullptr && before->landing_interrupted;
  phase_ = Handover{in.now, std::move(ending), landing_interrupted, /*rescue=*/true};
  return false;
}

Decision Supervisor::step(Stopping& phase, const Input& in) {
  const double stopping = in.now - phase.since;
  const bool stopped = !in.state.in_air || stopping > kLongestStop || (in.flight.at_rest && stopping > kShortestStop);
  if (!stopped) return {Motion::kBrake, {}};
  const bool lost = !in.state.local_position_ok || in.state.gps_lost;  // RETURN needs a position
  if (phase.then == config::EndsIn::kReturn && lost) phase.then = config::EndsIn::kLand;
  // In HOLD its motors would run on, a hand's breadth above the ground or on it, for as long as nobody comes.
  if (in.flight.nearly_down) phase.then = config::EndsIn::kLand;
  const bool ours = in.state.armed && in.state.mode == vehicle::FlightMode::kOffboard;
  if (phase.then == config::EndsIn::kLand && ours) {
    phase_ = Landing{in.now, std::move(phase.ending), /*forced=*/true};
  } else {
    Handover handover{in.now, std::move(phase.ending)};
    handover.returns = phase.then == config::EndsIn::kReturn && in.state.in_air;
    phase_ = std::move(handover);
  }
  return {Motion::kBrake, {}};
}

// Out of a failsafe that only sinks. Without a position HOLD cannot be flown, and the failsafe is what is left.
Decision Supervisor::rescue(Handover& phase, const Input& in) {
  const auto& [now, state, flight] = in;
  std::string& reason = phase.ending.reason;
  if (state.mode == vehicle::FlightMode::kOffboard) {  // it went back by itself: the stream was still on its way
    phase.rescue = false;
    return {Motion::kBrake, phase.request.ask(vehicle::Command::kHold, now, state)};
  }
  if (failsafe_flies(state) && !flies_by_itself(state.mode) && !grounded(state) && !pilots(state)) {
    if (!state.local_position_ok) {
      reason += "; without a position there is no HOLD, the failsafe has the vehicle";
    } else if (flight.nearly_down) {
      reason += "; it is nearly down, the failsafe lands it";
    } else if (phase.request.exhausted(now, state)) {
      const std::string refusal = phase.request.refusal();
      reason +=
          "; HOLD was not to be had" + (refusal.empty() ? "" : " (" + refusal + ")") + ", the failsafe has the vehicle";
    } else {
      return {Motion::kNone, phase.request.ask(vehicle::Command::kHold, now, state)};
    }
  }
  finish(std::move(phase.ending));
  return {};
}

Decision Supervisor::step(Handover& phase, const Input& in) {
  if (phase.rescue) return rescue(phase, in);
  const auto& [now, state, flight] = in;
  Ending& ending = phase.ending;
  // PX4 says of whatever is disarmed that it has landed.
  const bool up = ending.outcome == Outcome::kReached || !(flight.nearly_down || phase.landing_interrupted);
  if (!state.armed && flight_began_ && up) {
    ending.outcome = Outcome::kAborted;
    ending.reason += "; then the autopilot disarmed in flight";
    finish(std::move(ending));
    return {};
  }
  const bool offboard = state.mode == vehicle::FlightMode::kOffboard;
  const bool landing = phase.landing_interrupted && state.mode == vehicle::FlightMode::kLand;
  const Motion motion = landing                               ? Motion::kNone
                        : ending.outcome == Outcome::kReached ? Motion::kFollow
                                                              : Motion::kBrake;
  // Stopped while OFFBOARD or arming was asked for: whether that acted, only a newer heartbeat tells.
  const bool unsettled = ending.unsettled_until && state.heartbeat_stamp <= *ending.unsettled_until;
  if (unsettled && (offboard ? grounded(state) : !mode_changes_.offboard_seen())) {
    if (now - phase.since <= kHeartbeatTimeout) return {motion, {}};
    ending.reason += "; the autopilot's heartbeat is missing, whether it is in OFFBOARD is not known";
    finish(std::move(ending));
    return {};
  }
  if (failsafe_flies(state) && !offboard && !flies_by_itself(state.mode) && !pilots(state)) {
    ending.reason += "; then " + failsafe_words(state);
    ending.outcome = Outcome::kAborted;
    phase.rescue = true;
    return rescue(phase, in);
  }
  // What was asked for is there; or somebody chose another mode, and that stands.
  if ((!offboard && !landing) || grounded(state)) {
    if (!grounded(state) && mode_changes_.offboard_seen()) ending = ended_in(std::move(ending), phase.returns, state);
    finish(std::move(ending));
    return {};
  }
  if (phase.returns && phase.request.exhausted(now, state)) {
    const std::string refusal = phase.request.refusal();
    ending.reason += "; RETURN was not to be had" + (refusal.empty() ? "" : " (" + refusal + ")");
    phase.returns = false;
    phase.request = {};
  }
  if (phase.request.exhausted(now, state)) {
    if (ending.outcome == Outcome::kReached) ending.outcome = Outcome::kAborted;
    ending.reason += "; HOLD was never confirmed, the autopilot's own failsafe has the vehicle";
    finish(std::move(ending));
    return {};
  }
  // The stream goes on until HOLD is confirmed, so that the vehicle is never without an order.
  return {motion, phase.request.ask(phase.returns ? vehicle::Command::kReturn : vehicle::Command::kHold, now, state)};
}

Decision Supervisor::step(Landing& phase, const Input& in) {
  const auto& [now, state, flight] = in;
  const auto fail = [&](const std::string& what) {
    phase.ending.reason += ", but " + what;
    phase.ending.outcome = Outcome::kAborted;
  };
  const bool silent = now - state.heartbeat_stamp > kHeartbeatTimeout;
  if (grounded(state)) {
    finish(std::move(phase.ending));
    return {};
  }
  if (state.mode == vehicle::FlightMode::kLand) {
    phase.begun = true;
    const bool endless = !phase.leave && now - phase.since > kLandingTimeout;
    if (endless) fail(silent ? "the autopilot fell silent: whether it landed is not known" : "the landing did not end");
    if (endless || phase.leave) finish(std::move(phase.ending));
    return {};
  }
  // It has landed: with its motors PX4 leaves LAND for the mode before, and the heartbeat says so a second later.
  const bool touched_down = phase.begun && !state.in_air && now - phase.since <= kLandingTimeout;
  if (touched_down && state.mode == vehicle::FlightMode::kOffboard) return {};
  if (state.mode != vehicle::FlightMode::kOffboard) {
    fail(by_failsafe(state) ? failsafe_words(state) : "the landing was taken over: " + named(state.mode));
    finish(std::move(phase.ending));
    return {};
  }
  if (phase.request.exhausted(now, state)) {
    if (silent) {
      fail("the autopilot fell silent: whether it lands is not known");
      finish(std::move(phase.ending));
      return {};
    }
    const std::string refusal = phase.request.refusal();
    fail("the autopilot does not land" + (refusal.empty() ? "" : ": " + refusal));
    Handover next{now, std::move(phase.ending)};
    Decision decision{Motion::kBrake, next.request.ask(vehicle::Command::kHold, now, state)};
    phase_ = std::move(next);
    return decision;
  }
  return {phase.forced ? Motion::kBrake : Motion::kFollow, phase.request.ask(vehicle::Command::kLand, now, state)};
}

}  // namespace jink::bridge::supervisor
