// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a scenario file: refused with a ConfigError, or a world that can be asked where its obstacles are.
#include <cmath>

#include "config/error.hpp"
#include "config/scenario.hpp"
#include "sim/world.hpp"
#include "tests/fuzz/fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static jink::fuzz::MemoryFile file;
  file.write(data, size);
  try {
    const jink::config::Scenario scenario =
        jink::config::load_scenario(file.path(), JINK_SOURCE_DIR "/config/vehicles");
    const jink::sim::World world(scenario);
    for (const double t : {0.0, 0.004, 7.5}) {
      jink::fuzz::require(!std::isnan(world.clearance(scenario.start, t)), "a clearance is NaN");
    }
  } catch (const jink::config::ConfigError& error) {
    jink::fuzz::require(std::strchr(error.what(), '\n') == nullptr, "an error of more than one line");
  }
  return 0;
}
