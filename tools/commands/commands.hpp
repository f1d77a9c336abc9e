// SPDX-License-Identifier: BSD-3-Clause
// The commands of the flight program. The laboratory has two of them too, with more planners to choose from.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_line.hpp"
#include "tools/runs/flight.hpp"
#include "tools/runs/plan.hpp"

namespace jink::tools::commands {

using runs::Algorithm;

/// What plans besides jink's own planner, by name. The flight program carries none: whoever names one there gets
/// NeedsLaboratory.
struct OtherPlanners {
  std::vector<std::string> algorithms;  ///< for `plan --algorithm`
  std::vector<std::string> pilots;      ///< for `replay --pilot`
  std::function<Algorithm(std::string_view)> algorithm;
  runs::MakePilot pilot;
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
