// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoint_stream.hpp"

#include <cassert>
#include <cmath>
#include <utility>

namespace jink::bridge {
namespace {

constexpr double kBrakeStep = 0.05;  // s, between points of a stop
constexpr double kAtRest = 0.02;     // m/s

}  // namespace

void SetpointStream::hold(const Vec3& position, double now) {
  current_ = {{now, position, Vec3::Zero(), Vec3::Zero()}};
  next_.clear();
  is_plan_ = false;
  is_braking_ = false;
}

void SetpointStream::follow(planner::TimedPath path) {
  assert(!path.empty());
  if (!next_.empty()) current_ = std::move(next_);
  next_ = std::move(path);
  if (current_.empty()) current_ = next_;
  is_plan_ = true;
  is_braking_ = false;
}

void SetpointStream::brake(double now, const std::optional<planner::TimedPoint>& measured) {
  if (is_braking_ || (!active() && !measured)) return;
  const planner::TimedPoint from = measured ? *measured : reference(now);
  planner::TimedPath stop;
  Vec3 position = from.position;
  Vec3 velocity = from.velocity;
  double t = now;
  while (velocity.norm() > kAtRest) {
    const double speed = velocity.norm();
    const double next_speed = std::max(0.0, speed - settings_.braking * kBrakeStep);
    const Vec3 direction = velocity / speed;
    stop.push_back({t, position, velocity, -settings_.braking * direction});
    position += 0.5 * (speed + next_speed) * kBrakeStep * direction;
    velocity = next_speed * direction;
    t += kBrakeStep;
  }
  stop.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
  current_ = std::move(stop);
  next_.clear();
  is_plan_ = false;
  is_braking_ = true;
}

planner::TimedPoint SetpointStream::reference(double t) const {
  assert(active());
  return planner::sample(!next_.empty() && t >= next_.front().t ? next_ : current_, t);
}

Setpoint SetpointStream::setpoint(double now, double yaw) const {
  const planner::TimedPoint point = reference(now + settings_.lead);
  return {point.position, point.velocity, point.acceleration + settings_.drag * point.velocity, yaw};
}

planner::TimedPath SetpointStream::plan(double t) const {
  if (!is_plan_) return {};
  return planner::remainder(!next_.empty() && t >= next_.front().t ? next_ : current_, t);
}

}  // namespace jink::bridge
