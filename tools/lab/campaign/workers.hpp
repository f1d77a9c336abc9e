// SPDX-License-Identifier: BSD-3-Clause
// Threads that work through a campaign.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>

namespace jink::tools::lab::campaign {

class Workers {
 public:
  /// Calls `step` again and again from `threads` threads, in each until it returns false, and `on_wait` from the
  /// caller's a few times a second and once at the end. What a step throws ends its thread, makes failed() true for the
  /// others to look at, and is rethrown here when all have ended; the first where there are several.
  void run(int threads, const std::function<bool()>& step, const std::function<void()>& on_wait);

  /// Thread-safe.
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  void work(const std::function<bool()>& step);

  std::mutex mutex_;  // guards running_ and failure_
  std::condition_variable ended_;
  int running_ = 0;
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
};

}  // namespace jink::tools::lab::campaign
