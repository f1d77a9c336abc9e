// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/horizon_planner.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/gaps.hpp"
#include "planner/horizon/initial_paths.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "planner/optimizer/topsis.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kLonger = 8.0;         // m, that a solution may be longer than the shortest besides the band
constexpr double kMostMeetings = 500;   // PathProblem::meetings() up to which a search has all its generations
constexpr double kWaitingRoom = 2.0;    // times sudden_change, for who waits before a taken target
constexpr double kWaitingHaste = 1e-6;  // times the weights of length and turns, for the same: they choose among equals

base::OptimizerSettings sized(base::OptimizerSettings o, const base::HorizonSettings& s) {
  o.slaves = s.slaves;
  o.sharing = s.sharing;
  o.population = s.population;
  o.iterations = s.generations;
  return o;
}

/// What a verified horizon and the whole path's check amount to.
void conclude(const PathRequest& request, const PathProblem& problem, verify::Plan& plan) {
  plan.horizon = problem.horizon();
  plan.verification.limits = use_of_limits(plan.path, request, problem.step());
  if (!plan.verification.free()) {
    plan.status = verify::PlanStatus::kBlocked;
    return;
  }
  plan.status = verify::PlanStatus::kProgresses;
  if (!arrives(plan.path, request) || !plan.verification.limits.within()) return;
  if (plan.path.back().t <= problem.horizon()) {
    plan.status = verify::PlanStatus::kReaches;
    return;
  }
  verify::Verification whole = verify_until(plan.path, request, base::kInfinity);
  whole.limits = plan.verification.limits;
  if (whole.free()) {
    plan.status = verify::PlanStatus::kReaches;
    plan.verification = whole;
  }
}

/// Those of the budget; fewer where so many `meetings` make each of them slow; with a deadline, no more than the last
/// plan's pace lets expect, so that the schedule comes to its end.
int affordable_generations(const base::Budget& budget, std::size_t meetings, double pace, double share) {
  if (budget.repeats()) return budget.generations;
  double most = budget.generations * std::min(1.0, kMostMeetings / static_cast<double>(1 + meetings));
  if (budget.has_deadline() && pace > 0.0) {
    const std::chrono::duration<double> left = budget.deadline - std::chrono::steady_clock::now();
    most = std::min(most, share * left.count() / pace);
  }
  return static_cast<int>(std::min<double>(budget.generations, std::max(1.0, most)));
}

/// The farthest that two paths are apart at equal times up to `until`, at the points of the first, m.
double largest_distance(const base::TimedPath& path, const base::TimedPath& other, double until) {
  double most = 0.0;
  for (const base::TimedPoint& point : path) {
    if (point.t > until) break;
    most = std::max(most, (point.position - base::sample(other, point.t).position).norm());
  }
  return most;
}

/// Nobody gets to the target; or the vehicle stays there, has time, and something moves past.
bool makes_room(const PathRequest& asked, const base::HorizonSettings& settings) {
  if (!asked.stuck && !asked.holds) return false;
  if (taken(asked, asked.target, 0.0, settings) == Taken::kThroughout) return true;
  if (!asked.holds) return false;
  return taken(asked.without_standing(), asked.target, asked.margin, settings) == Taken::kAtTimes;
}

}  // namespace

std::vector<double> initial_solutions(const PathProblem& problem, const PathRequest& request,
                                      const base::TimedPath& previous, const base::HorizonSettings& settings) {
  const auto d = static_cast<std::size_t>(problem.dimension());
  std::vector<double> initial(d, 0.0);
  const base::TimedPath straight = problem.unobstructed_motion();
  const auto add = [&](const base::TimedPath& path) {
    initial.resize(initial.size() + d);
    problem.encode_path(path, {initial.data() + initial.size() - d, d});
  };
  if (!previous.empty()) add(previous);
  if (!settings.seeding) return initial;
  for (const base::TimedPath& path : initial_paths(request, straight, settings)) add(path);
  return initial;
}

