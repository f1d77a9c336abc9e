// SPDX-License-Identifier: BSD-3-Clause
#include "planner/paper/paper_planner.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/geometry/validity.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "planner/optimizer/topsis.hpp"
#include "planner/paper/waypoint_problem.hpp"

namespace jink::planner::paper {
namespace {

constexpr double kLeastAxisShare = 1.0 / 3.0;  // of the distance, below which world X does not carry the mission

/// The stations' frame: which two directions the variables move a waypoint in.
struct Laterals {
  Vec3 first = Vec3::UnitY();
  Vec3 second = Vec3::UnitZ();
};

Laterals laterals(const PaperRequest& request, base::Axis axis) {
  if (axis == base::Axis::kWorldX) return {};
  const geometry::PathFrame frame(request.start, request.target);
  return {frame.left, frame.up};
}

/// Offsets within ±range that keep base + offset · direction inside the volume. An offset of 0 is always allowed.
void bound(const Vec3& base, const Vec3& direction, double range, const base::Box& volume, double& lower,
           double& upper) {
  lower = -range;
  upper = range;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) < 1e-9) continue;
    const double a = (volume.min[k] - base[k]) / direction[k];
    const double b = (volume.max[k] - base[k]) / direction[k];
    lower = std::max(lower, std::min(a, b));
    upper = std::min(upper, std::max(a, b));
  }
  lower = std::min(lower, 0.0);
  upper = std::max(upper, 0.0);
}

/// The flown solution of a front: TOPSIS among those that violate the constraints least.
Vec3 choose(const optimizer::Front& front, const WaypointProblem& problem) {
  std::vector<optimizer::Cost> costs = front.costs;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const auto x = front.solution(i);
    costs[i].violation = problem.violation(problem.waypoint(x[0], x[1]));
  }
  const auto x = front.solution(static_cast<std::size_t>(optimizer::topsis_order(costs, 2).front()));
  return problem.waypoint(x[0], x[1]);
}

void append(base::TimedPath& path, const Vec3& to, const base::VehicleLimits& vehicle) {
  base::TimedPoint& from = path.back();
  const double duration = segment_duration(from.position, to, vehicle);
  if (duration <= 0.0) return;  // a waypoint on the one before adds nothing
  from.velocity = (to - from.position) / duration;
  path.push_back({from.t + duration, to, Vec3::Zero(), Vec3::Zero()});
}

bool is_valid(const PaperRequest& request) {
  return geometry::is_within(request.start, geometry::kFarthest) &&
         geometry::is_within(request.target, geometry::kFarthest) && geometry::is_valid(request.vehicle) &&
         geometry::is_valid_world(request.volume, request.tracks, {}, base::kInfinity);
}

/// Plans the free waypoints into `plan.path`, which holds the start.
void plan_steps(const PaperRequest& request, optimizer::Optimizer& optimizer, base::WorkerPool& pool,
                verify::Plan& plan) {
  const Laterals directions = laterals(request, effective_axis(request));
  WaypointProblem problem(request.settings, request.vehicle);
  std::vector<base::Track> now(request.tracks.size());
  const int segments = request.settings.waypoints - 1;
  Vec3 direction = request.target - request.start;
  for (int i = 1; i < segments; ++i) {
    const base::Budget budget{request.optimizer.iterations, request.deadline};
    if (budget.expired()) {
      plan.deadline_reached = true;
      return;
    }
    const base::TimedPoint from = plan.path.back();
    std::transform(request.tracks.begin(), request.tracks.end(), now.begin(),
                   [&](const base::Track& track) { return geometry::predict(track, from.t); });
    WaypointProblem::Step step;
    step.from = from.position;
    step.direction = direction;
    step.target = request.target;
    step.base = request.start + (request.target - request.start) * (static_cast<double>(i) / segments);
    step.volume = request.volume;
    step.lateral1 = directions.first;
    step.lateral2 = directions.second;
    bound(step.base, step.lateral1, request.settings.lateral_range, request.volume, step.lower[0], step.upper[0]);
    bound(step.base, step.lateral2, request.settings.lateral_range, request.volume, step.lower[1], step.upper[1]);
    problem.prepare(step, now);
    const optimizer::Front& front =
        optimizer.run(problem, {}, request.seed, static_cast<std::uint64_t>(i), budget, pool);
    plan.evaluations += optimizer.report().evaluations;
    plan.schedule = budget.generations;
    plan.generations = optimizer.report().generations;
    if (i == 1) {
      for (const optimizer::Cost& cost : front.costs) plan.front.push_back({cost.f[0], cost.f[1]});
    }
    const Vec3 to = choose(front, problem);
    direction = to - from.position;
    append(plan.path, to, request.vehicle);
  }
}

}  // namespace

base::Axis effective_axis(const PaperRequest& request) {
  const Vec3 mission = request.target - request.start;
  return std::abs(mission.x()) < kLeastAxisShare * mission.norm() ? base::Axis::kPath : request.settings.axis;
}

verify::Plan plan_paper(const PaperRequest& request, base::WorkerPool& pool) {
  optimizer::Pmomvo optimizer(request.optimizer, 2, 2);
  return plan_paper(request, optimizer, pool);
}

verify::Plan plan_paper(const PaperRequest& request, optimizer::Optimizer& optimizer, base::WorkerPool& pool) {
  if (request.settings.waypoints < 2) {
    throw std::invalid_argument("waypoints: " + std::to_string(request.settings.waypoints) + " is not at least 2");
  }
  verify::Plan plan;
  if (!is_valid(request)) return plan;
  plan.path.push_back({0.0, request.start, Vec3::Zero(), Vec3::Zero()});
  if (verify::start_blocked(request.start, request.vehicle.radius, request.tracks)) {
    plan.status = verify::PlanStatus::kStartBlocked;
  } else {
    plan_steps(request, optimizer, pool, plan);
    append(plan.path, request.target, request.vehicle);
  }
  const base::VehicleLimits& vehicle = request.vehicle;
  const verify::FlightLimits limits{Vec3::Zero(), vehicle.max_speed, vehicle.max_climb};  // of straight pieces
  plan.verification = verify::verify(
      {plan.path, request.tracks, 0.0, vehicle.radius, request.volume, base::kInfinity, base::kInfinity, {}, limits});
  if (plan.status != verify::PlanStatus::kStartBlocked) {
    plan.status = plan.verification.flyable() ? verify::PlanStatus::kReaches : verify::PlanStatus::kBlocked;
  }
  return plan;
}

}  // namespace jink::planner::paper
