// SPDX-License-Identifier: BSD-3-Clause
// What endangers a flight, what is done about it at once, and how the flight ends for it: one table.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"

namespace jink::bridge::supervisor {

struct SupervisorSettings {
  double peer_timeout = 30.0;    ///< for the autopilot's first words and the first tracks
  double health_timeout = 60.0;  ///< from then on, for it to become armable
  double stale_state = 0.2;      ///< without a position, at which to brake
  double stale_plan = 0.3;       ///< age of the newest plan at which to brake
  double give_up = 3.0;          ///< braking for so long at a stretch, or twice that in pieces, ends the flight in HOLD
};

/// What the companion knows besides the vehicle's state.
struct FlightContext {
  std::optional<double> newest_tracks;  ///< reception of the newest track message, see Intake
  std::string silent_writer;            ///< of tracks, that the mission names; empty: there is none
  bool blind = false;                   ///< the mission wants clouds of points, and none has come for too long
  std::optional<double> newest_plan;    ///< when the newest plan was made
  int lost_writers = 0;         ///< writers of tracks that were live in this flight and are silent, not replaced
  double unsent_for = 0.0;      ///< s, for which setpoints could not be handed to the transport
  std::string misplaced;        ///< why the mission cannot be flown from where the vehicle is; empty: it can
  std::string danger{};         ///< why it is not to be flown with this autopilot, see danger(); empty: it may be
  bool ground_known = true;     ///< its height, if the mission counts from it
  bool low = false;             ///< clearly under min_height
  bool nearly_down = false;     ///< so low, or will be where it comes to rest, that it is to be set down, not held
  double outside = 0.0;         ///< m, beside or under the geofence, of a vehicle that was inside
  double above = 0.0;           ///< m, likewise above its top
  bool aircraft_comes = false;  ///< with people on board, to less than well clear
  bool cannot_follow = false;   ///< what is asked for at the least is more than the vehicle can do
  bool at_takeoff_height = false;
  bool overhead_free = true;                     ///< nothing comes into the way of a take-off
  bool at_target = false;                        ///< within the arrival tolerance of the last waypoint, slow
  bool at_end = false;                           ///< so where the flight ends: there, or low above where it lands
  bool leaves_end = false;                       ///< no plan stays there: it does not stay free
  bool at_rest = false;                          ///< the brake has done its work
  std::optional<vehicle::CommandReport> report;  ///< newest answer of the autopilot
};

/// What a hazard is found in.
struct Situation {
  double now = 0.0;
  const vehicle::VehicleState& state;
  const FlightContext& flight;
  const config::TrackPolicy& tracks;
  const SupervisorSettings& settings;
  bool failsafe = false;                    ///< the autopilot's failsafe flies
  std::optional<double> following_since{};  ///< plans; none: while climbing
};

struct Hazard {
  enum class Reaction {
    kBrake,  ///< while it lasts; where it does not pass, or comes again and again, the flight is ended
    kStop    ///< the flight is ended at once
  };
  std::string_view what;
  bool (*present)(const Situation& s);
  Reaction reaction;
  config::EndsIn config::Endings::*ends_in;
  bool names_mode = false;  ///< in its text
  bool decides = false;     ///< also how a flight ends that is being stopped for something else
};
/// In the order in which they count: the first that is present is told.
[[nodiscard]] std::span<const Hazard> hazards();
/// The first present with that reaction; null: none.
[[nodiscard]] const Hazard* find_hazard(Hazard::Reaction reaction, const Situation& situation);
/// The first present that decides.
[[nodiscard]] const Hazard* find_deciding(const Situation& situation);

/// The hazard for which a vehicle brakes, and for how long it has. Pure logic.
class HazardWatch {
 public:
  /// The last step's hazard, or its absence, lasted until `now`. To be called in each step.
  void advance(double now);
  /// What is present in this step; null: nothing.
  void see(const Hazard* hazard, const Situation& situation);
  void clear() { text_.clear(); }
  /// Empty: none.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Why the flight ends, where the hazard does not pass or comes again and again; empty: it goes on.
  [[nodiscard]] std::string given_up(double now, double give_up) const;

 private:
  std::string text_;
  std::optional<double> since_;
  std::optional<double> advanced_;
  double spent_ = 0.0;  // s, in hazards; forgotten at a third of the rate
};

}  // namespace jink::bridge::supervisor
