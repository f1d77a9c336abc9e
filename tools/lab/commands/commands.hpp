// SPDX-License-Identifier: BSD-3-Clause
// The commands of the laboratory.
#pragma once

#include "tools/cli/command_line.hpp"

namespace jink::tools::lab::commands {

cli::Subcommand add_arena(CLI::App& jink);
cli::Subcommand add_study(CLI::App& jink);

}  // namespace jink::tools::lab::commands
