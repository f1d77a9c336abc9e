// SPDX-License-Identifier: BSD-3-Clause
// What a campaign's flights amount to: a row for each family, tier and pilot, and the files that hold them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/lab/arena/results.hpp"

namespace jink::tools::lab::arena {

/// Of some values: NaN each where there are none.
struct Spread {
  explicit Spread(std::vector<double> values = {});

  double min, p5, median, p95, max;
};

/// Flights of one pilot in one tier, of one family or of all.
struct Row {
  std::string family;  ///< or "all"
  std::string tier, pilot;

  // In worlds that the oracle did not show to be impossible:
  Proportion reached, collisions, left_world, timeouts;
  Proportion others;            ///< aborted, start blocked
  Proportion reached_solvable;  ///< of the worlds that are known to have a flight
  Spread clearance;             ///< m, of all
  Spread time, time_at_limit;   ///< of those reached: of the straight line at cruise speed, and at the vehicle's limit
  Spread length;                ///< of those reached: of the straight line
  std::int64_t plans = 0, deadline_misses = 0;
  Proportion late_plans;      ///< measured: took longer than horizon.deadline_ms
  DurationHistogram plan_ms;  ///< measured

  // In the others the least harm counts:
  std::int64_t impossible = 0;  ///< flights
  std::int64_t impossible_collisions = 0;
  Spread impossible_clearance;
};

struct Summary {
  std::vector<Row> rows;    ///< by family, then tier, then pilot, in the order of the settings; without empty ones
  std::vector<Row> totals;  ///< likewise, of all families
  std::vector<FlightRecord> failures;  ///< not reached, by pilot, then job
  std::size_t expected = 0;            ///< flights of the shard
  std::size_t flights = 0;             ///< of these, done
  std::size_t unknown_worlds = 0;      ///< in which nobody arrived, and the oracle has no answer
  std::size_t impossible_worlds = 0;
};

/// Counts. A world that has a flight is one in which a pilot reached the target, in any tier, or the oracle has one.
[[nodiscard]] Summary summarise(const Results& results);

/// All flights, by job: RFC 4180, a header line, numbers that read back to the same bits, empty where there is none.
/// `verdict` is flown, solvable, impossible, unknown or empty (not judged). The last columns are measured.
[[nodiscard]] std::string flights_csv(const Results& results, const std::filesystem::path& out);

/// The rows and totals as CSV: for each proportion the count and the interval, for each spread its values.
[[nodiscard]] std::string table_csv(const Summary& summary);

/// The summary object, format jink-arena/1. What was measured is in each row's `measured`.
[[nodiscard]] nlohmann::ordered_json summary_json(const Results& results, const Summary& summary,
                                                  const std::filesystem::path& out);

/// For people: settings, a table for each tier, and the failed flights with their commands, of which at most
/// `most_failures` are listed.
[[nodiscard]] std::string table_markdown(const Results& results, const Summary& summary,
                                         const std::filesystem::path& out, std::size_t most_failures = 200);

/// As table_markdown() has it, but for a terminal: fewer columns and no failures.
[[nodiscard]] std::string table_text(const Results& results, const Summary& summary);

// What the page shares with them.

/// The tier's rows, families first, then totals. They point into `summary`.
[[nodiscard]] std::vector<const Row*> rows_of_tier(const Summary& summary, const std::string& tier);
/// A header line and a line for each row, for people; not `all`: the columns for a terminal.
[[nodiscard]] std::vector<std::vector<std::string>> reading_cells(const std::vector<const Row*>& rows, bool all);
/// Version, seed and how far the campaign is, in one sentence without its full stop.
[[nodiscard]] std::string headline(const Results& results, const Summary& summary);
/// What the columns mean.
[[nodiscard]] std::string legend();

}  // namespace jink::tools::lab::arena
