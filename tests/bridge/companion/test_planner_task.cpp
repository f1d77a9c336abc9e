// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/planner_task.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "tests/support/bridge_fakes.hpp"

namespace jink::bridge::companion {
namespace {

PlannerTaskSettings small_settings() {
  PlannerTaskSettings settings;
  settings.horizon.generations = 3;
  settings.horizon.population = 8;
  settings.horizon.slaves = 2;
  settings.horizon.sharing = 1;
  settings.horizon.deadline_ms = 5000.0;
  settings.threads = 1;
  return settings;
}

PlanJob job(double begun, double start, std::uint64_t number = 0) {
  PlanJob j;
  j.request.position = {0, 0, 1.5};
  j.request.target = {6, 0, 1.5};
  j.request.margin = 0.35;
  j.tracks.push_back({.id = 1, .position = {3, 0, 1.5}, .radius = 0.5});
  j.number = number;
  j.begun = begun;
  j.start = start;
  j.newest_track = 0.5;
  return j;
}

/// Turns until the planner has something to say; fails after a minute rather than hanging.
std::optional<PlanResult> wait_for(PlannerTask& planner, double now) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < limit) {
    if (auto result = planner.poll(now)) return result;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return std::nullopt;
}

/// The clock that the thread reads; it can be made to throw there.
class ThrowingClock final : public base::Clock {
 public:
  [[nodiscard]] double now() const override {
    if (broken) throw std::runtime_error("the clock stands still");
    return 3.0;
  }
  std::atomic<bool> broken = false;
};

TEST(VirtualPlanner, HandsThePlanOutAfterItsLatency) {
  VirtualPlanner planner(small_settings(), 0.02);
  EXPECT_EQ(planner.latency(), 0.02);
  EXPECT_FALSE(planner.busy());
  EXPECT_FALSE(planner.poll(0.0));
  planner.start(job(1.0, 1.02, 4));
  EXPECT_TRUE(planner.busy());
  EXPECT_FALSE(planner.poll(1.0));
  EXPECT_FALSE(planner.poll(1.0199));
  const auto result = planner.poll(1.02);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->missed);
  EXPECT_DOUBLE_EQ(result->ms, 20.0);
  EXPECT_EQ(result->job.number, 4U);
  EXPECT_EQ(result->job.newest_track, 0.5);
  ASSERT_FALSE(result->plan.path.empty());
  EXPECT_EQ(result->plan.path.front().t, 0.0);
  EXPECT_FALSE(planner.busy());
  EXPECT_FALSE(planner.poll(2.0));
}

TEST(VirtualPlanner, SaysWhenAPlanCameAfterItsStart) {
  VirtualPlanner planner(small_settings(), 0.05);
  planner.start(job(1.0, 1.02));
  EXPECT_FALSE(planner.poll(1.02));
  const auto result = planner.poll(1.06);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->missed);
}

TEST(VirtualPlanner, SeesTheJobsOwnTracks) {
  VirtualPlanner planner(small_settings(), 0.0);
  PlanJob blocked = job(0.0, 0.0);
  blocked.tracks[0].position = blocked.request.position;  // in the middle of it
  planner.start(std::move(blocked));
  const auto result = planner.poll(0.0);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->plan.status, planner::verify::PlanStatus::kBlocked);
}

TEST(VirtualPlanner, IsAPureFunctionOfJobAndSeed) {
  const auto path_of = [](std::uint64_t seed, int threads) {
    PlannerTaskSettings settings = small_settings();
    settings.seed = seed;
    settings.threads = threads;
    VirtualPlanner planner(settings, 0.0);
    planner.start(job(0.0, 0.0));
    planner::base::TimedPath path = planner.poll(0.0)->plan.path;
    return path;
  };
  const auto equal = [](const planner::base::TimedPath& a, const planner::base::TimedPath& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i].t != b[i].t || a[i].position != b[i].position || a[i].velocity != b[i].velocity) return false;
    }
    return true;
  };
  EXPECT_TRUE(equal(path_of(1, 1), path_of(1, 1)));
  EXPECT_TRUE(equal(path_of(1, 1), path_of(1, 3)));
}

TEST(ThreadedPlanner, ThePlanArrivesOnceAndTheNextCanBegin) {
  const testing::FakeClock clock;
  ThreadedPlanner planner(small_settings(), clock);
  EXPECT_NEAR(planner.latency(), 5.03, 1e-9);
  for (std::uint64_t number = 0; number < 3; ++number) {
    EXPECT_FALSE(planner.busy());
    EXPECT_FALSE(planner.poll(1.0));
    planner.start(job(1.0, 1.1, number));
    EXPECT_TRUE(planner.busy());
    const auto result = wait_for(planner, 1.05);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->job.number, number);
    EXPECT_FALSE(result->missed);
    EXPECT_FALSE(result->plan.path.empty());
    EXPECT_EQ(result->plan.generations, 3);
    EXPECT_FALSE(planner.busy());
  }
}

TEST(ThreadedPlanner, APlanThatIsTakenAfterItsStartIsAMiss) {
  const testing::FakeClock clock;
  ThreadedPlanner planner(small_settings(), clock);
  planner.start(job(1.0, 1.1));
  const auto result = wait_for(planner, 1.2);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->missed);
}

TEST(ThreadedPlanner, GivesTheSamePlanAsInVirtualTime) {
  const testing::FakeClock clock;
  ThreadedPlanner threaded(small_settings(), clock);
  VirtualPlanner virtual_planner(small_settings(), 0.0);
  threaded.start(job(0.0, 0.0));
  virtual_planner.start(job(0.0, 0.0));
  const auto a = wait_for(threaded, 0.0);
  const auto b = virtual_planner.poll(0.0);
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->plan.path.size(), b->plan.path.size());
  for (std::size_t i = 0; i < a->plan.path.size(); ++i) EXPECT_EQ(a->plan.path[i].position, b->plan.path[i].position);
}

TEST(ThreadedPlanner, WhatItThrowsReachesTheCaller) {
  ThrowingClock clock;
  ThreadedPlanner planner(small_settings(), clock);
  clock.broken = true;
  planner.start(job(0.0, 0.0));
  EXPECT_THROW(
      {
        const auto result = wait_for(planner, 0.0);
        EXPECT_FALSE(result);
      },
      std::runtime_error);
}

TEST(ThreadedPlanner, CanBeDestroyedWhileItPlansOrBeforeItEverDid) {
  const testing::FakeClock clock;
  PlannerTaskSettings settings = small_settings();
  settings.horizon.generations = 200;
  for (int i = 0; i < 5; ++i) {
    ThreadedPlanner planner(settings, clock);
    planner.start(job(0.0, 0.0));
    EXPECT_TRUE(planner.busy());
  }
  const ThreadedPlanner idle(settings, clock);
  EXPECT_FALSE(idle.busy());
}

}  // namespace
}  // namespace jink::bridge::companion
