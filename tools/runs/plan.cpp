// SPDX-License-Identifier: BSD-3-Clause
#include "tools/runs/plan.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "planner/base/worker_pool.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/paper/paper_planner.hpp"
#include "sim/world/known_world.hpp"
#include "tools/base/exit_code.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::runs {
namespace {

using base::UsageError;
using Json = nlohmann::ordered_json;
using Note = std::function<void(const std::string&)>;

/// The numbers of the optimizer that a mode uses, in the configuration.
struct Knobs {
  int& slaves;
  int& sharing;
  int& population;
  int& iterations;
  int& waypoints;
};

Knobs knobs(config::Settings& s, bool paper) {
  if (paper)
    return {s.optimizer.slaves, s.optimizer.sharing, s.optimizer.population, s.optimizer.iterations, s.paper.waypoints};
  return {s.horizon.slaves, s.horizon.sharing, s.horizon.population, s.horizon.generations, s.horizon.waypoints};
}

/// pmomvo takes its slaves and sharing as configured; of the others PMOMVO-m alone shares.
void apply_algorithm(const PlanOptions& options, Knobs k) {
  if (!options.other) return;
  if (options.slaves)
    throw UsageError(fmt::format("--slaves: not with --algorithm {}, only with pmomvo", options.algorithm));
  k.slaves = options.other->slaves;
  if (options.other->slaves > 1) return;
  if (options.sharing)
    throw UsageError(
        fmt::format("--sharing: not with --algorithm {}, only with pmomvo and pmomvo-M", options.algorithm));
  k.sharing = 0;
}

void apply(const PlanOptions& options, Knobs k) {
  apply_algorithm(options, k);
  k.slaves = options.slaves.value_or(k.slaves);
  k.sharing = options.sharing.value_or(k.sharing);
  k.population = options.population.value_or(k.population);
  k.iterations = options.iterations.value_or(k.iterations);
  k.waypoints = options.waypoints.value_or(k.waypoints);
  const auto [fewest, most] = options.mode == "paper" ? std::pair{2, 1000} : std::pair{1, 20};
  if (k.waypoints < fewest || k.waypoints > most) {
    throw UsageError(
        fmt::format("--waypoints: Value {} not in range {} to {} in {} mode", k.waypoints, fewest, most, options.mode));
  }
  if (k.population < k.slaves) {
    throw UsageError(fmt::format("--population: {} leaves one of {} slaves without a universe; it is to be {} or more",
                                 k.population, k.slaves, k.slaves));
  }
}

planner::verify::Plan search(const PlanOptions& options, const config::Scenario& scenario,
                             const config::Settings& settings, planner::base::WorkerPool& pool, const Note& note) {
  const sim::world::KnownWorld world(scenario);
  const auto deadline =
      options.deadline_ms > 0.0
          ? std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                   std::chrono::duration<double, std::milli>(options.deadline_ms))
          : planner::base::Budget::Time::max();
  if (options.mode == "paper") {
    const planner::paper::PaperRequest request{scenario.start,   scenario.target, world.volume,
                                               scenario.vehicle, world.spheres,   settings.optimizer,
                                               settings.paper,   options.seed,    deadline};
    if (note && planner::paper::effective_axis(request) != settings.paper.axis)
      note("note: the mission is steep in world X, so the waypoints are placed along the path's own axis");
    if (!options.other) return planner::paper::plan_paper(request, pool);
    const auto optimizer = options.other->make(settings.optimizer, 2, 2);
    return planner::paper::plan_paper(request, *optimizer, pool);
  }
  return planner::horizon::plan_open_loop(settings.horizon, settings.optimizer, world.open_loop, options.seed,
                                          {settings.horizon.generations, deadline}, pool,
                                          options.other ? options.other->make : planner::optimizer::MakeOptimizer());
}

std::string outcome_of(const planner::verify::Plan& plan) {
  if (plan.status == planner::verify::PlanStatus::kStartBlocked) return "start_blocked";
  if (plan.status == planner::verify::PlanStatus::kReaches) return "reached";
  return plan.deadline_reached ? "deadline" : "unreachable";
}

