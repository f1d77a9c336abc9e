// SPDX-License-Identifier: BSD-3-Clause
// Where a tracked obstacle will be: [Paper] Eq. (4)-(7) in exact form.
#pragma once

#include <algorithm>

#include "planner/base/types.hpp"

namespace jink::planner::geometry {

/// The track's position after t >= 0 seconds: constant acceleration for the first `trust` seconds, constant velocity
/// from then on. differs: [Paper] Eq. (5)-(7) add v(t+Δt)Δt + ½aΔt², which is aΔt² too much; this is x + vΔt + ½aΔt².
/// `trust` bounds how far a measured acceleration is believed, counted from the measurement (the track's age is past
/// already); infinity makes it the paper's model.
inline Vec3 predict_position(const base::Track& track, double t, double trust = base::kInfinity) {
  const double believed = std::max(0.0, trust - track.age);
  const double accelerated = std::min(t, believed);
  Vec3 position = track.position + accelerated * track.velocity + 0.5 * accelerated * accelerated * track.acceleration;
  if (t <= believed) return position;
  return position + (t - accelerated) * (track.velocity + accelerated * track.acceleration);
}

/// The track's velocity after t >= 0 seconds, Eq. (4).
inline Vec3 predict_velocity(const base::Track& track, double t, double trust = base::kInfinity) {
  return track.velocity + std::min(t, std::max(0.0, trust - track.age)) * track.acceleration;
}

/// The same track, valid t >= 0 seconds later and older by that.
inline base::Track predict(const base::Track& track, double t, double trust = base::kInfinity) {
  base::Track later = track;
  later.position = predict_position(track, t, trust);
  later.velocity = predict_velocity(track, t, trust);
  later.age += t;
  if (later.age > trust) later.acceleration = Vec3::Zero();
  later.body.yaw += t * track.body.yaw_rate;
  return later;
}

}  // namespace jink::planner::geometry
