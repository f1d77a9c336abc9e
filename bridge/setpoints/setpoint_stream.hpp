// SPDX-License-Identifier: BSD-3-Clause
// What is sent now: the plan sampled ahead of the autopilot's lag, or a stop.
#pragma once

#include <optional>

#include "bridge/setpoints/tracking_offset.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "planner/base/trajectory.hpp"

namespace jink::bridge::setpoints {

/// The reference that the vehicle is to be on, as a timed path in the companion's clock, and the setpoints that put it
/// there. A new plan takes over at its own start; a brake takes over at once. Not thread-safe.
class SetpointStream {
 public:
  struct Settings {
    double lead = 0.0;               ///< s: position and velocity are the reference's that much later (transport)
    double acceleration_lead = 0.0;  ///< s: the acceleration is (attitude loop and rotors too)
    double drag = 0.0;               ///< 1/s: deceleration per speed that the acceleration makes up for, to begin with
    double damping = 0.0;            ///< of an acceleration, that the autopilot takes off again, horizontally; likewise
    double braking = 2.0;            ///< m/s², deceleration of a brake
    double hardest = 6.0;            ///< m/s², of a brake that would leave the volume
    planner::base::Box volume{};     ///< in which a brake is to end
    double max_speed = planner::base::kInfinity;  ///< m/s, at which a vehicle that lags cannot catch up
  };
  explicit SetpointStream(const Settings& settings)
      : settings_(settings), drag_(settings.drag), damping_(settings.damping) {}

  /// Stay at a point. Forgets any plan.
  void hold(const Vec3& position, double now);
  /// Follows `path`, whose times are the companion's clock, from its first time on; until then what was followed
  /// before. `offset`: what the vehicle is expected to be beside its reference, which is led so much beside the path.
  /// Precondition: not empty.
  void follow(planner::base::TimedPath path, const OffsetForecast& offset = {});
  /// Follows a way to rest at once, and stays at its end. Precondition: not empty.
  void brake(planner::base::TimedPath stop);
  /// The straight way to rest from there, as the deceleration allows. Where that would lead out of `volume` it is as
  /// hard as it takes to stay inside, up to `hardest`; below its floor it never leads.
  [[nodiscard]] planner::base::TimedPath straight_stop(const planner::base::TimedPoint& from) const;
  /// Moves all that is followed: the autopilot's estimate jumped by that, the vehicle did not move.
  void shift(const Vec3& by);

  /// Brakes are to end in `volume` from now on.
  void stay_in(const planner::base::Box& volume) { settings_.volume = volume; }

  /// Where the vehicle is to be at time t. Precondition: active().
  [[nodiscard]] planner::base::TimedPoint reference(double t) const;
  /// The setpoint to send at `now`, heading `yaw`. Its velocity is by how much the estimate of the velocity is off
  /// (VelocityError), so that the vehicle's own is the reference's.
  /// `delay`: s that the setpoint is on its way, by which it is led too.
  [[nodiscard]] vehicle::Setpoint setpoint(double now, double yaw, double delay = 0.0) const;

  /// Takes in where the vehicle is, measured at `position` with `velocity` at time t. Learns drag and damping from it,
  /// but not at the largest speed, at which no thrust makes good what is late.
  void observe(double t, const Vec3& position, const Vec3& velocity);
  /// The drag that setpoints make up for now, 1/s.
  [[nodiscard]] double drag() const { return drag_; }
  /// The share of an acceleration that they add to it now.
  [[nodiscard]] double damping() const { return damping_; }

  [[nodiscard]] bool active() const { return !current_.empty(); }
  /// Of the autopilot's estimate, m/s: estimated minus true.
  [[nodiscard]] Vec3 velocity_error() const { return velocity_error_.value(); }
  /// The path that follow() was given last, from time t on, for the planner's warm start; empty while holding or
  /// braking.
  [[nodiscard]] planner::base::TimedPath plan(double t) const;
  /// All that is followed from time t on, the path that waits for its start, a stop and a stay included: reference() as
  /// a path. Precondition: active().
  [[nodiscard]] planner::base::TimedPath ahead(double t) const;

 private:
  [[nodiscard]] double deceleration(const Vec3& position, const Vec3& velocity) const;

  Settings settings_;
  VelocityError velocity_error_;
  struct VelocityLag {
    double t;    // s
    Vec3 value;  // m/s, reference minus vehicle
  };
  std::optional<VelocityLag> lag_;
  double drag_;
  double damping_;
  bool is_plan_ = false;
  planner::base::TimedPath current_;
  planner::base::TimedPath next_;     // takes over at its first time
  planner::base::TimedPath planned_;  // the path that the vehicle is to fly along next_
};

}  // namespace jink::bridge::setpoints
