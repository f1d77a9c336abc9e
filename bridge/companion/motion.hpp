// SPDX-License-Identifier: BSD-3-Clause
// What the companion makes of a decision: the stream's reference, and the setpoint that goes on the wire.
#pragma once

#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/companion/planner_task.hpp"
#include "bridge/companion/report.hpp"
#include "bridge/setpoints/setpoint_stream.hpp"
#include "bridge/supervisor/supervisor.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"

namespace jink::bridge::companion {

/// Where a path may lead.
[[nodiscard]] planner::base::Box flight_volume(const config::Mission& mission);
/// Where a take-off from where the vehicle is leads to.
[[nodiscard]] Vec3 climb_end(const config::Mission& mission, const vehicle::VehicleState& state);

/// Moves the vehicle. What it refers to outlives it. Not thread-safe.
class MotionControl {
 public:
  /// `clock`: to measure what a step takes; null: virtual time.
  MotionControl(const config::Mission& mission, const config::Settings& settings, vehicle::VehicleLink& link,
                const base::Clock* clock, FlightReporter& reporter);

  /// The mission's heights have changed.
  void place() { stream_.stay_in(flight_volume(mission_)); }
  /// Makes the reference that of the decision: the take-off point, a stay. Not for Motion::kNone, and of a brake only
  /// its end: stop() begins it.
  void steer(double now, supervisor::Decision::Motion motion, supervisor::Phase phase,
             const vehicle::VehicleState& state);
  /// Where a stop begins.
  struct StopStart {
    planner::base::TimedPoint from;
    bool on_reference = true;  ///< else where the vehicle is
  };
  /// From where the vehicle is to stop now: its reference, but where that says nothing of its motion (in take-off, and
  /// where it was lost) and its position is known, from there. None while a stop is on, unless the vehicle is far from
  /// it, as after a silence: it is not to come back. `again`: while one is on, too.
  [[nodiscard]] std::optional<StopStart> stop_start(double now, const vehicle::VehicleState& state, bool again) const;
  /// Stops along that reference at once.
  void stop(planner::base::TimedPath reference);
  /// Where the stop that is on ends; none: none is on.
  [[nodiscard]] const std::optional<Vec3>& stop_point() const { return stop_point_; }
  /// Where the climb of a take-off ends; none: there was none.
  [[nodiscard]] const std::optional<Vec3>& takeoff_point() const { return takeoff_point_; }
  /// Follows a plan from its start, shifted by what the estimate has jumped since it was begun.
  void follow(PlanResult result, const Vec3& estimate_shift);
  /// Sends a setpoint where one is due. `dt`: since the last step; `towards`: where the vehicle is to look, where it
  /// is to turn at all.
  void send(double now, double dt, const vehicle::VehicleState& state, const std::optional<Vec3>& towards);
  /// The next place that is followed to, as far off on the level as the heading turns to; none: it stays.
  [[nodiscard]] std::optional<Vec3> place_ahead(double now, const Vec3& position) const;
  /// Learns from where the vehicle is on its reference.
  void observe(double now, const vehicle::VehicleState& state);
  /// The autopilot's estimate jumped by that.
  void shift(const Vec3& by);

  [[nodiscard]] const setpoints::SetpointStream& stream() const { return stream_; }
  /// Distance from the reference. Precondition: the stream is active.
  [[nodiscard]] double error(const vehicle::VehicleState& state) const;
  /// So far from its reference the vehicle has lost it. Where it is not known where it is, it has not.
  [[nodiscard]] bool lost(double now, const vehicle::VehicleState& state) const;
  /// It has just lost it again, though no more than the least was asked for: what drives it is stronger.
  [[nodiscard]] bool cannot_follow(double now) const { return now - helpless_at_ < kHelpless; }
  /// The share of the stated acceleration and cruise speed that is asked for: less after each time that the reference
  /// was lost, for a vehicle that cannot follow, and slowly all again.
  [[nodiscard]] double share(double now) const;
  /// How far the vehicle is beside its reference, and how well that is foreseen.
  [[nodiscard]] const setpoints::TrackingOffset& offset() const { return offset_; }
  /// What plans are to keep from obstacles: the margin of the settings, or what the vehicle was off from where it was
  /// expected where that is more.
  [[nodiscard]] double margin() const;
  /// s, for which setpoints could not be sent.
  [[nodiscard]] double unsent_for(double now) const { return unsent_since_ ? now - *unsent_since_ : 0.0; }
  [[nodiscard]] bool at_takeoff_height(const vehicle::VehicleState& state) const;

 private:
  static constexpr double kLostReference = 1.2;  // m
  static constexpr double kHelpless = 2.0;       // s, after which it is tried again
  void take_off(double now, supervisor::Phase phase, const vehicle::VehicleState& state);
  [[nodiscard]] bool known(double now, const vehicle::VehicleState& state) const;
  [[nodiscard]] double heading(double dt, const vehicle::VehicleState& state, const std::optional<Vec3>& towards);

  /// The newest track in a plan whose first setpoint is still to be sent.
  struct UnsentTrack {
    double received;
    double from;  ///< the plan's start
  };

  const config::Mission& mission_;
  const config::Settings& settings_;
  vehicle::VehicleLink& link_;
  const base::Clock* clock_;
  FlightReporter& reporter_;
  setpoints::SetpointStream stream_;
  std::optional<Vec3> takeoff_point_;  // none: not taking off
  std::optional<Vec3> stop_point_;
  setpoints::TrackingOffset offset_;
  bool was_lost_ = false;
  double share_ = 1.0;  // at lost_at_
  double lost_at_ = 0.0;
  double helpless_at_ = -planner::base::kInfinity;
  std::optional<double> last_sent_;
  bool new_plan_ = false;  // since then
  std::optional<UnsentTrack> unsent_track_;
  std::optional<double> unsent_since_;  // setpoints
  std::optional<double> yaw_;
};

}  // namespace jink::bridge::companion
