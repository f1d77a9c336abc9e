// SPDX-License-Identifier: BSD-3-Clause
// The results of a campaign, in memory and in OUT/flights.jsonl: a header, then a line for each flight and judged world
// as it ends.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/lab/arena/flight_record.hpp"
#include "tools/lab/arena/settings.hpp"
#include "tools/lab/campaign/jsonl_file.hpp"

namespace jink::tools::lab::arena {

using campaign::has_begun;
using campaign::ResultsError;
using campaign::write_atomically;

struct Results {
  CampaignSettings settings;
  std::map<std::size_t, FlightRecord> flights;  ///< by job
  std::map<std::size_t, WorldRecord> worlds;    ///< by number; judged ones
  bool cut_off = false;                         ///< the last line was

  /// Puts a record in. Throws ResultsError where another result is there for the same flight or world.
  void add(FlightRecord record);
  void add(const WorldRecord& record);
};

[[nodiscard]] std::filesystem::path results_path(const std::filesystem::path& out);

/// Reads a results file. A last line without its end is what a killed process leaves: it does not count. Throws
/// ResultsError with file and line for anything else that no campaign wrote, and for a flight that the header's
/// settings do not have.
[[nodiscard]] Results read_results(const std::filesystem::path& file);

/// The parts as one campaign, whose shard is the whole where the parts are of several. Flights may be in several parts
/// if their results are the same. Requires at least one part. Throws ResultsError naming two folders whose settings
/// differ, or a flight with two results.
[[nodiscard]] Results merge_results(const std::vector<std::filesystem::path>& folders);

/// The whole file: header, worlds and flights in the order of their numbers.
[[nodiscard]] std::string to_text(const Results& results);

/// OUT/flights.jsonl while a campaign runs.
class ResultsFile : public campaign::JsonLinesFile {
 public:
  /// As JsonLinesFile, with the results' header.
  ResultsFile(const std::filesystem::path& file, const Results& results);
};

}  // namespace jink::tools::lab::arena
