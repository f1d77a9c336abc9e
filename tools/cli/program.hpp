// SPDX-License-Identifier: BSD-3-Clause
// A program of subcommands: picks one and turns what goes wrong into one line and an exit code.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/cli/command_line.hpp"

namespace jink::tools::cli {

/// One line on stderr that begins with "jink: "; base::kExitUsage.
int complain(const std::string& message);

/// Parses the arguments and runs the command that they choose. `add` adds the subcommands to the application.
/// Config, usage and argument errors end as complain() does, any other std::exception with base::kExitFailed; what is
/// no std::exception goes through.
int run_program(int argc, char** argv, const std::function<std::vector<Subcommand>(const Parser&)>& add);

}  // namespace jink::tools::cli
