// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/rrt_star.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/base/solid.hpp"
#include "tools/lab/baselines/path_builder.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr std::uint64_t kRrtStream = 0x7272742aULL;  // "rrt*" in ASCII: apart from the other users of the seed
constexpr double kLookShare = 0.75;                  // of the time looked ahead, that the goal is away at cruise speed
constexpr double kSlackShare = 0.5;                  // of it, by which a place may be reached later
constexpr double kTargetTolerance = 0.2;             // m
constexpr double kOnTheWay = 1.5;                    // m, to a goal that is not the target
constexpr double kTouching = 0.01;                   // m, left to a sphere that the start is too near to
constexpr double kCornerMargin = 0.1;  // m, kept beyond the margin, since the motion cuts the way's corners
constexpr double kHintStep = 0.5;      // s, between the places of the previous plan that seed the search

/// Where the search looks: around the way to the goal, in the volume.
planner::base::Box region(const planner::horizon::PathRequest& request, const Vec3& goal, double aside) {
  planner::base::Box box{request.position.cwiseMin(goal) - Vec3::Constant(aside),
                         request.position.cwiseMax(goal) + Vec3::Constant(aside)};
  box.min = box.min.cwiseMax(request.volume.min);
  box.max = box.max.cwiseMin(request.volume.max);
  return box;
}

planner::base::TimedPath as_path(const std::vector<SpaceTime>& way) {
  planner::base::TimedPath path;
  for (const SpaceTime& place : way) path.push_back({place.t, place.position, Vec3::Zero(), Vec3::Zero()});
  return path;
}

/// A path that could be flown.
struct Candidate {
  planner::base::TimedPath path;
  bool is_previous = false;
  bool is_emergency = false;
};

/// The one that keeps the margin and is at the target first, the way from its end being straight; the previous plan,
/// unless another one is clearly better. Null where none keeps the margin.
Candidate* best_with_margin(std::vector<Candidate>& candidates, const planner::horizon::PathRequest& request,
                            const planner::base::HorizonSettings& settings) {
  Candidate* best = nullptr;
  double least = planner::base::kInfinity;
  for (Candidate& candidate : candidates) {
    if (!check(candidate.path, request, request.margin, settings.time).free()) continue;
    const planner::base::TimedPoint& end = candidate.path.back();
    const double time = end.t + (request.target - end.position).norm() / request.vehicle.cruise_speed;
    const double cost = candidate.is_previous ? time / (1.0 + settings.keep_ratio) : time;
    if (cost >= least) continue;
    least = cost;
    best = &candidate;
  }
  return best;
}

Candidate& least_harmful(std::vector<Candidate>& candidates, const planner::horizon::PathRequest& request,
                         const planner::base::HorizonSettings& settings) {
  std::size_t best = 0;
  std::vector<planner::verify::Verification> checks;
  for (const Candidate& candidate : candidates) checks.push_back(check(candidate.path, request, 0.0, settings.time));
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (is_safer(checks[i], checks[best])) best = i;
  }
  return candidates[best];
}

planner::verify::Plan made(Candidate& candidate, const planner::horizon::PathRequest& request,
                           const planner::base::HorizonSettings& settings) {
  planner::verify::Plan plan = verified_plan(std::move(candidate.path), request, settings.time);
  plan.kept_previous = candidate.is_previous;
  plan.emergency = candidate.is_emergency;
  return plan;
}

}  // namespace

SpaceTimeProblem RrtPilot::problem(const planner::horizon::PathRequest& request,
                                   std::vector<planner::base::Track>& spheres) const {
  const planner::base::HorizonSettings& horizon = settings_.horizon;
  spheres = inflated_obstacles(request, horizon);
  const double look = horizon.time * (kLookShare + kSlackShare);
  std::erase_if(spheres, [&](const planner::base::Track& sphere) {
    const double reach =
        (request.vehicle.cruise_speed + sphere.velocity.norm() + sphere.acceleration.norm() * look) * look;
    return (sphere.position - request.position).norm() - sphere.radius > reach + horizon.lateral_range;
  });
  for (planner::base::Track& sphere : spheres) {
    const double reach = sphere.body.solid ? sphere.body.solid->reach() : 0.0;
    const double distance = sphere.body.solid ? body_distance(sphere, sphere.position, 0.0, request.position)
                                              : (sphere.position - request.position).norm();
    // Already too near: no nearer.
    const double gap = std::min(sphere.radius - reach + kCornerMargin, std::max(distance - kTouching, kTouching));
    sphere.radius = reach + gap;
  }
  SpaceTimeProblem problem;
  problem.start = request.position;
  const Vec3 way = request.target - request.position;
  const double reach = kLookShare * horizon.time * request.vehicle.cruise_speed;
  const bool near = way.norm() <= reach;
  problem.goal = near ? request.target : Vec3(request.position + way * (reach / way.norm()));
  problem.tolerance = near ? kTargetTolerance : kOnTheWay;
  problem.region = region(request, problem.goal, horizon.lateral_range);
  problem.spheres = spheres;
  problem.acceleration_trust = request.acceleration_trust;
  problem.speed = request.vehicle.cruise_speed;
  problem.climb = request.vehicle.max_climb;
  problem.slack = kSlackShare * horizon.time;
  return problem;
}

std::vector<SpaceTime> RrtPilot::search(const bridge::companion::PlanJob& job) const {
  std::vector<planner::base::Track> spheres;
  const SpaceTimeProblem asked = problem(job.request, spheres);
  std::vector<SpaceTime> hints;
  if (!job.previous.empty()) {
    const double last = std::min(kLookShare * settings_.horizon.time, job.previous.back().t);
    for (double t = kHintStep; t < last; t += kHintStep)
      hints.push_back({t, planner::base::sample(job.previous, t).position});
  }
  return search_space_time(asked, search_, hints, settings_.seed ^ kRrtStream, job.number);
}

planner::verify::Plan RrtPilot::plan(const bridge::companion::PlanJob& job) {
  const planner::horizon::PathRequest& request = job.request;
  const planner::base::HorizonSettings& horizon = settings_.horizon;
  const double normal = normal_acceleration(request, horizon);
  PathBuilder unobstructed(request, horizon, normal);
  unobstructed.fly_to_target();
  if (check(unobstructed.path(), request, request.margin, horizon.time).free())
    return verified_plan(unobstructed.path(), request, horizon.time);

  const planner::base::TimedPath way = as_path(search(job));
  std::vector<Candidate> candidates;
  if (!job.previous.empty()) candidates.push_back({planner::base::remainder(job.previous, 0.0), true, false});
  PathBuilder on(request, horizon, normal);
  on.follow(way);
  PathBuilder waiting = on;
  on.fly_to_target();
  waiting.stop();
  candidates.push_back({on.path(), false, false});
  candidates.push_back({waiting.path(), false, false});
  if (Candidate* best = best_with_margin(candidates, request, horizon)) return made(*best, request, horizon);

  const double hardest = hardest_acceleration(request, horizon);
  PathBuilder hard(request, horizon, hardest);
  hard.follow(way);
  hard.stop();
  candidates.push_back({hard.path(), false, true});
  PathBuilder stop(request, horizon, hardest);
  stop.stop(true);
  candidates.push_back({stop.path(), false, true});
  return made(least_harmful(candidates, request, horizon), request, horizon);
}

}  // namespace jink::tools::lab::baselines
