// SPDX-License-Identifier: BSD-3-Clause
// Vehicle files: config/vehicles/NAME.yaml.
#pragma once

#include <filesystem>

#include "planner/base/types.hpp"

namespace jink::config {

/// Reads and checks a vehicle file. Its keys are the fields of VehicleLimits, all required and above 0, with
/// cruise_speed <= max_speed. Throws ConfigError (config/error.hpp).
planner::base::VehicleLimits load_vehicle(const std::filesystem::path& file);

}  // namespace jink::config
