// SPDX-License-Identifier: BSD-3-Clause
// What jink plan does: the whole path at once, open loop, in the world as it is known at t = 0.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/verify/plan.hpp"

namespace jink::tools::runs {

/// An optimizer in PMOMVO's place.
struct Algorithm {
  planner::optimizer::MakeOptimizer make;
  int slaves = 1;  ///< sub-swarms that it has
};

inline constexpr const char* kOwnAlgorithm = "pmomvo";

struct PlanOptions {
  std::string scenario;  ///< file, as the user named it
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one for each core
  std::string mode = "horizon";
  std::string algorithm = kOwnAlgorithm;
  std::optional<Algorithm> other;  ///< what `algorithm` names, where that is not jink's own
  // Within tools/base/option_ranges.hpp; what was not given stays as configured.
  std::optional<int> slaves, sharing, population, iterations, waypoints;
  double deadline_ms = 0.0;  ///< of wall time; 0: none
};

struct PlanRun {
  planner::verify::Plan plan;
  nlohmann::ordered_json summary;  ///< jink-plan/1
  std::string text;                ///< for people, several lines without the last end
  [[nodiscard]] bool reached() const;
};

/// Plans. `note` takes a line for people before the search begins; may be empty. The same bits for the same arguments
/// at any number of threads, but for the wall time and where there is a deadline. Throws UsageError for options that
/// do not go together or with the scenario.
PlanRun plan_scenario(const PlanOptions& options, const config::Scenario& scenario, config::Settings settings,
                      const std::function<void(const std::string&)>& note = {});

}  // namespace jink::tools::runs
