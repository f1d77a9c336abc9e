// SPDX-License-Identifier: BSD-3-Clause
// What the tests over real DDS transports share: a domain for each, and a clock that they set.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/payload_io.hpp"

namespace jink::bridge::testing {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Tests run side by side, each in a process: a domain for each call, nobody else's until the process ends.
inline int own_domain() {
  constexpr int kDomains = 38;  // 1 to 38; the system tests have those from 40 on
  for (int k = 0; k < kDomains; ++k) {
    const int domain = 1 + (static_cast<int>(getpid()) + k) % kDomains;
    const std::string lock = "/tmp/jink-test-domain-" + std::to_string(domain);
    const int file = open(lock.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644);  // held until the process ends
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return domain;
    if (file >= 0) close(file);
  }
  throw std::runtime_error("every DDS domain for tests is in use");
}

/// Reads what the test sets; safe from any thread.
class ManualClock final : public base::Clock {
 public:
  [[nodiscard]] double now() const override { return now_; }
  void set(double now) { now_ = now; }

 private:
  std::atomic<double> now_ = 0.0;
};

/// A message with a header as a payload, in that frame, stamped 100.5 s.
template <typename Message>
dds::Payload stamped_payload(Message message, const std::string& frame) {
  message.header().frame_id(frame);
  message.header().stamp().sec(100);
  message.header().stamp().nanosec(500'000'000);
  dds::Payload payload;
  dds::encode(message, payload);
  return payload;
}

/// Python with Cyclone DDS, another vendor's, and a script of this folder.
inline std::string python() {
  return std::string(JINK_SOURCE_DIR) + "/.venv/bin/python";
}
inline std::string script(const std::string& name) {
  return std::string(JINK_SOURCE_DIR) + "/tests/bridge/dds/" + name;
}

}  // namespace jink::bridge::testing
