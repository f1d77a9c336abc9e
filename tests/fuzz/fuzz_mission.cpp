// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a mission file: refused with a ConfigError, or a mission that says where to fly. The first byte, where it is
// a zero, makes the rest a file of planner parameters.
#include "config/error.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"
#include "tests/fuzz/fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static jink::fuzz::MemoryFile file;
  const bool parameters = size > 0 && data[0] == 0;
  parameters ? file.write(data + 1, size - 1) : file.write(data, size);
  try {
    if (parameters) {
      (void)jink::config::load_settings(file.path());
    } else {
      const jink::config::Mission mission = jink::config::load_mission(file.path(), JINK_SOURCE_DIR "/config/vehicles");
      jink::fuzz::require(!mission.waypoints.empty(), "a mission without a waypoint");
      jink::fuzz::require(!mission.connection.empty(), "a mission without a connection");
    }
  } catch (const jink::config::ConfigError& error) {
    jink::fuzz::require(std::strchr(error.what(), '\n') == nullptr, "an error of more than one line");
  }
  return 0;
}
