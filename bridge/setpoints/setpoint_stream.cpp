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
constexpr double kLearningSpeed = 1.0;      // m/s, below which a lag says little about drag
constexpr double kLearningRate = 6.0;       // 1/s, of normalised least mean squares
constexpr double kLongestPause = 0.2;       // s, between two observations
constexpr double kMostLacking = 5.0;        // m/s²; more is a reference that jumped
constexpr double kMostDrag = 2.0;           // 1/s
constexpr double kMostDamping = 0.5;        // of the acceleration
// Of PX4's cascade (MPC_XY_P, MPC_XY_VEL_P_ACC): the acceleration that it makes of errors is what the feed-forward
// lacked. Other gains make the learning faster or slower.
constexpr double kVelocityGain = 1.8;                   // 1/s
constexpr double kPositionGain = 0.95 * kVelocityGain;  // 1/s²
constexpr double kSaturated = 0.95;                     // of the largest speed

}  // namespace

void SetpointStream::hold(const Vec3& position, double now) {
  current_ = {{now, position, Vec3::Zero(), Vec3::Zero()}};
  next_.clear();
  is_plan_ = false;
}

void SetpointStream::follow(planner::base::TimedPath path, const OffsetForecast& offset) {
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
  planned_ = std::move(path);
  next_ = offset.taken_off(planned_);
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
  for (planner::base::TimedPath* path : {&current_, &next_, &planned_})
    for (planner::base::TimedPoint& point : *path) point.position += by;
  velocity_error_.forget();
}

void SetpointStream::observe(double t, const Vec3& position, const Vec3& velocity) {
  velocity_error_.observe(t, position, velocity);
  const std::optional<VelocityLag> last = std::exchange(lag_, std::nullopt);
  if (!active() || !is_plan_) return;
  const planner::base::TimedPoint point = reference(t);
  const Vec3 late = point.position - position;
  lag_ = VelocityLag{t, point.velocity - velocity + velocity_error_.value()};
  if (!last || t <= last->t || t > last->t + kLongestPause) return;
  const double speed = point.velocity.norm();
  if (speed < kLearningSpeed) return;
  if (late.dot(point.velocity) > 0.0 && velocity.norm() > kSaturated * settings_.max_speed) return;
  // What the autopilot makes of the errors, and by what the vehicle gets slower for all that.
  const double dt = t - last->t;
  Vec3 lacking = kPositionGain * late + kVelocityGain * lag_->value + (lag_->value - last->value) / dt;
  lacking *= std::min(1.0, kMostLacking / lacking.norm());
  const double step = kLearningRate * dt / (1.0 + point.velocity.squaredNorm() + point.acceleration.squaredNorm());
  drag_ = std::clamp(drag_ + step * lacking.dot(point.velocity), 0.0, kMostDrag);
  const double of_acceleration = lacking.head<2>().dot(point.acceleration.head<2>());
  damping_ = std::clamp(damping_ + step * of_acceleration, 0.0, kMostDamping);
}

planner::base::TimedPoint SetpointStream::reference(double t) const {
  assert(active());
  return planner::base::sample(!next_.empty() && t >= next_.front().t ? next_ : current_, t);
}

vehicle::Setpoint SetpointStream::setpoint(double now, double yaw, double delay) const {
  const planner::base::TimedPoint point = reference(now + settings_.lead + delay);
  const planner::base::TimedPoint later = reference(now + settings_.acceleration_lead + delay);
  const double taken_off = 1.0 + damping_;
  const Vec3 acceleration = later.acceleration.cwiseProduct(Vec3(taken_off, taken_off, 1.0));
  return {point.position, point.velocity + velocity_error_.value(), acceleration + drag_ * later.velocity, yaw};
}

planner::base::TimedPath SetpointStream::plan(double t) const {
  if (!is_plan_) return {};
  return planner::base::remainder(planned_, t);
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
