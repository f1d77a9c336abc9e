// SPDX-License-Identifier: BSD-3-Clause
// Threads that run numbered tasks. The calling thread works too, so a pool of one thread starts none.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace jink::planner {

/// run() may be called from one thread at a time. It neither allocates nor locks unless a task throws. Which thread
/// runs which task is open: tasks write into slots of their own, and whoever merges does so by task number.
class WorkerPool {
 public:
  /// `threads` >= 1, the caller included; 0: one for each core.
  explicit WorkerPool(int threads = 0);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  [[nodiscard]] int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls task(i) once for each i in [0, count) and returns when all have returned. count <= 65535. The exception of
  /// the lowest-numbered task that threw is thrown again here, after all tasks are done.
  template <typename Task>
  void run(std::uint32_t count, const Task& task) {
    run_erased(count, &task, [](const void* context, std::uint32_t i) { (*static_cast<const Task*>(context))(i); });
  }

 private:
  using Call = void (*)(const void*, std::uint32_t);
  void run_erased(std::uint32_t count, const void* context, Call call);
  bool work_once();
  void work(const std::stop_token& stop);

  // One word says which round is on, how many tasks it has and which is next; a task is taken by adding one. A late
  // worker cannot take a task of a round that it did not see.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> pending_{0};
  const void* context_ = nullptr;  // written between rounds, read after a task is taken
  Call call_ = nullptr;
  std::atomic<bool> failed_{false};
  std::mutex failure_mutex_;  // guards failure_ and failed_task_
  std::exception_ptr failure_;
  std::uint32_t failed_task_ = 0;
  std::vector<std::jthread> workers_;
};

}  // namespace jink::planner