Json path_json(const planner::base::TimedPath& path) {
  Json list = Json::array();
  for (const planner::base::TimedPoint& p : path) list.push_back({p.t, p.position.x(), p.position.y(), p.position.z()});
  return list;
}

Json summary_of(const PlanOptions& options, const config::Scenario& scenario, const Knobs& k, int threads,
                const planner::verify::Plan& plan, double seconds) {
  const double length = planner::base::path_length(plan.path);
  const double straight = (scenario.target - scenario.start).norm();
  Json front = Json::array();
  for (const auto& f : plan.front) front.push_back({f[0], f[1]});
  return {{"format", "jink-plan/1"},
          {"scenario", scenario.name},
          {"mode", options.mode},
          {"algorithm", options.algorithm},
          {"seed", options.seed},
          {"threads", threads},
          {"slaves", k.slaves},
          {"sharing", k.sharing},
          {"population", k.population},
          {"iterations", k.iterations},
          {"outcome", outcome_of(plan)},
          {"path", path_json(plan.path)},
          {"path_length", length},
          {"straight_length", straight},
          {"slr", finite_or_null(planner::optimizer::straight_line_rate(length, straight))},
          {"flight_time_s", plan.path.empty() ? 0.0 : plan.path.back().t},
          {"min_clearance", finite_or_null(plan.verification.min_clearance)},
          {"evaluations", plan.evaluations},
          {"planning_time_s", seconds},
          {"front", front}};
}

std::string describe(const Json& s, const config::Scenario& scenario, const planner::verify::Plan& plan) {
  std::string text;
  if (!scenario.map.empty()) text = fmt::format("map: {} solids\n", scenario.map.size());
  text += fmt::format("scenario {}: {} ({} mode, {}, seed {}, {} threads)\n", scenario.name,
                      s["outcome"].get<std::string>(), s["mode"].get<std::string>(), s["algorithm"].get<std::string>(),
                      s["seed"].get<std::uint64_t>(), s["threads"].get<int>());
  const double length = planner::base::path_length(plan.path), straight = s["straight_length"].get<double>();
  text += fmt::format("  path {:.3f} m of straight {:.3f} m (SLR {:.5f}), flight time {:.2f} s, {} points\n", length,
                      straight, planner::optimizer::straight_line_rate(length, straight),
                      s["flight_time_s"].get<double>(), plan.path.size());
  constexpr std::uint64_t kMap = planner::geometry::StaticMap::kFirstId;
  const planner::verify::Verification& v = plan.verification;
  const std::string nearest = std::isfinite(v.min_clearance)
                                  ? fmt::format("{:.3f} m at t = {:.2f} s, to {} {}", v.min_clearance,
                                                v.t_min_clearance, v.nearest_id >= kMap ? "map solid" : "obstacle",
                                                v.nearest_id >= kMap ? v.nearest_id - kMap + 1 : v.nearest_id)
                                  : "unlimited, no obstacles";
  return text + fmt::format("  smallest clearance {}; {} evaluations in {:.1f} ms", nearest, plan.evaluations,
                            1e3 * s["planning_time_s"].get<double>());
}

}  // namespace

bool PlanRun::reached() const {
  return plan.status == planner::verify::PlanStatus::kReaches;
}

PlanRun plan_scenario(const PlanOptions& options, const config::Scenario& scenario, config::Settings settings,
                      const Note& note) {
  const bool paper = options.mode == "paper";
  if (paper && !scenario.map.empty())
    throw UsageError("--mode: Value paper not with " + options.scenario + ", which has a map: the paper knows spheres");
  const Knobs k = knobs(settings, paper);
  apply(options, k);
  planner::base::WorkerPool pool(options.threads);
  const auto begun = std::chrono::steady_clock::now();
  PlanRun run;
  run.plan = search(options, scenario, settings, pool, note);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  run.summary = summary_of(options, scenario, k, pool.threads(), run.plan, seconds);
  run.text = describe(run.summary, scenario, run.plan);
  return run;
}

}  // namespace jink::tools::runs
