// SPDX-License-Identifier: BSD-3-Clause
// jink plan: the whole path at once, open loop, in the world as it is known at t = 0.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/paper/paper_planner.hpp"
#include "sim/world/known_world.hpp"
#include "tools/cli/summaries.hpp"
#include "tools/commands/commands.hpp"

namespace jink::tools::commands {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kOwnAlgorithm = "pmomvo";

struct PlanOptions {
  cli::CommonOptions common;
  std::string scenario;
  std::string mode = "horizon";
  std::string algorithm = kOwnAlgorithm;
  int slaves = 0, sharing = -1, population = 0, iterations = 0,
      waypoints = 0;  // what was not given stays as configured
  double deadline_ms = 0.0;
  std::optional<Algorithm> other;  ///< what `algorithm` names, where that is not jink's own
};

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
  if (options.slaves > 0) {
    throw cli::UsageError(fmt::format("--slaves: not with --algorithm {}, only with pmomvo", options.algorithm));
  }
  k.slaves = options.other->slaves;
  if (options.other->slaves > 1) return;
  if (options.sharing >= 0) {
    throw cli::UsageError(
        fmt::format("--sharing: not with --algorithm {}, only with pmomvo and pmomvo-M", options.algorithm));
  }
  k.sharing = 0;
}

void apply(const PlanOptions& options, Knobs k) {
  apply_algorithm(options, k);
  if (options.slaves > 0) k.slaves = options.slaves;
  if (options.sharing >= 0) k.sharing = options.sharing;
  if (options.population > 0) k.population = options.population;
  if (options.iterations > 0) k.iterations = options.iterations;
  if (options.waypoints > 0) k.waypoints = options.waypoints;
  const auto [fewest, most] = options.mode == "paper" ? std::pair{2, 1000} : std::pair{1, 20};
  if (k.waypoints < fewest || k.waypoints > most) {
    throw cli::UsageError(
        fmt::format("--waypoints: Value {} not in range {} to {} in {} mode", k.waypoints, fewest, most, options.mode));
  }
  if (k.population < k.slaves) {
    throw cli::UsageError(
        fmt::format("--population: {} leaves one of {} slaves without a universe; it is to be {} or more", k.population,
                    k.slaves, k.slaves));
  }
}

planner::verify::Plan plan_scenario(const PlanOptions& options, const config::Scenario& scenario,
                                    const config::Settings& settings, planner::base::WorkerPool& pool,
                                    const cli::Printer& printer) {
  const sim::world::KnownWorld world(scenario);
  const auto deadline =
      options.deadline_ms > 0.0
          ? std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                   std::chrono::duration<double, std::milli>(options.deadline_ms))
          : planner::base::Budget::Time::max();
  if (options.mode == "paper") {
    const planner::paper::PaperRequest request{scenario.start,   scenario.target,     world.volume,
                                               scenario.vehicle, world.spheres,       settings.optimizer,
                                               settings.paper,   options.common.seed, deadline};
    if (planner::paper::effective_axis(request) != settings.paper.axis) {
      printer.line("note: the mission is steep in world X, so the waypoints are placed along the path's own axis");
    }
    if (!options.other) return planner::paper::plan_paper(request, pool);
    const auto optimizer = options.other->make(settings.optimizer, 2, 2);
    return planner::paper::plan_paper(request, *optimizer, pool);
  }
  return planner::horizon::plan_open_loop(settings.horizon, settings.optimizer, world.open_loop, options.common.seed,
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

int run(PlanOptions options) {
  const cli::Printer printer(options.common.json == "-");
  cli::refuse_same_file({{"SCENARIO", options.scenario}}, {{"--json", options.common.json}});
  config::Settings settings = options.common.settings();
  const config::Scenario scenario = config::load_scenario(options.scenario);
  const bool paper = options.mode == "paper";
  if (paper && !scenario.map.empty())
    throw cli::UsageError("--mode: Value paper not with " + options.scenario +
                          ", which has a map: the paper knows spheres");
  const Knobs k = knobs(settings, paper);
  apply(options, k);

  cli::end_on_signals();
  planner::base::WorkerPool pool(options.common.thread_count());
  const auto begun = std::chrono::steady_clock::now();
  const planner::verify::Plan plan = plan_scenario(options, scenario, settings, pool, printer);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  cli::catch_signals();  // what is written now is not cut off

  const std::string outcome = outcome_of(plan);
  const double length = planner::base::path_length(plan.path);
  const double straight = (scenario.target - scenario.start).norm();
  const double flight_time = plan.path.empty() ? 0.0 : plan.path.back().t;
  const double slr = planner::optimizer::straight_line_rate(length, straight);
  Json front = Json::array();
  for (const auto& f : plan.front) front.push_back({f[0], f[1]});
  cli::write_json(options.common.json, {{"format", "jink-plan/1"},
                                        {"scenario", scenario.name},
                                        {"mode", options.mode},
                                        {"algorithm", options.algorithm},
                                        {"seed", options.common.seed},
                                        {"threads", pool.threads()},
                                        {"slaves", k.slaves},
                                        {"sharing", k.sharing},
                                        {"population", k.population},
                                        {"iterations", k.iterations},
                                        {"outcome", outcome},
                                        {"path", path_json(plan.path)},
                                        {"path_length", length},
                                        {"straight_length", straight},
                                        {"slr", cli::finite_or_null(slr)},
                                        {"flight_time_s", flight_time},
                                        {"min_clearance", cli::finite_or_null(plan.verification.min_clearance)},
                                        {"evaluations", plan.evaluations},
                                        {"planning_time_s", seconds},
                                        {"front", front}});
  if (!scenario.map.empty()) printer.line(fmt::format("map: {} solids", scenario.map.size()));
  printer.line(fmt::format("scenario {}: {} ({} mode, {}, seed {}, {} threads)", scenario.name, outcome, options.mode,
                           options.algorithm, options.common.seed, pool.threads()));
  printer.line(fmt::format("  path {:.3f} m of straight {:.3f} m (SLR {:.5f}), flight time {:.2f} s, {} points", length,
                           straight, slr, flight_time, plan.path.size()));
  const bool obstacles = std::isfinite(plan.verification.min_clearance);
  constexpr std::uint64_t kMap = planner::geometry::StaticMap::kFirstId;
  const std::uint64_t nearest = plan.verification.nearest_id;
  printer.line(
      fmt::format("  smallest clearance {}; {} evaluations in {:.1f} ms",
                  obstacles ? fmt::format("{:.3f} m at t = {:.2f} s, to {} {}", plan.verification.min_clearance,
                                          plan.verification.t_min_clearance, nearest >= kMap ? "map solid" : "obstacle",
                                          nearest >= kMap ? nearest - kMap + 1 : nearest)
                            : "unlimited, no obstacles",
                  plan.evaluations, 1e3 * seconds));
  return outcome == "reached" ? base::kExitReached : base::kExitFailed;
}

}  // namespace

