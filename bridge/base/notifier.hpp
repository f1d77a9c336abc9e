// SPDX-License-Identifier: BSD-3-Clause
// Ends a wait early: for the loop that would otherwise find a new track or plan only at its next turn.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace jink::bridge::base {

/// Safe from any thread. Several notifications before a wait count as one.
class Notifier {
 public:
  void notify() {
    {
      const std::scoped_lock lock(mutex_);
      notified_ = true;
    }
    changed_.notify_one();
  }

  /// Returns when notified, or at `until`. True: notified.
  bool wait_until(std::chrono::steady_clock::time_point until) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, until, [this] { return notified_; });
    const bool notified = notified_;
    notified_ = false;
    return notified;
  }

 private:
  std::mutex mutex_;  // guards notified_
  std::condition_variable changed_;
  bool notified_ = false;
};

}  // namespace jink::bridge::base
