// SPDX-License-Identifier: BSD-3-Clause
// The commands of the laboratory.
#pragma once

#include "tools/cli/command_line.hpp"

namespace jink::tools::lab::commands {

cli::Subcommand add_arena(const cli::Parser& jink);
cli::Subcommand add_study(const cli::Parser& jink);

}  // namespace jink::tools::lab::commands