cli::Subcommand add_plan(const cli::Parser& jink, const OtherPlanners* others) {
  const cli::Parser app = jink.add_subcommand("plan", "plan a scenario's whole path at once, open loop");
  const auto options = std::make_shared<PlanOptions>();
  app.add_option("SCENARIO", options->scenario, "scenario file").required();
  app.add_option("--mode", options->mode, "horizon: the remaining path at once; paper: one waypoint after the other")
      .one_of({"paper", "horizon"})
      .show_default();
  cli::Option algorithm =
      app.add_option(
             "--algorithm", options->algorithm,
             std::string(
                 "pmomvo takes --slaves and --sharing, pmomvo-M has M slaves; the others are those it is compared "
                 "with") +
                 (others == nullptr ? "; `jink-lab plan --help` names them" : ""))
          .show_default();
  if (others != nullptr) {
    std::vector<std::string> names{kOwnAlgorithm};
    names.insert(names.end(), others->algorithms.begin(), others->algorithms.end());
    algorithm.one_of(names);
  }
  app.add_option("--slaves", options->slaves, "sub-swarms of PMOMVO, 1 to 64").transform(cli::whole_number(1, 64));
  app.add_option("--sharing", options->sharing, "how often they share, 0 to 1000")
      .transform(cli::whole_number(0, 1000));
  app.add_option("--population", options->population,
                 "universes of all slaves together, or the population, 1 to 100000")
      .transform(cli::whole_number(1, 100000));
  app.add_option("--iterations", options->iterations, "iterations of each plan or step, 1 to 1000000")
      .transform(cli::whole_number(1, 1000000));
  app.add_option("--waypoints", options->waypoints,
                 "waypoints: 2 to 1000 in paper mode (start and target included), 1 to 20 in horizon mode")
      .transform(cli::whole_number(1, 1000));
  app.add_option("--deadline-ms", options->deadline_ms,
                 "stop planning after so many ms of wall time (default: no deadline)")
      .check(cli::number_in(0.001, 1e9));
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options, others] {
            if (options->algorithm != kOwnAlgorithm) {
              if (others == nullptr) throw NeedsLaboratory();
              options->other = others->algorithm(options->algorithm);
            }
            return run(*options);
          }};
}

}  // namespace jink::tools::commands
