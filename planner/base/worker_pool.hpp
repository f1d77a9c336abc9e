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

namespace jink::planner::base {

/// run() may be called from one thread at a time. It neither allocates nor locks unless a task throws. Which thread
/// runs which task is open: tasks write into slots of their own, and whoever merges does so by task number.
class WorkerPool {
 public:
  /// `threads` >= 1, the caller included; 0: one for each core.
  explicit WorkerPool(int threads = 0);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Threads that work, the caller included.
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
  bool work_once(std::uint32_t self);
  bool take(std::uint32_t owner, std::uint32_t& task);
  void execute(std::uint32_t task);
  void work(const std::stop_token& stop, std::uint32_t self);

  // The tasks of a round are dealt out to the threads in turn, the same ones in every round, so that a task's data stay
  // in its thread's cache; who has finished helps the others. Of each thread's share one word says which round is on,
  // how many tasks it has and which is next; a task is taken by adding one. A late worker cannot take a task of a round
  // that it did not see.
  struct alignas(64) Share {
    std::atomic<std::uint64_t> ticket{0};
  };
  std::vector<Share> shares_;
  alignas(64) std::atomic<std::uint32_t> pending_{0};
  std::uint64_t round_ = 0;
  const void* context_ = nullptr;  // written between rounds, read after a task is taken
  Call call_ = nullptr;
  std::atomic<bool> failed_{false};
  std::mutex failure_mutex_;  // guards failure_ and failed_task_
  std::exception_ptr failure_;
  std::uint32_t failed_task_ = 0;
  std::vector<std::jthread> workers_;
};

}  // namespace jink::planner::base
