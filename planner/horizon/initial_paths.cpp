// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/initial_paths.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "planner/horizon/encounters.hpp"
#include "planner/horizon/gaps.hpp"
#include "planner/horizon/path_scene.hpp"
#include "planner/horizon/polyline.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kOnTime = 1.2;  // legs, about an encounter, in which a displacement is held in full
constexpr double kReturn = 1.0;  // legs, in which it fades before and after
constexpr double kFollow = 1.0;  // legs, about the passage, in which a gap's motion is followed

std::vector<double> waypoint_times(const base::HorizonSettings& settings) {
  std::vector<double> times;
  for (int k = 1; k <= settings.waypoints; ++k) times.push_back(k * settings.leg());
  return times;
}

/// The displacements that lead past an obstacle, in the plane across the relative motion: near side, far side, and
/// across them either way.
std::array<Vec3, 4> ways_past(const Encounter& e, const Vec3& heading) {
  const double speed = e.closing.norm();
  const Vec3 along = speed > 1e-6 ? Vec3(e.closing / speed) : heading;
  const Vec3 across = e.apart - e.apart.dot(along) * along;
  Vec3 side = e.solid.is_none() ? across : Vec3(Vec3::Zero());  // most solids stand upright
  if (side.norm() < 1e-6) side = along.cross(Vec3::UnitZ());    // dead centre: any side will do
  if (side.norm() < 1e-6) side = Vec3::UnitX();
  side.normalize();
  const Vec3 other = along.cross(side);
  return {e.extent(side) * side - across, -e.extent(-side) * side - across, e.extent(other) * other - across,
          -e.extent(-other) * other - across};
}

