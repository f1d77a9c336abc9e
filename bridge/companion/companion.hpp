// SPDX-License-Identifier: BSD-3-Clause
// The companion loop: tracks and state in, plan, setpoints out. The same code flies in `fly` and in `replay`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/companion/intake.hpp"
#include "bridge/companion/motion.hpp"
#include "bridge/companion/planning.hpp"
#include "bridge/companion/report.hpp"
#include "bridge/companion/route.hpp"
#include "bridge/companion/sight.hpp"
#include "bridge/supervisor/supervisor.hpp"

namespace jink::bridge::companion {

struct CompanionParts {
  vehicle::VehicleLink& link;
  tracking::TrackSource& tracks;
  PlannerTask& planner;
  std::vector<FlightObserver*> observers;
  const base::Clock* clock =
      nullptr;  ///< the one that step() is told; to measure what a step takes. Null: virtual time
  team::IntentTransport* intents = nullptr;  ///< to and from the team's other vehicles; null: there are none
  map::CloudSource* clouds = nullptr;        ///< what a depth camera or a lidar sees; null: nothing does
};

/// Brings together what takes in, what plans, what moves and what reports; the supervisor decides. The parts outlive
/// it. Not thread-safe: step() from one thread.
class Companion {
 public:
  Companion(const config::Mission& mission, const config::Settings& settings, CompanionParts parts);
  Companion(const Companion&) = delete;  // its pieces refer to each other
  Companion& operator=(const Companion&) = delete;

  /// One turn of the loop, to be called at settings.companion.setpoint_rate_hz, and sooner where a track message or a
  /// plan has come: a plan goes on the wire at once, other setpoints keep the rate. Never blocks. False once it is
  /// over. What the planner throws ends the flight in HOLD, as Ctrl-C does, with its words as the reason.
  bool step(double now);
  /// Ends the flight as Ctrl-C does: brake, then HOLD.
  void interrupt(double now) { supervisor_.stop(now, supervisor::Outcome::kAborted, "interrupted"); }
  /// Ends the flight with an outcome that only the world knows (a collision in replay).
  void end(double now, supervisor::Outcome outcome, const std::string& reason) {
    supervisor_.stop(now, outcome, reason);
  }

  [[nodiscard]] const supervisor::Supervisor& supervisor() const { return supervisor_; }
  [[nodiscard]] FlightSummary summary() const;

 private:
  void notice_stall(double now);
  void take_state(double now);
  void take_tracks(double now);
  void take_clouds(double now);
  void take_plan(double now);
  [[nodiscard]] supervisor::FlightContext context(double now);
  void move(double now, double dt, const supervisor::Decision& decision);
  void stop_without_planner(double now);
  void stop(double now);
  [[nodiscard]] Vec3 end() const;
  [[nodiscard]] std::optional<Goal::Kind> goal_kind(supervisor::Decision::Motion motion) const;
  [[nodiscard]] Goal goal(double now, Goal::Kind kind);
  [[nodiscard]] bool overhead_free(double now);
  [[nodiscard]] Vec3 place_to_look_at(double now);
  void place_mission();
  void tell_beginning(double now);

  config::Mission given_;            // as it was written
  config::Mission mission_;          // in the local frame, see place_mission
  std::vector<std::string> raised_;  // of mission_'s waypoints, in words
  std::string misplaced_;            // why mission_ cannot be flown; empty: it can
  config::Settings settings_;
  vehicle::VehicleLink& link_;
  supervisor::Supervisor supervisor_;
  FlightReporter reporter_;
  Intake intake_;
  Intake::FrameChange frame_change_;  // in this turn
  Sight sight_;
  MotionControl motion_;
  double goes_on_ = 0.0;  // s, when the reference last led away from where the vehicle was
  Planning planning_;
  Route route_;
  std::optional<double> last_step_;
  std::optional<Goal::Kind> goal_;  // what is flown to; none: nothing by plans
  double stop_looked_at_ = -planner::base::kInfinity;
  double overhead_looked_at_ = -planner::base::kInfinity;
  bool was_inside_ = false;     // the geofence, in this flight
  bool overhead_free_ = false;  // then
};

}  // namespace jink::bridge::companion
