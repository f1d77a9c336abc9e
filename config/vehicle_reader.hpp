// SPDX-License-Identifier: BSD-3-Clause
// The `vehicle` key of scenarios and missions: a name or a map. Not a public header.
#pragma once

#include <filesystem>
#include <string>

#include "config/yaml.hpp"

namespace jink::config {

struct NamedVehicle {
  std::string name;  ///< "inline" where the file gives a map
  planner::base::VehicleLimits limits;
};

/// Reads `value`, found in `file`. A name is looked up in `vehicles`; where that is empty, in vehicles/ beside the
/// folder of `file`, then in vehicles/ of config_folder(). Throws ConfigError; an unknown name's error lists the names.
NamedVehicle read_vehicle(const Value& value, const std::filesystem::path& file, const std::filesystem::path& vehicles);

/// Whether vehicles/ of config_folder() has a file of that name that says just these limits. Throws ConfigError where
/// there is one that cannot be read.
bool is_project_vehicle(const std::string& name, const planner::base::VehicleLimits& limits);

}  // namespace jink::config
