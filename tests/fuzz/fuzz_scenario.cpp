// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a scenario file: refused with a ConfigError, or a world that can be asked where its obstacles are, and that
// is the same again once it has been written and read.
#include <cmath>
#include <optional>
#include <string>

#include "config/error.hpp"
#include "config/scenario.hpp"
#include "config/scenario_writer.hpp"
#include "sim/world/world.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

void expect_to_read_back(const jink::config::Scenario& scenario) {
  static jink::fuzz::MemoryFile file;
  const std::string text = jink::config::to_yaml(scenario);
  constexpr std::size_t kLargestFile = std::size_t{16} << 20;  // that is read; aliases spelled out may need more
  if (text.size() > kLargestFile) return;
  file.write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  // What load_scenario() accepted it accepts again: a ConfigError here is a finding too.
  const jink::config::Scenario again = jink::config::load_scenario(file.path(), JINK_SOURCE_DIR "/config/vehicles");
  const bool same = again.obstacles == scenario.obstacles && again.faults == scenario.faults &&
                    again.sensing == scenario.sensing && again.wind == scenario.wind &&
                    again.estimate == scenario.estimate && again.start == scenario.start &&
                    again.target == scenario.target && again.vehicles.size() == scenario.vehicles.size() &&
                    jink::config::to_yaml(again) == text;
  jink::fuzz::require(same, "a scenario that was written reads back as another");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static jink::fuzz::MemoryFile file;
  file.write(data, size);
  std::optional<jink::config::Scenario> accepted;
  try {
    accepted = jink::config::load_scenario(file.path(), JINK_SOURCE_DIR "/config/vehicles");
    const jink::config::Scenario& scenario = *accepted;
    const jink::sim::world::World world(scenario);
    for (const double t : {0.0, 0.004, 7.5}) {
      jink::fuzz::require(!std::isnan(world.clearance(scenario.start, t)), "a clearance is NaN");
    }
  } catch (const jink::config::ConfigError& error) {
    jink::fuzz::require(std::strchr(error.what(), '\n') == nullptr, "an error of more than one line");
  }
  if (accepted) expect_to_read_back(*accepted);
  return 0;
}
