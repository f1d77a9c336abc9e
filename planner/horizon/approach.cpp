// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/approach.hpp"

#include <algorithm>
#include <cmath>

namespace jink::planner::horizon {
namespace {

constexpr double kMostSteps = 1e6;  // of braking: more than any path has

/// The fewest steps N in which a velocity of asked / (N + 1) is braked by no more than `change` in each.
double fewest_steps(double asked, double change) {
  const double steps = std::ceil(std::sqrt(0.25 + asked / change) - 0.5);
  return std::clamp(steps, 1.0, kMostSteps);  // one where it is not a number
}

}  // namespace

Vec3 Approach::asked(const base::TimedPoint& now) const {
  return (2.0 / limits_.step) * (target_ - now.position) - now.velocity;
}

std::optional<Landing> Approach::checked(const base::TimedPoint& now, const Vec3& asked, int braking) const {
  const Vec3 velocity = asked / (braking + 1);
  const double speed = velocity.norm();
  const double change = std::max((velocity - now.velocity).norm(), speed / braking);
  const bool within = change <= limits_.change && speed <= std::max(limits_.cruise, now.velocity.norm()) &&
                      std::abs(velocity.z()) <= std::max(limits_.max_climb, std::abs(now.velocity.z()));
  if (!within) return std::nullopt;
  return Landing{velocity, braking, change};
}

std::optional<Landing> Approach::landing(const base::TimedPoint& now) const {
  const Vec3 ask = asked(now);
  const double asked_speed = ask.norm();
  const double steps = fewest_steps(asked_speed, limits_.braking);
  const double hardest = fewest_steps(asked_speed, limits_.change);
  const double speed = now.velocity.norm();
  const double steady = speed > 0.0 ? std::floor(asked_speed / speed - 0.5) : steps;  // N + 1 nearest to asked / speed
  return checked(now, ask, static_cast<int>(std::clamp(steady, hardest, steps)));
}

std::optional<Landing> Approach::landing_in(const base::TimedPoint& now, int steps) const {
  return checked(now, asked(now), steps - 1);
}

Vec3 Approach::wished_velocity(const base::TimedPoint& now) const {
  const Vec3 ask = asked(now);
  const Vec3 wish = ask / (fewest_steps(ask.norm(), limits_.braking) + 1.0);
  const double speed = wish.norm();
  return speed > limits_.cruise ? Vec3(wish * (limits_.cruise / speed)) : wish;
}

base::TimedPoint Approach::after(const Landing& landing, const base::TimedPoint& from, int steps) const {
  const double left = static_cast<double>(landing.braking - (steps - 1)) / landing.braking;
  const Vec3 way = (0.5 * limits_.step * landing.braking) * landing.velocity;
  return {from.t + steps * limits_.step, target_ - (left * left) * way, left * landing.velocity, Vec3::Zero()};
}

void Approach::fly(const Landing& landing, base::TimedPath& path) const {
  const base::TimedPoint from = path.back();
  for (int step = 1; step <= landing.braking + 1; ++step) {
    base::TimedPoint next = after(landing, from, step);
    path.back().acceleration = (next.velocity - path.back().velocity) / limits_.step;
    path.push_back(next);
  }
}

}  // namespace jink::planner::horizon
