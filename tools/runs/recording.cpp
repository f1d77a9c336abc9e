// SPDX-License-Identifier: BSD-3-Clause
#include "tools/runs/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "config/settings.hpp"
#include "planner/base/version.hpp"
#include "tools/base/exit_code.hpp"
#include "tools/log/flight_replay.hpp"
#include "tools/runs/flight.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::runs {
namespace {

using base::UsageError;

constexpr std::size_t kMostShown = 20;     // differences that are listed
constexpr std::size_t kNamedMissing = 10;  // parameters that are named

/// The log's parameters, unless told otherwise; what is not the log's own is said.
log::ReplaySettings replay_settings(const RecordingOptions& options, const log::FlightRecording& flight) {
  const auto note = [&](const std::string& line) {
    if (options.note) options.note(line);
  };
  std::vector<std::string> missing, ignored;
  log::ReplaySettings result;
  result.recorded = config::recorded_settings(flight.source(), flight.parameters(), {}, missing);
  result.settings = options.config.empty()
                        ? config::recorded_settings(flight.source(), flight.parameters(), options.overrides, ignored)
                        : config::load_settings(options.config, options.overrides);
  result.seed = options.seed.value_or(flight.seed());
  result.threads = options.threads;
  if (flight.version() != JINK_VERSION)
    note(fmt::format("the log is of jink {}, this is jink {}: differences may come from that", flight.version(),
                     JINK_VERSION));
  if (!missing.empty()) {
    const std::size_t named = std::min(missing.size(), kNamedMissing);
    note(fmt::format("the log does not tell {} parameter{}, which {} today's default: {}{}", missing.size(),
                     missing.size() == 1 ? "" : "s", missing.size() == 1 ? "has" : "have",
                     fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                     named < missing.size() ? ", ..." : ""));
  }
  if (options.seed || !options.config.empty() || !options.overrides.empty())
    note("other parameters than the log's: differences are what they lead to");
  return result;
}

nlohmann::ordered_json comparison_json(const log::FlightRecording& flight, const log::FlightComparison& comparison) {
  nlohmann::ordered_json differences = nlohmann::ordered_json::array();
  for (const log::PlanDifference& d : comparison.differences) {
    differences.push_back({{"t", d.t},
                           {"number", d.number},
                           {"line", d.line},
                           {"recorded", planner::verify::to_string(d.recorded)},
                           {"now", planner::verify::to_string(d.now)},
                           {"max_distance", d.max_distance ? finite_or_null(*d.max_distance) : nullptr}});
  }
  return {{"format", "jink-flight-replay/1"},
          {"flight", flight.name()},
          {"seed", flight.seed()},
          {"version", flight.version()},
          {"plans", comparison.plans},
          {"differ", comparison.differences.size()},
          {"differences", std::move(differences)},
          {"ignored_records", flight.unknown() + flight.without_inputs() + (flight.cut_off() ? 1U : 0U)}};
}

std::string describe(const log::FlightRecording& flight, const log::FlightComparison& comparison) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostShown, comparison.differences.size()); ++i) {
    const log::PlanDifference& d = comparison.differences[i];
    text += fmt::format("  t {:.2f} s, plan {}: recorded {}, now {}, paths {} apart\n", d.t, d.number,
                        planner::verify::to_string(d.recorded), planner::verify::to_string(d.now),
                        d.max_distance ? fmt::format("{:.3g} m", *d.max_distance) : "not comparable, one is empty");
  }
  if (comparison.differences.size() > kMostShown)
    text += fmt::format("  ... and {} more\n", comparison.differences.size() - kMostShown);
  if (flight.cut_off()) text += "the log's last line is cut off: its writer was killed; the lines before it count\n";
  if (flight.without_inputs() > 0)
    text +=
        fmt::format("{} plans have no record of what they were made from and were left out\n", flight.without_inputs());
  return text + fmt::format("{}: {} plans, {} differ", flight.name(), comparison.plans, comparison.differences.size());
}

}  // namespace

void refuse_for_recording(const std::string& pilot, const std::string& log, const std::string& report) {
  if (pilot != kOwnPilot)
    throw UsageError("--pilot: a replayed log has plans of jink; only a scenario is flown by others");
  if (!log.empty() || !report.empty())
    throw UsageError(std::string(log.empty() ? "--report" : "--log") +
                     ": a replayed log writes none; `jink report FLIGHT.jsonl` makes a report of it");
}

RecordingRun replay_recording(const RecordingOptions& options) {
  std::optional<log::FlightRecording> flight;
  log::FlightComparison comparison;
  try {
    flight.emplace(options.log);
    if (flight->pilot() != kOwnPilot)
      throw UsageError(
          fmt::format("{}: its plans are of '{}'; only jink's can be made again", options.log, flight->pilot()));
    comparison = log::compare_plans(*flight, replay_settings(options, *flight), options.progress);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
  if (comparison.plans == 0) {
    throw UsageError(options.log +
                     (flight->without_inputs() > 0
                          ? ": its " + std::to_string(flight->without_inputs()) +
                                " plans have no record of what they were made from (written by an older jink)"
                          : std::string(": holds no plans; logs of `jink replay` and `jink fly` do")));
  }
  return {comparison_json(*flight, comparison), describe(*flight, comparison), comparison.differences.empty()};
}

}  // namespace jink::tools::runs
