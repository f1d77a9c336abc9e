// SPDX-License-Identifier: BSD-3-Clause
// All pilots in closed loop: the companion, sensing and vehicle of `replay` with another planner.
#include "tools/lab/baselines/registry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "planner/base/solid.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tests/tools/lab/baselines/baseline_testing.hpp"
#include "tools/lab/baselines/baseline.hpp"
#include "tools/lab/baselines/paper_mode.hpp"

namespace jink::tools::lab::baselines {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(JINK_SOURCE_DIR) / "config";

config::Settings settings(const std::vector<std::string>& overrides = {}) {
  return config::load_settings(kConfig / "planner.yaml", overrides);
}

/// 12 m straight ahead.
config::Scenario straight(std::vector<config::Obstacle> obstacles = {}) {
  config::Scenario scenario;
  scenario.name = "straight";
  scenario.start = {0, 0, 1.5};
  scenario.target = {12, 0, 1.5};
  scenario.time_limit = 40.0;
  scenario.estimate.px4 = false;
  scenario.obstacles = std::move(obstacles);
  return scenario;
}

config::Obstacle sphere(double radius, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return {config::SphereShape{radius}, config::LinearMotion{position, velocity, Vec3::Zero()}};
}

/// Everything that was sent, and the plans' ends.
class Recorder final : public bridge::companion::FlightObserver {
 public:
  void on_setpoint(double, const bridge::vehicle::Setpoint& setpoint) override {
    for (const Vec3& v : {setpoint.position, setpoint.velocity, setpoint.acceleration}) {
      numbers.insert(numbers.end(), v.begin(), v.end());
    }
    farthest_aside = std::max(farthest_aside, std::abs(setpoint.position.y()));
  }
  void on_plan(double, const bridge::companion::PlanResult& result) override {
    numbers.push_back(result.plan.path.back().t);
    numbers.push_back(result.ms);
  }
  std::vector<double> numbers;
  double farthest_aside = 0.0;
};

sim::flight::ClosedLoopResult fly(std::string_view pilot, const config::Scenario& scenario,
                                  const config::Settings& with, int threads = 1, Recorder* recorder = nullptr) {
  sim::flight::ClosedLoopOptions options;
  options.threads = threads;
  if (recorder != nullptr) options.flight_observers.push_back(recorder);
  options.planner = [&](const bridge::companion::PlannerTaskSettings& task, double latency) {
    return make_pilot(pilot, task, latency, with.paper);
  };
  return sim::flight::fly_closed_loop(scenario, with, options);
}

class EveryPilot : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Arena, EveryPilot, testing::ValuesIn(pilots().begin(), pilots().end()),
                         [](const auto& pilot) { return std::string(pilot.param); });

const std::vector<std::string> kQuick{"horizon.generations=4", "optimizer.iterations=4", "companion.replan_rate_hz=5",
                                      "companion.largest_replan_rate_hz=5"};

TEST_P(EveryPilot, ReachesATargetInFreeAir) {
  const sim::flight::ClosedLoopResult result = fly(GetParam(), straight(), settings(kQuick));
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_LT(result.flight.flight_time, 12.0);
}

TEST_P(EveryPilot, FliesTheSameBitsAtAnyNumberOfThreadsAndBesideOthers) {
  const config::Scenario scenario =
      straight({sphere(0.5, {5, 0.2, 1.5}), sphere(0.5, {8, -6, 1.5}, {0, 2, 0}), sphere(0.4, {10, 0, 6}, {0, 0, -1})});
  const config::Settings with = settings(kQuick);
  Recorder one;
  std::vector<Recorder> more(2);
  fly(GetParam(), scenario, with, 1, &one);
  {
    std::vector<std::jthread> threads;
    threads.reserve(more.size());
    for (Recorder& recorder : more) threads.emplace_back([&] { fly(GetParam(), scenario, with, 4, &recorder); });
  }
  ASSERT_FALSE(one.numbers.empty());
  for (const Recorder& recorder : more) EXPECT_EQ(one.numbers, recorder.numbers);
}

TEST_P(EveryPilot, HandsAPlanOutWhenItsLatencyIsOver) {
  const std::unique_ptr<bridge::companion::PlannerTask> pilot = make_pilot(GetParam(), {}, 0.04);
  bridge::companion::PlanJob job;
  job.begun = 1.0;
  job.start = 1.2;
  job.request.target = {3, 0, 0};
  EXPECT_FALSE(pilot->busy());
  EXPECT_EQ(pilot->latency(), 0.04);
  pilot->start(job);
  EXPECT_TRUE(pilot->busy());
  EXPECT_FALSE(pilot->poll(1.03));
  const auto result = pilot->poll(1.04);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->missed);
  EXPECT_FALSE(pilot->busy());
  EXPECT_FALSE(result->plan.path.empty());
  EXPECT_EQ(result->plan.path.front().t, 0.0);
}

