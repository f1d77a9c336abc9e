// SPDX-License-Identifier: BSD-3-Clause
// jink-lab, the laboratory: what measures. Called by jink, or by hand with the same arguments.
#include "tools/cli/program.hpp"

#include "tools/commands/commands.hpp"
#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/baselines/registry.hpp"
#include "tools/lab/commands/commands.hpp"

namespace {

using namespace jink::tools;

commands::OtherPlanners other_planners() {
  commands::OtherPlanners others;
  for (const lab::algorithms::Algorithm& a : lab::algorithms::algorithms()) others.algorithms.emplace_back(a.name);
  others.pilots.assign(lab::baselines::pilots().begin(), lab::baselines::pilots().end());
  others.algorithm = [](std::string_view name) {
    const lab::algorithms::Algorithm* found = lab::algorithms::find_algorithm(name);
    return commands::Algorithm{found->make, found->slaves};
  };
  others.pilot = lab::baselines::make_pilot;
  return others;
}

}  // namespace

int main(int argc, char** argv) {
  const commands::OtherPlanners others = other_planners();
  return cli::run_program(argc, argv, [&](const cli::Parser& jink) -> std::vector<cli::Subcommand> {
    return {commands::add_plan(jink, &others), commands::add_replay(jink, &others), lab::commands::add_arena(jink),
            lab::commands::add_study(jink)};
  });
}
