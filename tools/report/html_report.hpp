// SPDX-License-Identifier: BSD-3-Clause
// The HTML flight report: flight logs made into one page that needs neither network nor server.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace jink::tools::report {

/// A flight for a report.
struct ReportSource {
  std::filesystem::path log;
  std::optional<nlohmann::json> summary;  ///< the flight's jink-flight/1 object
};

/// What was read for a report.
struct ReportResult {
  std::size_t lines = 0;    ///< of the log, the header and skipped ones included; empty lines are not counted
  std::size_t skipped = 0;  ///< of these: cut off at the end, without finite numbers, or of an unknown type
};

/// Reads flight logs (JSON Lines, jink-log/1, of `replay`, `sim` or `fly`), thins them to what a page can show and
/// writes them with their viewer as one self-contained file `html`, whole or not at all: a temporary file is renamed.
/// Several flights stand side by side under one time. Without a summary a flight's table is derived from its log, and
/// what the log does not hold is said to be missing. Requires at least one source. Throws std::runtime_error: one line
/// that names the file, and for bad content the line. Text of a log cannot leave its place in the page, whatever it
/// holds. The results are in the order of the sources.
std::vector<ReportResult> write_report(std::span<const ReportSource> sources, const std::filesystem::path& html);

/// Of one flight; `summary` may be null.
ReportResult write_report(const std::filesystem::path& log, const std::filesystem::path& html,
                          const nlohmann::json* summary = nullptr);

/// Writes `bytes` as `file`, whole or not at all. Throws std::runtime_error "FILE: cannot write WHAT: WHY".
void write_atomically(const std::filesystem::path& file, std::string_view bytes, const std::string& what);

}  // namespace jink::tools::report
