// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/worker_pool.hpp"

#include <algorithm>
#include <cassert>

namespace jink::planner::base {
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

// Rounds follow each other within microseconds; a sleep and a wake cost more than that. Some tens of microseconds.
constexpr int kSpins = 2000;

// Tells the processor that this is a waiting loop: the other hardware thread, and the memory, are left in peace.
void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

std::size_t thread_count(int wanted) {
  return static_cast<std::size_t>(wanted > 0 ? wanted
                                             : std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
}

}  // namespace

WorkerPool::WorkerPool(int threads) : shares_(thread_count(threads)) {
  workers_.reserve(shares_.size() - 1);
  for (std::uint32_t i = 1; i < shares_.size(); ++i) {
    workers_.emplace_back([this, i](const std::stop_token& stop) { work(stop, i); });
  }
}

WorkerPool::~WorkerPool() {
  for (std::jthread& worker : workers_) worker.request_stop();
  for (Share& share : shares_) {
    share.ticket.fetch_add(std::uint64_t{1} << 32U);  // a new round without tasks wakes the sleeper
    share.ticket.notify_all();
  }
}

void WorkerPool::run_erased(std::uint32_t count, const void* context, Call call) {
  assert(count <= 0xffffU);
  if (count == 0) return;
  context_ = context;
  call_ = call;
  ++round_;
  pending_.store(count, std::memory_order_relaxed);
  const auto threads = static_cast<std::uint32_t>(shares_.size());
  for (std::uint32_t i = 0; i < threads; ++i) {
    const std::uint32_t share = count / threads + (i < count % threads ? 1 : 0);
    shares_[i].ticket.store(make_ticket(round_, share), std::memory_order_release);
    if (i > 0) shares_[i].ticket.notify_one();
  }
  while (work_once(0)) {
  }
  for (int spin = 0; pending_.load(std::memory_order_acquire) != 0; ++spin) {
    if (spin > kSpins) {
      const std::uint32_t left = pending_.load(std::memory_order_acquire);
      if (left != 0) pending_.wait(left, std::memory_order_acquire);
    }
    relax();
  }
  if (!failed_.load(std::memory_order_acquire)) return;
  const std::scoped_lock lock(failure_mutex_);
  failed_.store(false, std::memory_order_relaxed);
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

bool WorkerPool::take(std::uint32_t owner, std::uint32_t& task) {
  std::atomic<std::uint64_t>& ticket = shares_[owner].ticket;
  std::uint64_t seen = ticket.load(std::memory_order_acquire);
  while (has_task(seen)) {
    if (!ticket.compare_exchange_weak(seen, seen + 1, std::memory_order_acq_rel)) continue;
    task = ticket_next(seen) * static_cast<std::uint32_t>(shares_.size()) + owner;
    return true;
  }
  return false;
}

// One task: of the thread's own share first, then of the others'.
bool WorkerPool::work_once(std::uint32_t self) {
  const auto threads = static_cast<std::uint32_t>(shares_.size());
  for (std::uint32_t i = 0; i < threads; ++i) {
    std::uint32_t task = 0;
    if (!take((self + i) % threads, task)) continue;
    execute(task);
    return true;
  }
  return false;
}

void WorkerPool::execute(std::uint32_t task) {
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
}

void WorkerPool::work(const std::stop_token& stop, std::uint32_t self) {
  const std::atomic<std::uint64_t>& ticket = shares_[self].ticket;
  while (!stop.stop_requested()) {
    const std::uint64_t idle = ticket.load(std::memory_order_acquire);
    if (work_once(self) || has_task(idle)) continue;
    int spin = 0;
    for (; spin < kSpins && ticket.load(std::memory_order_acquire) == idle; ++spin) relax();
    if (spin == kSpins && !stop.stop_requested()) ticket.wait(idle, std::memory_order_acquire);
  }
}

}  // namespace jink::planner::base
