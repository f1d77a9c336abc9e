// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/open_loop.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/elastic_band.hpp"
#include "planner/horizon/guided_planner.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/horizon/reach.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kJoint = 1e-9;  // s, within which two instants are the same
constexpr double kNear = 5.0;    // m, from a path, within which the map is looked at first

constexpr double kSecond = 0.05;    // m, of length, for which a path may take a second more
constexpr double kTimeGiven = 1.6;  // times a path's own, for it to be pulled tight; more leave hardly less length

/// All tracks, and of the map what is within `reach` of the box around the path.
std::vector<base::Track> tracks_along(const base::TimedPath& path, const OpenLoopRequest& request, double reach) {
  std::vector<base::Track> tracks(request.path.tracks.begin(), request.path.tracks.end());
  if (request.map == nullptr) return tracks;
  base::Box box{path.front().position, path.front().position};
  for (const base::TimedPoint& point : path) box = {box.min.cwiseMin(point.position), box.max.cwiseMax(point.position)};
  request.map->near(geometry::grown(box, reach), 0.0, tracks);
  return tracks;
}

/// Of the map what is near, and farther away only until nothing there can be the nearest.
verify::Verification verify_whole(const base::TimedPath& path, const OpenLoopRequest& request, double step) {
  const std::size_t all = request.path.tracks.size() + (request.map != nullptr ? request.map->tracks().size() : 0);
  PathRequest among = request.path;
  verify::Verification whole;
  for (double reach = kNear;; reach *= 4.0) {
    const std::vector<base::Track> tracks = tracks_along(path, request, reach);
    among.tracks = tracks;
    whole = verify_until(path, among, base::kInfinity);
    if (tracks.size() == all || whole.min_clearance + among.vehicle.radius <= reach) break;
  }
  whole.limits = use_of_limits(path, request.path, step);
  return whole;
}

/// When the path is at its last point by then, or at its first after time 0: between points the vehicle is not where
/// the motion with its velocity is, and a plan from there would begin with a jolt.
double at_a_point(const base::TimedPath& path, double wanted) {
  double t = path.back().t;
  for (std::size_t i = path.size(); i-- > 1 && t > wanted + kJoint;) t = path[i].t;
  return t;
}

/// Adds the first `keep` seconds of a part, which starts at time `t`, to the whole.
void append(const base::TimedPath& part, double t, double keep, base::TimedPath& whole) {
  for (const base::TimedPoint& point : part) {
    if (point.t > keep + kJoint) break;
    if (!whole.empty() && point.t <= kJoint) continue;
    whole.push_back({t + point.t, point.position, point.velocity, point.acceleration});
  }
  const base::TimedPoint end = base::sample(part, keep);
  if (t + keep > whole.back().t + kJoint) whole.push_back({t + keep, end.position, end.velocity, end.acceleration});
}

/// Verifies the plan's path, all of it, and says what it amounts to.
void judge(const OpenLoopRequest& request, double step, verify::Plan& plan) {
  plan.verification = verify_whole(plan.path, request, step);
  plan.status = verify::PlanStatus::kBlocked;
  if (!plan.verification.free()) return;
  const bool reaches = arrives(plan.path, request.path) && plan.verification.flyable();
  plan.status = reaches ? verify::PlanStatus::kReaches : verify::PlanStatus::kProgresses;
}

/// Plans one part after the other until the target, the time limit or the end of the budget.
verify::Plan attempt(HorizonPlanner& planner, const OpenLoopRequest& request, std::uint64_t seed,
                     const base::Budget& budget, base::WorkerPool& pool) {
  verify::Plan whole;
  PathRequest from = request.path;
  std::vector<base::Track> now, standing;
  std::vector<geometry::KnownPath> paths(request.path.paths.begin(), request.path.paths.end());
  from.paths = paths;
  base::TimedPath previous;
  GuidedPlanner guided(planner, Guide::Knowledge::kWhole);
  double t = 0.0;
  for (std::uint64_t number = 0;; ++number) {
    now.clear();
    for (const base::Track& track : request.path.tracks)
      now.push_back(geometry::predict(track, t, from.acceleration_trust));
    standing.clear();
    if (request.map != nullptr) request.map->near(reach_of(from, planner.settings()), 0.0, standing);
    from.tracks = now;
    from.standing = standing;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const geometry::KnownPath& at_start = request.path.paths[i];
      paths[i].offset = at_start.offset + t;
      paths[i].age = at_start.age + t;
      paths[i].until = at_start.until - t;
    }
    PathRequest led = from;
    verify::Plan part = guided.plan(led, t, {request.map}, previous, seed, number, budget, pool);
    if (part.status == verify::PlanStatus::kInvalid) return part;
    if (number == 0) whole.front = part.front;
    whole.evaluations += part.evaluations;
    whole.schedule = part.schedule;
    whole.generations = part.generations;
    whole.deadline_reached = whole.deadline_reached || part.deadline_reached || budget.expired();
    const double end = part.path.back().t;
    // What is known to be free: to the target, or as far as was looked ahead. Without time left that is the result.
    double wanted = std::min(request.commit, end);
    if (part.status == verify::PlanStatus::kReaches && led.target == from.target) wanted = end;
    if (part.status == verify::PlanStatus::kProgresses && budget.expired()) wanted = std::min(part.horizon, end);
    double keep = std::min(at_a_point(part.path, wanted), request.time_limit - t);
    const bool waits = keep == end && led.target != from.target;  // until there is a way on
    if (waits) keep = std::min(std::max(end, request.commit), request.time_limit - t);
    append(part.path, t, keep, whole.path);
    t += keep;
    if ((keep == end && !waits) || t + kJoint >= request.time_limit || budget.expired()) break;
    const base::TimedPoint next = base::sample(part.path, keep);
    from.position = next.position;
    from.velocity = next.velocity;
    previous = base::later(part.path, keep);
  }
  judge(request, planner.settings().step, whole);
  return whole;
}

