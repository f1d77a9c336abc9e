// SPDX-License-Identifier: BSD-3-Clause
// config/planner.yaml: parameters of the planner and of the companion loop.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/settings.hpp"

namespace jink::config {

/// The loop around the planner: rates and what virtual time assumes.
struct CompanionSettings {
  double setpoint_rate_hz = 50.0;
  double replan_rate_hz = 10.0;
  double planner_latency_ms = 20.0;  ///< in virtual time: from a plan's start to its use
  double setpoint_lead = 0.2;        ///< how far ahead of now the plan is sampled, for the autopilot's lag
  double stale_state = 0.5;          ///< age of the vehicle's position at which to brake
  double stale_plan = 0.5;           ///< age of the newest plan at which to brake
};

struct Settings {
  planner::OptimizerSettings optimizer;
  planner::PaperSettings paper;
  planner::HorizonSettings horizon;
  CompanionSettings companion;
};

/// Reads and checks a jink-planner/1 file, then applies `overrides`, each "section.key=value" as of `--set`; throws
/// ConfigError naming file and line, or "--set" and the text. Unknown and missing keys are errors.
Settings load_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

}  // namespace jink::config
