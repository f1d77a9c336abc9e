// SPDX-License-Identifier: BSD-3-Clause
// Holds the planner to what it is for: in worlds with the straight line blocked, a free flight found wherever one
// exists. Whether one exists, and whether the planner's is free, says the judge.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <ostream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "config/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/horizon/open_loop.hpp"
#include "sim/families/families.hpp"
#include "sim/flight/closed_loop.hpp"
#include "sim/world/known_world.hpp"
#include "sim/world/world.hpp"
#include "tools/lab/oracle/feasibility.hpp"

namespace jink::worlds {
namespace {

using planner::verify::Plan;
using planner::verify::PlanStatus;

constexpr double kPatience = 30.0;  // s, twice what most need; a world without a flight is planned to the end

/// The world that a planner is asked about: what a perfect sensor tells at t = 0 of each obstacle, its enclosing sphere
/// with position, velocity and acceleration, is true for ever.
config::Scenario as_tracked(const config::Scenario& scenario) {
  const sim::world::World world(scenario);
  config::Scenario tracked = scenario;
  tracked.time_limit = std::min(tracked.time_limit, kPatience);
  tracked.obstacles.clear();
  for (int i = 0; i < world.obstacle_count(); ++i) {
    const planner::base::Track track = world.exact_track(i, 0.0);
    tracked.obstacles.push_back(
        {config::SphereShape{track.radius}, config::LinearMotion{track.position, track.velocity, track.acceleration}});
  }
  return tracked;
}

planner::base::Box volume_of(const config::Scenario& scenario) {
  if (scenario.world) return *scenario.world;
  planner::base::Box box;
  box.min.z() = std::min({0.0, scenario.start.z(), scenario.target.z()});
  return box;
}

/// What `jink plan` does.
Plan plan(const config::Scenario& scenario, const planner::base::HorizonSettings& settings = {}) {
  const sim::world::KnownWorld known(scenario);
  planner::base::WorkerPool pool(1);
  return planner::horizon::plan_open_loop(settings, {}, known.open_loop, 1, {settings.generations}, pool);
}

std::vector<tools::lab::oracle::TimedPoint> timed(const planner::base::TimedPath& path) {
  std::vector<tools::lab::oracle::TimedPoint> points;
  for (const planner::base::TimedPoint& point : path) points.push_back({point.t, point.position});
  return points;
}

/// What holds of every path that is planned from rest, wherever it leads.
void expect_flyable(const config::Scenario& scenario, const planner::base::TimedPath& path) {
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.front().t, 0.0);
  EXPECT_LT((path.front().position - scenario.start).norm(), 1e-6);
  EXPECT_LT(path.front().velocity.norm(), 1e-6);
  const std::vector<tools::lab::oracle::TimedPoint> points = timed(path);
  EXPECT_LE(tools::lab::oracle::top_speed(points), scenario.vehicle.max_speed + 1e-6);
  EXPECT_LE(tools::lab::oracle::top_climb(points), scenario.vehicle.max_climb + 1e-6);
  const planner::base::Box volume = volume_of(scenario);
  const double most = planner::base::HorizonSettings{}.emergency_share * scenario.vehicle.max_acceleration;
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_TRUE(volume.contains(path[i].position, 1e-6)) << path[i].t;
    if (i == 0) continue;
    const double duration = path[i].t - path[i - 1].t;
    ASSERT_GT(duration, 0.0) << path[i].t;
    EXPECT_LE((path[i].velocity - path[i - 1].velocity).norm(), most * duration + 1e-6) << path[i].t;
    const Vec3 evenly = path[i - 1].position + duration * path[i - 1].velocity;
    EXPECT_LE((path[i].position - evenly).norm(), 0.5 * most * duration * duration + 1e-6) << path[i].t;
  }
}

/// What its status says of a plan, by the judge. Of a blocked one it says no more than that it can be flown.
void expect_true(const config::Scenario& scenario, const Plan& plan) {
  expect_flyable(scenario, plan.path);
  if (plan.status != PlanStatus::kReaches && plan.status != PlanStatus::kProgresses) return;
  const double clearance = tools::lab::oracle::true_clearance(scenario, timed(plan.path));
  EXPECT_GT(clearance, 0.0);
  EXPECT_NEAR(clearance, plan.verification.min_clearance, 2e-4);
  if (plan.status == PlanStatus::kProgresses) return;
  ASSERT_FALSE(plan.path.empty());
  EXPECT_LT((plan.path.back().position - scenario.target).norm(), 1e-6);
  EXPECT_LE(plan.path.back().t, scenario.time_limit);
}