/// Unobstructed flight with `displacement` from time `first` to `last`: all of it while it counts, none before and
/// after; but what it falls behind (or hurries ahead) along `heading` stays.
base::TimedPath displaced(const base::TimedPath& unobstructed, std::span<const double> times, double first, double last,
                          const Vec3& displacement, const Vec3& heading, double leg) {
  base::TimedPath path;
  const Vec3 lag = displacement.dot(heading) * heading;
  for (const double time : times) {
    const double off = std::abs(time - std::clamp(time, first, last)) - 0.5 * kOnTime * leg;
    const double share = std::clamp(1.0 - off / (kReturn * leg), 0.0, 1.0);
    const Vec3 offset = share * displacement + (time > last ? 1.0 - share : 0.0) * lag;
    path.push_back({time, base::sample(unobstructed, time).position + offset, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

/// Through an opening at time `t`: unobstructed flight, as late as it takes to be at the opening then, and beside its
/// line from the start on until past the opening; then on, and at its end to the target.
base::TimedPath through(const base::TimedPath& unobstructed, std::span<const double> times, double t,
                        const Gap& opening, const geometry::PathFrame& frame, double leg) {
  const auto along = [&](const Vec3& position) { return (position - frame.origin).dot(frame.axis); };
  const double opens = along(opening.position);
  const auto there = std::find_if(unobstructed.begin(), unobstructed.end() - 1,
                                  [&](const auto& p) { return along(p.position) >= opens; });
  const double delay = std::max(0.0, t - there->t);
  base::TimedPath path;
  bool is_past = false;
  for (const double time : times) {
    const Vec3 on_line = base::sample(unobstructed, std::max(0.0, time - delay)).position;
    const double after = time - t;
    const bool arrives = is_past && time - delay >= unobstructed.back().t;
    const Vec3 place = opening.position + std::clamp(after, -kFollow * leg, kFollow * leg) * opening.velocity;
    const Vec3 aside = place - along(place) * frame.axis;
    path.push_back({time, arrives ? on_line : Vec3(aside + along(on_line) * frame.axis), Vec3::Zero(), Vec3::Zero()});
    is_past = after > 0.0;
  }
  return path;
}

/// The ways through what is met first, at the next waypoints' times.
void add_ways_through(std::vector<base::TimedPath>& paths, const PathRequest& request, const geometry::PathFrame& frame,
                      const base::TimedPath& unobstructed, std::span<const double> times, const Encounter& e,
                      const base::HorizonSettings& settings) {
  const Vec3 centre = beside(unobstructed, frame, e);
  for (const double time : passages(settings, e.t)) {
    for (const Gap& opening :
         find_gaps(request, frame, centre, time, settings, static_cast<std::size_t>(settings.gaps))) {
      paths.push_back(through(unobstructed, times, time, opening, frame, settings.leg()));
    }
  }
}

/// Unobstructed flight as far as it would have come at warped times.
template <typename Warp>
base::TimedPath warped(const base::TimedPath& unobstructed, std::span<const double> times, const Warp& warp) {
  base::TimedPath path;
  for (const double time : times) {
    path.push_back({time, base::sample(unobstructed, warp(time)).position, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

/// From the vehicle along the request's way at a speed, m/s, as far as it leads.
base::TimedPath along_way(const PathRequest& request, std::span<const double> times, double speed) {
  std::vector<Vec3> way{request.position};
  way.insert(way.end(), request.way.begin(), request.way.end());
  base::TimedPath path;
  for (const double time : times) path.push_back({time, place_along(way, speed * time), Vec3::Zero(), Vec3::Zero()});
  return path;
}

/// Unobstructed flight as far as `distance` from its start, and a gentle stop there.
base::TimedPath stopped_short(const base::TimedPath& unobstructed, std::span<const double> times, double distance,
                              const Vec3& heading, const base::HorizonSettings& settings) {
  base::TimedPath path;
  double travelled = 0.0;
  double t = 0.0;
  for (const double time : times) {
    for (; t < time - 0.5 * settings.step; t += settings.step) {
      const double left = std::max(0.0, distance - travelled);
      const double speed = base::sample(unobstructed, t + settings.step).velocity.norm();
      travelled +=
          settings.step * std::min({speed, std::sqrt(2.0 * settings.braking * left), left / settings.catch_up});
    }
    path.push_back({time, unobstructed.front().position + travelled * heading, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

}  // namespace

std::vector<base::TimedPath> initial_paths(const PathRequest& request, const base::TimedPath& unobstructed,
                                           const base::HorizonSettings& settings) {
  std::vector<base::TimedPath> paths;
  const geometry::PathFrame frame(request.position, request.target);
  const std::vector<double> times = waypoint_times(settings);
  const double until = settings.horizon();
  const std::vector<Encounter> met = encounters(request, unobstructed, until, settings);
  if (!request.way.empty()) {
    for (const double rate : {1.0, 0.7, 0.4})
      paths.push_back(along_way(request, times, rate * request.vehicle.cruise_speed));
  }
  if (!met.empty()) add_ways_through(paths, request, frame, unobstructed, times, met.front(), settings);
  for (const Encounter& e : met) {
    for (const Vec3& displacement : ways_past(e, frame.axis)) {
      paths.push_back(displaced(unobstructed, times, e.t, e.until, displacement, frame.axis, settings.leg()));
    }
    const Vec3 there = base::sample(unobstructed, e.t).position;
    const Vec3 centre = there - e.apart;
    const double before = e.solid.is_none() ? (centre - request.position).dot(frame.axis) - e.wanted
                                            : (there - request.position).dot(frame.axis);
    paths.push_back(stopped_short(unobstructed, times, std::max(0.0, before), frame.axis, settings));
  }
  for (const double rate : {0.9, 0.8, 0.65, 0.4, 1.3}) {
    paths.push_back(warped(unobstructed, times, [&](double t) { return rate * t; }));
  }
  for (const double wait : {until / 12.0, until / 6.0, until / 3.0, until / 1.5}) {
    paths.push_back(warped(unobstructed, times, [&](double t) { return std::max(0.0, t - wait); }));
  }
  paths.push_back(warped(unobstructed, times, [](double) { return 0.0; }));
  for (const double part : {0.125, 0.25, 0.5}) {
    for (const Vec3& side : {frame.left, Vec3(-frame.left), frame.up, Vec3(-frame.up)}) {
      paths.push_back(warped(unobstructed, times, [](double t) { return t; }));
      for (std::size_t k = 0; 3 * k < 2 * times.size(); ++k)
        paths.back()[k].position += part * settings.lateral_range * side;
    }
  }
  return paths;
}

std::optional<Vec3> gap_ahead(const PathRequest& request, const base::TimedPath& unobstructed,
                              const base::HorizonSettings& settings) {
  const geometry::PathFrame frame(request.position, request.target);
  const double until = settings.horizon();
  const std::vector<Encounter> met = encounters(request, unobstructed, until, settings);
  if (met.empty()) return std::nullopt;
  const auto places = find_gaps(request, frame, beside(unobstructed, frame, met.front()), until, settings, 1);
  if (places.empty() || places.front().lacking > 0.0) return std::nullopt;
  return places.front().position;
}

}  // namespace jink::planner::horizon
