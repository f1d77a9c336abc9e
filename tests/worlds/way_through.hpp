// SPDX-License-Identifier: BSD-3-Clause
// What is asked of a world through which there is a way: to be flown and planned through.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "bridge/companion/planner_task.hpp"
#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/horizon/open_loop.hpp"
#include "sim/flight/closed_loop.hpp"
#include "sim/world/known_world.hpp"
#include "sim/world/world.hpp"

namespace jink::worlds {

/// Flies it at the settings' defaults.
inline sim::flight::ClosedLoopResult flown(const config::Scenario& scenario, std::uint64_t seed = 1) {
  sim::flight::ClosedLoopOptions options;
  options.seed = seed;
  options.threads = 1;
  return sim::flight::fly_closed_loop(scenario, config::Settings(), options);
}

/// The flight arrives, and touches nothing. Returns it.
inline sim::flight::ClosedLoopResult expect_flown_through(const config::Scenario& scenario, std::uint64_t seed = 1) {
  sim::flight::ClosedLoopResult result = flown(scenario, seed);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
  return result;
}

/// jink's planner, as if there were no map: who does not look. For ClosedLoopOptions::planner.
inline std::unique_ptr<bridge::companion::PlannerTask> blind_planner(
    const bridge::companion::PlannerTaskSettings& settings, double latency) {
  class Blind final : public bridge::companion::PlannerTask {
   public:
    Blind(const bridge::companion::PlannerTaskSettings& task, double late) : own_(task, late) {}
    void start(bridge::companion::PlanJob job) override {
      job.map = {};
      own_.start(std::move(job));
    }
    [[nodiscard]] bool busy() const override { return own_.busy(); }
    [[nodiscard]] double latency() const override { return own_.latency(); }
    [[nodiscard]] std::optional<bridge::companion::PlanResult> poll(double now) override { return own_.poll(now); }

   private:
    bridge::companion::VirtualPlanner own_;
  };
  return std::make_unique<Blind>(settings, latency);
}

/// Plans as `jink plan` does. The plan arrives, and is as free, m, by the judge's measure, which shares nothing with
/// the verifier's.
inline void expect_planned_through(const config::Scenario& scenario, double accuracy) {
  const sim::world::KnownWorld known(scenario);
  planner::base::WorkerPool pool(1);
  const planner::base::HorizonSettings settings;
  const planner::verify::Plan plan =
      planner::horizon::plan_open_loop(settings, {}, known.open_loop, 1, {settings.generations}, pool);
  ASSERT_EQ(plan.status, planner::verify::PlanStatus::kReaches);
  const sim::world::World world(scenario);
  double least = planner::base::kInfinity;
  for (std::size_t i = 1; i < plan.path.size(); ++i) {
    const planner::base::TimedPoint& a = plan.path[i - 1];
    const planner::base::TimedPoint& b = plan.path[i];
    least = std::min(least, world.sweep(a.position, a.t, b.position, b.t).min_clearance);
  }
  EXPECT_NEAR(least, plan.verification.min_clearance, accuracy);
  EXPECT_GT(least, 0.0);
}

}  // namespace jink::worlds
