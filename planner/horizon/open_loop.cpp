// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/open_loop.hpp"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/elastic_band.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/path_check.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kJoint = 1e-9;  // s, within which two instants are the same

/// What else counts in flight decides here between paths of nearly equal length alone. So much of it is left that a
/// second lost, or a metre aside, weighs some centimetres of length; of what is kept, that a millimetre in a metre
/// counts.
constexpr double kTimeLeft = 0.04;
constexpr double kDeviationLeft = 0.07;
constexpr double kSlackLeft = 0.01;

base::HorizonSettings for_shortest(base::HorizonSettings settings) {
  settings.time_weight *= kTimeLeft;
  settings.deviation_weight *= kDeviationLeft;
  settings.length_band *= kSlackLeft;
  settings.keep_ratio *= kSlackLeft;
  return settings;
}

verify::Verification verify_whole(const base::TimedPath& path, const OpenLoopRequest& request, double step) {
  verify::Verification whole = verify_until(path, request.path, base::kInfinity);
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

verify::Plan attempt(HorizonPlanner& planner, const OpenLoopRequest& request, std::uint64_t seed,
                     const base::Budget& budget, base::WorkerPool& pool) {
  verify::Plan whole;
  PathRequest from = request.path;
  std::vector<base::Track> now(request.path.tracks.size());
  from.tracks = now;
  std::vector<geometry::KnownPath> paths(request.path.paths.begin(), request.path.paths.end());
  from.paths = paths;
  base::TimedPath previous;
  double t = 0.0;
  for (std::uint64_t number = 0;; ++number) {
    std::transform(request.path.tracks.begin(), request.path.tracks.end(), now.begin(),
                   [&](const base::Track& track) { return geometry::predict(track, t, from.acceleration_trust); });
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const geometry::KnownPath& at_start = request.path.paths[i];
      paths[i].offset = at_start.offset + t;
      paths[i].age = at_start.age + t;
      paths[i].until = at_start.until - t;
    }
    verify::Plan part = planner.plan(from, previous, seed, number, budget, pool);
    if (part.status == verify::PlanStatus::kInvalid) return part;
    if (number == 0) whole.front = part.front;
    whole.evaluations += part.evaluations;
    whole.schedule = part.schedule;
    whole.generations = part.generations;
    whole.deadline_reached = whole.deadline_reached || part.deadline_reached || budget.expired();
    const double end = part.path.back().t;
    // What is known to be free: to the target, or as far as was looked ahead. Without time left that is the result.
    double wanted = std::min(request.commit, end);
    if (part.status == verify::PlanStatus::kReaches) wanted = end;
    if (part.status == verify::PlanStatus::kProgresses && budget.expired()) wanted = std::min(part.horizon, end);
    const double keep = std::min(at_a_point(part.path, wanted), request.time_limit - t);
    append(part.path, t, keep, whole.path);
    t += keep;
    if (keep == end || t + kJoint >= request.time_limit || budget.expired()) break;
    const base::TimedPoint next = base::sample(part.path, keep);
    from.position = next.position;
    from.velocity = next.velocity;
    previous = base::remainder(part.path, keep);
    for (base::TimedPoint& point : previous) point.t -= keep;
  }
  whole.verification = verify_whole(whole.path, request, planner.settings().step);
  whole.status = verify::PlanStatus::kBlocked;
  if (whole.verification.free()) {
    const bool reaches = arrives(whole.path, request.path) && whole.verification.flyable();
    whole.status = reaches ? verify::PlanStatus::kReaches : verify::PlanStatus::kProgresses;
  }
  return whole;
}

/// Where the path arrives and pulled tight it is as good and shorter, that is the path.
void pull_tight(const OpenLoopRequest& request, const base::HorizonSettings& settings, verify::Plan& plan) {
  if (plan.status != verify::PlanStatus::kReaches) return;
  base::TimedPath tight =
      elastic_band(plan.path, request.path, settings.planned_acceleration(request.path.vehicle.max_acceleration));
  const verify::Verification verification = verify_whole(tight, request, settings.step);
  if (!verification.free() || !verification.flyable() || base::path_length(tight) >= base::path_length(plan.path) ||
      verification.min_clearance < std::min(request.path.margin, plan.verification.min_clearance))
    return;
  plan.path = std::move(tight);
  plan.verification = verification;
}

}  // namespace

verify::Plan plan_open_loop(const base::HorizonSettings& settings, const base::OptimizerSettings& optimizer,
                            const OpenLoopRequest& request, std::uint64_t seed, const base::Budget& budget,
                            base::WorkerPool& pool, const optimizer::MakeOptimizer& make) {
  if (!is_valid(request.path) || !(request.time_limit >= 0.0) || !(request.commit > 0.0)) return {};
  if (verify::start_blocked(request.path.position, request.path.vehicle.radius, request.path.tracks,
                            request.path.paths)) {
    verify::Plan plan;
    plan.path.push_back({0.0, request.path.position, Vec3::Zero(), Vec3::Zero()});
    plan.verification = verify_whole(plan.path, request, settings.step);
    plan.status = verify::PlanStatus::kStartBlocked;
    return plan;
  }
  HorizonPlanner patient(for_shortest(settings), optimizer, make);
  verify::Plan plan = attempt(patient, request, seed, budget, pool);
  if (plan.status == verify::PlanStatus::kInvalid) return plan;
  pull_tight(request, settings, plan);
  if (budget.expired()) return plan;
  HorizonPlanner eager(settings, optimizer, make);
  verify::Plan other = attempt(eager, request, seed, budget, pool);
  pull_tight(request, settings, other);
  const auto worth = [&](const verify::Plan& p) {
    const double left = (p.path.back().position - request.path.target).norm();
    return std::tuple(p.status == verify::PlanStatus::kReaches, p.verification.free(), -left,
                      -base::path_length(p.path));
  };
  other.evaluations += plan.evaluations;
  plan.evaluations = other.evaluations;
  other.deadline_reached = plan.deadline_reached || other.deadline_reached;
  return worth(other) > worth(plan) ? other : plan;
}

}  // namespace jink::planner::horizon
