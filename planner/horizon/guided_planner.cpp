// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/guided_planner.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/horizon/polyline.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kPatience = 1.0 / 3;  // of the horizon, that may be lost on a way before others are looked at
constexpr double kHeld = 4.0;          // m, from the vehicle, that its plan leads at most meanwhile
constexpr double kBeside = 2.0;        // m, from there, that something comes
constexpr double kMoves = 0.1;         // m, by which that is elsewhere before or after
constexpr double kLookStep = 0.5;      // s
constexpr double kBlocked = 0.5;       // s, for which that lasts before
constexpr double kRegret = 1.0;        // s, by which another arrives earlier to be taken
constexpr double kWait = 1.0;          // s, that a way in time waits at one place; who waits less follows something

/// Where it is known to lead to.
base::TimedPoint known_end(const verify::Plan& plan) {
  return base::sample(plan.path, std::min(plan.horizon, plan.path.back().t));
}

/// Whether something that moves comes near a place within so many seconds.
bool is_crossed(const PathRequest& request, const Vec3& place, double until) {
  const double near = request.vehicle.radius + request.margin + kBeside;
  const auto comes = [&](double radius, const auto& position) {
    bool moves = false, comes_near = false;
    for (double t = 0.0; t <= until; t += kLookStep) {
      moves = moves || (position(t) - position(0.0)).norm() > kMoves;
      comes_near = comes_near || (position(t) - place).norm() - radius < near;
    }
    return moves && comes_near;
  };
  return std::any_of(request.tracks.begin(), request.tracks.end(),
                     [&](const base::Track& track) {
                       return comes(track.radius, [&](double t) {
                         return geometry::predict_position(track, t, request.acceleration_trust);
                       });
                     }) ||
         std::any_of(request.paths.begin(), request.paths.end(), [&](const geometry::KnownPath& path) {
           return comes(path.radius, [&](double t) { return path.position(t); });
         });
}

/// When a plan along a way gets to the flight's target, s, if it goes on at cruise speed after what is known of it.
double arrival(const verify::Plan& plan, std::span<const Vec3> way, double cruise) {
  if (!plan.verification.free()) return base::kInfinity;
  const base::TimedPoint end = known_end(plan);
  return end.t + left_along(way, end.position) / cruise;
}

}  // namespace

GuidedPlanner::Surroundings GuidedPlanner::surround(PathRequest& request) const {
  Surroundings around{{}, {}, {guide_.standing().begin(), guide_.standing().end()}};
  if (around.ids.empty()) return around;
  around.tracks.assign(request.tracks.begin(), request.tracks.end());
  around.standing.assign(request.standing.begin(), request.standing.end());
  set_apart(around.ids, around.tracks, around.standing);
  request.tracks = around.tracks;
  request.standing = around.standing;
  return around;
}

WayInTime GuidedPlanner::way_in_time(const PathRequest& request, const base::TimedPoint& from) {
  return in_time_.find(request, from, planner_.settings().guide_cell);
}

// What a plan comes to cannot go on as soon as the way, or not stay.
bool GuidedPlanner::is_behind(const verify::Plan& plan, const WayInTime& way, const PathRequest& request) {
  WayInTime on;
  if (plan.verification.free()) on = way_in_time(request, known_end(plan));
  return way.arrival + kRegret < on.arrival || (way.stays && !on.stays);
}

// The way to where a way in time waits first, within the horizon; none where it does not wait.
std::vector<Vec3> GuidedPlanner::up_to_wait(const WayInTime& way) const {
  std::vector<Vec3> places;
  const double horizon = planner_.settings().horizon();
  for (std::size_t i = 0; i < way.path.size() && way.path[i].t <= horizon; ++i) {
    places.push_back(way.path[i].position);
    const bool ends = i + 1 == way.path.size();
    const bool waits = ends ? way.arrival == base::kInfinity
                            : way.path[i + 1].position == places.back() && way.path[i + 1].t > way.path[i].t + kWait;
    if (waits) return places;
  }
  return {};
}

