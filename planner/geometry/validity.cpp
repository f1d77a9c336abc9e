// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/validity.hpp"

#include <algorithm>
#include <cmath>

#include "planner/base/solid.hpp"

namespace jink::planner::geometry {
namespace {

bool is_limit(double value, double most) {
  return value > 0.0 && value <= most;
}

}  // namespace

bool is_valid(const base::Box& volume) {
  const auto low = volume.min.array();
  const auto high = volume.max.array();
  return (low <= high).all() && (low == -base::kInfinity || low.abs() <= kFarthest).all() &&
         (high == base::kInfinity || high.abs() <= kFarthest).all();
}

bool is_valid(const base::VehicleLimits& vehicle) {
  return is_amount(vehicle.radius) && is_limit(vehicle.length, kFarthest) && is_limit(vehicle.mass, base::kInfinity) &&
         std::isfinite(vehicle.mass) && is_limit(vehicle.max_speed, kFastest) &&
         is_limit(vehicle.cruise_speed, kFastest) && is_limit(vehicle.max_climb, kFastest) &&
         is_limit(vehicle.max_acceleration, kHardest) && is_limit(vehicle.max_jerk, kFarthest) &&
         is_amount(vehicle.drag) && is_amount(vehicle.damping);
}

bool is_valid(const base::Body& body, double radius) {
  constexpr double kRounding = 1e-9;  // of the radius, and m
  if (body.solid == nullptr) return true;
  return std::abs(body.yaw) <= kTurned && std::abs(body.yaw_rate) <= kTurning &&
         body.solid->reach() * std::abs(body.yaw_rate) <= kFastest &&
         body.solid->reach() <= radius + kRounding * (1.0 + radius);
}

bool is_valid(const KnownPath& path) {
  return is_valid_path(path.points) && std::abs(path.offset) <= kLongest && is_amount(path.radius) &&
         is_amount(path.margin) && is_amount(path.position_sigma) && is_amount(path.velocity_sigma) &&
         is_amount(path.age, kLongest) && !std::isnan(path.until) && is_valid(path.body, path.radius);
}

bool is_valid_path(std::span<const base::TimedPoint> path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!is_within(path[i].position, kFarthest) || !(std::abs(path[i].t) <= kLongest)) return false;
    if (i == 0) continue;
    const double duration = path[i].t - path[i - 1].t;
    if (!(duration > 0.0) || !is_within(path[i].position - path[i - 1].position, kFastest * duration)) return false;
  }
  return !path.empty();
}

bool is_valid_world(const base::Box& volume, std::span<const base::Track> tracks, std::span<const KnownPath> paths,
                    double acceleration_trust) {
  return is_valid(volume) && acceleration_trust >= 0.0 &&
         std::all_of(tracks.begin(), tracks.end(), [](const base::Track& track) { return is_valid(track); }) &&
         std::all_of(paths.begin(), paths.end(), [](const KnownPath& path) { return is_valid(path); });
}

}  // namespace jink::planner::geometry
