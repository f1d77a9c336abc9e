// SPDX-License-Identifier: BSD-3-Clause
// The companion loop: tracks and state in, plan, setpoints out. The same code flies in `fly` and in `replay`.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/companion/planner_task.hpp"
#include "bridge/setpoints/setpoint_stream.hpp"
#include "bridge/supervisor/supervisor.hpp"
#include "bridge/team/team.hpp"
#include "bridge/tracking/track_source.hpp"
#include "bridge/tracking/track_table.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"

namespace jink::bridge::companion {

/// Who wants to know what the companion does: the flight log, the live line. Called from the loop, unlocked; times are
/// the companion's clock. Must not block.
class FlightObserver {
 public:
  virtual ~FlightObserver() = default;
  virtual void on_state(double, const vehicle::VehicleState&) {}
  virtual void on_tracks(double, const std::vector<planner::base::Track>&) {}
  virtual void on_plan(double, const PlanResult&) {}
  virtual void on_setpoint(double, const vehicle::Setpoint&) {}
  virtual void on_event(double, std::string_view /*name*/, const std::string& /*detail*/) {}
};

/// p50, p99 and largest of a set of durations, ms; empty where there is none.
struct Percentiles {
  double p50 = 0.0, p99 = 0.0, max = 0.0;
};
std::optional<Percentiles> percentiles(std::vector<double> values);

/// A time in which the vehicle braked though nobody ended the flight.
struct HazardRecord {
  std::string what;
  double t = 0.0;         ///< companion's clock
  double duration = 0.0;  ///< s; until the end of the flight where it did not pass
};

/// What a flight amounts to, as the companion saw it.
struct FlightSummary {
  supervisor::Outcome outcome = supervisor::Outcome::kNone;
  std::string reason;
  supervisor::MissingPeer missing_peer = supervisor::MissingPeer::kNone;
  double flight_time = 0.0;  ///< from the take-off height (or engagement in the air) to the end of the flight
  double path_length = 0.0;  ///< flown in that time, by the autopilot's estimate
  double straight_length = 0.0;
  double max_speed = 0.0;
  double largest_tracking_error = 0.0;  ///< distance from the reference
  double largest_margin = 0.0;          ///< that the planner was asked for
  std::uint64_t estimate_resets = 0;    ///< jumps of the autopilot's position estimate, by which the plan was shifted
  std::vector<HazardRecord> hazards;
  std::uint64_t plans = 0;
  std::uint64_t blocked_plans = 0;
  std::uint64_t deadline_misses = 0;
  std::uint64_t dropped_tracks = 0;
  std::vector<double> plan_ms;
  std::vector<double> track_to_setpoint_ms;
};

struct CompanionParts {
  vehicle::VehicleLink& link;
  tracking::TrackSource& tracks;
  PlannerTask& planner;
  std::vector<FlightObserver*> observers;
  const base::Clock* clock =
      nullptr;  ///< the one that step() is told; to measure what a step takes. Null: virtual time
  team::IntentTransport* intents = nullptr;  ///< to and from the team's other vehicles; null: there are none
};

/// Owns the state of the flight; the parts outlive it. Not thread-safe: step() from one thread.
class Companion {
 public:
  Companion(const config::Mission& mission, const config::Settings& settings, CompanionParts parts);

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
  static constexpr double kLostReference =
      1.2;  // m from the reference, beyond which plans start at the vehicle instead

  void take_tracks(double now);
  void take_plan(double now);
  void start_plan(double now);
  void move(double now, const supervisor::Decision& decision);
  void brake(double now);
  void planner_failed(double now, const std::exception& failure);
  void notice_stall(double now);
  void take_state(double now);
  void measure(double now);
  void record_hazard(double now);
  [[nodiscard]] int lost_writers(double now);
  [[nodiscard]] bool stuck(double now);
  void announce(double now);
  void next_waypoint(double now);
  [[nodiscard]] supervisor::FlightPicture picture(double now);
  [[nodiscard]] double heading(double now);
  [[nodiscard]] planner::base::Box volume(const Vec3& start, const Vec3& target) const;
  [[nodiscard]] double margin() const;
  void announce_tracks(double now);
  void announce_vehicle(double now);
  void event(double now, std::string_view name, const std::string& detail);

  config::Mission mission_;
  config::Settings settings_;
  CompanionParts parts_;
  supervisor::Supervisor supervisor_;
  tracking::TrackTable table_;
  std::optional<team::Team> team_;  // where the mission wants it and there is a transport
  setpoints::SetpointStream stream_;
  vehicle::VehicleState state_;
  Vec3 takeoff_point_ = Vec3::Zero();
  std::size_t waypoint_ = 0;  // the one flown to
  double last_plan_begun_ = -1.0;
  bool new_tracks_ = false;  // since then
  double last_sent_ = -1.0;
  bool new_plan_ = false;  // since then
  double newest_plan_ = -1.0;
  std::optional<double>
      unsent_track_;  // reception of the newest track in a plan whose first setpoint is still to be sent
  double unsent_from_ = 0.0;
  double yaw_ = 0.0;
  bool yaw_known_ = false;
  double last_step_ = -1.0;
  std::uint32_t estimate_resets_ = 0;  // that have been dealt with
  std::uint32_t reboots_ = 0;          // likewise
  Vec3 estimate_shift_ = Vec3::Zero();
  double tracking_error_ = 0.0;  // the largest of late, forgotten slowly
  bool planner_failed_ = false;
  bool announced_cautious_ = false;
  bool announced_stuck_ = false;
  double nearest_ = planner::base::kInfinity;  // that the vehicle came to its waypoint, m
  double gained_at_ = 0.0;                     // when
  bool announced_lost_ = false;
  tracking::TrackTableCounts announced_table_;
  int announced_own_ = 0;
  std::uint64_t announced_malformed_ = 0;
  int most_writers_ = 0;        // live at once in this flight
  double unsent_since_ = -1.0;  // setpoints; negative: they go out
  bool announced_margin_ = false;
  vehicle::BatteryState announced_battery_ = vehicle::BatteryState::kUnknown;
  supervisor::Phase announced_phase_ = supervisor::Phase::kDone;
  std::string announced_waiting_, announced_hazard_;
  tracking::TrackSourceStatus announced_tracks_;
  planner::verify::PlanStatus announced_status_ = planner::verify::PlanStatus::kInvalid;
  std::optional<Vec3> last_position_;
  double flight_began_ = -1.0;
  FlightSummary summary_;
};

}  // namespace jink::bridge::companion
