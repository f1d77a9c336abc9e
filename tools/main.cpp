// SPDX-License-Identifier: BSD-3-Clause
// The jink executable: picks the subcommand and turns what goes wrong into one line and an exit code.
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/error.hpp"
#include "tools/command_line.hpp"

namespace {

using namespace jink::tools;

constexpr const char* kFooter =
    "Exit codes: 0 target reached, nothing hit; 1 the flight or the plan failed; 2 bad usage, file or value;\n"
    "3 a peer (autopilot, obstacle tracks) did not show up.\n"
    "`jink COMMAND --help` tells more. First flight: tools/demo.sh";

int complain(const std::string& message) {
  std::string line = message.substr(0, message.find_last_not_of(" \n") + 1);
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "jink: %s\n", line.c_str());
  return kExitUsage;
}

int run(int argc, char** argv) {
  CLI::App jink("jink plans collision-free paths for a drone among moving obstacles, and flies them.", "jink");
  jink.footer(kFooter);
  jink.set_version_flag("--version", std::string("jink ") + JINK_VERSION);
  jink.require_subcommand(1);
  const std::vector<Subcommand> commands{add_plan(jink),   add_replay(jink), add_sim(jink),
                                         add_fly(jink),    add_doctor(jink), add_report(jink),
                                         add_export(jink), add_arena(jink),  add_study(jink)};
  const auto names = [&] {
    std::string list;
    for (const Subcommand& c : commands) list += (list.empty() ? "" : ", ") + c.app->get_name();
    return list;
  };
  const auto known = [&](const std::string& name) {
    return std::any_of(commands.begin(), commands.end(),
                       [&](const Subcommand& c) { return c.app->get_name() == name; });
  };
  const auto chosen = [&] {
    return std::find_if(commands.begin(), commands.end(), [](const Subcommand& c) { return c.app->parsed(); });
  };
  if (argc > 1 && argv[1][0] != '-' && !known(argv[1])) {
    return complain("there is no command '" + std::string(argv[1]) + "'; the commands are " + names());
  }
  try {
    jink.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return jink.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    const auto command = chosen();  // none where the command line ends before one
    const std::string name = command == commands.end() ? "" : command->app->get_name() + " ";
    return complain(std::string(error.what()) + " (see `jink " + name + "--help`)");
  }
  return chosen()->run();
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  try {
    return run(argc, argv);
  } catch (const jink::config::ConfigError& error) {
    return complain(error.what());
  } catch (const UsageError& error) {
    return complain(error.what());
  } catch (const std::invalid_argument& error) {
    return complain(error.what());  // settings that no range check of a single key can refuse
  } catch (const std::exception& error) {
    std::fprintf(stderr, "jink: %s\n", error.what());
    return kExitFailed;
  }
}
