// SPDX-License-Identifier: BSD-3-Clause
// Where an obstacle's reference point is at any time: the true motion, in closed form, and bounds on it. What shape
// hangs on that point is sim/world/shapes.
#pragma once

#include "config/scenario.hpp"
#include "planner/base/types.hpp"

namespace jink::sim::world {

/// The motion of an obstacle's reference point at one instant: m, m/s, m/s², ENU.
struct ObstacleState {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 acceleration = Vec3::Zero();
};

/// The state at scenario time `t` in seconds. Closed form, so it does not drift however long the flight; O(1), or
/// O(log n) for n waypoints. Pure and thread safe; no errors.
/// - For t < 0, while the scenario's clock does not run, the obstacle stands at its t = 0 position.
/// - Where the velocity jumps (a bounce, a waypoint), it is the velocity just after.
/// - Linear motion: [Paper] Eq. (4)-(7) in exact form. Waypoints: still before the first time and from the last one on.
/// - A bounce axis with min = max stands there. A start outside [min, max] is reflected into it.
/// Requires of `motion` what config::load_scenario checks: finite numbers, slower != 0, min <= max, as many times as
/// points, at least one of them, times strictly ascending.
[[nodiscard]] ObstacleState state_at(const config::Motion& motion, double t);

/// A speed in m/s that the obstacle does not exceed anywhere in [t0, t1], t0 <= t1. Exact for linear, bounce and
/// waypoints motion and for a trefoil of equal scales; otherwise an upper bound.
[[nodiscard]] double speed_bound(const config::Motion& motion, double t0, double t1);

/// How far in metres the obstacle is at most, during [t0, t1], from where it would be if it moved at constant velocity
/// from its position at t0 to its position at t1. Zero (to 1e-9) where it does move at constant velocity; shrinks with
/// the square of t1 - t0 on smooth motion and linearly about a jump of the velocity. Requires t0 <= t1.
[[nodiscard]] double chord_deviation(const config::Motion& motion, double t0, double t1);

}  // namespace jink::sim::world
