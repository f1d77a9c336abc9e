// SPDX-License-Identifier: BSD-3-Clause
// The phases of a flight, each with the data that only it has.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "bridge/supervisor/command_request.hpp"
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

/// How a flight ends that has been stopped; what else happens until it is over is added to the reason.
struct Ending {
  Outcome outcome = Outcome::kNone;
  std::string reason;
  /// A request of before the stop may act until then: an older heartbeat says nothing of it.
  std::optional<double> unsettled_until;
};

struct Waiting {
  static constexpr Phase kPhase = Phase::kWaiting;
  MissingPeer absent = MissingPeer::kNone;  ///< who is waited for; kNone: the autopilot's health
  std::optional<double> since;              ///< for that; none: before the first step
  std::optional<double> ready_since{};      ///< but for what the autopilot may never tell
  std::optional<double> heard_since{};      ///< the autopilot
};
struct Engaging {
  static constexpr Phase kPhase = Phase::kEngaging;
  CommandRequest request;
  std::optional<double> granted;          ///< when the autopilot granted OFFBOARD
  std::optional<double> not_ready_since;  ///< what was there when it was waited for is gone again
};
struct Climbing {
  static constexpr Phase kPhase = Phase::kClimbing;
  double since = 0.0;
};
struct Flying {
  static constexpr Phase kPhase = Phase::kFlying;
  double since = 0.0;
  std::optional<double> arrived{};  ///< when it first was at the target
  std::optional<double> at_end{};   ///< when it first was where the flight ends, which did not stay free
};
struct Stopping {
  static constexpr Phase kPhase = Phase::kStopping;
  double since = 0.0;
  Ending ending;
  config::EndsIn then = config::EndsIn::kHold;
};
struct Handover {
  static constexpr Phase kPhase = Phase::kHandover;
  double since = 0.0;
  Ending ending;
  bool landing_interrupted = false;  ///< the autopilot may be in LAND still
  bool rescue = false;               ///< out of a failsafe that sinks: HOLD without setpoints
  bool returns = false;              ///< RETURN is asked for, and HOLD where that is refused
  CommandRequest request = {};
};
struct Landing {
  static constexpr Phase kPhase = Phase::kLanding;
  double since = 0.0;
  Ending ending;
  bool forced = false;  ///< goes on whoever stops the flight
  bool leave = false;   ///< that was tried: the flight is over once the autopilot lands
  bool begun = false;   ///< the autopilot has been in LAND
  CommandRequest request = {};
};
struct Done {
  static constexpr Phase kPhase = Phase::kDone;
  Ending ending;
  MissingPeer missing_peer = MissingPeer::kNone;
};
using FlightPhase = std::variant<Waiting, Engaging, Climbing, Flying, Stopping, Handover, Landing, Done>;

[[nodiscard]] Phase phase_of(const FlightPhase& phase);
/// Null where the phase has none.
[[nodiscard]] const Ending* ending_of(const FlightPhase& phase);
[[nodiscard]] Ending* ending_of(FlightPhase& phase);
[[nodiscard]] CommandRequest* request_of(FlightPhase& phase);

}  // namespace jink::bridge::supervisor
