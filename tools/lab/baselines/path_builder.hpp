// SPDX-License-Identifier: BSD-3-Clause
// The vehicle's motion under a wished velocity: what turns a baseline's wishes into a path that can be flown.
#pragma once

#include "planner/horizon/path_problem.hpp"

namespace jink::tools::lab::baselines {

/// s, in which a distance from the wished position is made good, as by jink.
inline constexpr double kCatchUp = planner::base::HorizonSettings{}.catch_up;

/// Builds a timed path step by step from a request's position and velocity. The velocity goes towards what is wished
/// with bounded acceleration; speed and climb keep the vehicle's limits (or where they were above, come down to them).
/// The same law, step and limits as jink's own motion (planner::Follower).
class PathBuilder {
 public:
  /// `acceleration` (m/s²) bounds every change of velocity. The request outlives this.
  PathBuilder(const planner::horizon::PathRequest& request, const planner::base::HorizonSettings& settings,
              double acceleration);

  /// One step of settings.step seconds with this velocity wished.
  void steer(const Vec3& wished);
  /// On to the target at cruise speed, braking for it, as jink's unobstructed flight; ends at rest there, or after
  /// kLongest. Looks at no obstacle.
  void fly_to_target();
  /// Brakes to rest with settings.braking, which is also what unobstructed flight brakes with, or harder if `hard`: all
  /// of the acceleration.
  void stop(bool hard = false);

  /// Follows a timed path from its first time to its last, the first being the motion's time 0: its velocity, and what
  /// the motion is off by made good within kCatchUp seconds, never faster than allows to brake for the target.
  /// Precondition: not empty.
  void follow(const planner::base::TimedPath& reference);

  [[nodiscard]] double t() const { return path_.back().t; }
  [[nodiscard]] const Vec3& position() const { return path_.back().position; }
  [[nodiscard]] const Vec3& velocity() const { return path_.back().velocity; }
  [[nodiscard]] const planner::base::TimedPath& path() const { return path_; }

  static constexpr double kLongest = 600.0;  ///< s

 private:
  const planner::horizon::PathRequest& request_;
  double step_, braking_, acceleration_;
  planner::horizon::Follower follower_;
  planner::base::TimedPath path_;
};

/// The velocity of unobstructed flight at `position`: straight to the target at cruise speed, slower where it has to
/// brake for it or the climb limit asks for it.
[[nodiscard]] Vec3 unobstructed_velocity(const planner::horizon::PathRequest& request, double braking,
                                         const Vec3& position);

/// What plans normally use of the vehicle's acceleration, and what they use in an emergency, m/s².
[[nodiscard]] double normal_acceleration(const planner::horizon::PathRequest& request,
                                         const planner::base::HorizonSettings& settings);
[[nodiscard]] double hardest_acceleration(const planner::horizon::PathRequest& request,
                                          const planner::base::HorizonSettings& settings);

}  // namespace jink::tools::lab::baselines
