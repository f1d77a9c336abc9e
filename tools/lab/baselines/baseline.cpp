// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/baseline.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "planner/base/portable_math.hpp"
#include "planner/base/solid.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/verify/solid_contact.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr double kClockRounding = 1e-9;  // s, of the companion's clock
constexpr double kSlope = 0.1;           // s, over which a known path's present velocity is taken
constexpr double kSameTime = 1e-6;       // s, between contacts that count as simultaneous
constexpr double kAtTarget = 1e-6;       // m
constexpr double kSlopeStep = 1e-4;      // m, over which the slope of a distance is taken
constexpr double kBeneath = 0.01;        // m, at least, from what one is in to the middle of its nearest part

}  // namespace

void BaselineTask::start(bridge::companion::PlanJob job) {
  assert(!result_);
  bridge::companion::PlanResult& result = result_.emplace();
  result.job = std::move(job);
  result.job.map.append_to(result.job.tracks);
  result.job.request.tracks = result.job.tracks;
  result.job.request.paths = result.job.paths;
  if (planner::horizon::is_valid(result.job.request)) result.plan = baseline_->plan(result.job);
  result.ms = 1e3 * latency_;
}

std::optional<bridge::companion::PlanResult> BaselineTask::poll(double now) {
  if (!result_ || now + kClockRounding < result_->job.begun + latency_) return std::nullopt;
  std::optional<bridge::companion::PlanResult> result = std::exchange(result_, std::nullopt);
  result->missed = now > result->job.start + kClockRounding;
  return result;
}

std::vector<planner::base::Track> inflated_obstacles(const planner::horizon::PathRequest& request,
                                                     const planner::base::HorizonSettings& settings) {
  std::vector<planner::base::Track> spheres(request.tracks.begin(), request.tracks.end());
  for (const planner::geometry::KnownPath& path : request.paths) {
    planner::base::Track track;
    track.id = path.id;
    track.position = path.position(0.0);
    track.velocity = (path.position(kSlope) - track.position) / kSlope;
    track.radius = path.radius + path.margin;
    track.position_sigma = path.position_sigma;
    track.velocity_sigma = path.velocity_sigma;
    track.age = path.age;
    spheres.push_back(track);
  }
  for (planner::base::Track& sphere : spheres) {
    const double sigma = planner::base::hypotenuse(sphere.position_sigma, sphere.velocity_sigma * sphere.age);
    if (sphere.body.solid) sphere.radius = sphere.body.solid->reach();
    sphere.radius +=
        request.vehicle.radius + request.margin + std::min(settings.clearance_limit, settings.sigma_factor * sigma);
  }
  return spheres;
}

double body_gap(const planner::base::Track& inflated) {
  return inflated.radius - inflated.body.solid->reach();
}

double body_distance(const planner::base::Track& track, const Vec3& center, double t, const Vec3& point) {
  return planner::verify::solid_distance(track.body.later(t), point - center);
}

planner::base::Track nearest_part(const planner::base::Track& inflated, const Vec3& point) {
  const auto distance = [&](const Vec3& place) { return body_distance(inflated, inflated.position, 0.0, place); };
  Vec3 outwards;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kSlopeStep * Vec3::Unit(axis);
    outwards[axis] = distance(point + step) - distance(point - step);
  }
  // In the middle of a hull there is no slope.
  if (outwards.norm() < kSlopeStep) outwards = point - inflated.position;
  outwards = outwards.norm() > 0.0 ? outwards.normalized() : Vec3::UnitZ();
  planner::base::Track part = inflated;
  part.position = point - std::max(distance(point), kBeneath) * outwards;
  const Vec3 arm = part.position - inflated.position;
  part.velocity += inflated.body.yaw_rate * Vec3(-arm.y(), arm.x(), 0.0);
  part.radius = body_gap(inflated);
  part.body = {};
  return part;
}

planner::verify::Verification check(const planner::base::TimedPath& path, const planner::horizon::PathRequest& request,
                                    double margin, double until) {
  planner::base::TimedPath looked_at = path;
  if (std::isfinite(until) && !path.empty() && path.back().t < until)
    looked_at.push_back({until, path.back().position, Vec3::Zero(), Vec3::Zero()});
  return planner::verify::verify({looked_at, request.tracks, 0.0, request.vehicle.radius + margin, request.volume,
                                  request.acceleration_trust, until, request.paths});
}

planner::verify::Plan verified_plan(planner::base::TimedPath path, const planner::horizon::PathRequest& request,
                                    double horizon) {
  planner::verify::Plan plan;
  plan.path = std::move(path);
  plan.verification = check(plan.path, request, 0.0, horizon);
  if (!plan.verification.free()) {
    plan.status = planner::verify::PlanStatus::kBlocked;
    return plan;
  }
  plan.status = planner::verify::PlanStatus::kProgresses;
  if ((plan.path.back().position - request.target).norm() > kAtTarget) return plan;
  const planner::verify::Verification whole = check(plan.path, request, 0.0, std::max(horizon, plan.path.back().t));
  if (!whole.free()) return plan;
  plan.status = planner::verify::PlanStatus::kReaches;
  plan.verification = whole;
  return plan;
}

bool is_safer(const planner::verify::Verification& a, const planner::verify::Verification& b) {
  if (a.free() != b.free()) return a.free();
  if (a.free()) return a.min_clearance > b.min_clearance;
  if (a.first_contact.has_value() != b.first_contact.has_value()) return !a.first_contact;
  if (!a.first_contact) return false;
  if (std::abs(*a.first_contact - *b.first_contact) > kSameTime) return *a.first_contact > *b.first_contact;
  return a.contact_speed < b.contact_speed;
}

}  // namespace jink::tools::lab::baselines
