// SPDX-License-Identifier: BSD-3-Clause
// The `faults` key of scenarios. Not a public header.
#pragma once

#include <string>
#include <vector>

#include "config/faults.hpp"
#include "config/yaml.hpp"

namespace jink::config {

/// Reads a list of faults for a scenario with `vehicles` vehicles. Throws ConfigError: unknown kind, a key that is not
/// its kind's, a missing one, a value out of range, `for` where a fault happens at once.
std::vector<Fault> read_faults(const Value& value, int vehicles);

/// One fault as the map that read_faults() reads back: "{at: 1, kind: delay, direction: both, seconds: 0.2}".
std::string fault_text(const Fault& fault);

}  // namespace jink::config