std::string description(const tools::lab::oracle::Flight& flight) {
  std::string text = "the judge's flight arrives at " + std::to_string(flight.arrival_time) + " s with " +
                     std::to_string(flight.min_clearance) + " m clear:";
  double next = 0.0;
  for (const tools::lab::oracle::TimedPoint& point : flight.path) {
    if (point.t < next && &point != &flight.path.back()) continue;
    std::array<char, 80> line{};
    std::snprintf(line.data(), line.size(), "\n  %6.2f s  %7.2f %7.2f %7.2f", point.t, point.position.x(),
                  point.position.y(), point.position.z());
    text += line.data();
    next = point.t + 0.5;
  }
  return text;
}

std::string name_of(std::string_view family) {
  return std::string(family);
}

class OpenLoop : public testing::TestWithParam<std::string_view> {};

// That all worlds of a family have a flight is no matter of course, but so it is with these, save where the target is
// occupied: as seen at t = 0 it stays so. Two of those, which cost the most, are enough.
TEST_P(OpenLoop, FindsAPlanWhereverAFlightExists) {
  const bool occupied = GetParam() == "target_occupied";
  const int worlds = occupied ? 2 : 8;
  int solvable = 0;
  int reached = 0;
  for (int seed = 1; seed <= worlds; ++seed) {
    const config::Scenario scenario =
        as_tracked(sim::families::make_world(GetParam(), static_cast<std::uint64_t>(seed)));
    SCOPED_TRACE(scenario.name);
    const tools::lab::oracle::OracleResult judgement = tools::lab::oracle::judge(scenario);
    const Plan found = plan(scenario);
    expect_true(scenario, found);
    const bool reaches = found.status == PlanStatus::kReaches;
    if (judgement.verdict == tools::lab::oracle::Verdict::kSolvable) {
      ++solvable;
      reached += reaches ? 1 : 0;
      EXPECT_TRUE(reaches) << planner::verify::to_string(found.status) << ", but " << description(judgement.flight);
    }
    EXPECT_FALSE(reaches && judgement.verdict == tools::lab::oracle::Verdict::kImpossible);
  }
  EXPECT_EQ(solvable, occupied ? 0 : worlds);
  std::printf("%s: %d of %d worlds solvable, %d of these solved\n", name_of(GetParam()).c_str(), solvable, worlds,
              reached);
}

/// Where an obstacle blocks the line: all but the corridors of the literature, which are the arena's, the teams, which
/// nobody plans for at once, and the known places, which nobody passes who takes people and doors for balls.
std::vector<std::string_view> blocked_families() {
  std::vector<std::string_view> families(sim::families::world_families().begin(),
                                         sim::families::world_families().end());
  std::erase_if(families, [](std::string_view family) {
    return !sim::families::blocks_straight_line(family) || sim::families::has_map(family) ||
           sim::families::make_world(family, 1).obstacles.empty();
  });
  return families;
}

INSTANTIATE_TEST_SUITE_P(Worlds, OpenLoop, testing::ValuesIn(blocked_families()),
                         [](const auto& tested) { return name_of(tested.param); });

/// The families that a vehicle must get through whatever it knows: constant velocities, and the target that is free in
/// the end. How well it does where obstacles turn is a matter of degree and belongs to the bench.
std::vector<std::string_view> promised_families() {
  std::vector<std::string_view> families = {"target_occupied"};
  std::copy_if(sim::families::world_families().begin(), sim::families::world_families().end(),
               std::back_inserter(families), sim::families::is_linear);
  return families;
}

sim::flight::ClosedLoopResult fly(const config::Scenario& scenario, int threads = 1) {
  sim::flight::ClosedLoopOptions options;
  options.threads = threads;
  return sim::flight::fly_closed_loop(scenario, config::load_settings(config::config_folder() / "planner.yaml"),
                                      options);
}

class ClosedLoop : public testing::TestWithParam<std::tuple<std::string_view, int>> {};

TEST_P(ClosedLoop, ReachesTheTarget) {
  const auto [family, seed] = GetParam();
  const config::Scenario scenario = sim::families::make_world(family, static_cast<std::uint64_t>(seed));
  const sim::flight::ClosedLoopResult result = fly(scenario);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Worlds, ClosedLoop,
                         testing::Combine(testing::ValuesIn(promised_families()), testing::Range(1, 4)),
                         [](const auto& tested) {
                           return name_of(std::get<0>(tested.param)) + "_" + std::to_string(std::get<1>(tested.param));
                         });