verify::Plan GuidedPlanner::plan(PathRequest& request, double now, const MapPlace& map, base::TimedPath& previous,
                                 std::uint64_t seed, std::uint64_t number, const base::Budget& budget,
                                 base::WorkerPool& pool) {
  const PathRequest given = request;
  guide_.lead(request, now, map);
  around_ = surround(request);
  const base::TimedPoint here{0.0, request.position, request.velocity, Vec3::Zero()};
  // To where the way waits, or to where it did before if there is none now; nothing where no free plan leads there.
  const auto plan_aside = [&](const WayInTime& in_time) -> std::optional<verify::Plan> {
    if (in_time.stays || in_time.arrival < base::kInfinity) aside_ = up_to_wait(in_time);
    if (aside_.empty()) return std::nullopt;
    PathRequest aside = request;
    aside.way = aside_;
    aside.target = aside_.back();
    verify::Plan plan = planner_.plan(aside, previous, seed, number, budget, pool);
    if (!plan.verification.free()) return std::nullopt;
    request = std::move(aside);
    return plan;
  };
  // That in place of a plan which is behind the way in time.
  const auto went_aside = [&](verify::Plan& best, const WayInTime& in_time) {
    if (!is_behind(best, in_time, request)) return false;
    std::optional<verify::Plan> plan = plan_aside(in_time);
    if (!plan) return false;
    plan->evaluations += best.evaluations;
    best = *std::move(plan);
    return true;
  };
  // What waits where it can stay, and sees no way on in time, goes on as soon as a plan does.
  std::optional<WayInTime> stay;
  if (!aside_.empty() && is_valid(request)) {
    stay = way_in_time(request, here);
    if (!stay->stays || stay->arrival < base::kInfinity) {
      if (std::optional<verify::Plan> plan = plan_aside(*stay)) return *std::move(plan);
      stay.reset();
    }
  }
  verify::Plan best = planner_.plan(request, previous, seed, number, budget, pool);
  if (stay && went_aside(best, *stay)) return best;
  aside_.clear();
  if (best.path.empty()) return best;
  const std::vector<Vec3> way = guide_.way().empty() ? std::vector{given.position, given.target}
                                                     : std::vector(guide_.way().begin(), guide_.way().end());
  const double cruise = given.vehicle.cruise_speed;
  double earliest = arrival(best, way, cruise);
  // Farther ahead a narrow place looks closed, until the margin gives way there.
  const Vec3 held_at = known_end(best).position;
  const bool loses = earliest > left_along(way, given.position) / cruise + kPatience * best.horizon;
  if (!loses || (held_at - given.position).norm() >= kHeld ||
      !is_crossed(request, held_at, planner_.settings().horizon())) {
    if (blocked_since_) guide_.forget_others();
    blocked_since_.reset();
    return best;
  }
  if (!blocked_since_) blocked_since_ = now;
  if (now - *blocked_since_ < kBlocked) return best;
  guide_.want_others();
  std::optional<std::size_t> taken;
  std::int64_t evaluations = best.evaluations;
  for (std::size_t k = 0; k < guide_.others().size(); ++k) {
    PathRequest other = given;
    guide_.lead_along(k, other);
    Surroundings around = surround(other);
    verify::Plan plan = planner_.plan(other, {}, seed, number, budget, pool);
    evaluations += plan.evaluations;
    const double arrives = arrival(plan, guide_.others()[k], cruise);
    if (!(arrives + kRegret < earliest)) continue;
    earliest = arrives;
    best = std::move(plan);
    request = std::move(other);
    around_ = std::move(around);
    taken = k;
  }
  best.evaluations = evaluations;
  if (taken) {
    previous.clear();
    guide_.take(*taken);
    blocked_since_.reset();
  } else if (!stay && !went_aside(best, way_in_time(request, here))) {
    aside_.clear();
  }
  return best;
}

}  // namespace jink::planner::horizon