/// The same way in so many times the time. A path that begins and ends at rest does so still.
base::TimedPath retimed(base::TimedPath path, double times) {
  for (base::TimedPoint& point : path) {
    point.t *= times;
    point.velocity /= times;
    point.acceleration /= times * times;
  }
  return path;
}

/// How many times its time a path needs to be flown with no more than the planned acceleration; below 1 it has more.
double time_needed(const base::TimedPath& path, const PathRequest& request, const base::HorizonSettings& settings) {
  const verify::LimitsUse use = use_of_limits(path, request, settings.step);
  const double most = request.vehicle.max_acceleration;
  const double acceleration = use.acceleration * most / settings.planned_acceleration(most);
  return std::max({use.speed, use.climb, std::sqrt(acceleration)});
}

/// What decides between plans that arrive, m: length, and time only where it costs hardly any.
double cost(const base::TimedPath& path) {
  return base::path_length(path) + kSecond * path.back().t;
}

/// Where the path arrives, and pulled tight is as good and costs less, or reaches where it did not, that is the path. A
/// band that is given time bends more; from rest it has as much as it needs.
void pull_tight(const OpenLoopRequest& request, const base::HorizonSettings& settings, verify::Plan& plan) {
  PathRequest from = request.path;
  if (plan.path.size() < 3 || !arrives(plan.path, from)) return;
  const std::vector<base::Track> tracks = tracks_along(plan.path, request, kNear);
  from.tracks = tracks;
  const double acceleration = settings.planned_acceleration(from.vehicle.max_acceleration);
  const double hardest = settings.emergency_acceleration(from.vehicle.max_acceleration);
  const double time_limit = std::max(request.time_limit, plan.path.back().t);
  const double clearance = plan.status == verify::PlanStatus::kReaches
                               ? std::min(from.margin, plan.verification.min_clearance)
                               : from.margin;
  const auto offer = [&](base::TimedPath tight) {
    if (tight.back().t > time_limit) return;
    verify::Plan offered;
    offered.path = std::move(tight);
    judge(request, settings.step, offered);
    if (offered.status != verify::PlanStatus::kReaches || offered.verification.min_clearance < clearance) return;
    if (offered.verification.limits.acceleration * from.vehicle.max_acceleration > hardest) return;
    if (plan.status == verify::PlanStatus::kReaches && cost(offered.path) >= cost(plan.path)) return;
    plan.path = std::move(offered.path);
    plan.verification = offered.verification;
    plan.status = offered.status;
  };
  const base::TimedPath given = plan.path;
  offer(elastic_band(given, from, acceleration));
  if (!from.velocity.isZero()) return;
  const base::TimedPath slow = elastic_band(retimed(given, kTimeGiven), from, acceleration);
  offer(slow);
  offer(retimed(slow, time_needed(slow, from, settings)));
}

/// The way that would be flown if there were nothing, pulled tight among what there is.
verify::Plan straight_way(HorizonPlanner& planner, const OpenLoopRequest& request, std::uint64_t seed,
                          const base::Budget& budget, base::WorkerPool& pool) {
  OpenLoopRequest empty = request;
  empty.path.tracks = {};
  empty.path.paths = {};
  empty.map = nullptr;
  verify::Plan plan = attempt(planner, empty, seed, budget, pool);
  judge(request, planner.settings().step, plan);
  pull_tight(request, planner.settings(), plan);
  return plan;
}

}  // namespace

verify::Plan plan_open_loop(const base::HorizonSettings& settings, const base::OptimizerSettings& optimizer,
                            const OpenLoopRequest& request, std::uint64_t seed, const base::Budget& budget,
                            base::WorkerPool& pool, const optimizer::MakeOptimizer& make) {
  if (!is_valid(request.path) || !(request.time_limit >= 0.0) || !(request.commit > 0.0)) return {};
  verify::Plan rest;
  rest.path.push_back({0.0, request.path.position, Vec3::Zero(), Vec3::Zero()});
  const double radius = request.path.vehicle.radius;
  if (verify::start_blocked(request.path.position, radius, tracks_along(rest.path, request, radius),
                            request.path.paths)) {
    verify::Plan plan = std::move(rest);
    plan.verification = verify_whole(plan.path, request, settings.step);
    plan.status = verify::PlanStatus::kStartBlocked;
    return plan;
  }
  HorizonPlanner planner(settings.for_known_motion(), optimizer, make);
  verify::Plan plan = attempt(planner, request, seed, budget, pool);
  if (plan.status == verify::PlanStatus::kInvalid) return plan;
  pull_tight(request, settings, plan);
  if (budget.expired()) return plan;
  const verify::Plan straight = straight_way(planner, request, seed, budget, pool);
  const auto worth = [&](const verify::Plan& p) {
    const double left = (p.path.back().position - request.path.target).norm();
    return std::tuple(p.status == verify::PlanStatus::kReaches, p.verification.free(), -left, -cost(p.path));
  };
  if (worth(straight) > worth(plan)) {
    plan.path = straight.path;
    plan.verification = straight.verification;
    plan.status = straight.status;
  }
  return plan;
}

}  // namespace jink::planner::horizon