/// The first of a world's walls along x, to be passed.
config::Scenario first_wall(std::uint64_t seed) {
  config::Scenario scenario = sim::families::make_world("walls", seed);
  const sim::world::World all(scenario);
  std::vector<config::Obstacle> wall;
  for (int i = 0; i < all.obstacle_count(); ++i) {
    if (all.exact_track(i, 0.0).position.x() < 10.0) wall.push_back(scenario.obstacles[static_cast<std::size_t>(i)]);
  }
  scenario.obstacles = wall;
  scenario.target.x() = 10.0;
  return scenario;
}

// The first of two walls, 111 spheres: whoever only tries ways past the nearest of them never meets the hole that
// wanders 3 to 5 m aside.
TEST(ClosedLoop, PassesThroughAWallWithAWanderingHole) {
  const config::Scenario scenario = first_wall(103);
  ASSERT_EQ(scenario.obstacles.size(), 111U);
  const sim::flight::ClosedLoopResult result = fly(scenario);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

// A hole that wanders 4 m aside and 2 m above of a vehicle between wall and wall: to wait is cheaper in every single
// plan.
TEST(ClosedLoop, FliesToAHoleFarAsideWhereWaitingDoesNotHelp) {
  config::Scenario scenario = sim::families::make_world("walls", 2431836138);
  scenario.start = {2.2, 13.2, 1.6};
  scenario.estimate.px4 = false;
  scenario.time_limit = 60.0;
  const sim::flight::ClosedLoopResult result = fly(scenario);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

// A hole that is thrown back every 0.9 s is passed only by who does not also keep clear, for a second, of where its
// wall would be if it went straight on.
TEST(ClosedLoop, PassesThroughAWallThatSwingsQuickly) {
  config::Scenario scenario = first_wall(2449717983);
  ASSERT_EQ(scenario.obstacles.size(), 88U);
  scenario.time_limit = 40.0;
  sim::families::set_tier(scenario, sim::families::Tier::kRealistic);
  const sim::flight::ClosedLoopResult result = fly(scenario);
  EXPECT_EQ(result.flight.outcome, bridge::supervisor::Outcome::kReached) << result.flight.reason;
  EXPECT_GT(result.min_clearance, 0.0);
}

class ThreadCount : public testing::TestWithParam<std::string_view> {};

TEST_P(ThreadCount, DoesNotChangeABitOfTheFlight) {
  config::Scenario scenario = sim::families::make_world(GetParam(), 1);
  scenario.time_limit = 4.0;  // enough for a difference to show
  const sim::flight::ClosedLoopResult one = fly(scenario, 1);
  const sim::flight::ClosedLoopResult eight = fly(scenario, 8);
  EXPECT_EQ(one.flight.path_length, eight.flight.path_length);
  EXPECT_EQ(one.flight.flight_time, eight.flight.flight_time);
  EXPECT_EQ(one.min_clearance, eight.min_clearance);
}

INSTANTIATE_TEST_SUITE_P(Worlds, ThreadCount, testing::Values("crossing", "falling", "darts"),
                         [](const auto& tested) { return name_of(tested.param); });

// Worlds made by hand: a hall with a wall across. First those with a hole in it, then those that the judge proves to
// have no flight.

constexpr double kWallAt = 8.0;      // m, along x
constexpr double kBallRadius = 0.5;  // m

/// The mission is 16 m long, down the middle of a hall 6 m wide and 4 m high.
config::Scenario hall(std::vector<config::Obstacle> obstacles) {
  config::Scenario scenario;
  scenario.name = "hall";
  scenario.start = {0, 0, 2};
  scenario.target = {16, 0.3, 2.2};
  scenario.world = planner::base::Box{{-1, -3, 0}, {18, 3, 4}};
  scenario.time_limit = 20;
  scenario.obstacles = std::move(obstacles);
  return scenario;
}

/// Closed but for the balls whose centres are nearer than `hole` to (y, z).
std::vector<config::Obstacle> wall(double hole = 0.0, double y = 0.0, double z = 0.0) {
  std::vector<config::Obstacle> balls;
  for (int i = 0; i <= 8; ++i) {
    for (int k = 0; k <= 5; ++k) {
      const Vec3 at(kWallAt, 0.75 * i - 3.0, 0.8 * k);
      if (std::hypot(at.y() - y, at.z() - z) >= hole) {
        balls.push_back({config::SphereShape{kBallRadius}, config::LinearMotion{at}});
      }
    }
  }
  return balls;
}

struct Hole {
  double radius = 0.0;  // m, from its middle to the centres of the nearest balls at the least
  double height = 0.0;  // m, of its middle
};

std::ostream& operator<<(std::ostream& out, const Hole& hole) {
  return out << "radius " << hole.radius << " m, height " << hole.height << " m";
}

class WallWithAHole : public testing::TestWithParam<Hole> {};

// What the families do not ask: there is one way, and it is not where the vehicle looks first.
TEST_P(WallWithAHole, IsFlownThroughWhereverItIs) {
  for (const double y : {-2.0, -1.0, 0.0, 1.5, 2.2}) {
    SCOPED_TRACE("hole at y = " + std::to_string(y));
    const config::Scenario scenario = hall(wall(GetParam().radius, y, GetParam().height));
    const tools::lab::oracle::OracleResult judgement = tools::lab::oracle::judge(scenario);
    EXPECT_EQ(judgement.verdict, tools::lab::oracle::Verdict::kSolvable);
    const Plan found = plan(scenario);
    expect_true(scenario, found);
    EXPECT_EQ(planner::verify::to_string(found.status), planner::verify::to_string(PlanStatus::kReaches))
        << description(judgement.flight);
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, WallWithAHole,
                         testing::Values(Hole{1.2, 1.6}, Hole{1.2, 2.0}, Hole{1.2, 3.0}, Hole{1.4, 1.2}, Hole{1.4, 2.0},
                                         Hole{1.4, 3.0}, Hole{1.6, 1.2}, Hole{1.6, 2.0}, Hole{1.6, 3.0}),
                         [](const auto& tested) {
                           return "radius_" + std::to_string(std::lround(100 * tested.param.radius)) + "_cm_height_" +
                                  std::to_string(std::lround(100 * tested.param.height)) + "_cm";
                         });

TEST(NoFlight, PastAClosedWallButToIt) {
  const config::Scenario scenario = hall(wall());
  ASSERT_EQ(tools::lab::oracle::judge(scenario).verdict, tools::lab::oracle::Verdict::kImpossible);
  const Plan found = plan(scenario);
  EXPECT_EQ(planner::verify::to_string(found.status), planner::verify::to_string(PlanStatus::kProgresses));
  expect_true(scenario, found);
  ASSERT_FALSE(found.path.empty());
  EXPECT_LT(found.path.back().position.x(), kWallAt - kBallRadius);
  EXPECT_GT(found.path.back().position.x(), 0.5 * kWallAt);  // it comes as near as is safe, or most of the way
}

TEST(NoFlight, IntoAnOccupiedTargetButNearIt) {
  config::Scenario scenario = hall({});
  scenario.obstacles = {{config::SphereShape{1.0}, config::LinearMotion{scenario.target}}};
  ASSERT_EQ(tools::lab::oracle::judge(scenario).verdict, tools::lab::oracle::Verdict::kImpossible);
  const Plan found = plan(scenario);
  EXPECT_EQ(planner::verify::to_string(found.status), planner::verify::to_string(PlanStatus::kProgresses));
  expect_true(scenario, found);
  ASSERT_FALSE(found.path.empty());
  EXPECT_GT(found.path.back().position.x(), 0.5 * scenario.target.x());
}

TEST(NoFlight, OutOfABlockedStart) {
  const config::Scenario scenario =
      hall({{config::SphereShape{kBallRadius}, config::LinearMotion{{0.7, 0, 2}, {1, 0, 0}}}});
  ASSERT_EQ(tools::lab::oracle::judge(scenario).verdict, tools::lab::oracle::Verdict::kImpossible);
  const Plan found = plan(scenario);
  EXPECT_EQ(planner::verify::to_string(found.status), planner::verify::to_string(PlanStatus::kStartBlocked));
  EXPECT_FALSE(found.verification.free());
  expect_flyable(scenario, found.path);
  EXPECT_EQ(found.path.size(), 1U);
  EXPECT_EQ(bridge::supervisor::to_string(fly(scenario).flight.outcome),
            bridge::supervisor::to_string(bridge::supervisor::Outcome::kStartBlocked));
}

}  // namespace
}  // namespace jink::worlds
