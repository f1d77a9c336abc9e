// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace jink::bridge::companion {
namespace {

constexpr double kBackOff = 0.7;           // of the share that was asked for when the reference was lost
constexpr double kLeastShare = 0.25;       // that is asked for
constexpr double kHelplessShare = 0.3;     // asked for, of what loses its reference for all that
constexpr double kRecovery = 0.01;         // 1/s, of the share
constexpr double kYawRate = 1.5;           // rad/s, at which the heading turns to the next waypoint
constexpr double kLookAhead = 20.0;        // s, along what is followed: who flies slowly looks there all the same
constexpr double kLookStep = 0.25;         // s
constexpr double kYawDistance = 1.0;       // m, a nearer waypoint does not turn it
constexpr double kSlack = 0.9;             // of a setpoint's period, after which the next may go
constexpr double kTakeoffTolerance = 0.2;  // m

using Motion = supervisor::Decision::Motion;

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

}  // namespace

planner::base::Box flight_volume(const config::Mission& mission) {
  planner::base::Box box = mission.geofence;
  box.min.z() = std::max(box.min.z(), mission.min_height);
  return box;
}

MotionControl::MotionControl(const config::Mission& mission, const config::Settings& settings,
                             vehicle::VehicleLink& link, const base::Clock* clock, FlightReporter& reporter)
    : mission_(mission),
      settings_(settings),
      link_(link),
      clock_(clock),
      reporter_(reporter),
      stream_({settings.companion.setpoint_lead, settings.companion.committed_acceleration_lead(), mission.vehicle.drag,
               mission.vehicle.damping, settings.horizon.braking, mission.vehicle.max_acceleration,
               flight_volume(mission), mission.vehicle.max_speed}) {}

void MotionControl::steer(double now, Motion motion, supervisor::Phase phase, const vehicle::VehicleState& state) {
  if (motion == Motion::kTakeoffPoint) take_off(now, phase, state);
  // Until OFFBOARD is confirmed the vehicle may be moving: it is to stop where it is then, not to come back.
  if (motion == Motion::kStay) {
    takeoff_point_.reset();
    stream_.hold(state.motion.value.position, now);
  }
  if (motion != Motion::kBrake) stop_point_.reset();
  if (!stream_.active()) stream_.hold(state.motion.value.position, now);
}

Vec3 climb_end(const config::Mission& mission, const vehicle::VehicleState& state) {
  Vec3 end = state.motion.value.position;
  const double height = state.in_air ? end.z() : end.z() + mission.takeoff_height;
  end.z() = std::min(std::max(height, mission.min_height), std::max(mission.geofence.max.z(), end.z()));
  return end;
}

void MotionControl::take_off(double now, supervisor::Phase phase, const vehicle::VehicleState& state) {
  if (!takeoff_point_ || phase == supervisor::Phase::kEngaging) {
    takeoff_point_ = climb_end(mission_, state);
    stream_.hold(*takeoff_point_, now);
  } else if (stop_point_ && !state.in_air) {  // a hazard has passed; in the air plans lead on
    stream_.hold(*takeoff_point_, now);
  }
}

std::optional<MotionControl::StopStart> MotionControl::stop_start(double now, const vehicle::VehicleState& state,
                                                                  bool again) const {
  const bool away = lost(now, state);
  if (stop_point_ && !away && !again) return std::nullopt;
  const bool says_nothing = away || (!stop_point_ && stream_.plan(now).empty());
  // What stood on the ground when it was heard last has not moved, and is not to.
  if (says_nothing && (known(now, state) || !state.in_air))
    return StopStart{{now, state.motion.value.position, state.motion.value.velocity, Vec3::Zero()}, false};
  return StopStart{stream_.reference(now)};
}

void MotionControl::stop(planner::base::TimedPath reference) {
  stop_point_ = reference.back().position;
  stream_.brake(std::move(reference));
}

bool MotionControl::known(double now, const vehicle::VehicleState& state) const {
  return state.motion.silence(now) <= settings_.companion.stale_state;
}

bool MotionControl::lost(double now, const vehicle::VehicleState& state) const {
  return known(now, state) && error(state) > kLostReference;
}

void MotionControl::follow(PlanResult result, const Vec3& estimate_shift) {
  planner::base::TimedPath path = std::move(result.plan.path);
  // Of the time that the plan took.
  const Vec3 shift = estimate_shift - result.job.estimate_shift;
  for (planner::base::TimedPoint& point : path) {
    point.t += result.job.start;
    point.position += shift;
  }
  stream_.follow(std::move(path), result.job.offset);
  new_plan_ = true;
  if (result.job.newest_track) unsent_track_ = UnsentTrack{*result.job.newest_track, result.job.start};
}

