// SPDX-License-Identifier: BSD-3-Clause
// What jink replay does with a recorded flight: its plans are made again and compared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace jink::tools::runs {

struct RecordingOptions {
  std::string log;                    ///< file
  std::optional<std::uint64_t> seed;  ///< none: the log's
  int threads = 0;                    ///< 0: one for each core
  std::string config;                 ///< file of parameters; empty: the log's
  std::vector<std::string> overrides;
  std::function<void(const std::string&)> note;  ///< takes a line for people before the plans are made; may be empty
  std::function<void(std::size_t)> progress;     ///< takes the number of plans made so far; may be empty
};

struct RecordingRun {
  nlohmann::ordered_json summary;  ///< jink-flight-replay/1
  std::string text;                ///< for people, several lines without the last end
  bool same = false;               ///< no plan differs
};

/// Throws UsageError for options of a flight that a recording does not take; empty ones were not given.
void refuse_for_recording(const std::string& pilot, const std::string& log, const std::string& report);

/// Makes the log's plans again, with its own parameters and seed unless told otherwise. Throws UsageError for a log
/// that is none, has no plans with what they were made from, or plans that are not jink's.
RecordingRun replay_recording(const RecordingOptions& options);

}  // namespace jink::tools::runs