TEST_P(EveryPilot, MakesNoPathOfNumbersThatAreNone) {
  const std::unique_ptr<bridge::companion::PlannerTask> pilot = make_pilot(GetParam(), {}, 0.0);
  bridge::companion::PlanJob job;
  job.request.target = {3, 0, 0};
  job.tracks.resize(1);
  job.tracks[0].velocity.x() = std::numeric_limits<double>::quiet_NaN();
  pilot->start(job);
  const auto result = pilot->poll(0.0);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->plan.status, planner::verify::PlanStatus::kInvalid);
  EXPECT_TRUE(result->plan.path.empty());
}

TEST(Pilots, AreListedInTheirOrder) {
  const std::vector<std::string_view> names(pilots().begin(), pilots().end());
  EXPECT_EQ(names,
            (std::vector<std::string_view>{"jink", "paper", "momvo", "straight", "stop_and_wait", "orca", "rrt_star"}));
}

TEST(Pilots, UnknownOnesAreRefused) {
  EXPECT_THROW(static_cast<void>(make_pilot("icarus", {}, 0.0)), std::invalid_argument);
}

// The hook's own pilot is what flies without it.
TEST(Pilots, JinkIsThePlannerOfReplay) {
  const config::Scenario scenario = straight({sphere(0.5, {6, 0.1, 1.5})});
  const config::Settings with = settings(kQuick);
  Recorder hooked, own;
  fly("jink", scenario, with, 1, &hooked);
  sim::flight::ClosedLoopOptions options;
  options.threads = 1;
  options.flight_observers.push_back(&own);
  sim::flight::fly_closed_loop(scenario, with, options);
  EXPECT_EQ(hooked.numbers, own.numbers);
}

TEST(Pilots, MomvoIsAnotherSearchThanJinks) {
  const config::Scenario scenario = straight({sphere(0.5, {6, 0.1, 1.5})});
  const config::Settings with = settings(kQuick);
  Recorder jink, momvo;
  fly("jink", scenario, with, 1, &jink);
  fly("momvo", scenario, with, 1, &momvo);
  EXPECT_NE(jink.numbers, momvo.numbers);
}

TEST(StraightPilot, HitsWhatIsInItsWay) {
  Recorder recorder;
  const sim::flight::ClosedLoopResult result =
      fly("straight", straight({sphere(0.5, {6, 0.2, 1.5})}), settings(), 1, &recorder);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kCollision);
  EXPECT_LT(recorder.farthest_aside, 1e-3);
}

TEST(WaitingPilot, LetsASlowCrossingOnePass) {
  // It would be hit at x = 6 after 2.5 s.
  const config::Scenario scenario = straight({sphere(0.6, {6, -1.5, 1.5}, {0, 0.5, 0})});
  EXPECT_EQ(fly("straight", scenario, settings()).flight.outcome, bridge::supervisor::Outcome::kCollision);
  Recorder recorder;
  const sim::flight::ClosedLoopResult result = fly("stop_and_wait", scenario, settings(), 1, &recorder);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
  EXPECT_LT(recorder.farthest_aside, 1e-3);
}

TEST(WaitingPilot, WaitsInFrontOfWhatStands) {
  const sim::flight::ClosedLoopResult result = fly("stop_and_wait", straight({sphere(0.6, {6, 0, 1.5})}), settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kTimeout);
  EXPECT_GT(result.min_clearance, 0.2);
}

