// SPDX-License-Identifier: BSD-3-Clause
// Time comes in through here and nothing else reads it.
#pragma once

#include <chrono>

namespace jink::bridge::base {

/// Seconds since an arbitrary origin; never runs backwards. Safe from any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual double now() const = 0;
};

/// The machine's monotonic clock, zero at construction.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] double now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - origin_).count();
  }

 private:
  std::chrono::steady_clock::time_point origin_ = std::chrono::steady_clock::now();
};

}  // namespace jink::bridge::base
