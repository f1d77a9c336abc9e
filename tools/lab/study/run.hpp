// SPDX-License-Identifier: BSD-3-Clause
// Makes one run.
#pragma once

#include <vector>

#include "config/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "tools/lab/study/benchmark_problems.hpp"
#include "tools/lab/study/record.hpp"
#include "tools/lab/study/worlds.hpp"

namespace jink::tools::lab::study {

/// What all runs share. Immutable, so threads may share it.
struct Setting {
  /// Reads the paper's scenarios and searches the reference fronts (a second or two). Throws config::ConfigError, and
  /// std::invalid_argument as front_steps() does and where an algorithm refuses the parameters. The parameters are
  /// those that settings.parameters lists.
  Setting(const StudySettings& settings, const config::Settings& planner);

  config::Settings planner;
  StudyWorlds scenes;
  std::vector<FrontStep> steps;          ///< of the paper's hardest world
  std::vector<FrontStep> blocked_steps;  ///< of the first run's blocked one

  [[nodiscard]] const std::vector<FrontStep>& steps_of(const std::string& world) const {
    return is_blocked(world) ? blocked_steps : steps;
  }
};

/// Shares of the iterations at which an anytime run is stopped, increasing, the last one 1.
[[nodiscard]] std::vector<double> checkpoints();

/// A pure function of setting and job, but for what is measured. The planner's threads are the pool's.
[[nodiscard]] Record make_run(const Job& job, const Setting& setting, planner::base::WorkerPool& pool);

}  // namespace jink::tools::lab::study