TEST(OrcaPilot, FliesPastWhatStandsAndWhatComes) {
  const config::Scenario scenario = straight({sphere(0.5, {4, 0, 1.5}), sphere(0.4, {16, 0.1, 1.5}, {-1.5, 0, 0})});
  const sim::flight::ClosedLoopResult result = fly("orca", scenario, settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
}

TEST(RrtPilot, FliesPastWhatStandsAndWhatComes) {
  const config::Scenario scenario = straight({sphere(0.5, {4, 0, 1.5}), sphere(0.4, {16, 0.1, 1.5}, {-1.5, 0, 0})});
  const sim::flight::ClosedLoopResult result = fly("rrt_star", scenario, settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
}

/// A wall across the way that is on the map, with a gap of 2.4 m about y = 1: the balls round its halves leave none.
config::Scenario gap_in_a_wall() {
  config::Scenario scenario = straight();
  scenario.map = {{config::BoxShape{{0.3, 10, 12}}, config::LinearMotion{{6, -5.2, 5}}},
                  {config::BoxShape{{0.3, 10, 12}}, config::LinearMotion{{6, 7.2, 5}}}};
  scenario.world = planner::base::Box{{-3, -8, 0.3}, {15, 9, 4}};
  return scenario;
}

TEST(StraightPilot, HitsWhatIsOnTheMap) {
  config::Scenario scenario = gap_in_a_wall();
  scenario.start.y() = scenario.target.y() = -1.0;
  EXPECT_EQ(fly("straight", scenario, settings()).flight.outcome, bridge::supervisor::Outcome::kCollision);
}

TEST(WaitingPilot, WaitsInFrontOfWhatIsOnTheMap) {
  config::Scenario scenario = gap_in_a_wall();
  scenario.start.y() = scenario.target.y() = -1.0;
  const sim::flight::ClosedLoopResult result = fly("stop_and_wait", scenario, settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kTimeout);
  EXPECT_GT(result.min_clearance, 0.2);
}

TEST(OrcaPilot, FliesThroughAGapOfTheMap) {
  const sim::flight::ClosedLoopResult result = fly("orca", gap_in_a_wall(), settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

// 8 m long: its nearest corner alone is passed by, its side is not.
TEST(OrcaPilot, SeesATruckFromItsFrontToItsRear) {
  const config::Obstacle truck{config::BoxShape{{2.5, 8, 3}}, config::LinearMotion{{6, -9, 1.5}, {0, 3, 0}}};
  const sim::flight::ClosedLoopResult result = fly("orca", straight({truck}), settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

TEST(RrtPilot, FliesThroughAGapOfTheMap) {
  const sim::flight::ClosedLoopResult result = fly("rrt_star", gap_in_a_wall(), settings());
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

TEST(NearestPart, OfABodyIsOnItsSurfaceOrBehindWhoIsInIt) {
  planner::base::Track slab;
  slab.position = {5, 0, 0};
  slab.velocity = {0, 1, 0};
  slab.body = {planner::base::Solid::box({2, 20, 20}, {}), 0.0, 0.5};
  slab.radius = slab.body.solid->reach() + 0.7;
  const planner::base::Track part = nearest_part(slab, {1, 3, 2});
  EXPECT_LT((part.position - Vec3(4, 3, 2)).norm(), 1e-6);
  EXPECT_NEAR(part.radius, 0.7, 1e-12);
  EXPECT_LT((part.velocity - Vec3(-1.5, 1 - 0.5, 0)).norm(), 1e-6);
  EXPECT_EQ(part.body.solid, nullptr);
  const planner::base::Track within = nearest_part(slab, {4.2, 3, 2});
  EXPECT_GT(within.position.x(), 4.2);  // the way out is to smaller x
  EXPECT_NEAR(within.position.y(), 3.0, 1e-6);
}

// The path is planned with more than the margin, since the flown motion cuts its corners.
TEST(PaperPilot, KeepsItsPathWhileThatKeepsTheMarginAndNoLonger) {
  planner::base::PaperSettings wide;
  wide.margin = planner::base::HorizonSettings{}.margin + 0.2;
  PaperPilot pilot({}, wide);
  bridge::companion::PlanJob asked = job({0, 0, 2}, {12, 0, 2}, {ball(0.5, {6, 0.6, 2})});
  const planner::verify::Plan first = plan(pilot, asked);
  ASSERT_GT(first.verification.min_clearance, asked.request.margin);
  asked.previous = first.path;
  ++asked.number;
  const planner::verify::Plan kept = plan(pilot, asked);
  EXPECT_TRUE(kept.kept_previous);
  EXPECT_EQ(kept.status, planner::verify::PlanStatus::kReaches);
  const Vec3 met = planner::base::sample(asked.previous, 3.0).position;
  asked.tracks.push_back(ball(0.5, met));
  EXPECT_FALSE(plan(pilot, asked).kept_previous);
}

TEST(PaperPilot, FliesTheFirstScenarioOfThePaper) {
  const config::Scenario scenario = config::load_scenario(kConfig / "scenarios" / "table2-1.yaml");
  const sim::flight::ClosedLoopResult result =
      fly("paper", scenario, settings({"companion.replan_rate_hz=5", "companion.largest_replan_rate_hz=5"}));
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

}  // namespace
}  // namespace jink::tools::lab::baselines
