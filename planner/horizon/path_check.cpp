// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/path_check.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "planner/geometry/validity.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kSamePlace = 1e-6;  // m
constexpr double kStray = 0.06;      // m, kArrival and what a path that leads back to a plan turns

}  // namespace

bool is_valid(const PathRequest& request) {
  using geometry::is_amount, geometry::is_within;
  return is_within(request.position, geometry::kFarthest) && is_within(request.velocity, geometry::kFastest) &&
         is_within(request.target, geometry::kFarthest) && geometry::is_valid(request.vehicle) &&
         is_amount(request.margin) && is_amount(request.standing_margin, base::kInfinity) &&
         std::all_of(request.standing.begin(), request.standing.end(),
                     [](const base::Track& t) { return geometry::is_valid(t) && geometry::is_at_rest(t); }) &&
         is_amount(request.track_acceleration, geometry::kHardest) && is_amount(request.volume_clearance) &&
         is_amount(request.sudden_change, geometry::kFastest) && is_amount(request.time_price, geometry::kFastest) &&
         std::all_of(request.way.begin(), request.way.end(),
                     [](const Vec3& place) { return is_within(place, geometry::kFarthest); }) &&
         geometry::is_valid_world(request.volume, request.tracks, request.paths, request.acceleration_trust);
}

bool continues(const base::TimedPath& path, const PathRequest& request, double step) {
  if (!geometry::is_valid_path(path) || path.front().t > 0.0) return false;
  const Vec3 first = base::sample(path, 0.0).position;
  const Vec3 later = base::sample(path, step).position;
  return geometry::is_within(first - request.position, kSamePlace) &&
         geometry::is_within(later - first - step * request.velocity,
                             request.vehicle.max_acceleration * step * step + kStray);
}

verify::Verification verify_until(const base::TimedPath& path, const PathRequest& request, double until) {
  const auto check = [&](std::span<const base::TimedPoint> points) {
    return verify::verify({points,
                           request.tracks,
                           0.0,
                           request.vehicle.radius,
                           request.volume,
                           request.acceleration_trust,
                           until,
                           request.paths,
                           {},
                           request.standing});
  };
  if (path.empty() || !std::isfinite(until) || path.back().t >= until) return check(path);
  base::TimedPath waiting = path;
  waiting.push_back({until, path.back().position, Vec3::Zero(), Vec3::Zero()});
  return check(waiting);
}

bool keeps_margins(const base::TimedPath& path, const PathRequest& request, double until,
                   const verify::Verification& found) {
  if (!found.free() || found.min_clearance >= request.margin) return found.free();
  if (found.min_clearance < request.margin_beside_standing()) return false;
  PathRequest others = request;
  others.standing = {};
  return verify_until(path, others, until).min_clearance >= request.margin;
}

bool arrives(const base::TimedPath& path, const PathRequest& request) {
  return (path.back().position - request.target).norm() < 1e-6;
}

verify::LimitsUse use_of_limits(const base::TimedPath& path, const PathRequest& request, double step) {
  const base::VehicleLimits& vehicle = request.vehicle;
  return verify::use_of_limits(path, {request.velocity, vehicle.max_speed, vehicle.max_climb, vehicle.max_acceleration,
                                      step, arrives(path, request)});
}

bool is_safer(const verify::Verification& a, const verify::Verification& b) {
  if (a.free() != b.free()) return a.free();
  if (a.valid != b.valid) return a.valid;
  if (a.free()) return a.min_clearance > b.min_clearance;
  if (a.inside_volume != b.inside_volume && !a.first_contact) return a.inside_volume;
  const double until_a = a.first_contact.value_or(base::kInfinity);
  const double until_b = b.first_contact.value_or(base::kInfinity);
  if (std::abs(until_a - until_b) > 1e-6) return until_a > until_b;
  return a.contact_speed < b.contact_speed;
}

}  // namespace jink::planner::horizon
