// SPDX-License-Identifier: BSD-3-Clause
// Whole flights whose planner stops answering, or that are interrupted.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "sim/flight/closed_loop.hpp"

namespace jink::sim::flight {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(JINK_SOURCE_DIR) / "config";

/// Hands no plan out within [from, until): what is ready then comes at its end, as from a thread
/// that got no time.
class StallingPlanner final : public bridge::companion::PlannerTask {
 public:
  StallingPlanner(std::unique_ptr<bridge::companion::PlannerTask> planner, double from, double until)
      : planner_(std::move(planner)), from_(from), until_(until) {}
  void start(bridge::companion::PlanJob job) override { planner_->start(std::move(job)); }
  [[nodiscard]] bool busy() const override { return planner_->busy(); }
  [[nodiscard]] double latency() const override { return planner_->latency(); }
  [[nodiscard]] std::optional<bridge::companion::PlanResult> poll(double now) override {
    if (now >= from_ && now < until_) return std::nullopt;
    return planner_->poll(now);
  }

 private:
  std::unique_ptr<bridge::companion::PlannerTask> planner_;
  double from_, until_;
};

/// Around a ball that stands in the way.
config::Scenario blocked_line() {
  config::Scenario scenario;
  scenario.name = "stall";
  scenario.start = {0, 0, 1.5};
  scenario.target = {10, 0, 1.5};
  scenario.time_limit = 30.0;
  scenario.obstacles = {{config::SphereShape{0.6}, config::LinearMotion{{5, 0, 1.5}, Vec3::Zero(), Vec3::Zero()}}};
  return scenario;
}

config::Settings settings() {
  return config::load_settings(kShipped / "planner.yaml", {"horizon.generations=4"});
}

ClosedLoopResult fly_with_stall(double from, double until) {
  ClosedLoopOptions options;
  options.planner = [=](const bridge::companion::PlannerTaskSettings& task, double latency) {
    return std::make_unique<StallingPlanner>(std::make_unique<bridge::companion::VirtualPlanner>(task, latency), from,
                                             until);
  };
  return fly_closed_loop(blocked_line(), settings(), options);
}

bool braked_for_the_planner(const ClosedLoopResult& result) {
  for (const bridge::companion::HazardRecord& hazard : result.flight.hazards) {
    if (hazard.what.find("plan") != std::string::npos) return true;
  }
  return false;
}

// Wherever on the way it stalls: before the ball, beside it, behind it.
TEST(ClosedLoopStalls, APlannerThatStallsForAWhileBrakesTheVehicleWhichThenGoesOn) {
  for (const double from : {0.8, 1.4, 2.0, 2.6}) {
    SCOPED_TRACE(from);
    const ClosedLoopResult result = fly_with_stall(from, from + 1.5);
    EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
    EXPECT_TRUE(braked_for_the_planner(result));
    EXPECT_GT(result.min_clearance, 0.0);
  }
}

TEST(ClosedLoopStalls, APlannerThatStallsForGoodEndsTheFlightInHoldWithTheReason) {
  for (const double from : {0.8, 1.4, 2.0, 2.6}) {
    SCOPED_TRACE(from);
    const ClosedLoopResult result = fly_with_stall(from, planner::base::kInfinity);
    EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kAborted);
    EXPECT_NE(result.flight.reason.find("plan"), std::string::npos) << result.flight.reason;
    EXPECT_TRUE(braked_for_the_planner(result));
    EXPECT_GT(result.min_clearance, 0.0);
    EXPECT_LT(result.flight.flight_time, from + 6.0);
  }
}

TEST(ClosedLoopStalls, AnInterruptEndsAFlightInVirtualTimeAsItEndsARealOne) {
  int turns = 0;
  ClosedLoopOptions options;
  options.interrupted = [&turns] { return ++turns > 60; };  // of 20 ms
  const ClosedLoopResult result = fly_closed_loop(blocked_line(), settings(), options);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kAborted);
  EXPECT_EQ(result.flight.reason, "interrupted");
  EXPECT_GT(result.flight.flight_time, 1.2);
  EXPECT_LT(result.flight.flight_time, 5.0);
  EXPECT_GT(result.min_clearance, 0.0);
}

}  // namespace
}  // namespace jink::sim::flight
