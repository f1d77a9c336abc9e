// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/path_builder.hpp"

#include <algorithm>
#include <cmath>

#include "planner/horizon/approach.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr double kAtRest = 1e-3;  // m/s

}  // namespace

PathBuilder::PathBuilder(const planner::horizon::PathRequest& request, const planner::base::HorizonSettings& settings,
                         double acceleration)
    : request_(request),
      step_(settings.step),
      braking_(std::min(settings.braking, acceleration)),
      acceleration_(acceleration),
      follower_{settings.step, 1.0 / request.vehicle.max_speed, 1.0 / request.vehicle.max_climb,
                1.0 / (acceleration * settings.step)} {
  path_.push_back({0.0, request.position, request.velocity, Vec3::Zero()});
}

void PathBuilder::steer(const Vec3& wished) {
  Vec3 p = position();
  Vec3 v = velocity();
  follower_.advance(p.x(), p.y(), p.z(), v.x(), v.y(), v.z(), wished.x(), wished.y(), wished.z());
  path_.back().acceleration = (v - path_.back().velocity) / step_;
  path_.push_back({t() + step_, p, v, Vec3::Zero()});
}

void PathBuilder::fly_to_target() {
  const planner::base::VehicleLimits& vehicle = request_.vehicle;
  const planner::horizon::Approach approach(
      request_.target, {step_, vehicle.cruise_speed, vehicle.max_climb, acceleration_ * step_, braking_ * step_});
  while (t() < kLongest) {
    if (const auto landing = approach.landing(path_.back())) {
      approach.fly(*landing, path_);
      return;
    }
    steer(approach.wished_velocity(path_.back()));
  }
}

void PathBuilder::stop(bool hard) {
  const double change = (hard ? acceleration_ : braking_) * step_;
  while (velocity().norm() > kAtRest && t() < kLongest) {
    const double speed = velocity().norm();
    steer(velocity() * (std::max(0.0, speed - change) / speed));
  }
  if (path_.size() == 1) steer(Vec3::Zero());
}

void PathBuilder::follow(const planner::base::TimedPath& reference) {
  const double first = reference.front().t;
  while (first + t() < reference.back().t && t() < kLongest) {
    const Vec3 from = planner::base::sample(reference, first + t()).position;
    const Vec3 to = planner::base::sample(reference, first + t() + step_).position;
    const Vec3 wished = (to - from) / step_ + (from - position()) / kCatchUp;
    const double fastest = std::sqrt(2.0 * braking_ * (request_.target - position()).norm());
    const double speed = wished.norm();
    steer(speed > fastest ? Vec3(wished * (fastest / speed)) : wished);
  }
}

Vec3 unobstructed_velocity(const planner::horizon::PathRequest& request, double braking, const Vec3& position) {
  const Vec3 way = request.target - position;
  const double distance = way.norm();
  if (distance <= 0.0) return Vec3::Zero();
  const Vec3 direction = way / distance;
  const double climb_share = std::abs(direction.z());
  const double cruise = climb_share * request.vehicle.cruise_speed > request.vehicle.max_climb
                            ? request.vehicle.max_climb / climb_share
                            : request.vehicle.cruise_speed;
  return std::min({cruise, std::sqrt(2.0 * braking * distance), distance / kCatchUp}) * direction;
}

double normal_acceleration(const planner::horizon::PathRequest& request,
                           const planner::base::HorizonSettings& settings) {
  return settings.planned_acceleration(request.vehicle.max_acceleration);
}

double hardest_acceleration(const planner::horizon::PathRequest& request,
                            const planner::base::HorizonSettings& settings) {
  return settings.emergency_acceleration(request.vehicle.max_acceleration);
}

}  // namespace jink::tools::lab::baselines
