// SPDX-License-Identifier: BSD-3-Clause
// The HTML flight report: a flight log made into one page that needs neither network nor server.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace jink::tools {

/// What was read for a report.
struct ReportResult {
  std::size_t lines = 0;    ///< of the log, the header and skipped ones included; empty lines are not counted
  std::size_t skipped = 0;  ///< of these: cut off at the end, without finite numbers, or of an unknown type
};

/// Reads the flight log `log` (JSON Lines, jink-log/1, of `replay`, `sim` or `fly`), thins it to what a page can show
/// and writes it with its viewer as one self-contained file `html`, whole or not at all: a temporary file is renamed.
/// `summary` is the flight's jink-flight/1 object; without one the page's table is derived from the log, and what the
/// log does not hold is said to be missing. Throws std::runtime_error: one line that names the file, and for bad
/// content the line. Text of the log cannot leave its place in the page, whatever it holds.
ReportResult write_report(const std::filesystem::path& log, const std::filesystem::path& html,
                          const nlohmann::json* summary = nullptr);

}  // namespace jink::tools
