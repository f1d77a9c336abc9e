// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/encounters.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "planner/geometry/geometry.hpp"
#include "planner/horizon/each_obstacle.hpp"
#include "planner/horizon/gaps.hpp"

namespace jink::planner::horizon {
namespace {

/// How far aside a vehicle can be that much later: from rest to rest, and no more than that share of the usual, m.
double aside_within(double time, const PathRequest& request, const base::HorizonSettings& settings) {
  const double acceleration = settings.planned_acceleration(request.vehicle.max_acceleration);
  return std::min(settings.lateral_range * time / settings.time, 0.25 * acceleration * time * time);
}

/// Unobstructed flight and a sphere, where they are nearest.
template <typename Obstacle>
std::optional<Encounter> met_sphere(const Obstacle& obstacle, const base::TimedPath& unobstructed, double until) {
  double least = obstacle.wanted * obstacle.wanted;
  std::optional<Encounter> met;
  for (const base::TimedPoint& point : unobstructed) {
    if (point.t > std::min(until, obstacle.until)) break;
    const Vec3 apart = point.position - obstacle.position(point.t);
    if (apart.squaredNorm() >= least) continue;
    least = apart.squaredNorm();
    met = {point.t, point.t, apart, apart, point.velocity - obstacle.velocity(point.t), obstacle.wanted, {}};
  }
  return met;
}

/// The same with a solid, where flight comes too close first: it may go through it for long.
template <typename Obstacle>
std::optional<Encounter> met_solid(const Obstacle& obstacle, const base::TimedPath& unobstructed, double until) {
  std::optional<Encounter> met;
  for (const base::TimedPoint& point : unobstructed) {
    if (point.t > std::min(until, obstacle.until)) break;
    const Vec3 apart = point.position - obstacle.position(point.t);
    if (apart.squaredNorm() >= obstacle.wanted * obstacle.wanted) continue;
    const PlacedSolid solid = obstacle.solid(point.t);
    const double distance = solid.distance(point.position);
    if (distance >= obstacle.kept) continue;
    if (!met) {
      const Vec3 closing = point.velocity - obstacle.velocity(point.t);
      met = {point.t, point.t, apart, distance * solid.outward(point.position), closing, obstacle.kept, solid};
    }
    met->until = point.t;
  }
  return met;
}

}  // namespace

std::vector<Encounter> encounters(const PathRequest& request, const base::TimedPath& unobstructed, double until,
                                  const base::HorizonSettings& settings) {
  std::vector<Encounter> list;
  for_each_obstacle(request, first_clearance(request, settings), [&](const auto& obstacle) {
    const std::optional<Encounter> met = obstacle.body.solid == nullptr ? met_sphere(obstacle, unobstructed, until)
                                                                        : met_solid(obstacle, unobstructed, until);
    if (met) list.push_back(*met);
  });
  const std::size_t first = std::min(static_cast<std::size_t>(settings.encounters), list.size());
  std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(first), list.end(),
                    [](const Encounter& a, const Encounter& b) { return a.t < b.t; });
  list.resize(first);
  return list;
}

Extent extent_of(const PathRequest& request, const base::TimedPath& unobstructed,
                 const base::HorizonSettings& settings) {
  base::HorizonSettings near = settings.for_brief();
  const bool is_led = !request.way.empty() && !request.visit;  // to a place that is passed
  const Vec3 soon = base::sample(unobstructed, near.horizon()).position;
  const bool stays = (soon - request.target).norm() <= settings.near_target;
  const bool brief = near.time < settings.time && (is_led || (!stays && !request.stuck));
  const std::vector<Encounter> met =
      encounters(is_led ? request.without_standing() : request, unobstructed, settings.horizon(), settings);
  if (met.empty()) return brief ? Extent::kBrief : Extent::kUsual;
  const geometry::PathFrame frame(request.position, request.target);
  const Vec3 centre = beside(unobstructed, frame, met.front());
  const auto leads_on = [&](const base::HorizonSettings& within) {
    const std::vector<double> times = passages(within, met.front().t);
    return std::any_of(times.begin(), times.end(), [&](double t) {
      const std::vector<Gap> gaps = find_gaps(request, frame, centre, t, within, 1);
      return !gaps.empty() && gaps.front().lacking <= 0.0 &&
             (gaps.front().position - centre).norm() <= within.lateral_range;
    });
  };
  near.lateral_range = aside_within(near.time, request, settings);
  if (met.front().t > near.horizon()) near.time = settings.time;
  if (brief && leads_on(near)) return Extent::kBrief;
  if (leads_on(settings)) return Extent::kUsual;
  return leads_on(settings.for_far()) ? Extent::kFar : Extent::kUsual;
}

}  // namespace jink::planner::horizon
