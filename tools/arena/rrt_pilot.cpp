// SPDX-License-Identifier: BSD-3-Clause
#include "tools/arena/rrt_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/arena/motion.hpp"

namespace jink::arena {
namespace {

constexpr std::uint64_t kRrtStream = 0x7272742aULL;  // "rrt*" in ASCII: apart from the other users of the seed
constexpr double kLookShare = 0.75;   // of the time looked ahead, that the goal is away at cruise speed
constexpr double kSlackShare = 0.5;   // of it, by which a place may be reached later
constexpr double kAtTarget = 0.2;     // m
constexpr double kOnTheWay = 1.5;     // m, to a goal that is not the target
constexpr double kTouching = 0.01;    // m, left to a sphere that the start is too near to
constexpr double kCornerMargin = 0.1; // m, kept beyond the margin, since the motion cuts the way's corners
constexpr double kHintStep = 0.5;     // s, between the places of the previous plan that seed the search

/// Where the search looks: around the way to the goal, in the volume.
planner::Box region(const planner::PathRequest& request, const Vec3& goal, double aside) {
  planner::Box box{request.position.cwiseMin(goal) - Vec3::Constant(aside),
                   request.position.cwiseMax(goal) + Vec3::Constant(aside)};
  box.min = box.min.cwiseMax(request.volume.min);
  box.max = box.max.cwiseMin(request.volume.max);
  return box;
}

planner::TimedPath as_path(const std::vector<SpaceTime>& way) {
  planner::TimedPath path;
  for (const SpaceTime& place : way) path.push_back({place.t, place.position, Vec3::Zero(), Vec3::Zero()});
  return path;
}

}  // namespace

SpaceTimeProblem RrtPilot::problem(const planner::PathRequest& request, std::vector<planner::Track>& spheres) const {
  const planner::HorizonSettings& horizon = settings_.horizon;
  spheres = kept_clear(request, horizon);
  const double look = horizon.time * (kLookShare + kSlackShare);
  std::erase_if(spheres, [&](const planner::Track& sphere) {
    const double reach = (request.vehicle.cruise_speed + sphere.velocity.norm() + sphere.acceleration.norm() * look) * look;
    return (sphere.position - request.position).norm() - sphere.radius > reach + horizon.lateral_range;
  });
  for (planner::Track& sphere : spheres) {
    const double distance = (sphere.position - request.position).norm() - kTouching;
    // Already too near: no nearer.
    sphere.radius = std::min(sphere.radius + kCornerMargin, std::max(distance, kTouching));
  }
  SpaceTimeProblem problem;
  problem.start = request.position;
  const Vec3 way = request.target - request.position;
  const double reach = kLookShare * horizon.time * request.vehicle.cruise_speed;
  const bool near = way.norm() <= reach;
  problem.goal = near ? request.target : Vec3(request.position + way * (reach / way.norm()));
  problem.tolerance = near ? kAtTarget : kOnTheWay;
  problem.region = region(request, problem.goal, horizon.lateral_range);
  problem.spheres = spheres;
  problem.acceleration_trust = request.acceleration_trust;
  problem.speed = request.vehicle.cruise_speed;
  problem.climb = request.vehicle.max_climb;
  problem.slack = kSlackShare * horizon.time;
  return problem;
}

planner::Plan RrtPilot::plan(const bridge::PlanJob& job) {
  const planner::PathRequest& request = job.request;
  const planner::HorizonSettings& horizon = settings_.horizon;
  const auto keeps_margin = [&](const planner::TimedPath& path) {
    return check(path, request, request.margin, horizon.time).free();
  };
  Motion undisturbed(request, horizon, normal_acceleration(request, horizon));
  undisturbed.fly_to_target();
  if (keeps_margin(undisturbed.path())) return judged(undisturbed.path(), request, horizon.time);

  std::vector<planner::Track> spheres;
  const SpaceTimeProblem asked = problem(request, spheres);
  std::vector<SpaceTime> hints;
  if (!job.previous.empty()) {
    const double last = kLookShare * horizon.time;
    for (double t = kHintStep; t < std::min(last, job.previous.back().t); t += kHintStep)
      hints.push_back({t, planner::sample(job.previous, t).position});
  }
  const std::uint64_t seed = settings_.seed ^ kRrtStream;
  const std::vector<SpaceTime> way = search_space_time(asked, search_, hints, seed, job.number);

  std::vector<planner::TimedPath> candidates;
  Motion motion(request, horizon, normal_acceleration(request, horizon));
  motion.follow(as_path(way));
  candidates.push_back(motion.path());
  const bool has_previous = !job.previous.empty();
  if (has_previous) candidates.push_back(planner::remainder(job.previous, 0.0));
  const bool new_is_free = keeps_margin(candidates[0]);
  const bool old_is_free = has_previous && keeps_margin(candidates[1]);
  if (new_is_free || old_is_free) {
    const bool keep = old_is_free && (!new_is_free || candidates[1].back().t <=
                                                          (1.0 + horizon.keep_ratio) * candidates[0].back().t);
    planner::Plan plan = judged(std::move(candidates[keep ? 1 : 0]), request, horizon.time);
    plan.kept_previous = keep;
    return plan;
  }
  for (const bool follows : {true, false}) {
    Motion hard(request, horizon, hardest_acceleration(request, horizon));
    follows ? hard.follow(as_path(way)) : hard.stop(true);
    candidates.push_back(hard.path());
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (less_harm(check(candidates[i], request, 0.0, horizon.time), check(candidates[best], request, 0.0, horizon.time)))
      best = i;
  }
  planner::Plan plan = judged(std::move(candidates[best]), request, horizon.time);
  plan.emergency = best + 2 >= candidates.size();
  plan.kept_previous = has_previous && best == 1;
  return plan;
}

}  // namespace jink::arena
