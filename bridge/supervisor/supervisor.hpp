// SPDX-License-Identifier: BSD-3-Clause
// The flight's state machine: what the vehicle is asked for, when, and why it ends. Pure logic: no transport, no clock.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "bridge/supervisor/flight_phases.hpp"
#include "bridge/supervisor/hazards.hpp"
#include "bridge/supervisor/mode_changes.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"

namespace jink::bridge::supervisor {

/// What the companion is to do in this step.
struct Decision {
  enum class Motion { kNone, kTakeoffPoint, kStay, kFollow, kBrake };
  Motion motion = Motion::kNone;  ///< kNone: send no setpoints
  std::optional<vehicle::Command> request;
};

/// Arms only where the autopilot says it is ready and never by force. Confirms arming and modes by the heartbeat, not
/// by an acknowledgement; asks again where nothing happened, a few times. Any mode change that was not asked for ends
/// the flight and the stream at once: a pilot's word is the last one. A failsafe of the autopilot is another matter: it
/// may pass when the setpoints arrive again, so it counts as a hazard first; where it stays, LAND, RETURN and HOLD are
/// left to it, and where it only sinks, HOLD is asked for, without setpoints, which would take it back to OFFBOARD.
/// What is nearly down is set down instead of held.
class Supervisor {
 public:
  Supervisor(const config::Mission& mission, const SupervisorSettings& settings)
      : mission_(mission), settings_(settings) {}

  /// One step at time `now` (non-decreasing).
  Decision update(double now, const vehicle::VehicleState& state, const FlightContext& flight);
  /// Ends the flight: brakes, hands over. On the ground it just ends.
  void stop(double now, Outcome outcome, std::string reason, config::EndsIn then = config::EndsIn::kHold);

  /// The autopilot began anew: ends the flight; of one that is being ended it says so.
  void began_anew(double now);

  [[nodiscard]] Phase phase() const { return phase_of(phase_); }
  [[nodiscard]] bool done() const { return std::holds_alternative<Done>(phase_); }
  /// kNone before it is done.
  [[nodiscard]] Outcome outcome() const { return done() ? ending_of(phase_)->outcome : Outcome::kNone; }
  /// Why the flight ends; empty before that.
  [[nodiscard]] std::string reason() const;
  [[nodiscard]] MissingPeer missing_peer() const;
  /// What is being waited for; for people. Empty: nothing.
  [[nodiscard]] const std::string& waiting_for() const { return waiting_for_; }
  /// Why the vehicle brakes though nobody ended the flight; empty: it does not.
  [[nodiscard]] const std::string& hazard() const { return hazard_.text(); }
  /// It has been at the target. Flying still, it holds near there, out of the way of what comes, until the target stays
  /// free or the time is over.
  [[nodiscard]] bool arrived() const;
  /// It has been at the target and is to stay there, config::Mission::hold_time.
  [[nodiscard]] bool holds(double now) const;
  /// When OFFBOARD flight began; none: not yet.
  [[nodiscard]] std::optional<double> flight_began() const { return flight_began_; }

 private:
  static constexpr double kHeartbeatTimeout = 3.0;  // s; PX4 sends one a second

  struct Input {
    double now;
    const vehicle::VehicleState& state;
    const FlightContext& flight;
  };
  /// One step of each phase. It may replace the phase: what it was given is not to be touched after that.
  Decision step(Waiting& phase, const Input& in);
  Decision step(Engaging& phase, const Input& in);
  Decision step(Climbing& phase, const Input& in);
  Decision step(Flying& phase, const Input& in);
  Decision step(Stopping& phase, const Input& in);
  Decision step(Handover& phase, const Input& in);
  Decision step(Landing& phase, const Input& in);
  static Decision step(Done&, const Input&) { return {}; }
  Decision rescue(Handover& phase, const Input& in);

  /// True: the mode changed hands, and the flight is over.
  bool ended_by_mode(const Input& in);
  bool left_to_failsafe(const Input& in);
  /// The ending that has begun, or else that of an aborted flight, with `what` added to its reason.
  [[nodiscard]] Ending ending_with(const std::string& what) const;
  void abort(const std::string& reason) { phase_ = Done{{Outcome::kAborted, reason, {}}}; }
  void finish(Ending ending) { phase_ = Done{std::move(ending)}; }

  [[nodiscard]] Situation situation(const Input& in, std::optional<double> following_since = {}) const;
  void stop_for_hazard(const Input& in);
  /// Takes in what is present. True: the vehicle is to brake, and the flight ends where that has lasted too long.
  bool brakes_for_hazard(const Input& in, std::optional<double> following_since = {});
  /// What a flight cannot begin without, into waiting_for_; returns whom that is about.
  MissingPeer find_missing(const Input& in);
  /// Which of two aircraft is meant nobody knows, in words; empty: it is known.
  [[nodiscard]] std::string ambiguity(const vehicle::VehicleState& state) const;

  config::Mission mission_;
  SupervisorSettings settings_;
  FlightPhase phase_;
  ModeChanges mode_changes_;
  HazardWatch hazard_;
  std::optional<double> flight_began_;
  std::string waiting_for_;
  bool nearly_down_ = false;  // as of the last step
};

}  // namespace jink::bridge::supervisor
