// SPDX-License-Identifier: BSD-3-Clause
// A scenario as a jink-scenario/1 file: the inverse of load_scenario().
#pragma once

#include <string>

#include "config/scenario.hpp"

namespace jink::config {

/// The text of a file that load_scenario() reads back as the same scenario, bit for bit: each number is the shortest
/// decimal that reads back as the same double (17 significant digits where it takes as many). A vehicle is written by
/// its name where the project's own file of that name (config_folder()/vehicles) says just these limits, otherwise as a
/// map, which reads back under the name "inline". What has its default, and an unlimited sensing range, is left out.
/// Precondition: the scenario would pass the checks of load_scenario(); of one that would not, the text is refused by
/// it. Reads vehicle files; throws ConfigError where the file of a vehicle's name cannot be read.
[[nodiscard]] std::string to_yaml(const Scenario& scenario);

}  // namespace jink::config
