// SPDX-License-Identifier: BSD-3-Clause
// jink, the flight program. What measures is another program, jink-lab beside it, which it starts for `jink arena` and
// `jink study` and where another planner than jink's own is named.
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "tools/cli/program.hpp"
#include "tools/commands/commands.hpp"

namespace {

using namespace jink::tools;

/// Goes on as the laboratory, with the same arguments. Returns only where that cannot be.
int become_laboratory(char** argv) {
  std::error_code unknown;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::string laboratory = (here.parent_path() / "jink-lab").string();
  ::execv(laboratory.c_str(), argv);
  return cli::complain("this needs the laboratory, " + laboratory + ", which cannot be started (" +
                       std::generic_category().message(errno) +
                       "); it is in the package jink-lab, and `tools/build.sh release jink_lab` builds it");
}

/// For --help alone: these commands are the laboratory's.
cli::Subcommand listed(const cli::Parser& jink, const char* name, const char* what) {
  return {jink.add_subcommand(name, what), [] { return base::kExitUsage; }};
}

}  // namespace

int main(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "arena" || command == "study") return become_laboratory(argv);
  try {
    return cli::run_program(argc, argv, [](const cli::Parser& jink) -> std::vector<cli::Subcommand> {
      return {commands::add_plan(jink),
              commands::add_replay(jink),
              commands::add_sim(jink),
              commands::add_fly(jink),
              commands::add_doctor(jink),
              commands::add_report(jink),
              commands::add_export(jink),
              commands::add_demo(jink),
              listed(jink, "arena", "fly many seeded worlds, and make tables of it"),
              listed(jink, "study", "run the paper's experiments again")};
    });
  } catch (const commands::NeedsLaboratory&) {
    return become_laboratory(argv);
  }
}
