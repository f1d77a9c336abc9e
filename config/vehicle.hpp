// SPDX-License-Identifier: BSD-3-Clause
// Vehicle files: config/vehicles/NAME.yaml.
#pragma once

#include <filesystem>
#include <string>

#include "planner/types.hpp"

namespace jink::config {

/// Reads and checks a vehicle file; throws ConfigError.
planner::VehicleLimits load_vehicle(const std::filesystem::path& file);

}  // namespace jink::config
