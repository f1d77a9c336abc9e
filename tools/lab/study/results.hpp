// SPDX-License-Identifier: BSD-3-Clause
// The results of the study, in memory and in OUT/runs.jsonl: a header, then a line for each machine that worked on it
// and for each run as it ends.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/lab/campaign/jsonl_file.hpp"
#include "tools/lab/study/machine.hpp"
#include "tools/lab/study/record.hpp"
#include "tools/lab/study/settings.hpp"

namespace jink::tools::lab::study {

using campaign::ResultsError;

struct Results {
  StudySettings settings;
  std::map<std::size_t, Record> runs;  ///< by job
  std::vector<Machine> machines;       ///< each once
  bool cut_off = false;                ///< the last line was

  /// Puts a record in; of two with the same result the first stays. Throws ResultsError where they differ.
  void add(Record record);
  void add(const Machine& machine);
};

[[nodiscard]] std::filesystem::path results_path(const std::filesystem::path& out);

/// Reads a results file. Throws ResultsError as campaign::read_lines() does, and for a run that the header's settings
/// do not have.
[[nodiscard]] Results read_results(const std::filesystem::path& file);

/// The parts as one study, whose shard is the whole. Requires at least one part. Throws ResultsError naming two folders
/// whose settings differ, or a run with two results.
[[nodiscard]] Results merge_results(const std::vector<std::filesystem::path>& folders);

/// The whole file: header, machines, runs in the order of their numbers.
[[nodiscard]] std::string to_text(const Results& results);

}  // namespace jink::tools::lab::study
