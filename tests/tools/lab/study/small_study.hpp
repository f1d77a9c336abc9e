// SPDX-License-Identifier: BSD-3-Clause
// A study small enough for unit tests, and records made by hand.
#pragma once

#include <string>

#include "tools/lab/study/results.hpp"
#include "tools/lab/study/run.hpp"

namespace jink::tools::lab::study {

/// Two runs of every variant of a search that takes no time.
inline config::Settings small_planner() {
  config::Settings settings = config::load_settings(config::config_folder() / "planner.yaml");
  settings.optimizer.population = 12;
  settings.optimizer.iterations = 2;
  settings.optimizer.archive = 10;
  settings.paper.waypoints = 12;
  return settings;
}

inline StudySettings small_study(int runs = 2) {
  StudySettings settings;
  settings.version = "0.1.0";
  settings.runs = runs;
  settings.quick = true;
  settings.parameters = config::list_settings(small_planner());
  return settings;
}

/// A record that says nothing but has all that is asked of its kind.
inline Record empty_record(const Job& job) {
  Record r;
  r.job = job;
  r.values[key::kEvaluations] = 1.0;
  r.measured[key::kThreads] = 2.0;
  switch (job.variant.kind) {
    case RunKind::kFront:
      for (const char* name : {key::kHv, key::kMs, key::kHrs, key::kSize}) r.values[name] = 1.0;
      r.series[key::kF1] = r.series[key::kF2] = {0.0, 1.0};
      break;
    case RunKind::kPath:
      for (const char* name : {key::kReached, key::kLength, key::kSlr, key::kFlight, key::kClearance})
        r.values[name] = 1.0;
      r.measured[key::kPlanning] = 0.001;
      if (is_pictured(job.variant.world))
        for (const char* name : {key::kT, key::kX, key::kY, key::kZ}) r.series[name] = {0.0, 1.0};
      break;
    case RunKind::kAnytime:
      r.series[key::kEvaluationsAt] = r.series[key::kHvAt] = std::vector<double>(checkpoints().size(), 1.0);
      for (std::size_t i = 0; i < checkpoints().size(); ++i) r.measured[key::seconds_at(i)] = 0.001;
      break;
  }
  return r;
}

/// All runs of the settings, empty.
inline Results empty_results(const StudySettings& settings) {
  Results results;
  results.settings = settings;
  results.add(Machine{"a CPU", 2, "a compiler", "a system"});
  for (const Job& job : jobs_of(settings)) results.add(empty_record(job));
  return results;
}

}  // namespace jink::tools::lab::study
