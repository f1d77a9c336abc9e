// SPDX-License-Identifier: BSD-3-Clause
// What the tests over real DDS transports share: a domain for each, and a clock that they set.
#pragma once

#include <unistd.h>

#include <atomic>
#include <string>

#include "bridge/clock.hpp"

namespace jink::bridge::testing {

/// Tests run side by side, each in a process: a domain each. 1 to 100 are clear of the ephemeral ports.
inline int own_domain() {
  static int tests = 0;
  return 1 + (static_cast<int>(getpid()) + 7 * tests++) % 100;
}

/// Reads what the test sets; safe from any thread.
class ManualClock final : public Clock {
 public:
  [[nodiscard]] double now() const override { return now_; }
  void set(double now) { now_ = now; }

 private:
  std::atomic<double> now_ = 0.0;
};

/// Python with Cyclone DDS, another vendor's, and a script of this folder.
inline std::string python() {
  return std::string(JINK_SOURCE_DIR) + "/.venv/bin/python";
}
inline std::string script(const std::string& name) {
  return std::string(JINK_SOURCE_DIR) + "/tests/bridge/" + name;
}

}  // namespace jink::bridge::testing
