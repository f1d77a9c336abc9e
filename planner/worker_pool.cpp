// SPDX-License-Identifier: BSD-3-Clause
#include "planner/worker_pool.hpp"

#include <algorithm>
#include <cassert>

namespace jink::planner {
namespace {

// ticket: round (32 bits) | tasks of the round (16) | next task (16)
constexpr std::uint64_t make_ticket(std::uint64_t round, std::uint64_t count) {
  return (round << 32U) | (count << 16U);
}
constexpr std::uint32_t ticket_next(std::uint64_t ticket) {
  return static_cast<std::uint32_t>(ticket & 0xffffU);
}
constexpr std::uint32_t ticket_count(std::uint64_t ticket) {
  return static_cast<std::uint32_t>((ticket >> 16U) & 0xffffU);
}
constexpr bool has_task(std::uint64_t ticket) {
  return ticket_next(ticket) < ticket_count(ticket);
}

// Rounds follow each other within microseconds; a sleep and a wake cost more than that.
constexpr int kSpins = 2000;

}  // namespace

WorkerPool::WorkerPool(int threads) {
  const int wanted = threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  workers_.reserve(static_cast<std::size_t>(wanted - 1));
  for (int i = 1; i < wanted; ++i) {
    workers_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  }
}

WorkerPool::~WorkerPool() {
  for (std::jthread& worker : workers_) worker.request_stop();
  ticket_.fetch_add(std::uint64_t{1} << 32U);  // a new round without tasks wakes the sleepers
  ticket_.notify_all();
}

void WorkerPool::run_erased(std::uint32_t count, const void* context, Call call) {
  assert(count <= 0xffffU);
  if (count == 0) return;
  context_ = context;
  call_ = call;
  pending_.store(count, std::memory_order_relaxed);
  ticket_.store(make_ticket((ticket_.load(std::memory_order_relaxed) >> 32U) + 1U, count), std::memory_order_release);
  if (!workers_.empty()) ticket_.notify_all();
  while (work_once()) {
  }
  for (int spin = 0; pending_.load(std::memory_order_acquire) != 0; ++spin) {
    if (spin > kSpins) {
      const std::uint32_t left = pending_.load(std::memory_order_acquire);
      if (left != 0) pending_.wait(left, std::memory_order_acquire);
    }
  }
  if (!failed_.load(std::memory_order_acquire)) return;
  const std::scoped_lock lock(failure_mutex_);
  failed_.store(false, std::memory_order_relaxed);
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

bool WorkerPool::work_once() {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  while (has_task(ticket)) {
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
    const std::uint32_t task = ticket_next(ticket);
    try {
      call_(context_, task);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex_);
      if (!failure_ || task < failed_task_) {
        failure_ = std::current_exception();
        failed_task_ = task;
        failed_.store(true, std::memory_order_release);
      }
    }
    if (pending_.fetch_sub(1, std::memory_order_acq_rel) == 1) pending_.notify_all();
    return true;
  }
  return false;
}

void WorkerPool::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (work_once()) continue;
    const std::uint64_t idle = ticket_.load(std::memory_order_acquire);
    if (has_task(idle)) continue;
    int spin = 0;
    while (spin < kSpins && ticket_.load(std::memory_order_acquire) == idle) ++spin;
    if (spin == kSpins && !stop.stop_requested()) ticket_.wait(idle, std::memory_order_acquire);
  }
}

}  // namespace jink::planner
