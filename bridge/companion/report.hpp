// SPDX-License-Identifier: BSD-3-Clause
// What the companion says of a flight, and keeps of it: its events and its summary.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridge/companion/intake.hpp"
#include "bridge/companion/planner_task.hpp"
#include "bridge/map/clouds.hpp"
#include "bridge/map/mapper.hpp"
#include "bridge/supervisor/supervisor.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"
#include "planner/horizon/contingency.hpp"

namespace jink::bridge::companion {

/// Who wants to know what the companion does: the flight log, the progress line. Called from the loop, unlocked; times
/// are the companion's clock. Must not block.
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
  double flight_time = 0.0;  ///< from the take-off height (or engagement in the air) to the target, else to the end
  double path_length = 0.0;  ///< flown in that time, by the autopilot's estimate
  double straight_length = 0.0;
  double max_speed = 0.0;
  double largest_tracking_error = 0.0;  ///< distance from the reference
  double largest_margin = 0.0;          ///< that the planner was asked for
  std::optional<Vec3> end_estimate;     ///< newest position told; its height drifts and is none above the ground
  std::uint64_t estimate_resets = 0;    ///< jumps of the autopilot's position estimate, by which the plan was shifted
  std::vector<HazardRecord> hazards;
  std::uint64_t plans = 0;
  std::uint64_t blocked_plans = 0;
  std::uint64_t deadline_misses = 0;
  std::uint64_t dropped_tracks = 0;
  std::uint64_t clouds = 0;          ///< of points, that the map was made of
  std::uint64_t dropped_clouds = 0;  ///< refused, malformed, or not to be placed
  std::vector<double> plan_ms;
  std::vector<double> track_to_setpoint_ms;
};

/// Tells the observers and sums up. What lasts is said when it changes: nothing happens silently, and nothing is said
/// fifty times a second. Not thread-safe.
class FlightReporter {
 public:
  /// `margin`: that of the settings, which plans keep where tracking is good.
  FlightReporter(const config::Mission& mission, double margin, std::vector<FlightObserver*> observers)
      : mission_(mission), margin_(margin), observers_(std::move(observers)) {}

  void event(double now, std::string_view name, const std::string& detail);

  // What comes in and goes out, each time.
  void state(double now, const vehicle::VehicleState& state);
  void tracks(double now, const std::vector<planner::base::Track>& tracks);
  void plan(double now, const PlanResult& result);
  void setpoint(double now, const vehicle::Setpoint& setpoint);
  void stops(double now, const planner::horizon::Stop& stop);
  void stall(double now, double duration, const std::string& text);
  void estimate_reset(double now, const Vec3& shift);
  /// In flight: the way from the last call's position.
  void flown(double now, const vehicle::VehicleState& state);
  void hazard_lasts(double now, const std::string& hazard);

  // What lasts, each time that it is looked at.
  void reference_lost(double now, bool lost, double error, double share);
  void cautious(double now, bool cautious);
  /// `risk`: probability to be hit on the way.
  void retreats(double now, const std::optional<Vec3>& refuge, double risk);
  void stuck(double now, bool stuck);
  void unseen(double now, bool stays);
  void sending(double now, bool works);
  void aircraft(double now, const std::optional<Intake::Approach>& approach);
  /// What became of clouds of points: those refused, or of a time at which it is not known where the vehicle was.
  void clouds(double now, const map::CloudSourceStatus& source, std::uint64_t unplaced, const map::MapperCounts& map);
  /// At the end of a step: what changed in it. `margin` is the planner's, for `tracking_error`.
  void announce(double now, const supervisor::Supervisor& supervisor, Intake& intake, double margin,
                double tracking_error);

  /// The figures that others measure.
  FlightSummary& summary() { return summary_; }
  [[nodiscard]] const FlightSummary& summary() const { return summary_; }

 private:
  /// What was last said.
  struct Said {
    supervisor::Phase phase = supervisor::Phase::kDone;
    std::string waiting, hazard;
    planner::verify::PlanStatus plan_status = planner::verify::PlanStatus::kInvalid;
    bool evades = false, reference_lost = false, cautious = false, retreats = false, stuck = false, unseen = false,
         arrived = false, holds = false, sending = true, margin = false;
    vehicle::BatteryState battery = vehicle::BatteryState::kUnknown;
    tracking::TrackSourceStatus sources;
    map::CloudSourceStatus clouds;
    std::uint64_t unplaced = 0;
    std::optional<double> clouds_at;
    tracking::TrackTableCounts table;
    std::uint64_t elsewhere = 0;
    std::set<std::uint32_t> aircraft;
    int own_tracks = 0;
    std::optional<double> at;
  };
  void announce_phase(double now, const supervisor::Supervisor& supervisor, const vehicle::VehicleState& state);
  void announce_vehicle(double now, const supervisor::Supervisor& supervisor, vehicle::BatteryState battery,
                        double margin, double tracking_error);
  void announce_tracks(double now, const tracking::TrackTable& table);

  const config::Mission& mission_;
  double margin_;
  std::vector<FlightObserver*> observers_;
  Said said_;
  FlightSummary summary_;
  std::optional<double> flight_began_;
  Vec3 last_position_ = Vec3::Zero();  // since then
};

}  // namespace jink::bridge::companion
