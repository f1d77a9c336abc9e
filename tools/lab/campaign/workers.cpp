// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/campaign/workers.hpp"

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

namespace jink::tools::lab::campaign {
namespace {

constexpr std::chrono::milliseconds kWaitPeriod{200};

}  // namespace

void Workers::run(int threads, const std::function<bool()>& step, const std::function<void()>& on_wait) {
  running_ = threads;
  failed_ = false;
  std::vector<std::jthread> workers;
  workers.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) workers.emplace_back([&] { work(step); });
  const auto ended = [&] {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, kWaitPeriod, [this] { return running_ == 0; });
  };
  while (!ended()) on_wait();
  workers.clear();
  on_wait();
  if (const std::exception_ptr failure = std::exchange(failure_, nullptr)) std::rethrow_exception(failure);
}

void Workers::work(const std::function<bool()>& step) {
  try {
    while (!failed_ && step()) {
    }
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    failed_ = true;
  }
  {
    const std::scoped_lock lock(mutex_);
    --running_;
  }
  ended_.notify_all();
}

}  // namespace jink::tools::lab::campaign
