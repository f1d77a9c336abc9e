// SPDX-License-Identifier: BSD-3-Clause
// How a flight begins and goes on: waiting, engaging, climbing, flying.
#include "bridge/supervisor/supervisor.hpp"

#include <utility>

#include "bridge/base/text.hpp"
#include "bridge/supervisor/dangers.hpp"

namespace jink::bridge::supervisor {
namespace {

constexpr double kSettling = 0.3;       // s, within which a request acts; PX4 takes up to 15 ms
constexpr double kReadyAgain = 10.0;    // s, to become ready again between the first request and arming
constexpr double kClimbTimeout = 30.0;  // s
constexpr double kToldWithin = 3.0;     // s; PX4 tells its home every 2 s
constexpr double kOthersTime = 1.5;     // s, in which each autopilot says something; PX4 sends a heartbeat a second

using Motion = Decision::Motion;

}  // namespace

std::string Supervisor::reason() const {
  const Ending* ending = ending_of(phase_);
  return ending != nullptr ? ending->reason : std::string();
}

MissingPeer Supervisor::missing_peer() const {
  const Done* over = std::get_if<Done>(&phase_);
  return over != nullptr ? over->missing_peer : MissingPeer::kNone;
}

bool Supervisor::arrived() const {
  const Flying* flying = std::get_if<Flying>(&phase_);
  if (flying != nullptr) return flying->arrived.has_value();
  const Ending* ending = ending_of(phase_);
  return ending != nullptr && ending->outcome == Outcome::kReached;
}

bool Supervisor::holds(double now) const {
  const Flying* flying = std::get_if<Flying>(&phase_);
  return flying != nullptr && flying->arrived && now - *flying->arrived < mission_.hold_time;
}

void Supervisor::stop(double now, Outcome outcome, std::string reason, config::EndsIn then) {
  const Phase before = phase();
  if (before == Phase::kDone || before == Phase::kStopping || before == Phase::kHandover) return;
  auto* landing = std::get_if<Landing>(&phase_);
  if (landing != nullptr && (landing->forced || nearly_down_)) {  // once it has begun it goes on without us
    if (!landing->leave) landing->ending.reason += "; " + reason + ", the landing goes on";
    landing->ending.outcome = Outcome::kAborted;  // whether it ends nobody watches
    landing->leave = true;
    return;
  }
  waiting_for_.clear();
  hazard_.clear();
  Ending ending{outcome, std::move(reason), {}};
  if (landing != nullptr) {
    ending.unsettled_until = landing->ending.unsettled_until;
    phase_ = Handover{now, std::move(ending), /*landing_interrupted=*/true};
  } else if (before == Phase::kWaiting) {
    finish(std::move(ending));
  } else {
    const CommandRequest* request = request_of(phase_);
    if (request != nullptr && request->asked()) ending.unsettled_until = request->asked_at() + kSettling;
    phase_ = Stopping{now, std::move(ending), then};
  }
}

void Supervisor::began_anew(double now) {
  const std::string what = "the autopilot began anew: its local frame may be another";
  Ending* ending = phase() == Phase::kDone ? nullptr : ending_of(phase_);
  if (ending == nullptr) return stop(now, Outcome::kAborted, what);
  ending->outcome = Outcome::kAborted;
  ending->reason += "; then " + what;
}

Decision Supervisor::update(double now, const vehicle::VehicleState& state, const FlightContext& flight) {
  const Input in{now, state, flight};
  CommandRequest* request = request_of(phase_);
  if (request != nullptr && flight.report) request->answer(*flight.report);
  nearly_down_ = flight.nearly_down;
  hazard_.advance(now);
  if (ended_by_mode(in)) return {};
  stop_for_hazard(in);
  return std::visit([&](auto& phase) { return step(phase, in); }, phase_);
}

MissingPeer Supervisor::find_missing(const Input& in) {
  const vehicle::VehicleState& state = in.state;
  const bool autopilot = in.now - state.heartbeat_stamp < kHeartbeatTimeout;
  const bool tracks = !mission_.tracks.required ||
                      (in.flight.newest_tracks && in.now - *in.flight.newest_tracks < mission_.tracks.timeout_s);
  const bool position = state.motion.silence(in.now) < settings_.stale_state;
  const bool falls = state.in_air && !state.armed;  // by its word: it is not armed then
  const bool ready =
      position && state.local_position_ok && state.landed_state_known && !falls && (state.armed || state.armable);
  waiting_for_.clear();
  if (!autopilot) {
    waiting_for_ = "an autopilot's heartbeat on " + mission_.connection;
    if (mission_.system_id != 0) waiting_for_ += ", system " + std::to_string(mission_.system_id);
    return MissingPeer::kAutopilot;
  }
  if (!tracks) {
    const std::string& writer = in.flight.silent_writer;
    waiting_for_ = "obstacle tracks " + (writer.empty() ? std::string() : "of '" + writer + "' ") + "on DDS domain " +
                   std::to_string(mission_.dds_domain);
    return MissingPeer::kTracks;
  }
  if (in.flight.unsent_for > 0.0) {  // without them it is not ready
    waiting_for_ = "setpoints to be sent";
  } else if (!ready) {
    const std::string lacks = falls                      ? "disarmed in the air, it says"
                              : !state.health.empty()    ? state.health
                              : state.landed_state_known ? "local position"
                                                         : "landed state";
    waiting_for_ = "the autopilot to be ready: " + lacks;
  } else if (mission_.heights == config::Heights::kSea && !state.origin) {
    waiting_for_ = "the local origin's height above the sea";
  } else if (state.battery == vehicle::BatteryState::kLow || state.battery == vehicle::BatteryState::kCritical) {
    waiting_for_ = "a charged battery: it is " + std::string(vehicle::to_string(state.battery));
  } else if (in.flight.aircraft_comes && !state.in_air) {
    waiting_for_ = "a crewed aircraft to pass";
  } else if (!in.flight.overhead_free) {
    waiting_for_ = "the air above the vehicle to be free of obstacles";
  } else if (const Hazard* hazard = find_hazard(Hazard::Reaction::kBrake, situation(in));
             hazard != nullptr && !in.state.in_air) {  // it would brake as soon as it flies
    waiting_for_ = "this to pass: " + std::string(hazard->what);
  }
  return MissingPeer::kNone;
}

std::string Supervisor::ambiguity(const vehicle::VehicleState& state) const {
  if (mission_.system_id != 0 || state.other_system_id == 0) return {};
  return "systems " + std::to_string(state.system_id) + " and " + std::to_string(state.other_system_id) +
         " are autopilots on " + mission_.connection + ": the mission's system_id is to name one";
}

Decision Supervisor::step(Waiting& phase, const Input& in) {
  if (const std::string why = ambiguity(in.state); !why.empty()) {
    abort(why);
    return {};
  }
  const MissingPeer absent = find_missing(in);
  if (absent == MissingPeer::kAutopilot) phase.heard_since.reset();
  if (!phase.heard_since && absent != MissingPeer::kAutopilot) phase.heard_since = in.now;
  if (waiting_for_.empty() && mission_.system_id == 0 && !in.state.in_air && in.now - *phase.heard_since < kOthersTime)
    waiting_for_ = "other autopilots to speak up, as the mission names none (system_id)";
  const bool parameters_known = told(mission_, in.state.failsafe_parameters);
  if (waiting_for_.empty() && !(in.flight.ground_known && parameters_known)) {
    if (!phase.ready_since) phase.ready_since = in.now;
    if (in.now - *phase.ready_since < kToldWithin) {
      waiting_for_ = in.flight.ground_known ? "the autopilot's parameters, to know what its failsafe does"
                                            : "the autopilot's home, to know where the ground is";
    }
  }
  if (waiting_for_.empty()) {
    if (const std::string& why = in.flight.danger.empty() ? in.flight.misplaced : in.flight.danger; !why.empty()) {
      abort(why);
      return {};
    }
    mode_changes_.engage(in.state);
    phase_ = Engaging{};
    return {Motion::kStay, {}};
  }
  if (!phase.since || absent != phase.absent || in.flight.aircraft_comes) {  // which passes
    phase.absent = absent;
    phase.since = in.now;
  }
  const bool peer = absent != MissingPeer::kNone;
  if (in.now - *phase.since > (peer ? settings_.peer_timeout : settings_.health_timeout))
    phase_ = Done{{Outcome::kAborted, "waited in vain for " + waiting_for_, {}}, absent};
  return {};
}

Decision Supervisor::step(Engaging& phase, const Input& in) {
  const auto& [now, state, flight] = in;
  Decision decision{state.in_air ? Motion::kStay : Motion::kTakeoffPoint, {}};
  if (state.mode == vehicle::FlightMode::kOffboard && state.armed) {
    waiting_for_.clear();
    flight_began_ = now;
    // One that was taken over while it sank climbs first, too.
    phase_ = state.in_air && !flight.low ? FlightPhase(Flying{now}) : FlightPhase(Climbing{now});
    return decision;
  }
  if (std::string why = ambiguity(state); !why.empty()) {
    stop(now, Outcome::kAborted, std::move(why));
    return decision;
  }
  if (!flight.danger.empty()) {  // told late
    stop(now, Outcome::kAborted, flight.danger);
    return decision;
  }
  if (phase.request.exhausted(now, state)) {
    const std::string refusal = phase.request.refusal();
    const std::string request(vehicle::to_string(*phase.request.command()));
    stop(now, Outcome::kAborted,
         !refusal.empty()                                  ? refusal
         : now - state.heartbeat_stamp > kHeartbeatTimeout ? "the autopilot fell silent before it granted: " + request
                                                           : "the autopilot did not follow the request: " + request);
    return decision;
  }
  if (flight.report && flight.report->command == vehicle::Command::kOffboard && flight.report->accepted)
    phase.granted = now;
  if (state.mode != vehicle::FlightMode::kOffboard) {
    // It was there, by the autopilot's word, and is no more: somebody took it back.
    if (state.armed && phase.granted && state.heartbeat_stamp > *phase.granted + kSettling && !state.failsafe) {
      abort("OFFBOARD was granted and taken back: mode " + std::string(vehicle::to_string(state.mode)));
      return {};
    }
    decision.request = phase.request.ask(vehicle::Command::kOffboard, now, state);
    return decision;
  }
  // What was there when it was waited for may be gone again.
  find_missing(in);
  const bool plans = in.now - flight.newest_plan.value_or(-planner::base::kInfinity) <= settings_.stale_plan;
  if (waiting_for_.empty() && !plans && !state.in_air && !state.armed) waiting_for_ = "the planner to plan";
  if (waiting_for_.empty()) {
    phase.not_ready_since.reset();
    decision.request = phase.request.ask(vehicle::Command::kArm, now, state);
    return decision;
  }
  decision.motion = Motion::kStay;  // whether it is armed may only be told later
  if (!phase.not_ready_since) phase.not_ready_since = now;
  if (now - *phase.not_ready_since > kReadyAgain) stop(now, Outcome::kAborted, "waited in vain for " + waiting_for_);
  return decision;
}

Situation Supervisor::situation(const Input& in, std::optional<double> following_since) const {
  return {in.now, in.state, in.flight, mission_.tracks, settings_, mode_changes_.failsafe(), following_since};
}

// What ends a flight at once; and how it ends, where it is being stopped already, for whatever else.
void Supervisor::stop_for_hazard(const Input& in) {
  const Hazard* hazard = find_hazard(Hazard::Reaction::kStop, situation(in));
  if (hazard != nullptr && (phase() == Phase::kClimbing || phase() == Phase::kFlying))
    stop(in.now, Outcome::kAborted, std::string(hazard->what), mission_.endings.*hazard->ends_in);
  const Hazard* deciding = find_deciding(situation(in));
  auto* stopping = std::get_if<Stopping>(&phase_);
  if (deciding == nullptr || stopping == nullptr) return;
  const config::EndsIn then = mission_.endings.*deciding->ends_in;
  if (then == stopping->then || stopping->then == config::EndsIn::kLand) return;
  stopping->then = then;
  stopping->ending.reason += "; then " + std::string(deciding->what);
}

bool Supervisor::brakes_for_hazard(const Input& in, std::optional<double> following_since) {
  const Situation now = situation(in, following_since);
  const Hazard* hazard = find_hazard(Hazard::Reaction::kBrake, now);
  hazard_.see(hazard, now);
  if (hazard == nullptr) return false;
  if (const std::string why = hazard_.given_up(in.now, settings_.give_up); !why.empty())
    stop(in.now, Outcome::kAborted, why, mission_.endings.*hazard->ends_in);
  return true;
}

Decision Supervisor::step(Climbing& phase, const Input& in) {
  if (brakes_for_hazard(in, phase.since)) return {Motion::kBrake, {}};
  if (in.state.in_air && in.flight.at_takeoff_height) {
    phase_ = Flying{in.now};
    return {Motion::kFollow, {}};
  }
  if (in.now - phase.since > kClimbTimeout) {
    stop(in.now, Outcome::kAborted, "the take-off height was not reached");
    return {Motion::kBrake, {}};
  }
  return {Motion::kTakeoffPoint, {}};
}

Decision Supervisor::step(Flying& phase, const Input& in) {
  // Where the vehicle was is no proof of where it is.
  const bool sure = in.state.motion.silence(in.now) <= settings_.stale_state && !mode_changes_.failsafe();
  if (sure && in.flight.at_target && !phase.arrived) phase.arrived = in.now;
  if (sure && phase.arrived && !holds(in.now) && in.flight.at_end && !phase.at_end) phase.at_end = in.now;
  if (sure && phase.at_end && in.flight.at_end && !in.flight.leaves_end && !in.flight.aircraft_comes) {
    hazard_.clear();
    const double held = in.now - *phase.at_end;
    Ending ending{Outcome::kReached, "target reached" + (held > 0.0 ? ", free after " + base::seconds(held) : ""), {}};
    if (mission_.arrival == config::Arrival::kLand) {
      phase_ = Landing{in.now, std::move(ending)};
    } else {
      phase_ = Handover{in.now, std::move(ending)};
    }
    return {Motion::kFollow, {}};
  }
  if (in.now - *flight_began_ > mission_.time_limit) {
    if (phase.arrived) {
      stop(in.now, Outcome::kReached,
           holds(in.now) ? "target reached, but the time limit passed before its hold_time"
                         : "target reached, but it did not stay free within the time limit");
    } else {
      stop(in.now, Outcome::kTimeout, "the time limit passed before the target was reached");
    }
    return {Motion::kBrake, {}};
  }
  return {brakes_for_hazard(in, phase.since) ? Motion::kBrake : Motion::kFollow, {}};
}

}  // namespace jink::bridge::supervisor