HorizonPlanner::HorizonPlanner(const base::HorizonSettings& settings, const base::OptimizerSettings& optimizer,
                               const optimizer::MakeOptimizer& make)
    : settings_(settings), problems_{Problems(settings.for_brief()), Problems(settings), Problems(settings.for_far())} {
  const base::OptimizerSettings size = sized(optimizer, settings);
  const auto [d, n] = std::pair(problems_[0].usual.dimension(), problems_[0].usual.objectives());
  optimizer_ = make ? make(size, d, n) : std::make_unique<optimizer::Pmomvo>(size, d, n);
}

verify::Plan HorizonPlanner::plan(const PathRequest& request, const base::TimedPath& previous, std::uint64_t seed,
                                  std::uint64_t number, const base::Budget& budget, base::WorkerPool& pool) {
  return make(request, previous, {seed, number}, {budget, budget}, pool);
}

verify::Plan HorizonPlanner::repeat(const PathRequest& request, const base::TimedPath& previous, std::uint64_t seed,
                                    std::uint64_t number, const std::array<verify::SearchExtent, 2>& searches,
                                    base::WorkerPool& pool) {
  const auto budget = [](const verify::SearchExtent& s) {
    return base::Budget{s.schedule, base::Budget::Time::max(), s.generations};
  };
  // A plan that needed no search may need one with other settings or inputs.
  const base::Budget first = searches[0].schedule > 0 ? budget(searches[0]) : base::Budget{settings_.generations};
  return make(request, previous, {seed, number}, {first, searches[1].schedule > 0 ? budget(searches[1]) : first}, pool);
}

verify::Plan HorizonPlanner::make(const PathRequest& asked, const base::TimedPath& before, const Random& random,
                                  const std::array<base::Budget, 2>& budgets, base::WorkerPool& pool) {
  if (!is_valid(asked)) return {};
  PathRequest request = asked;
  weights_ = {settings_.weight_length, settings_.weight_steering, settings_.weight_clearance};
  longer_ = kLonger;
  if (makes_room(asked, settings_)) {
    // To be there or nearer helps nothing: room comes before all else, since who is there may set off or turn.
    request.stuck = false;
    request.sudden_change = kWaitingRoom * asked.sudden_change;
    weights_[0] *= kWaitingHaste;
    weights_[1] *= kWaitingHaste;
    longer_ = base::kInfinity;
  } else if (asked.stuck) {
    weights_ = {1.0, 0.0, 0.0};  // what gets on, not what turns least: that waits
  }
  const base::TimedPath none;
  const base::TimedPath& previous = continues(before, request, settings_.step) ? before : none;
  PathProblem& usual = problems(Extent::kUsual).usual;
  usual.prepare(request);
  if (std::optional<verify::Plan> settled = without_search(usual, request, previous)) return *std::move(settled);
  const base::TimedPath straight = usual.unobstructed_motion();
  Problems& look = problems(extent_of(request, straight, settings_));
  // Where straight on does not get there and waiting has not helped, the way on is measured over the nearest opening:
  // else to wait for a wall to go away is for ever cheaper than to fly to its hole.
  const std::optional<Vec3> via = request.stuck ? gap_ahead(request, straight, look.usual.settings()) : std::nullopt;
  if (via || &look.usual != &usual) look.usual.prepare(request, via);
  verify::Plan plan = search(look.usual, request, previous, random, budgets[0], look.pace, pool);
  std::array<verify::SearchExtent, 2> searches{{{plan.schedule, plan.generations}, {}}};
  if (!previous.empty()) keep_previous(look.usual, request, previous, plan);
  const bool safe = keeps_margins(plan.path, request, look.usual.horizon(), plan.verification);
  if (!safe && settings_.emergency_share > settings_.acceleration_share) {
    look.emergency.prepare(request, via);
    verify::Plan harder = search(look.emergency, request, previous, random, budgets[1], look.pace, pool);
    searches[1] = {harder.schedule, harder.generations};
    plan.evaluations += harder.evaluations;
    if (is_safer(harder.verification, plan.verification)) {
      harder.evaluations = plan.evaluations;
      harder.emergency = true;
      plan = std::move(harder);
    }
  }
  plan.searches = searches;
  conclude(request, look.usual, plan);
  return plan;
}

