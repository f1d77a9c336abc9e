// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/worker_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace jink::planner::base {
namespace {

TEST(WorkerPool, HasTheThreadsAskedForCallerIncluded) {
  EXPECT_EQ(WorkerPool(1).threads(), 1);
  EXPECT_EQ(WorkerPool(3).threads(), 3);
  EXPECT_GE(WorkerPool(0).threads(), 1);
}

TEST(WorkerPool, RunsEveryTaskOnce) {
  for (const int threads : {1, 2, 8}) {
    WorkerPool pool(threads);
    for (const std::uint32_t count : {0U, 1U, 2U, 7U, 1000U, 65535U}) {
      std::vector<std::atomic<int>> runs(count);
      pool.run(count, [&](std::uint32_t i) { ++runs[i]; });
      for (const auto& r : runs) ASSERT_EQ(r.load(), 1);
    }
  }
}

TEST(WorkerPool, RunsOnTheCallerAloneWithOneThread) {
  WorkerPool pool(1);
  const std::thread::id self = std::this_thread::get_id();
  int elsewhere = 0;
  std::vector<std::uint32_t> order;
  pool.run(5, [&](std::uint32_t i) {
    elsewhere += std::this_thread::get_id() == self ? 0 : 1;
    order.push_back(i);
  });
  EXPECT_EQ(elsewhere, 0);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

// Each task waits until the other has begun, which one thread alone could not do.
TEST(WorkerPool, RunsTasksAtTheSameTime) {
  WorkerPool pool(2);
  std::atomic<int> begun{0};
  pool.run(2, [&](std::uint32_t) {
    ++begun;
    while (begun.load() < 2) std::this_thread::yield();
  });
  EXPECT_EQ(begun.load(), 2);
}

// Plain writes of one round are read in the next, by any thread: the rounds must be ordered (also under
// -fsanitize=thread).
TEST(WorkerPool, RoundsFollowEachOther) {
  for (const int threads : {2, 4}) {
    WorkerPool pool(threads);
    constexpr std::uint32_t kTasks = 7;
    std::vector<std::uint64_t> now(kTasks, 1);
    std::vector<std::uint64_t> next(kTasks, 0);
    for (std::uint64_t round = 0; round < 5000; ++round) {
      pool.run(kTasks, [&](std::uint32_t i) { next[i] = now[(i + 1) % kTasks] + round; });
      std::swap(now, next);
    }
    for (const std::uint64_t value : now) EXPECT_EQ(value, 1U + 5000U * 4999U / 2U);
  }
}

TEST(WorkerPool, RoundsOfChangingSizeAndContextDoNotMix) {
  WorkerPool pool(3);
  std::atomic<std::uint64_t> sum{0};
  std::uint64_t expected = 0;
  for (std::uint32_t round = 0; round < 3000; ++round) {
    const std::uint32_t count = round % 5;
    expected += static_cast<std::uint64_t>(count) * round;
    if (round % 2 == 0) {
      pool.run(count, [&sum, round](std::uint32_t) { sum += round; });
    } else {
      pool.run(count, [&sum, twice = 2 * round](std::uint32_t) { sum += twice / 2; });
    }
  }
  EXPECT_EQ(sum.load(), expected);
}

// More workers than the spin bound lasts: the workers have gone to sleep when the next round comes.
TEST(WorkerPool, WakesSleepingWorkers) {
  WorkerPool pool(4);
  std::atomic<int> runs{0};
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 500; ++i) std::this_thread::yield();
    pool.run(4, [&](std::uint32_t) { ++runs; });
  }
  EXPECT_EQ(runs.load(), 80);
}

TEST(WorkerPool, ThrowsTheExceptionOfTheLowestTaskAfterAllAreDone) {
  for (const int threads : {1, 2, 8}) {
    WorkerPool pool(threads);
    for (int round = 0; round < 200; ++round) {
      std::atomic<int> runs{0};
      std::string message;
      try {
        pool.run(20, [&](std::uint32_t i) {
          ++runs;
          if (i == 3 || i == 7 || i == 19) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& error) {
        message = error.what();
      }
      ASSERT_EQ(message, "3");
      ASSERT_EQ(runs.load(), 20);
    }
  }
}

TEST(WorkerPool, IsUsableAfterAnException) {
  WorkerPool pool(2);
  EXPECT_THROW(pool.run(3, [](std::uint32_t) { throw std::logic_error("x"); }), std::logic_error);
  std::atomic<int> runs{0};
  EXPECT_NO_THROW(pool.run(3, [&](std::uint32_t) { ++runs; }));
  EXPECT_EQ(runs.load(), 3);
}

TEST(WorkerPool, CanBeMadeAndDestroyedInsideATask) {
  WorkerPool outer(2);
  std::atomic<int> runs{0};
  outer.run(6, [&](std::uint32_t) {
    WorkerPool inner(2);
    inner.run(5, [&](std::uint32_t) { ++runs; });
  });
  EXPECT_EQ(runs.load(), 30);
}

TEST(WorkerPool, IsDestroyedAtOnceAndAfterUse) {
  std::atomic<int> runs{0};
  for (int i = 0; i < 200; ++i) {
    WorkerPool pool(1 + i % 4);
    if (i % 2 == 0) pool.run(2, [&](std::uint32_t) { ++runs; });
  }
  EXPECT_EQ(runs.load(), 200);
}

TEST(WorkerPool, AllocatesNothingInARound) {
  WorkerPool pool(3);
  std::atomic<int> runs{0};
  pool.run(3, [&](std::uint32_t) { ++runs; });
  const test::AllocationGuard guard;
  for (int i = 0; i < 100; ++i) pool.run(5, [&](std::uint32_t) { ++runs; });
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(runs.load(), 503);
}

}  // namespace
}  // namespace jink::planner::base
