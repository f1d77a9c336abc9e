// SPDX-License-Identifier: BSD-3-Clause
// The flight's state machine: what the vehicle is asked for, when, and why it ends. Pure logic: no transport, no clock.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"

namespace jink::bridge::supervisor {

enum class Phase {
  kWaiting,   ///< for autopilot, health, tracks
  kEngaging,  ///< setpoints stream; OFFBOARD is asked for, then arming
  kClimbing,  ///< take-off, in OFFBOARD
  kFlying,    ///< follows plans
  kStopping,  ///< brakes, then hands over
  kHandover,  ///< HOLD is asked for
  kLanding,   ///< NAV_LAND is asked for and watched
  kDone
};
std::string_view to_string(Phase phase);

/// How a flight ended; the names of contracts' flight summary.
enum class Outcome { kNone, kReached, kCollision, kTimeout, kLeftWorld, kStartBlocked, kAborted };
std::string_view to_string(Outcome outcome);

/// Who did not show up within the time-out, for exit code 3.
enum class MissingPeer { kNone, kAutopilot, kTracks };

struct SupervisorSettings {
  double peer_timeout = 30.0;    ///< for the autopilot's first words and the first tracks
  double health_timeout = 60.0;  ///< from then on, for it to become armable
  double stale_state = 0.2;      ///< age of the position at which to brake
  double stale_plan = 0.3;       ///< age of the newest plan at which to brake
  double give_up = 3.0;          ///< braking for so long at a stretch, or twice that in pieces, ends the flight in HOLD
};

/// What the companion knows besides the vehicle's state.
struct FlightPicture {
  double newest_tracks = -1.0;  ///< reception of the newest track message; negative: never
  double newest_plan = -1.0;    ///< when the newest plan was made; negative: none
  int lost_writers = 0;         ///< writers of tracks that were live in this flight and are silent, not replaced
  double unsent_for = 0.0;      ///< s, for which setpoints could not be handed to the transport
  bool at_takeoff_height = false;
  bool at_target = false;                        ///< within the arrival tolerance of the last waypoint, slow
  bool at_rest = false;                          ///< the brake has done its work
  std::optional<vehicle::CommandReport> report;  ///< newest answer of the autopilot
};

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
class Supervisor {
 public:
  Supervisor(const config::Mission& mission, const SupervisorSettings& settings)
      : mission_(mission), settings_(settings) {}

  /// One step at time `now` (non-decreasing).
  Decision update(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  /// Ends the flight: brakes, hands over to HOLD. On the ground it just ends.
  void stop(double now, Outcome outcome, std::string reason);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool done() const { return phase_ == Phase::kDone; }
  [[nodiscard]] Outcome outcome() const { return outcome_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] MissingPeer missing_peer() const { return missing_peer_; }
  /// What is being waited for; for people. Empty: nothing.
  [[nodiscard]] const std::string& waiting_for() const { return waiting_for_; }
  /// Why the vehicle brakes though nobody ended the flight; empty: it does not.
  [[nodiscard]] const std::string& hazard() const { return hazard_; }
  /// When OFFBOARD flight began; negative: not yet.
  [[nodiscard]] double flight_began() const { return flight_began_; }

 private:
  static constexpr double kHeartbeatTimeout = 3.0;  // s; PX4 sends one a second
  // s, in flight: a link that loses every fifth packet loses three heartbeats in a row twice in five minutes.
  static constexpr double kHeartbeatLost = 5.0;

  void enter(Phase phase, double now);
  void finish(Outcome outcome, std::string reason);
  std::optional<vehicle::Command> ask(vehicle::Command command, double now, const vehicle::VehicleState& state);
  Decision wait(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  Decision engage(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  Decision climb(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  Decision fly(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  Decision hand_over(double now, const vehicle::VehicleState& state);
  Decision land(double now, const vehicle::VehicleState& state);
  Decision rescue(double now, const vehicle::VehicleState& state);
  Decision fall_back(double now);
  void flee_battery(double now, const vehicle::VehicleState& state);
  [[nodiscard]] bool exhausted(double now, const vehicle::VehicleState& state) const;
  void find_missing(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  void find_hazard(double now, const vehicle::VehicleState& state, const FlightPicture& picture);
  bool taken_over(double now, const vehicle::VehicleState& state);
  bool failsafe_took_over(double now, const vehicle::VehicleState& state);
  bool outside_fence(const vehicle::VehicleState& state);

  config::Mission mission_;
  SupervisorSettings settings_;
  Phase phase_ = Phase::kWaiting;
  double entered_ = -1.0;  // the phase
  double began_ = -1.0;    // the first update
  double flight_began_ = -1.0;
  double hazard_since_ = -1.0;
  double hazard_time_ = 0.0;      // s, spent in hazards; forgotten at a third of the rate
  double updated_ = -1.0;         // the last update
  double failsafe_since_ = -1.0;  // of the autopilot
  bool rescue_ = false;           // out of a failsafe that sinks: HOLD without setpoints
  bool land_ = false;             // the stop ends in a landing, not in HOLD
  bool landing_interrupted_ = false;
  bool leave_landing_ = false;  // once it has begun
  double granted_ = -1.0;       // when the autopilot granted OFFBOARD; negative: not yet
  double absent_since_ = -1.0;  // who is waited for
  MissingPeer absent_before_ = MissingPeer::kNone;
  double asked_ = -1.0;  // the newest request
  std::optional<vehicle::Command> asked_for_;
  int tries_ = 0;
  vehicle::FlightMode mode_before_ = vehicle::FlightMode::kUnknown;  // when OFFBOARD was first asked for
  bool offboard_seen_ = false;                                       // the heartbeat confirmed OFFBOARD since we asked
  double unsettled_until_ = -1.0;            // a request may act until then: an older heartbeat says nothing of it
  double not_ready_since_ = -1.0;            // while engaging
  MissingPeer absent_ = MissingPeer::kNone;  // whom waiting_for_ is about
  Outcome outcome_ = Outcome::kNone;
  Outcome pending_outcome_ = Outcome::kNone;  // once the hand-over is through
  std::string reason_;
  std::string refusal_;  // the autopilot's last no
  std::string waiting_for_;
  std::string hazard_;
  MissingPeer missing_peer_ = MissingPeer::kNone;
};

}  // namespace jink::bridge::supervisor