void MotionControl::send(double now, double dt, const vehicle::VehicleState& state,
                         const std::optional<Vec3>& towards) {
  const config::CompanionSettings& companion = settings_.companion;
  const bool due = !last_sent_ || now - *last_sent_ + 1e-6 >= kSlack / companion.setpoint_rate_hz;
  if (!due && !new_plan_) return;
  last_sent_ = now;
  new_plan_ = false;
  vehicle::Setpoint setpoint = stream_.setpoint(now, heading(dt, state, towards), state.link_delay);
  // What sinks faster than its plan can stop is not asked to go under the ground.
  const double floor = std::min(mission_.ground, state.motion.value.position.z());
  if (setpoint.position.z() < floor) {
    setpoint.position.z() = floor;
    setpoint.velocity.z() = std::max(0.0, setpoint.velocity.z());
  }
  const bool sent = link_.send(setpoint);
  reporter_.sending(now, sent);
  if (!sent) {
    if (!unsent_since_) unsent_since_ = now;
    return;
  }
  unsent_since_.reset();
  reporter_.setpoint(now, setpoint);
  const double lead = std::max(companion.setpoint_lead, companion.committed_acceleration_lead()) + state.link_delay;
  if (unsent_track_ && now + lead >= unsent_track_->from) {
    const double at = clock_ != nullptr ? clock_->now() : now;
    reporter_.summary().track_to_setpoint_ms.push_back(1e3 * (at - unsent_track_->received));
    unsent_track_.reset();
  }
}

// Turning at a bounded rate from where the vehicle looks now.
double MotionControl::heading(double dt, const vehicle::VehicleState& state, const std::optional<Vec3>& towards) {
  if (!yaw_) yaw_ = state.yaw;
  if (!towards) return *yaw_;
  const Vec3 ahead = *towards - state.motion.value.position;
  if (ahead.head<2>().norm() > kYawDistance) {
    const double most = kYawRate * dt;
    yaw_ = wrapped(*yaw_ + std::clamp(wrapped(std::atan2(ahead.y(), ahead.x()) - *yaw_), -most, most));
  }
  return *yaw_;
}

std::optional<Vec3> MotionControl::place_ahead(double now, const Vec3& position) const {
  for (double later = kLookStep; stream_.active() && later <= kLookAhead; later += kLookStep) {
    const Vec3 place = stream_.reference(now + later).position;
    if ((place - position).head<2>().norm() > kYawDistance) return place;
  }
  return std::nullopt;
}

void MotionControl::observe(double now, const vehicle::VehicleState& state) {
  if (!stream_.active() || !known(now, state)) return;
  stream_.observe(state.motion.stamp, state.motion.value.position, state.motion.value.velocity);
  const planner::base::TimedPoint reference = stream_.reference(state.motion.stamp);
  const Vec3 offset = state.motion.value.position - reference.position;
  double& largest = reporter_.summary().largest_tracking_error;
  largest = std::max(largest, offset.norm());
  const bool was_lost = std::exchange(was_lost_, offset.norm() > kLostReference);
  if (was_lost_ && !was_lost) {
    if (share(now) < kHelplessShare) helpless_at_ = now;
    share_ = std::max(kLeastShare, kBackOff * share(now));
    lost_at_ = now;
  }
  if (was_lost_) return offset_.forget();
  offset_.observe(state.motion.stamp, offset,
                  state.motion.value.velocity - stream_.velocity_error() - reference.velocity);
}

double MotionControl::share(double now) const {
  return std::min(1.0, share_ + kRecovery * (now - lost_at_));
}

void MotionControl::shift(const Vec3& by) {
  stream_.shift(by);
  if (takeoff_point_) *takeoff_point_ += by;
  if (stop_point_) *stop_point_ += by;
}

double MotionControl::error(const vehicle::VehicleState& state) const {
  return (stream_.reference(state.motion.stamp).position - state.motion.value.position).norm();
}

double MotionControl::margin() const {
  const double least = settings_.horizon.margin;
  return std::clamp(offset_.error().value_or(least), least, std::max(least, settings_.companion.margin_limit));
}

bool MotionControl::at_takeoff_height(const vehicle::VehicleState& state) const {
  return takeoff_point_ && takeoff_point_->z() - state.motion.value.position.z() < kTakeoffTolerance;
}

}  // namespace jink::bridge::companion
