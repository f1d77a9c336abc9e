// SPDX-License-Identifier: BSD-3-Clause
// What the companion makes of a decision: the stream's reference, and the setpoint that goes on the wire.
#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <string>

#include "bridge/companion/companion.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kYawRate = 1.5;      // rad/s, at which the heading turns to the next waypoint
constexpr double kYawDistance = 1.0;  // m, a nearer waypoint does not turn it
constexpr double kSlack = 0.9;        // of a setpoint's period, after which the next may go

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

}  // namespace

void Companion::move(double now, const supervisor::Decision& decision) {
  using Motion = supervisor::Decision::Motion;
  switch (decision.motion) {
    case Motion::kNone:
      return;
    case Motion::kTakeoffPoint:
      if (!stream_.active() || supervisor_.phase() == supervisor::Phase::kEngaging) {
        takeoff_point_ = state_.position;
        takeoff_point_.z() = std::max(state_.position.z() + mission_.takeoff_height, mission_.min_height);
        takeoff_point_.z() = std::min(takeoff_point_.z(), std::max(mission_.geofence.max.z(), state_.position.z()));
        stream_.hold(takeoff_point_, now);
      } else if (stream_.braking()) {  // a hazard of the climb has passed
        stream_.hold(takeoff_point_, now);
      }
      break;
    case Motion::kStay:
      // Until OFFBOARD is confirmed the vehicle may be moving: it is to stop where it is then, not to come back.
      stream_.hold(state_.position, now);
      break;
    case Motion::kFollow:
      if (supervisor_.phase() == supervisor::Phase::kFlying) start_plan(now);
      break;
    case Motion::kBrake:
      brake(now);
      // While a hazard lasts the planner goes on: when it has passed there is a plan to follow.
      if (supervisor_.phase() == supervisor::Phase::kFlying) start_plan(now);
      break;
  }
  if (!stream_.active()) stream_.hold(state_.position, now);
  const bool due = now - last_sent_ + 1e-6 >= kSlack / settings_.companion.setpoint_rate_hz;
  if (!due && !new_plan_) return;
  last_sent_ = now;
  new_plan_ = false;
  const vehicle::Setpoint setpoint = stream_.setpoint(now, heading(now));
  if (!parts_.link.send(setpoint)) {
    if (unsent_since_ < 0.0) {
      unsent_since_ = now;
      event(now, "send_failed", "setpoints cannot be sent");
    }
    return;
  }
  if (unsent_since_ >= 0.0) event(now, "send_works", "setpoints can be sent again");
  unsent_since_ = -1.0;
  for (FlightObserver* observer : parts_.observers) observer->on_setpoint(now, setpoint);
  const double lead = std::max(settings_.companion.setpoint_lead, settings_.companion.committed_acceleration_lead());
  if (unsent_track_ && now + lead >= unsent_from_) {
    const double sent = parts_.clock != nullptr ? parts_.clock->now() : now;
    summary_.track_to_setpoint_ms.push_back(1e3 * (sent - *unsent_track_));
    unsent_track_.reset();
  }
}

// Along the reference; but from the vehicle where the reference says nothing of its motion, in take-off and where it
// was lost, and the vehicle's position is known.
void Companion::brake(double now) {
  if (stream_.braking()) return;
  const bool known = state_.position_stamp >= 0.0 && now - state_.position_stamp <= settings_.companion.stale_state;
  const bool says_nothing =
      !stream_.active() || stream_.plan(now).empty() ||
      (stream_.reference(state_.position_stamp).position - state_.position).norm() > kLostReference;
  if (!known || !says_nothing) {
    stream_.brake(now);
    return;
  }
  stream_.brake(now, planner::base::TimedPoint{now, state_.position, state_.velocity, Vec3::Zero()});
}

// Towards the waypoint, turning at a bounded rate from where the vehicle looks now.
double Companion::heading(double now) {
  if (!yaw_known_) {
    yaw_ = state_.yaw;
    yaw_known_ = true;
  }
  const Vec3 ahead = mission_.waypoints[waypoint_] - state_.position;
  if (supervisor_.phase() == supervisor::Phase::kFlying && ahead.head<2>().norm() > kYawDistance) {
    const double most = kYawRate * std::max(0.0, now - last_step_);
    yaw_ = wrapped(yaw_ + std::clamp(wrapped(std::atan2(ahead.y(), ahead.x()) - yaw_), -most, most));
  }
  return yaw_;
}

}  // namespace jink::bridge::companion
