// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "config/error.hpp"
#include "planner/base/version.hpp"

namespace jink::tools::cli {
namespace {

constexpr const char* kFooter =
    "Exit codes: 0 target reached, nothing hit; 1 the flight or the plan failed; 2 bad usage, file or value;\n"
    "3 a peer (autopilot, obstacle tracks) did not show up.\n"
    "`jink COMMAND --help` tells more. First flight: jink demo";

int run(int argc, char** argv, const std::function<std::vector<Subcommand>(const Parser&)>& add) {
  CLI::App jink("jink plans collision-free paths for a drone among moving obstacles, and flies them.", "jink");
  jink.footer(kFooter);
  jink.set_version_flag("--version", std::string("jink ") + JINK_VERSION);
  jink.require_subcommand(1);
  const std::vector<Subcommand> commands = add(Parser(&jink));
  const auto names = [&] {
    std::string list;
    for (const Subcommand& c : commands) list += (list.empty() ? "" : ", ") + c.parser.name();
    return list;
  };
  const auto known = [&](const std::string& name) {
    return std::any_of(commands.begin(), commands.end(), [&](const Subcommand& c) { return c.parser.name() == name; });
  };
  const auto chosen = [&] {
    return std::find_if(commands.begin(), commands.end(), [](const Subcommand& c) { return c.parser.parsed(); });
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
    const std::string name = command == commands.end() ? "" : command->parser.name() + " ";
    return complain(std::string(error.what()) + " (see `jink " + name + "--help`)");
  }
  return chosen()->run();
}

}  // namespace

int complain(const std::string& message) {
  std::string line = message.substr(0, message.find_last_not_of(" \n") + 1);
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "jink: %s\n", line.c_str());
  return base::kExitUsage;
}

int run_program(int argc, char** argv, const std::function<std::vector<Subcommand>(const Parser&)>& add) {
  open_standard_streams();
  try {
    return run(argc, argv, add);
  } catch (const config::ConfigError& error) {
    return complain(error.what());
  } catch (const UsageError& error) {
    return complain(error.what());
  } catch (const std::invalid_argument& error) {
    return complain(error.what());  // settings that no range check of a single key can refuse
  } catch (const std::exception& error) {
    std::fprintf(stderr, "jink: %s\n", error.what());
    return base::kExitFailed;
  }
}

}  // namespace jink::tools::cli
