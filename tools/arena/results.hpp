// SPDX-License-Identifier: BSD-3-Clause
// The results of a campaign, in memory and in OUT/flights.jsonl: a header, then a line for each flight and judged world
// as it ends.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/arena/campaign_settings.hpp"
#include "tools/arena/flight_record.hpp"

namespace jink::arena {

/// A results file that cannot be read, written or used: one line, fit for stderr.
class ResultsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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

/// Whether a results file has begun: there is a file, and its header is whole.
[[nodiscard]] bool has_begun(const std::filesystem::path& file);

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

/// Writes a file that appears whole or not at all. Throws ResultsError.
void write_whole(const std::filesystem::path& file, const std::string& text);

/// OUT/flights.jsonl while a campaign runs; no second process can open it. Not thread-safe.
class ResultsFile {
 public:
  /// Creates the file with the results' header, or, where it is there, goes on behind its last whole line. Throws
  /// ResultsError where it cannot be written or another process has it.
  ResultsFile(const std::filesystem::path& file, const Results& results);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;

  /// Appends a line, which is in the file when this returns. Throws ResultsError (a full disk).
  void append(const nlohmann::ordered_json& line);

 private:
  void write(const std::string& text);

  std::filesystem::path file_;
  int descriptor_ = -1;
  bool broken_ = false;  // nothing may follow a line that could not be written to its end
};

}  // namespace jink::arena
