// SPDX-License-Identifier: BSD-3-Clause
// config/planner.yaml: parameters of the planner and of the companion loop.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "planner/base/settings.hpp"

namespace jink::config {

/// The loop around the planner: rates and what virtual time assumes.
struct CompanionSettings {
  double setpoint_rate_hz = 50.0;
  double replan_rate_hz = 10.0;          ///< at least, also where no new tracks come
  double largest_replan_rate_hz = 40.0;  ///< on average: a new track message starts a plan at once, unless that is more
  double planner_latency_ms = 20.0;      ///< in virtual time: from a plan's start to its use
  double commitment = 0.2;      ///< from a plan's beginning to its start at the least: the present plan is flown until
                                ///< then, since the vehicle answers a new acceleration that late
  double setpoint_lead = 0.04;  ///< how far ahead of now the plan is sampled for position and velocity: the transport
  double acceleration_lead = 0.2;  ///< and for the acceleration: the autopilot's attitude loop and rotors too
  /// What counts of acceleration_lead. Beyond the commitment a plan may be replaced before it is flown: the vehicle
  /// would accelerate for motions that never come about.
  [[nodiscard]] double committed_acceleration_lead() const { return std::min(acceleration_lead, commitment); }
  double stale_state = 0.2;   ///< without a position of the vehicle, at which to brake
  double stale_plan = 0.3;    ///< age of the newest plan at which to brake
  double margin_limit = 0.8;  ///< the most that the tracking error measured in flight may make of horizon.margin
};

struct Settings {
  planner::base::OptimizerSettings optimizer;
  planner::base::PaperSettings paper;
  planner::base::HorizonSettings horizon;
  CompanionSettings companion;
};

/// Reads and checks a jink-planner/1 file, of an empty name the shipped planner.yaml, then applies `overrides` in
/// order, each "section.key=value" as of `--set`. Every key is required; unknown ones are errors. Beyond each key's
/// range: a population is no smaller than its number of slaves, optimizer.wep_min <= wep_max, horizon.step <= time, and
/// the horizon's weights are not all 0. Throws ConfigError (config/error.hpp) naming file and line, and FILE.dpkg-dist
/// where an upgrade has left that, or "--set" and the text.
Settings load_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// One parameter as text: "horizon.margin", "0.35". Numbers read back to the same bits.
struct SettingText {
  std::string key;
  std::string value;
  bool operator==(const SettingText&) const = default;
};

/// Every parameter, in the order of config/planner.yaml; for the header of a flight log and for tests.
std::vector<SettingText> list_settings(const Settings& settings);

/// Parameters as list_settings() gave them once, in a flight log: the defaults with `values` in their place, then
/// `overrides` as in load_settings(), checked like a file. Keys that `values` lacks keep their default and are added to
/// `missing`. Throws ConfigError naming `source` and the key, also for a key that is not known any more.
Settings recorded_settings(const std::string& source, const std::vector<SettingText>& values,
                           const std::vector<std::string>& overrides, std::vector<std::string>& missing);

/// Where the project's own files are, planner.yaml, vehicles/, scenarios/ and missions/: the environment variable
/// JINK_CONFIG_DIR, else what set_config_folder() said, else etc/jink of where the program is installed (/etc/jink for
/// /usr/bin), else the source tree's config folder for a program in its build folder, else /etc/jink. The environment
/// is read at each call.
std::filesystem::path config_folder();

/// Where config_folder() finds them in a process that is not a program of jink's, as Python; JINK_CONFIG_DIR still
/// comes first. To be told once, before any thread asks.
void set_config_folder(std::filesystem::path folder);

}  // namespace jink::config
