// SPDX-License-Identifier: BSD-3-Clause
// jink plan: the whole path at once, open loop, in the world as it is known at t = 0.
#include <memory>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "tools/base/option_ranges.hpp"
#include "tools/commands/commands.hpp"
#include "tools/runs/plan.hpp"

namespace jink::tools::commands {
namespace {

struct PlanOptions {
  cli::CommonOptions common;
  runs::PlanOptions plan;
};

int run(PlanOptions options) {
  const cli::Printer printer(options.common.json == "-");
  cli::refuse_same_file({{"SCENARIO", options.plan.scenario}}, {{"--json", options.common.json}});
  options.plan.seed = options.common.seed;
  options.plan.threads = options.common.thread_count();
  const config::Settings settings = options.common.settings();
  const config::Scenario scenario = config::load_scenario(options.plan.scenario);
  cli::end_on_signals();
  const runs::PlanRun run =
      runs::plan_scenario(options.plan, scenario, settings, [&](const std::string& line) { printer.line(line); });
  cli::catch_signals();  // what is written now is not cut off
  cli::write_json(options.common.json, run.summary);
  printer.line(run.text);
  return run.reached() ? base::kExitReached : base::kExitFailed;
}

}  // namespace

cli::Subcommand add_plan(const cli::Parser& jink, const OtherPlanners* others) {
  const cli::Parser app = jink.add_subcommand("plan", "plan a scenario's whole path at once, open loop");
  const auto options = std::make_shared<PlanOptions>();
  app.add_option("SCENARIO", options->plan.scenario, "scenario file").required();
  app.add_option("--mode", options->plan.mode,
                 "horizon: the remaining path at once; paper: one waypoint after the other")
      .one_of({"paper", "horizon"})
      .show_default();
  cli::Option algorithm =
      app.add_option(
             "--algorithm", options->plan.algorithm,
             std::string(
                 "pmomvo takes --slaves and --sharing, pmomvo-M has M slaves; the others are those it is compared "
                 "with") +
                 (others == nullptr ? "; `jink-lab plan --help` names them" : ""))
          .show_default();
  if (others != nullptr) {
    std::vector<std::string> names{runs::kOwnAlgorithm};
    names.insert(names.end(), others->algorithms.begin(), others->algorithms.end());
    algorithm.one_of(names);
  }
  app.add_option("--slaves", options->plan.slaves, "sub-swarms of PMOMVO, 1 to 64")
      .transform(cli::whole_number(base::kSlaves));
  app.add_option("--sharing", options->plan.sharing, "how often they share, 0 to 1000")
      .transform(cli::whole_number(base::kSharing));
  app.add_option("--population", options->plan.population,
                 "universes of all slaves together, or the population, 1 to 100000")
      .transform(cli::whole_number(base::kPopulation));
  app.add_option("--iterations", options->plan.iterations, "iterations of each plan or step, 1 to 1000000")
      .transform(cli::whole_number(base::kIterations));
  app.add_option("--waypoints", options->plan.waypoints,
                 "waypoints: 2 to 1000 in paper mode (start and target included), 1 to 20 in horizon mode")
      .transform(cli::whole_number(base::kWaypoints));
  app.add_option("--deadline-ms", options->plan.deadline_ms,
                 "stop planning after so many ms of wall time (default: no deadline)")
      .check(cli::number_in(base::kDeadline_ms));
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options, others] {
            if (options->plan.algorithm != runs::kOwnAlgorithm) {
              if (others == nullptr) throw NeedsLaboratory();
              options->plan.other = others->algorithm(options->plan.algorithm);
            }
            return run(*options);
          }};
}

}  // namespace jink::tools::commands
