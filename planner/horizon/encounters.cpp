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

/// Whether, from settings.brief_time on, neither unobstructed flight nor one up to half as fast is near anything.
bool passes_soon(const PathRequest& request, const base::TimedPath& unobstructed, double until,
                 const base::HorizonSettings& settings) {
  std::vector<Vec3> slow;
  for (const base::TimedPoint& point : unobstructed) {
    slow.push_back(base::sample(unobstructed, 0.5 * point.t).position);
  }
  bool passes = true;
  for_each_obstacle(request, first_clearance(request, settings), [&](const auto& obstacle) {
    for (std::size_t i = 0; passes && i < slow.size(); ++i) {
      const base::TimedPoint& point = unobstructed[i];
      if (point.t > std::min(until, obstacle.until)) break;
      if (point.t <= settings.brief_time) continue;
      const Vec3 there = obstacle.position(point.t);
      const double squared = geometry::swept_distance_squared(slow[i], point.position, there, there);
      passes = squared >= obstacle.wanted * obstacle.wanted;
    }
  });
  return passes;
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
  const double until = settings.horizon();
  const std::vector<Encounter> met = encounters(request, unobstructed, until, settings);
  if (met.empty()) return Extent::kUsual;
  if (settings.far_range > settings.lateral_range || settings.far_time > settings.time) {
    const geometry::PathFrame frame(request.position, request.target);
    const Vec3 centre = beside(unobstructed, frame, met.front());
    const auto leads_on = [&](const base::HorizonSettings& within) {
      const std::vector<double> times = passages(within, met.front().t);
      return std::any_of(times.begin(), times.end(), [&](double t) {
        const std::vector<Gap> gaps = find_gaps(request, frame, centre, t, within, 1);
        return !gaps.empty() && gaps.front().lacking <= 0.0;
      });
    };
    if (!leads_on(settings) && leads_on(settings.for_far())) return Extent::kFar;
  }
  if (settings.brief_time < until && passes_soon(request, unobstructed, until, settings)) return Extent::kBrief;
  return Extent::kUsual;
}

}  // namespace jink::planner::horizon
