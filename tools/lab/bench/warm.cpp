// SPDX-License-Identifier: BSD-3-Clause
// How far the plans of a flight, each made from the one before, are from what fifty times the budget finds.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "planner/horizon/horizon_planner.hpp"
#include "sim/families/families.hpp"
#include "sim/world/world.hpp"
#include "tools/lab/bench/measure.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kTimesTheBudget = 50;  // times the budget
constexpr double kReplan = 0.1;      // s, between plans
constexpr int kEvery = 10;           // of which one is compared
constexpr double kFarEnough = 3.0;   // m, from the target: nearer, shares of what is left say little
constexpr double kAsClear = 1e-3;    // of f3, by which it may be more

namespace horizon = planner::horizon;

/// Shares of f1 that plans have too much, over all that were compared.
struct Gaps {
  std::vector<double> chosen;    ///< beside the plan that the reference chooses
  std::vector<double> as_clear;  ///< beside its shortest solution that is no less clear

  void add(const Gaps& other) {
    chosen.insert(chosen.end(), other.chosen.begin(), other.chosen.end());
    as_clear.insert(as_clear.end(), other.as_clear.begin(), other.as_clear.end());
  }
};

/// What the flight's next plan starts from: the vehicle is where the plan before says.
struct Moment {
  horizon::PathRequest request;
  std::vector<planner::base::Track> tracks;
  planner::base::TimedPath previous;
  double t = 0.0;

  Moment(const sim::world::World& world, const planner::base::HorizonSettings& settings) {
    const config::Scenario& scenario = world.scenario();
    request = planner::horizon::PathRequest::with(settings);
    request.position = scenario.start;
    request.target = scenario.target;
    request.volume = world.volume();
    request.vehicle = scenario.vehicle;
    look(world);
  }
  void look(const sim::world::World& world) {
    tracks.clear();
    for (int i = 0; i < world.obstacle_count(); ++i) tracks.push_back(world.exact_track(i, t));
    request.tracks = tracks;
  }
  void fly(const sim::world::World& world, const planner::base::TimedPath& path) {
    t += kReplan;
    previous = planner::base::later(path, kReplan);
    request.position = previous.front().position;
    request.velocity = previous.front().velocity;
    look(world);
  }
};

/// Compares one plan; the costs are those of the default horizon for both.
void compare(const Moment& moment, const planner::verify::Plan& plan, std::uint64_t number,
             const planner::base::HorizonSettings& settings, planner::base::WorkerPool& pool, Gaps& gaps) {
  if (plan.status != planner::verify::PlanStatus::kReaches && plan.status != planner::verify::PlanStatus::kProgresses)
    return;
  if ((moment.request.target - moment.request.position).norm() < kFarEnough) return;
  horizon::PathProblem problem(settings);
  problem.prepare(moment.request);
  const planner::optimizer::Cost cost = problem.cost_of(plan.path);
  if (cost.violation > 0.0) return;
  planner::base::HorizonSettings patient = settings;
  patient.generations *= kTimesTheBudget;
  patient.keep_ratio = 0.0;
  horizon::HorizonPlanner reference(patient);
  const planner::verify::Plan best =
      reference.plan(moment.request, moment.previous, kSeed, number, {patient.generations}, pool);
  const planner::optimizer::Cost best_cost = problem.cost_of(best.path);
  if (best_cost.violation > 0.0) return;
  gaps.chosen.push_back(std::max(0.0, cost.f[0] / best_cost.f[0] - 1.0));
  if (best_cost.f[2] <= cost.f[2] + kAsClear) gaps.as_clear.push_back(gaps.chosen.back());
}

Gaps fly(std::string_view family, std::uint64_t seed, const planner::base::HorizonSettings& settings,
         planner::base::WorkerPool& pool) {
  const sim::world::World world(sim::families::make_world(family, seed));
  Moment moment(world, settings);
  horizon::HorizonPlanner planner(settings);
  Gaps gaps;
  const double limit = std::min(20.0, world.scenario().time_limit);
  for (std::uint64_t number = 0; moment.t < limit; ++number) {
    const planner::verify::Plan plan =
        planner.plan(moment.request, moment.previous, seed, number, {settings.generations}, pool);
    if (plan.path.empty() || plan.path.back().t <= kReplan) break;
    if (number % kEvery == kEvery / 2 && plan.evaluations > 0) compare(moment, plan, number, settings, pool, gaps);
    moment.fly(world, plan.path);
  }
  return gaps;
}

}  // namespace

void bench_warm(const Options& options) {
  const std::uint64_t seeds = options.quick ? 1 : 4;
  print_title("warm plans, beside fifty times the budget",
              fmt::format("{} seeds of each family, flown exactly along the plans, a plan each {} s from the one "
                          "before, one in {} compared where it took a search.\ngap: of the plan's f1 over that of the "
                          "plan that {} times the generations choose; as clear: where that has no more of f3.",
                          seeds, kReplan, kEvery, kTimesTheBudget));
  Table table({"family", "plans", "gap: mean, %", "p90, %", "most, %", "as clear", "mean, %", "p90, %"});
  const planner::base::HorizonSettings settings;
  planner::base::WorkerPool pool(options.cores);
  Gaps all;
  const auto row = [&](std::string_view name, const Gaps& gaps) {
    if (gaps.chosen.empty() || gaps.as_clear.empty()) return;
    const auto percent = [](double share) { return fmt::format("{:.2f}", 100.0 * share); };
    table.row({std::string(name), fmt::format("{}", gaps.chosen.size()), percent(mean(gaps.chosen)),
               percent(quantile(gaps.chosen, 0.9)), percent(quantile(gaps.chosen, 1.0)),
               fmt::format("{}", gaps.as_clear.size()), percent(mean(gaps.as_clear)),
               percent(quantile(gaps.as_clear, 0.9))});
  };
  for (const std::string_view family : measured_families(options)) {
    if (!sim::families::blocks_straight_line(family) || sim::families::has_map(family) ||
        sim::families::make_world(family, 1).obstacles.empty())
      continue;
    Gaps gaps;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) gaps.add(fly(family, seed, settings, pool));
    row(family, gaps);
    all.add(gaps);
  }
  row("all", all);
  table.print();
}

}  // namespace jink::tools::lab::bench
