// SPDX-License-Identifier: BSD-3-Clause
// The commands of the flight program. The laboratory has two of them too, with more planners to choose from.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/companion/planner_task.hpp"
#include "planner/base/settings.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "tools/cli/command_line.hpp"

namespace jink::tools::commands {

/// An optimizer in PMOMVO's place.
struct Algorithm {
  planner::optimizer::MakeOptimizer make;
  int slaves = 1;  ///< sub-swarms that it has
};

/// What plans besides jink's own planner, by name. The flight program carries none: whoever names one there gets
/// NeedsLaboratory.
struct OtherPlanners {
  std::vector<std::string> algorithms;  ///< for `plan --algorithm`
  std::vector<std::string> pilots;      ///< for `replay --pilot`
  std::function<Algorithm(std::string_view)> algorithm;
  std::function<std::unique_ptr<bridge::companion::PlannerTask>(std::string_view,
                                                                const bridge::companion::PlannerTaskSettings&,
                                                                double latency, const planner::base::PaperSettings&)>
      pilot;
};

/// Thrown where a command names a planner that the flight program does not carry: jink-lab is to do it.
struct NeedsLaboratory {};

cli::Subcommand add_plan(const cli::Parser& jink, const OtherPlanners* others = nullptr);
cli::Subcommand add_replay(const cli::Parser& jink, const OtherPlanners* others = nullptr);
cli::Subcommand add_sim(const cli::Parser& jink);
cli::Subcommand add_fly(const cli::Parser& jink);
cli::Subcommand add_doctor(const cli::Parser& jink);
cli::Subcommand add_report(const cli::Parser& jink);
cli::Subcommand add_export(const cli::Parser& jink);
cli::Subcommand add_demo(const cli::Parser& jink);

}  // namespace jink::tools::commands
