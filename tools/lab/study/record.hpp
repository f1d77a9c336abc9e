// SPDX-License-Identifier: BSD-3-Clause
// What is kept of one run: a line of the results file.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/lab/study/settings.hpp"

namespace jink::tools::lab::study {

/// One run. All but `measured` follows from the study's settings, bit by bit.
struct Record {
  Job job;
  std::map<std::string, double> values;               ///< finite
  std::map<std::string, std::vector<double>> series;  ///< finite
  std::map<std::string, double> measured;             ///< wall-clock figures: another machine or moment gives others

  /// Throws std::out_of_range where the run has no such value.
  [[nodiscard]] double value(const std::string& name) const { return values.at(name); }
};

/// Names of values and series.
namespace key {
// Of every run.
inline constexpr const char* kEvaluations = "evaluations";
inline constexpr const char* kThreads = "threads";      ///< measured: of the planner
inline constexpr const char* kPlanning = "planning_s";  ///< measured, path and front: wall time of the search, s
// Of a front: means over the steps, and the first step's front in units of the reference's bounds.
inline constexpr const char* kHv = "hv";
inline constexpr const char* kMs = "ms";
inline constexpr const char* kHrs = "hrs";
inline constexpr const char* kSize = "front_size";
inline constexpr const char* kF1 = "f1";
inline constexpr const char* kF2 = "f2";
// Of a path.
inline constexpr const char* kReached = "reached";  ///< 1: free and at the target; 0: not
inline constexpr const char* kLength = "path_length";
inline constexpr const char* kSlr = "slr";
inline constexpr const char* kFlight = "flight_time_s";
inline constexpr const char* kClearance = "min_clearance";
inline constexpr const char* kT = "t";  ///< of the path's points where the world is pictured, like the next three
inline constexpr const char* kX = "x";
inline constexpr const char* kY = "y";
inline constexpr const char* kZ = "z";
// Anytime: at each checkpoint, means over the steps.
inline constexpr const char* kEvaluationsAt = "evaluations_at";
inline constexpr const char* kHvAt = "hv_at";
/// Measured: seconds of one search up to checkpoint i.
[[nodiscard]] std::string seconds_at(std::size_t i);
}  // namespace key

/// One line without its end. Numbers read back to the same bits.
[[nodiscard]] nlohmann::ordered_json to_json(const Record& record);

/// The inverse. Throws std::runtime_error for anything else.
[[nodiscard]] Record record_from(const nlohmann::ordered_json& line);

/// The same in all but what was measured.
[[nodiscard]] bool same_result(const Record& a, const Record& b);

}  // namespace jink::tools::lab::study