// No path is shorter than unobstructed flight, none has less of the last objective than nothing: where unobstructed
// flight has both it is the plan, and where the previous plan comes so near to it that a search has little to find, it
// is kept.
std::optional<verify::Plan> HorizonPlanner::without_search(const PathProblem& problem, const PathRequest& request,
                                                           const base::TimedPath& previous) const {
  verify::Plan plan;
  plan.path = problem.unobstructed_motion();
  const optimizer::Cost ideal = problem.cost_of(plan.path);
  const auto settle = [&](verify::Plan& settled) {
    settled.verification = verify_until(settled.path, request, problem.horizon());
    if (!keeps_margins(settled.path, request, problem.horizon(), settled.verification)) return false;
    conclude(request, problem, settled);
    return settled.verification.limits.within(settings_.keep_limits);
  };
  if (ideal.violation == 0.0 && ideal.f[2] == 0.0 && settle(plan)) return plan;
  if (previous.empty()) return std::nullopt;
  const optimizer::Cost cost = problem.cost_of(previous);
  const double slack = settings_.search_ratio;
  if (cost.violation > 0.0 || cost.f[0] > ideal.f[0] * (1.0 + slack) || cost.f[2] > slack) return std::nullopt;
  verify::Plan kept;
  kept.path = base::remainder(previous, 0.0);
  kept.kept_previous = true;
  if (!settle(kept)) return std::nullopt;
  return kept;
}

verify::Plan HorizonPlanner::search(PathProblem& problem, const PathRequest& request, const base::TimedPath& previous,
                                    const Random& random, const base::Budget& budget, double& pace,
                                    base::WorkerPool& pool) {
  initial_ = initial_solutions(problem, request, previous, problem.settings());
  base::Budget affordable = budget;
  affordable.generations = affordable_generations(budget, problem.meetings(), pace, settings_.deadline_share);
  const auto begun = std::chrono::steady_clock::now();
  const optimizer::Front& front = optimizer_->run(problem, initial_, random.seed, random.stream, affordable, pool);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  pace = took.count() / optimizer_->report().generations;
  front_ = &front;
  verify::Plan plan = choose(problem, request, front);
  plan.evaluations = optimizer_->report().evaluations;
  plan.generations = optimizer_->report().generations;
  plan.schedule = affordable.generations;
  plan.deadline_reached = optimizer_->report().deadline_reached;
  for (const optimizer::Cost& cost : front.costs) plan.front.push_back({cost.f[0], cost.f[1]});
  return plan;
}

// TOPSIS looks for a compromise between the front's extremes, and a front's far end is no measure of what a detour may
// cost: what is much longer than need be counts as violating, by how much.
std::vector<optimizer::Cost> HorizonPlanner::quantized(std::span<const optimizer::Cost> costs) const {
  double shortest = base::kInfinity;
  for (const optimizer::Cost& cost : costs) {
    if (cost.violation == 0.0) shortest = std::min(shortest, cost.f[0]);
  }
  std::vector<optimizer::Cost> result(costs.begin(), costs.end());
  for (optimizer::Cost& cost : result) {
    if (cost.violation == 0.0)
      cost.violation = std::max(0.0, cost.f[0] - (1.0 + settings_.length_band) * shortest - longer_);
  }
  return result;
}

