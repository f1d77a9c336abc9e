// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "planner/obstacle_motion.hpp"
#include "planner/topsis.hpp"

namespace jink::planner {
namespace {

constexpr std::size_t kMostVerified = 32;  // candidates looked at when choosing

OptimizerSettings optimizer_settings(const HorizonSettings& s) {
  OptimizerSettings o;
  o.slaves = s.slaves;
  o.sharing = s.sharing;
  o.population = s.population;
  o.iterations = s.generations;
  return o;
}

bool finite(const PathRequest& request) {
  return request.position.allFinite() && request.velocity.allFinite() && request.target.allFinite() &&
         std::all_of(request.tracks.begin(), request.tracks.end(), [](const Track& t) {
           return t.position.allFinite() && t.velocity.allFinite() && t.acceleration.allFinite() &&
                  std::isfinite(t.radius + t.position_sigma + t.velocity_sigma + t.age);
         });
}

/// Checks a path up to a time; a path that ends before waits at its end.
Verification verify_until(const TimedPath& path, const PathRequest& request, double until) {
  const auto check = [&](std::span<const TimedPoint> points) {
    return verify(
        {points, request.tracks, 0.0, request.vehicle.radius, request.volume, request.acceleration_trust, until});
  };
  if (path.empty() || !std::isfinite(until) || path.back().t >= until) return check(path);
  TimedPath waiting = path;
  waiting.push_back({until, path.back().position, Vec3::Zero(), Vec3::Zero()});
  return check(waiting);
}

/// Whether `a` does less harm than `b`: free before not free, then more clearance; else free for longer (by more than
/// the verifier's accuracy), then the softer contact.
bool less_harm(const Verification& a, const Verification& b) {
  if (a.free() != b.free()) return a.free();
  if (a.valid != b.valid) return a.valid;
  if (a.free()) return a.min_clearance > b.min_clearance;
  if (a.inside_volume != b.inside_volume && !a.first_contact) return a.inside_volume;
  const double until_a = a.first_contact.value_or(kInfinity);
  const double until_b = b.first_contact.value_or(kInfinity);
  if (std::abs(until_a - until_b) > 1e-6) return until_a > until_b;
  return a.contact_speed < b.contact_speed;
}

/// What a verified horizon and the whole path's check amount to.
void conclude(const PathRequest& request, double horizon, Plan& plan) {
  if (!plan.verification.free()) {
    plan.status = PlanStatus::kBlocked;
    return;
  }
  plan.status = PlanStatus::kProgresses;
  const bool arrives = (plan.path.back().position - request.target).norm() < 1e-6;
  if (!arrives) return;
  if (plan.path.back().t <= horizon) {
    plan.status = PlanStatus::kReaches;
    return;
  }
  const Verification whole = verify_until(plan.path, request, kInfinity);
  if (whole.free()) {
    plan.status = PlanStatus::kReaches;
    plan.verification = whole;
  }
}

}  // namespace

HorizonPlanner::HorizonPlanner(const HorizonSettings& settings)
    : settings_(settings),
      problem_(settings),
      optimizer_(optimizer_settings(settings), problem_.dimension(), problem_.objectives()) {}

// What a pilot would try first: straight on, stop, slower, faster, and aside in four directions.
void HorizonPlanner::seed_manoeuvres(const PathRequest& request, const TimedPath& previous) {
  initial_.clear();
  const auto add = [&]() -> std::span<double> {
    const auto d = static_cast<std::size_t>(problem_.dimension());
    initial_.resize(initial_.size() + d);
    return {initial_.data() + initial_.size() - d, d};
  };
  problem_.manoeuvre(0.0, 0.0, 0.0, add());
  if (!previous.empty()) problem_.imitate(previous, add());
  problem_.imitate({{0.0, request.position, Vec3::Zero(), Vec3::Zero()}}, add());
  for (const double share : {-0.5, -0.25, -0.1, 0.25, 0.75}) problem_.manoeuvre(share, 0.0, 0.0, add());
  for (const double distance : {0.7, 1.5, 3.0}) {
    for (const auto& [left, up] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
      problem_.manoeuvre(0.0, distance * left, distance * up, add());
    }
  }
}

Plan HorizonPlanner::plan(const PathRequest& request, const TimedPath& previous, std::uint64_t seed,
                          std::uint64_t number, const Budget& budget, WorkerPool& pool) {
  if (!finite(request)) return {};
  problem_.prepare(request);
  seed_manoeuvres(request, previous);
  const Front& front = optimizer_.run(problem_, initial_, seed, number, budget, pool);
  Plan plan = choose(request, front);
  plan.evaluations = optimizer_.report().evaluations;
  plan.generations = optimizer_.report().generations;
  plan.deadline_reached = optimizer_.report().deadline_reached;
  for (const Cost& cost : front.costs) plan.front.push_back({cost.f[0], cost.f[1]});
  if (!previous.empty()) keep_previous(request, previous, plan);
  conclude(request, problem_.horizon(), plan);
  return plan;
}

// TOPSIS looks for a compromise between the front's extremes, and a front's far end is no measure of what a detour may
// cost: what is much longer than need be counts as violating, by how much.
std::vector<Cost> HorizonPlanner::banded(std::span<const Cost> costs) const {
  double shortest = kInfinity;
  for (const Cost& cost : costs) {
    if (cost.violation == 0.0) shortest = std::min(shortest, cost.f[0]);
  }
  std::vector<Cost> result(costs.begin(), costs.end());
  for (Cost& cost : result) {
    if (cost.violation == 0.0) cost.violation = std::max(0.0, cost.f[0] - (1.0 + settings_.length_band) * shortest);
  }
  return result;
}

Plan HorizonPlanner::choose(const PathRequest& request, const Front& front) const {
  const std::array<double, 3> weights{settings_.weight_length, settings_.weight_steering, settings_.weight_clearance};
  const std::vector<int> order = topsis_order(banded(front.costs), problem_.objectives(), weights);
  Plan best;
  for (std::size_t i = 0; i < std::min(order.size(), kMostVerified); ++i) {
    const auto candidate = static_cast<std::size_t>(order[i]);
    Plan plan;
    plan.path = problem_.motion(front.solution(candidate));
    plan.verification = verify_until(plan.path, request, problem_.horizon());
    if (front.costs[candidate].violation == 0.0 && plan.verification.free()) return plan;
    if (best.path.empty() || less_harm(plan.verification, best.verification)) best = std::move(plan);
  }
  return best;
}

void HorizonPlanner::keep_previous(const PathRequest& request, const TimedPath& previous, Plan& plan) const {
  const Cost old_cost = problem_.cost_of(previous);
  const Cost new_cost = problem_.cost_of(plan.path);
  Plan old;
  old.path = remainder(previous, 0.0);
  old.verification = verify_until(old.path, request, problem_.horizon());
  bool keep = false;
  if (old_cost.violation == 0.0 && old.verification.free()) {
    const double slack = settings_.keep_ratio;
    keep = new_cost.violation > 0.0 || !plan.verification.free() ||
           (old_cost.f[0] <= new_cost.f[0] * (1.0 + slack) && old_cost.f[2] <= new_cost.f[2] * (1.0 + slack) + slack);
  } else if (new_cost.violation > 0.0 || !plan.verification.free()) {
    keep = less_harm(old.verification, plan.verification);
  }
  if (!keep) return;
  plan.path = std::move(old.path);
  plan.verification = old.verification;
  plan.kept_previous = true;
}

Plan plan_open_loop(HorizonPlanner& planner, const OpenLoopRequest& request, std::uint64_t seed, Budget budget,
                    WorkerPool& pool) {
  Plan whole;
  const auto inside = [&](const Track& track) {
    return (track.position - request.path.position).norm() < track.radius + request.path.vehicle.radius;
  };
  if (std::any_of(request.path.tracks.begin(), request.path.tracks.end(), inside)) {
    whole.path.push_back({0.0, request.path.position, Vec3::Zero(), Vec3::Zero()});
    whole.verification = verify_until(whole.path, request.path, kInfinity);
    whole.status = PlanStatus::kStartBlocked;
    return whole;
  }
  PathRequest from = request.path;
  std::vector<Track> now(request.path.tracks.begin(), request.path.tracks.end());
  from.tracks = now;
  TimedPath previous;
  double t = 0.0;
  for (std::uint64_t number = 0;; ++number) {
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = predict(request.path.tracks[i], t, from.acceleration_trust);
    Plan part = planner.plan(from, previous, seed, number, budget, pool);
    if (part.status == PlanStatus::kInvalid) return part;
    if (number == 0) whole.front = part.front;
    whole.evaluations += part.evaluations;
    whole.generations = part.generations;
    whole.deadline_reached = whole.deadline_reached || part.deadline_reached;
    whole.deadline_reached = whole.deadline_reached || budget.expired();
    const bool last = part.status == PlanStatus::kReaches || t + request.commit >= request.time_limit ||
                      part.path.back().t <= request.commit || budget.expired();
    const double keep =
        part.status == PlanStatus::kReaches ? part.path.back().t : std::min(request.commit, part.path.back().t);
    for (const TimedPoint& point : part.path) {
      if (point.t > keep + 1e-9) break;
      if (!whole.path.empty() && point.t <= 1e-9) continue;
      whole.path.push_back({t + point.t, point.position, point.velocity, point.acceleration});
    }
    const TimedPoint next = sample(part.path, keep);
    if (t + keep > whole.path.back().t + 1e-9)
      whole.path.push_back({t + keep, next.position, next.velocity, next.acceleration});
    if (last) break;
    t += keep;
    from.position = next.position;
    from.velocity = next.velocity;
    previous = remainder(part.path, keep);
    for (TimedPoint& point : previous) point.t -= keep;
  }
  whole.verification = verify_until(whole.path, request.path, kInfinity);
  const bool arrived = (whole.path.back().position - request.path.target).norm() < 1e-6;
  whole.status =
      whole.verification.free() ? (arrived ? PlanStatus::kReaches : PlanStatus::kProgresses) : PlanStatus::kBlocked;
  return whole;
}

}  // namespace jink::planner
