// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/position_history.hpp"

#include <cmath>

namespace jink::bridge::prediction {

void PositionHistory::set_velocity(double t, planner::base::Track& track) const {
  track.velocity.setZero();
  track.velocity_sigma = kUnknown;
  if (places_.empty()) return;
  auto from = places_.begin();
  while (from + 1 != places_.end() && (from + 1)->t <= t - kSpan) ++from;
  const double dt = t - from->t;
  if (!(dt > 0.0)) return;
  const Vec3 velocity = (track.position - from->position) / dt;
  const double sigma = std::hypot(track.position_sigma / dt, from->sigma / dt, 0.5 * kManoeuvre * dt);
  if (!(sigma < kUnknown && velocity.norm() < kFastest)) return;
  track.velocity = velocity;
  track.velocity_sigma = sigma;
}

void PositionHistory::add(double t, const planner::base::Track& measured) {
  if (!places_.empty() && !(t > places_.back().t)) return;
  places_.push_back({t, measured.position, measured.position_sigma});
  auto needed = places_.begin();
  while (needed + 1 != places_.end() && (needed + 1)->t <= t - kSpan) ++needed;
  places_.erase(places_.begin(), needed);
}

}  // namespace jink::bridge::prediction