verify::Plan HorizonPlanner::choose(const PathProblem& problem, const PathRequest& request,
                                    const optimizer::Front& front) const {
  const std::vector<int> order = optimizer::topsis_order(quantized(front.costs), problem.objectives(), weights_);
  verify::Plan best;
  // True where there is nothing left to look for.
  const auto consider = [&](std::span<const double> x, bool feasible) {
    verify::Plan plan;
    plan.path = problem.motion(x);
    plan.verification = verify_until(plan.path, request, problem.horizon());
    const bool good = feasible && plan.verification.free();
    if (good || best.path.empty() || is_safer(plan.verification, best.verification)) best = std::move(plan);
    return good;
  };
  for (std::size_t i = 0; i < std::min(order.size(), static_cast<std::size_t>(settings_.candidates)); ++i) {
    const auto candidate = static_cast<std::size_t>(order[i]);
    if (consider(front.solution(candidate), front.costs[candidate].violation == 0.0)) return best;
  }
  // The optimizer measures how deep and how long, harm is measured in when and how hard: the first ideas count too.
  const auto d = static_cast<std::size_t>(problem.dimension());
  for (std::size_t at = 0; at < initial_.size() && !best.verification.free(); at += d) {
    consider(std::span(initial_).subspan(at, d), false);
  }
  return best;
}

// The shortest of what the last search found that is shorter than the previous plan, no less clear, and goes its way:
// to hold on to what was begun matters between ways, not along one. Where two paths that keep the margin pass something
// on different sides, there is a time at which it is between them, and each is as far from it as that.
std::optional<verify::Plan> HorizonPlanner::improved(const PathProblem& problem, const PathRequest& request,
                                                     const base::TimedPath& previous,
                                                     const optimizer::Cost& cost) const {
  const double other_way = 2.0 * (request.vehicle.radius + request.margin);
  const std::vector<optimizer::Cost>& found = front_->costs;
  std::vector<std::size_t> better;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].violation == 0.0 && found[i].f[0] < cost.f[0] && found[i].f[2] <= cost.f[2]) better.push_back(i);
  }
  std::sort(better.begin(), better.end(), [&](std::size_t a, std::size_t b) { return found[a].f[0] < found[b].f[0]; });
  better.resize(std::min(better.size(), static_cast<std::size_t>(settings_.candidates)));
  for (const std::size_t i : better) {
    verify::Plan plan;
    plan.path = problem.motion(front_->solution(i));
    if (largest_distance(plan.path, previous, problem.horizon()) >= other_way) continue;
    plan.verification = verify_until(plan.path, request, problem.horizon());
    if (keeps_margins(plan.path, request, problem.horizon(), plan.verification)) return plan;
  }
  return std::nullopt;
}

void HorizonPlanner::keep_previous(const PathProblem& problem, const PathRequest& request,
                                   const base::TimedPath& previous, verify::Plan& plan) const {
  const optimizer::Cost old_cost = problem.cost_of(previous);
  const optimizer::Cost new_cost = problem.cost_of(plan.path);
  verify::Plan old;
  old.path = base::remainder(previous, 0.0);
  old.verification = verify_until(old.path, request, problem.horizon());
  old.verification.limits = use_of_limits(old.path, request, problem.step());
  bool keep = false;
  if (old_cost.violation == 0.0 && old.verification.free()) {
    const double slack = settings_.keep_ratio;
    const bool no_worse =
        new_cost.f[0] > old_cost.f[0] * (1.0 + settings_.length_band) ||
        (old_cost.f[0] <= new_cost.f[0] * (1.0 + slack) && old_cost.f[2] <= new_cost.f[2] * (1.0 + slack) + slack);
    keep = new_cost.violation > 0.0 || !plan.verification.free() ||
           (no_worse && old.verification.limits.within(settings_.keep_limits));
  } else if (new_cost.violation > 0.0 || !plan.verification.free()) {
    keep = is_safer(old.verification, plan.verification);
  }
  if (!keep) return;
  // A stuck vehicle holds on to what leads on: what is shorter waits.
  std::optional<verify::Plan> better;
  if (!request.stuck && old_cost.violation == 0.0 && old.verification.free())
    better = improved(problem, request, old.path, old_cost);
  verify::Plan& flown = better ? *better : old;
  plan.path = std::move(flown.path);
  plan.verification = flown.verification;
  plan.kept_previous = !better;
}

}  // namespace jink::planner::horizon
