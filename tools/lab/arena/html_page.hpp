// SPDX-License-Identifier: BSD-3-Clause
// A campaign as one HTML page, and all files of a campaign's end.
#pragma once

#include <filesystem>
#include <string>

#include "tools/lab/arena/tables.hpp"

namespace jink::tools::lab::arena {

/// One self-contained page, which needs no network and no script: settings, for each tier a figure and the table, the
/// failed flights with their commands.
[[nodiscard]] std::string page(const Results& results, const Summary& summary, const std::filesystem::path& out);

/// Writes flights.jsonl (in order of the flights), flights.csv, table.csv, table.json, table.md and arena.html into
/// `out`, each whole or not at all. Throws ResultsError.
void write_tables(const Results& results, const Summary& summary, const std::filesystem::path& out);

}  // namespace jink::tools::lab::arena
