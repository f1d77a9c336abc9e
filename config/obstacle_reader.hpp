// SPDX-License-Identifier: BSD-3-Clause
// One obstacle of a file. Not a public header.
#pragma once

#include "config/scenario.hpp"
#include "config/yaml.hpp"

namespace jink::config {

/// Reads an item of `obstacles`, as load_scenario() says. Throws ConfigError.
Obstacle read_obstacle(const Value& value);
/// The same of one of a map, which is an error where it moves or turns.
Obstacle read_solid_at_rest(const Value& value);

}  // namespace jink::config
