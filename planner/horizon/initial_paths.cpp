// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/initial_paths.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/gaps.hpp"
#include "planner/horizon/path_scene.hpp"

namespace jink::planner::horizon {
namespace {

constexpr std::size_t kEncounters = 3;  // looked at, the first ones
constexpr double kOnTime = 1.2;         // s, about an encounter, in which a displacement is held in full
constexpr double kStopBraking = 2.0;    // m/s², of a gentle stop
constexpr double kStopStep = 0.1;       // s
constexpr double kReturn = 1.0;         // s, in which it fades before and after
constexpr double kDifference = 0.05;    // s, over which twice a known path's velocity is taken
constexpr int kPasses = 3;              // times at which an opening is looked for, one for each waypoint
constexpr std::size_t kOpenings = 3;    // at each
constexpr double kOpeningReach = 1.0;   // s, about the passage, in which an opening's motion is followed

/// Where unobstructed flight comes too close to an obstacle.
struct Encounter {
  double t = 0.0;       // of the closest approach
  Vec3 apart;           // from the obstacle to the vehicle, then
  Vec3 closing;         // velocity of the vehicle relative to the obstacle, then
  double wanted = 0.0;  // distance between the centres
};

/// The closest approach of unobstructed flight to an obstacle of which `position` and `velocity` tell at a time, where
/// it is nearer than `wanted`.
template <typename Position, typename Velocity>
std::optional<Encounter> encounter(const base::TimedPath& unobstructed, double until, double wanted,
                                   const Position& position, const Velocity& velocity) {
  Encounter e;
  e.wanted = wanted;
  double least = wanted * wanted;
  bool met = false;
  for (const base::TimedPoint& point : unobstructed) {
    if (point.t > until) break;
    const Vec3 apart = point.position - position(point.t);
    if (apart.squaredNorm() >= least) continue;
    least = apart.squaredNorm();
    met = true;
    e.t = point.t;
    e.apart = apart;
    e.closing = point.velocity - velocity(point.t);
  }
  if (!met) return std::nullopt;
  return e;
}

/// The first encounters, in order of time.
std::vector<Encounter> encounters(const PathRequest& request, const base::TimedPath& unobstructed, double until,
                                  double clearance) {
  std::vector<Encounter> list;
  const double trust = request.acceleration_trust;
  for (const base::Track& track : request.tracks) {
    const auto e = encounter(
        unobstructed, until, track.radius + request.vehicle.radius + clearance,
        [&](double t) { return geometry::predict_position(track, t, trust); },
        [&](double t) { return geometry::predict_velocity(track, t, trust); });
    if (e) list.push_back(*e);
  }
  for (const geometry::KnownPath& path : request.paths) {
    const auto velocity = [&](double t) -> Vec3 {
      return (path.position(t + kDifference) - path.position(t - kDifference)) / (2.0 * kDifference);
    };
    const auto e = encounter(
        unobstructed, std::min(until, path.until), path.radius + path.margin + request.vehicle.radius + clearance,
        [&](double t) { return path.position(t); }, velocity);
    if (e) list.push_back(*e);
  }
  const std::size_t first = std::min(kEncounters, list.size());
  std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(first), list.end(),
                    [](const Encounter& a, const Encounter& b) { return a.t < b.t; });
  list.resize(first);
  return list;
}

/// The displacements that lead past an obstacle, in the plane across the relative motion: near side, far side, and
/// across them either way.
std::array<Vec3, 4> ways_past(const Encounter& e, const Vec3& heading) {
  const double speed = e.closing.norm();
  const Vec3 along = speed > 1e-6 ? Vec3(e.closing / speed) : heading;
  const Vec3 across = e.apart - e.apart.dot(along) * along;
  Vec3 side = across;
  if (side.norm() < 1e-6) side = along.cross(Vec3::UnitZ());  // dead centre: any side will do
  if (side.norm() < 1e-6) side = Vec3::UnitX();
  side.normalize();
  const Vec3 other = along.cross(side);
  return {e.wanted * side - across, -e.wanted * side - across, e.wanted * other - across, -e.wanted * other - across};
}

/// Unobstructed flight with `displacement` about time `t`: all of it while it counts, none before and after; but what
/// it falls behind (or hurries ahead) along `heading` stays.
base::TimedPath displaced(const base::TimedPath& unobstructed, std::span<const double> times, double t,
                          const Vec3& displacement, const Vec3& heading) {
  base::TimedPath path;
  const Vec3 lag = displacement.dot(heading) * heading;
  for (const double time : times) {
    const double off = std::abs(time - t) - 0.5 * kOnTime;
    const double share = std::clamp(1.0 - off / kReturn, 0.0, 1.0);
    const Vec3 offset = share * displacement + (time > t ? 1.0 - share : 0.0) * lag;
    path.push_back({time, base::sample(unobstructed, time).position + offset, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

/// The point of unobstructed flight's line beside an obstacle that is met.
Vec3 across(const base::TimedPath& unobstructed, const geometry::PathFrame& frame, const Encounter& e) {
  return base::sample(unobstructed, e.t).position - e.apart.dot(frame.axis) * frame.axis;
}

/// Through an opening at time `t`: unobstructed flight, as late as it takes to be at the opening then, and beside its
/// line from the start on until past the opening; then on, and at its end to the target.
base::TimedPath through(const base::TimedPath& unobstructed, std::span<const double> times, double t,
                        const Gap& opening, const geometry::PathFrame& frame) {
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
    const Vec3 place = opening.position + std::clamp(after, -kOpeningReach, kOpeningReach) * opening.velocity;
    const Vec3 aside = place - along(place) * frame.axis;
    path.push_back({time, arrives ? on_line : Vec3(aside + along(on_line) * frame.axis), Vec3::Zero(), Vec3::Zero()});
    is_past = after > 0.0;
  }
  return path;
}

/// The ways through what is met first, at the next waypoints' times.
void add_ways_through(std::vector<base::TimedPath>& paths, const PathRequest& request, const geometry::PathFrame& frame,
                      const base::TimedPath& unobstructed, std::span<const double> times, const Encounter& e,
                      double clearance) {
  const Vec3 centre = across(unobstructed, frame, e);
  int passes = 0;
  for (const double time : times) {
    if (time < e.t || passes == kPasses) continue;
    ++passes;
    for (const Gap& opening : find_gaps(request, frame, centre, time, clearance, kOpenings)) {
      paths.push_back(through(unobstructed, times, time, opening, frame));
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

/// Unobstructed flight as far as `distance` from its start, and a gentle stop there.
base::TimedPath stopped_short(const base::TimedPath& unobstructed, std::span<const double> times, double distance,
                              const Vec3& heading) {
  base::TimedPath path;
  double travelled = 0.0;
  double t = 0.0;
  for (const double time : times) {
    for (; t < time - 0.5 * kStopStep; t += kStopStep) {
      const double left = std::max(0.0, distance - travelled);
      const double speed = base::sample(unobstructed, t + kStopStep).velocity.norm();
      travelled += kStopStep * std::min({speed, std::sqrt(2.0 * kStopBraking * left), left / kCatchUp});
    }
    path.push_back({time, unobstructed.front().position + travelled * heading, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

}  // namespace

std::vector<base::TimedPath> initial_paths(const PathRequest& request, const base::TimedPath& unobstructed,
                                           std::span<const double> times, double clearance) {
  std::vector<base::TimedPath> paths;
  const geometry::PathFrame frame(request.position, request.target);
  const double until = times.back();
  const std::vector<Encounter> met = encounters(request, unobstructed, until, clearance);
  if (!met.empty()) add_ways_through(paths, request, frame, unobstructed, times, met.front(), clearance);
  for (const Encounter& e : met) {
    for (const Vec3& displacement : ways_past(e, frame.axis)) {
      paths.push_back(displaced(unobstructed, times, e.t, displacement, frame.axis));
    }
    const Vec3 centre = base::sample(unobstructed, e.t).position - e.apart;
    const double before = (centre - request.position).dot(frame.axis) - e.wanted;
    paths.push_back(stopped_short(unobstructed, times, std::max(0.0, before), frame.axis));
  }
  for (const double rate : {0.9, 0.8, 0.65, 0.4, 1.3}) {
    paths.push_back(warped(unobstructed, times, [&](double t) { return rate * t; }));
  }
  for (const double wait : {0.5, 1.0, 2.0, 4.0}) {
    paths.push_back(warped(unobstructed, times, [&](double t) { return std::max(0.0, t - wait); }));
  }
  paths.push_back(warped(unobstructed, times, [](double) { return 0.0; }));
  for (const double distance : {0.7, 1.5, 3.0}) {
    for (const Vec3& side : {frame.left, Vec3(-frame.left), frame.up, Vec3(-frame.up)}) {
      paths.push_back(displaced(unobstructed, times, 0.0, Vec3::Zero(), frame.axis));
      for (std::size_t k = 0; 3 * k < 2 * times.size(); ++k) paths.back()[k].position += distance * side;
    }
  }
  return paths;
}

std::optional<Vec3> gap_ahead(const PathRequest& request, const base::TimedPath& unobstructed, double until,
                              double clearance) {
  const geometry::PathFrame frame(request.position, request.target);
  const std::vector<Encounter> met = encounters(request, unobstructed, until, clearance);
  if (met.empty()) return std::nullopt;
  const auto places = find_gaps(request, frame, across(unobstructed, frame, met.front()), until, clearance, 1);
  if (places.empty() || places.front().lacking > 0.0) return std::nullopt;
  return places.front().position;
}

}  // namespace jink::planner::horizon
