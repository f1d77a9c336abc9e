// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/flight_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jink::planner::verify {
namespace {

/// A piece of constant velocity.
struct Segment {
  Vec3 velocity = Vec3::Zero();
  double duration = 0.0;
  double rounding = 0.0;  // m/s, that the velocity can be off by

  Segment() = default;
  Segment(const base::TimedPoint& a, const base::TimedPoint& b)
      : velocity((b.position - a.position) / (b.t - a.t)), duration(b.t - a.t) {
    constexpr double kUlps = 4.0 * std::numeric_limits<double>::epsilon();
    const double way = a.position.cwiseAbs().maxCoeff() + b.position.cwiseAbs().maxCoeff();
    rounding = kUlps * (way + velocity.norm() * (std::abs(a.t) + std::abs(b.t))) / duration;
  }
};

void raise(double& most, double value) {
  if (!std::isnan(most) && !(value <= most)) most = value;  // what is not a number stays
}

}  // namespace

LimitsUse use_of_limits(std::span<const base::TimedPoint> path, const FlightLimits& limits) {
  LimitsUse use;
  const double most_speed = std::max(limits.max_speed, limits.velocity.norm());
  const double most_climb = std::max(limits.max_climb, std::abs(limits.velocity.z()));
  const auto change = [&](const Segment& from, const Segment& to, double time) {
    const double by = (to.velocity - from.velocity).norm() - from.rounding - to.rounding;
    raise(use.acceleration, by / time / limits.max_acceleration);
  };
  // The first segment and the last, of which a part may be cut off, count as no shorter than the one beside them.
  const std::size_t n = path.size();
  const auto whole = [&](std::size_t neighbour) {
    return neighbour > 0 && neighbour < n ? path[neighbour].t - path[neighbour - 1].t : limits.step;
  };
  Segment before;
  before.velocity = limits.velocity;
  for (std::size_t i = 1; i < n; ++i) {
    Segment now(path[i - 1], path[i]);
    if (i == 1) now.duration = std::max(now.duration, whole(2));
    if (i + 1 == n) now.duration = std::max(now.duration, whole(i - 1));
    raise(use.speed, (now.velocity.norm() - now.rounding) / most_speed);
    raise(use.climb, (std::abs(now.velocity.z()) - now.rounding) / most_climb);
    change(before, now, 0.5 * (before.duration + now.duration));
    before = now;
  }
  Segment rest;
  if (limits.rests && n > 1) change(before, rest, 0.5 * before.duration);
  return use;
}

}  // namespace jink::planner::verify
