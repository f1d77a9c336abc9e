// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/setpoint_stream.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace jink::bridge::setpoints {
namespace {

constexpr double kBrakeStep = 0.05;         // s, between points of a stop
constexpr std::size_t kLongestStop = 4000;  // points: no vehicle is so fast
constexpr double kAtRest = 0.02;            // m/s
constexpr double kJoint = 1e-6;             // s, between the end of one path and the beginning of the next
constexpr double kHistory = 1.0;            // s, of a path followed before that is kept: positions arrive late

}  // namespace

void SetpointStream::hold(const Vec3& position, double now) {
  current_ = {{now, position, Vec3::Zero(), Vec3::Zero()}};
  next_.clear();
  is_plan_ = false;
}

void SetpointStream::follow(planner::base::TimedPath path) {
  assert(!path.empty());
  if (!next_.empty()) {
    // The one that waits for its start, or was followed till now, goes on where the present one ends.
    const double joint = next_.front().t;
    if (current_.front().t < joint - kJoint) {
      planner::base::TimedPoint end = planner::base::sample(current_, joint - kJoint);
      std::erase_if(current_,
                    [&](const planner::base::TimedPoint& p) { return p.t >= end.t || p.t < joint - kHistory; });
      current_.push_back(end);
    } else {
      current_.clear();
    }
    current_.insert(current_.end(), next_.begin(), next_.end());
  }
  next_ = std::move(path);
  if (current_.empty()) current_ = next_;
  is_plan_ = true;
}

void SetpointStream::brake(planner::base::TimedPath stop) {
  assert(!stop.empty());
  current_ = std::move(stop);
  next_.clear();
  is_plan_ = false;
}

planner::base::TimedPath SetpointStream::straight_stop(const planner::base::TimedPoint& from) const {
  planner::base::TimedPath stop;
  Vec3 position = from.position;
  Vec3 velocity = from.velocity;
  double t = from.t;
  const double braking = deceleration(position, velocity);
  const double lowest = std::min(from.position.z(), settings_.volume.min.z());
  const auto stay_above = [&] {  // what is below the volume is not to go on sinking while it stops
    if (position.z() > lowest) return;
    position.z() = lowest;
    velocity.z() = std::max(0.0, velocity.z());
  };
  stay_above();
  while (velocity.norm() > kAtRest && stop.size() < kLongestStop) {
    const double speed = velocity.norm();
    const double next_speed = std::max(0.0, speed - braking * kBrakeStep);
    const Vec3 direction = velocity / speed;
    stop.push_back({t, position, velocity, -braking * direction});
    position += 0.5 * (speed + next_speed) * kBrakeStep * direction;
    velocity = next_speed * direction;
    t += kBrakeStep;
    stay_above();
  }
  stop.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
  return stop;
}

// A stop from speed v takes v²/2a; along each axis the volume leaves so much way.
double SetpointStream::deceleration(const Vec3& position, const Vec3& velocity) const {
  double needed = settings_.braking;
  for (int axis = 0; axis < 3; ++axis) {
    const double v = velocity[axis];
    const double way =
        v > 0.0 ? settings_.volume.max[axis] - position[axis] : position[axis] - settings_.volume.min[axis];
    if (v == 0.0 || way <= 0.0) continue;  // outside already: there is nothing to keep
    needed = std::max(needed, std::abs(v) * velocity.norm() / (2.0 * way));
  }
  return std::min(needed, std::max(settings_.braking, settings_.hardest));
}

void SetpointStream::shift(const Vec3& by) {
  for (planner::base::TimedPath* path : {&current_, &next_})
    for (planner::base::TimedPoint& point : *path) point.position += by;
  velocity_error_.forget();
  response_.forget();
}

void SetpointStream::observe(double t, const Vec3& position, const Vec3& velocity, bool in_flight) {
  velocity_error_.observe(t, position, velocity);
  response_.observe(t, position, velocity - velocity_error_.value(), in_flight && is_plan_);
}

void SetpointStream::sent(double t, vehicle::Setpoint setpoint) {
  setpoint.velocity -= velocity_error_.value();
  response_.sent(t, setpoint);
}

std::optional<planner::base::TimedPoint> SetpointStream::expected(double t) const {
  return response_.at(t, [this](double later) {
    vehicle::Setpoint next = setpoint(later, 0.0);
    next.velocity -= velocity_error_.value();
    return next;
  });
}

planner::base::TimedPoint SetpointStream::reference(double t) const {
  assert(active());
  return planner::base::sample(!next_.empty() && t >= next_.front().t ? next_ : current_, t);
}

planner::base::TimedPoint SetpointStream::jumped(double from, double to) const {
  planner::base::TimedPoint sum{to};
  const auto jump = [&](const planner::base::TimedPoint& a, const planner::base::TimedPoint& b) {
    if (b.t <= from || b.t > to || b.t - a.t > 2.0 * kJoint) return;
    sum.position += b.position - a.position;
    sum.velocity += b.velocity - a.velocity;
  };
  for (std::size_t i = 1; i < current_.size(); ++i) jump(current_[i - 1], current_[i]);
  if (!next_.empty()) jump(planner::base::sample(current_, next_.front().t - kJoint), next_.front());
  return sum;
}

vehicle::Setpoint SetpointStream::setpoint(double now, double yaw, double delay) const {
  const planner::base::TimedPoint point = reference(now + settings_.lead + delay);
  const planner::base::TimedPoint later = reference(now + settings_.acceleration_lead + delay);
  const double taken_off = 1.0 + damping();
  const Vec3 acceleration = later.acceleration.cwiseProduct(Vec3(taken_off, taken_off, 1.0));
  return {point.position, point.velocity + velocity_error_.value(),
          acceleration + drag() * later.velocity - response_.unexplained(), yaw};
}

planner::base::TimedPath SetpointStream::plan(double t) const {
  if (!is_plan_) return {};
  return planner::base::remainder(next_, t);
}

planner::base::TimedPath SetpointStream::ahead(double t) const {
  assert(active());
  if (next_.empty()) return planner::base::remainder(current_, t);
  if (t >= next_.front().t) return planner::base::remainder(next_, t);
  planner::base::TimedPath path = planner::base::remainder(current_, t);
  const planner::base::TimedPoint end = planner::base::sample(path, next_.front().t - kJoint);
  std::erase_if(path, [&](const planner::base::TimedPoint& p) { return p.t >= end.t; });
  if (!path.empty()) path.push_back(end);
  path.insert(path.end(), next_.begin(), next_.end());
  return path;
}

}  // namespace jink::bridge::setpoints
