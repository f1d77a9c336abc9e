// SPDX-License-Identifier: BSD-3-Clause
// A recorded flight's plans, read from its log with all that they were made from, and made again.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/companion/planner_task.hpp"
#include "config/settings.hpp"
#include "tools/log/log_reader.hpp"

namespace jink::tools::log {

/// One plan of a log.
struct RecordedPlan {
  std::size_t line = 0;
  double t = 0.0;                  ///< when it was taken into use, companion's clock
  bridge::companion::PlanJob job;  ///< what it was made from; request.tracks is left to whoever plans
  std::array<planner::verify::SearchExtent, 2> searches;
  planner::verify::PlanStatus status = planner::verify::PlanStatus::kInvalid;
  planner::base::TimedPath path;  ///< times in the companion's clock; velocities and accelerations are not recorded
};

/// Reads the plans of a jink-log/1 file (tools/log/flight_log.hpp), checked like any input: what it gives can be
/// planned.
class FlightRecording {
 public:
  /// Reads the header. Throws std::runtime_error "FILE: ..." or "FILE:LINE: ...".
  explicit FlightRecording(const std::filesystem::path& log);

  [[nodiscard]] const std::string& name() const { return name_; }  ///< of the scenario or mission
  [[nodiscard]] const std::string& version() const { return version_; }
  /// Who made the plans: jink, or a baseline of the arena.
  [[nodiscard]] const std::string& pilot() const { return pilot_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  /// Where the header stands, and its parameters: for config::recorded_settings().
  [[nodiscard]] const std::string& source() const { return source_; }
  [[nodiscard]] const std::vector<config::SettingText>& parameters() const { return parameters_; }

  /// The next plan that is recorded with its inputs; nothing at the end. Throws std::runtime_error "FILE:LINE: ..." for
  /// a line that is not as jink-log/1 has it; only the last one may be cut off.
  std::optional<RecordedPlan> next();

  [[nodiscard]] std::size_t without_inputs() const { return without_inputs_; }  ///< plans that next() passed over
  [[nodiscard]] std::size_t unknown() const { return unknown_; }                ///< records of another type
  [[nodiscard]] bool cut_off() const { return lines_.cut_off(); }

 private:
  LogReader lines_;
  std::string name_, version_, source_;
  std::string pilot_ = "jink";
  std::uint64_t seed_ = 1;
  std::vector<config::SettingText> parameters_;
  std::shared_ptr<const planner::geometry::StaticMap> map_;  // the header's; plans share it
  std::shared_ptr<const bridge::map::Seen> seen_;            // of the last `seen` record, likewise
  std::size_t without_inputs_ = 0;
  std::size_t unknown_ = 0;
};

struct PlanDifference {
  std::size_t line = 0;
  double t = 0.0;
  std::uint64_t number = 0;
  planner::verify::PlanStatus recorded = planner::verify::PlanStatus::kInvalid,
                              now = planner::verify::PlanStatus::kInvalid;
  std::optional<double> max_distance;  ///< of the two paths at the same instant; none where there is no path
};

struct ReplaySettings {
  config::Settings recorded;  ///< what the flight was flown with
  config::Settings settings;  ///< what to plan with now
  std::uint64_t seed = 1;
  int threads = 1;
};

struct FlightComparison {
  std::size_t plans = 0;
  std::vector<PlanDifference> differences;
};

/// Makes every plan of the recording again and compares status and path, the path's times and positions bit for bit.
/// With the recorded settings and seed the same decisions come out, those under a deadline too. Other settings answer
/// what would have been decided from the same inputs with them.
/// `progress` is called after each plan with their number so far. Throws as FlightRecording::next() and the planner's
/// constructor do.
FlightComparison compare_plans(FlightRecording& recording, const ReplaySettings& settings,
                               const std::function<void(std::size_t)>& progress = {});

}  // namespace jink::tools::log
