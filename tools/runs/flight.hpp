// SPDX-License-Identifier: BSD-3-Clause
// What jink replay does with a scenario: it is flown closed loop in virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "sim/flight/closed_loop.hpp"

namespace jink::tools::runs {

inline constexpr const char* kOwnPilot = "jink";

/// What is said of a report without a log.
inline constexpr const char* kReportNeedsLog = "--report: needs --log FILE.jsonl, from which it is made";

/// Makes the planner of that name, from its settings, the latency in s and the paper's parameters.
using MakePilot = std::function<std::unique_ptr<bridge::companion::PlannerTask>(
    std::string_view, const bridge::companion::PlannerTaskSettings&, double, const planner::base::PaperSettings&)>;

struct FlightOptions {
  std::uint64_t seed = 1;
  int threads = 0;  ///< of the planner; 0: one for each core
  std::string log;  ///< file of the flight log; empty: none
  std::string pilot = kOwnPilot;
  MakePilot make_pilot;  ///< of any other pilot
  std::vector<bridge::companion::FlightObserver*> flight_observers;
  std::vector<sim::world::TruthObserver*> truth_observers;
  std::function<bool()> interrupted;  ///< as of sim::flight::ClosedLoopOptions
};

struct FlightRun {
  sim::flight::ClosedLoopResult result;
  nlohmann::ordered_json summary;  ///< jink-flight/1
  [[nodiscard]] bool reached() const { return result.flight.outcome == bridge::supervisor::Outcome::kReached; }
};

/// Flies. The same bits for the same arguments at any number of threads, but for wall times. Throws UsageError where
/// the log cannot be written, std::runtime_error where not all of it was.
FlightRun fly_scenario(const config::Scenario& scenario, const config::Settings& settings,
                       const FlightOptions& options);

}  // namespace jink::tools::runs
