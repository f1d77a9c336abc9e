// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/oracle/feasibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/families/families.hpp"
#include "sim/world/world.hpp"
#include "tests/sim/world/random_obstacles.hpp"
#include "tools/lab/oracle/cells.hpp"

namespace jink::tools::lab::oracle {
namespace {

using std::numbers::pi;

config::Scenario hall(std::vector<config::Obstacle> obstacles) {
  config::Scenario scenario;
  scenario.start = {0, 0, 2};
  scenario.target = {16, 0.3, 2.2};
  scenario.world = planner::base::Box{{-1, -3, 0}, {18, 3, 4}};
  scenario.time_limit = 60;
  scenario.obstacles = std::move(obstacles);
  return scenario;
}

config::Obstacle ball(double radius, const config::Motion& motion) {
  return {config::SphereShape{radius}, motion};
}

/// Closed across the hall at x = 8 but for the spheres whose centres are nearer than `hole` to (y, z) = (1, 2); all
/// swing along x by `swing`.
std::vector<config::Obstacle> wall(double hole, double swing = 0.0) {
  std::vector<config::Obstacle> spheres;
  for (double y = -3; y <= 3.01; y += 0.75) {
    for (double z = 0; z <= 4.01; z += 0.8) {
      if (std::hypot(y - 1, z - 2) < hole) continue;
      spheres.push_back(ball(0.5, config::SineMotion{{8, y, z}, {swing, 0, 0}, {0.1, 0, 0}, {1, 0, 0}}));
    }
  }
  return spheres;
}

/// Every promise that judge.hpp makes of a flight, with the sweep of sim as the second opinion on its clearance.
void expect_sound(const config::Scenario& scenario, const Flight& flight, const OracleOptions& options = {}) {
  const std::vector<TimedPoint>& path = flight.path;
  ASSERT_GE(path.size(), 2U);
  EXPECT_EQ(path.front().t, 0.0);
  EXPECT_EQ(path.front().position, scenario.start);
  EXPECT_LT((path.back().position - scenario.target).norm(), 1e-12);
  EXPECT_EQ(path.back().t, flight.arrival_time);
  EXPECT_LE(flight.arrival_time, scenario.time_limit);
  EXPECT_LE(top_speed(path), scenario.vehicle.max_speed + 1e-9);
  EXPECT_LE(top_climb(path), scenario.vehicle.max_climb + 1e-9);
  const sim::world::World world(scenario);
  double nearest = planner::base::kInfinity;
  Vec3 velocity = Vec3::Zero();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double duration = path[i].t - path[i - 1].t;
    const Vec3 next = (path[i].position - path[i - 1].position) / duration;
    const double most = options.acceleration_share * scenario.vehicle.max_acceleration;
    EXPECT_LE((next - velocity).norm() / duration, most + 1e-6) << path[i].t;
    velocity = next;
    EXPECT_TRUE(world.inside(path[i].position)) << path[i].t;
    nearest =
        std::min(nearest, world.sweep(path[i - 1].position, path[i - 1].t, path[i].position, path[i].t).min_clearance);
  }
  EXPECT_LE(velocity.norm(), 0.2);  // it comes to rest
  EXPECT_GE(nearest, options.margin);
  if (!scenario.obstacles.empty() || !scenario.map.empty()) {
    EXPECT_NEAR(nearest, flight.min_clearance, 2e-4);
  }
}

TEST(Judge, EmptyWorldIsSolvable) {
  const config::Scenario scenario = hall({});
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight);
  EXPECT_GE(judgement.flight.arrival_time, 16.0 / 5.0);
  EXPECT_LE(judgement.flight.arrival_time, 9.0);
  EXPECT_EQ(judgement.flight.min_clearance, planner::base::kInfinity);
}

TEST(Judge, NeedsNoWorldBox) {
  config::Scenario scenario = hall({ball(1.0, config::LinearMotion{{8, 0, 2}})});
  scenario.world.reset();
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight);
}

TEST(Judge, ClosedWallIsImpossible) {
  EXPECT_EQ(judge(hall(wall(0.0))).verdict, Verdict::kImpossible);
}

TEST(Judge, WallWithAHoleIsSolvable) {
  const config::Scenario scenario = hall(wall(1.6));
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight);
}

/// As `options`, but for flights that keep the least margin alone.
OracleOptions tight(OracleOptions options = {}) {
  options.margin = options.least_margin;
  return options;
}

// The hole leaves 0.39 m around the vehicle, which is too little for the margin: nothing is promised either way by who
// asks for no less.
TEST(Judge, WallWithATightHoleTakesTheLeastMargin) {
  const config::Scenario scenario = hall(wall(1.0));
  OracleOptions strict;
  strict.least_margin = strict.margin;
  EXPECT_EQ(judge(scenario, strict).verdict, Verdict::kUnknown);
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight, tight());
}

config::Obstacle box(const Vec3& center, const Vec3& edges) {
  return {config::BoxShape{edges}, config::LinearMotion{center}};
}

/// Two solid walls across the hall at x, but for an opening of that width and height from the floor on.
void add_wall(std::vector<config::Obstacle>& solids, double x, double y, double width, double height) {
  const double low = y - 0.5 * width;
  const double high = y + 0.5 * width;
  solids.push_back(box({x, 0.5 * (low - 3.5), 2}, {0.2, low + 3.5, 4}));
  solids.push_back(box({x, 0.5 * (high + 3.5), 2}, {0.2, 3.5 - high, 4}));
  if (height < 4) solids.push_back(box({x, y, 0.5 * (4 + height)}, {0.2, width, 4 - height}));
}

// Of 1.3 m, which leaves 0.35 m on either side of the vehicle; the balls round the walls' halves would leave nothing.
// The walls are in the map or among the obstacles.
TEST(Judge, DoorsAreFlownThrough) {
  std::vector<config::Obstacle> walls;
  add_wall(walls, 5, -1.9, 1.3, 2.1);
  add_wall(walls, 8, 2.1, 1.3, 2.1);
  add_wall(walls, 11, -1.33, 1.3, 2.1);
  config::Scenario scenario = hall(walls);
  const OracleResult seen = judge(scenario);
  ASSERT_EQ(seen.verdict, Verdict::kSolvable);
  expect_sound(scenario, seen.flight, tight());
  EXPECT_LT(seen.flight.min_clearance, 0.36);
  std::swap(scenario.obstacles, scenario.map);
  const OracleResult known = judge(scenario);
  ASSERT_EQ(known.verdict, Verdict::kSolvable);
  expect_sound(scenario, known.flight, tight());
  EXPECT_EQ(known.flight.arrival_time, seen.flight.arrival_time);
}

TEST(Judge, AClosedRoomOfTheMapIsImpossible) {
  config::Scenario scenario = hall({});
  scenario.map = {box({8, 0, 2}, {0.2, 8, 4.5})};
  EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible);
  scenario.map.clear();
  EXPECT_EQ(judge(scenario).verdict, Verdict::kSolvable);
  // The target stands in a room without a door.
  scenario.world.reset();
  for (const double side : {-1.0, 1.0}) {
    scenario.map.push_back(box({16 + 2 * side, 0, 2}, {0.2, 4.2, 5}));
    scenario.map.push_back(box({16, 2 * side, 2}, {4.2, 0.2, 5}));
    scenario.map.push_back(box({16, 0, 2 + 2.5 * side}, {4.2, 4.2, 0.2}));
  }
  EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible);
  scenario.map.front() = box({14, 1.4, 2}, {0.2, 1.4, 5});  // a part of the near wall is gone
  EXPECT_EQ(judge(scenario).verdict, Verdict::kSolvable);
}

double length_of(const Flight& flight) {
  double length = 0.0;
  for (std::size_t i = 1; i < flight.path.size(); ++i)
    length += (flight.path[i].position - flight.path[i - 1].position).norm();
  return length;
}

// A container along the way, 12 m long: past its side it is 1.3 m aside, round its ball 7.
TEST(Judge, ALongBoxIsFlownRoundCloserThanItsBall) {
  config::Scenario scenario = hall({box({8, 0.2, 2}, {12, 1.2, 4})});
  scenario.world = planner::base::Box{{-1, -9, 0}, {18, 9, 4}};
  const OracleResult as_it_is = judge(scenario);
  ASSERT_EQ(as_it_is.verdict, Verdict::kSolvable);
  expect_sound(scenario, as_it_is.flight);
  EXPECT_LT(length_of(as_it_is.flight), 18.0);
  const planner::geometry::Sphere around = sim::world::World(scenario).sphere(0, 0.0);
  scenario.obstacles = {ball(around.radius, config::LinearMotion{around.center})};
  const OracleResult as_ball = judge(scenario);
  ASSERT_EQ(as_ball.verdict, Verdict::kSolvable);
  EXPECT_LT(length_of(as_it_is.flight) + 3.0, length_of(as_ball.flight));
}

// Out of a bag: the straight distance leads to its bottom, from where no beam comes back.
TEST(Judge, DeadEndsAreLeft) {
  config::Scenario scenario = hall({});
  scenario.world = planner::base::Box{{-6, -9, 0}, {24, 9, 4}};
  scenario.map = {box({12, 0, 2}, {0.3, 12, 6}), box({5, 6, 2}, {14, 0.3, 6}), box({5, -6, 2}, {14, 0.3, 6})};
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight);
  EXPECT_GT(length_of(judgement.flight), 24.0);
}

// What turns and what leans, each as near as it is.
TEST(Judge, ShapesThatTurnAreFlownPast) {
  config::Obstacle plank = box({8, 0, 2}, {5.6, 0.2, 6});  // as long as the hall is wide
  plank.yaw_rate = 0.6;
  config::Obstacle mast{config::CylinderShape{0.2, 12}, config::LinearMotion{{12, 1, 2}}, {0.4, 0.6, 0}};
  config::Obstacle pipe{config::CapsuleShape{0.1, {0, -4, 0}, {0, 4, 1}}, config::LinearMotion{{3.5, 0, 2.2}}};
  const config::Scenario scenario = hall({plank, mast, pipe});
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight, tight());
}

// It sweeps the hall to and fro without a gap; the vehicle can go with it but not past it.
TEST(Judge, SealedMovingGateIsImpossible) {
  EXPECT_EQ(judge(hall(wall(0.0, 2.0))).verdict, Verdict::kImpossible);
}

TEST(Judge, TargetInAnObstacleIsImpossible) {
  const Vec3 target = hall({}).target;
  const std::vector<config::Shape> shapes = {
      config::SphereShape{0.6}, config::BoxShape{{1.5, 1.5, 1.5}},
      config::VertexShape{{{-1, -1, -1}, {2, -1, -1}, {-1, 2, -1}, {-1, -1, 2}, {0.6, 0.6, 0.6}}}};
  for (const config::Shape& shape : shapes) {
    config::Scenario scenario = hall({{shape, config::LinearMotion{target}}});
    EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible) << shape.index();
    scenario.world.reset();
    EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible) << shape.index();
  }
}

TEST(Judge, TargetIsReachedOnceItIsFree) {
  const Vec3 target = hall({}).target;
  const config::WaypointsMotion leaves{{10, 13}, {target, target + Vec3(0, 0, 10)}};
  const config::Scenario scenario = hall({ball(0.8, leaves)});
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  expect_sound(scenario, judgement.flight);
  EXPECT_GE(judgement.flight.arrival_time, 10.0);
  EXPECT_LE(judgement.flight.arrival_time, 14.0);

  config::Scenario impatient = scenario;
  impatient.time_limit = 9.9;
  EXPECT_EQ(judge(impatient).verdict, Verdict::kImpossible);
}

TEST(Judge, BlockedStartIsImpossible) {
  EXPECT_EQ(judge(hall({ball(0.5, config::LinearMotion{{0.7, 0, 2}, {1, 0, 0}})})).verdict, Verdict::kImpossible);
}

TEST(Judge, TooFarForItsSpeedIsImpossible) {
  config::Scenario scenario = hall({});
  scenario.time_limit = 2.9;  // 16 m at 5 m/s, less the acceptance: 3.1 s
  EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible);
  scenario.target = {1, 0, 12};  // 10 m up at 2 m/s: 4.75 s
  scenario.world->max.z() = 14;
  scenario.time_limit = 4.5;
  EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible);
  scenario.time_limit = 9;
  EXPECT_EQ(judge(scenario).verdict, Verdict::kSolvable);
}

TEST(Judge, NamesItsVerdicts) {
  EXPECT_EQ(to_string(Verdict::kSolvable), "solvable");
  EXPECT_EQ(to_string(Verdict::kImpossible), "impossible");
  EXPECT_EQ(to_string(Verdict::kUnknown), "unknown");
}

// The two searches are independent; here they must not contradict each other.
TEST(Judge, FlightsThroughTheFamiliesAreSound) {
  for (const std::string_view family : sim::families::world_families()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const config::Scenario scenario = sim::families::make_world(family, seed);
      SCOPED_TRACE(scenario.name);
      const OracleResult judgement = judge(scenario);
      ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
      expect_sound(scenario, judgement.flight, sim::families::has_map(family) ? tight() : OracleOptions{});
      ASSERT_EQ(judgement.others.size(), scenario.vehicles.size());
      for (std::size_t k = 0; k < judgement.others.size(); ++k)
        expect_sound(alone(scenario, k + 1), judgement.others[k]);
    }
  }
}

/// Where a flight is at `t`; at its end from then on.
Vec3 place_at(const Flight& flight, double t) {
  for (std::size_t i = 1; i < flight.path.size(); ++i) {
    const TimedPoint& from = flight.path[i - 1];
    const TimedPoint& to = flight.path[i];
    if (t <= to.t) return from.position + (t - from.t) / (to.t - from.t) * (to.position - from.position);
  }
  return flight.path.back().position;
}

// Two that swap places: each alone flies straight through the other.
TEST(Judge, FlightsOfATeamKeepApart) {
  config::Scenario scenario = hall({});
  scenario.vehicles = {{scenario.target, scenario.start, "ardrone2", {}}, {{8, -2, 2}, {8, 2, 2}, "ardrone2", {}}};
  const OracleResult judgement = judge(scenario);
  ASSERT_EQ(judgement.verdict, Verdict::kSolvable);
  ASSERT_EQ(judgement.others.size(), 2U);
  const std::vector<const Flight*> flights = {&judgement.flight, &judgement.others[0], &judgement.others[1]};
  for (std::size_t k = 0; k < 3; ++k) {
    expect_sound(alone(scenario, k), *flights[k]);
    for (std::size_t j = 0; j < k; ++j) {
      for (double t = 0.0; t < 20.0; t += 0.01) {
        ASSERT_GE((place_at(*flights[k], t) - place_at(*flights[j], t)).norm(), 2 * 0.3 + 0.4 - 1e-3) << t;
      }
    }
  }
}

TEST(Judge, TeamIsImpossibleWhereOneOfItIsAlone) {
  config::Scenario scenario = hall({ball(0.6, config::LinearMotion{{14, -2, 2}})});
  scenario.vehicles = {{{2, 2, 2}, {14, -2, 2}, "ardrone2", {}}};
  scenario.time_limit = 10;
  EXPECT_EQ(judge(scenario).verdict, Verdict::kImpossible);
  scenario.vehicles.clear();
  EXPECT_EQ(judge(scenario).verdict, Verdict::kSolvable);
}

TEST(TrueClearance, OfCasesWorkedByHand) {
  // They close at 3 m/s from 10 m: level after 10/3 s, 1 m apart at the side.
  config::Scenario scenario = hall({ball(0.5, config::LinearMotion{{10, 1, 0}, {-2, 0, 0}})});
  const std::vector<TimedPoint> path = {{0, {0, 0, 0}}, {5, {5, 0, 0}}};
  EXPECT_NEAR(true_clearance(scenario, path), 1.0 - 0.5 - 0.3, 1e-4);
  // There and back within a millisecond.
  const config::WaypointsMotion dart{{0, 1, 1.0005, 1.001}, {{50, 0, 0}, {50, 0, 0}, {0, 0, 0}, {50, 0, 0}}};
  scenario.obstacles = {ball(0.01, dart)};
  const std::vector<TimedPoint> standing = {{0, {0, 0.5, 0}}, {2, {0, 0.5, 0}}};
  EXPECT_NEAR(true_clearance(scenario, standing), 0.5 - 0.01 - 0.3, 1e-4);
  // Always at the same distance.
  scenario.obstacles = {ball(0.5, config::SineMotion{{0, 0.5, 0}, {3, 3, 0}, {0.2, 0.2, 0}, {pi / 2, 0, 0}})};
  EXPECT_NEAR(true_clearance(scenario, standing), 2.5 - 0.3, 1e-4);
  // A box, by its edge, and from within.
  scenario.obstacles = {{config::BoxShape{{2, 2, 2}}, config::LinearMotion{{4, 4, 0}}}};
  EXPECT_NEAR(true_clearance(scenario, std::vector<TimedPoint>{{0, {0, 0, 0}}}), std::hypot(3, 3) - 0.3, 1e-12);
  EXPECT_NEAR(true_clearance(scenario, std::vector<TimedPoint>{{0, {4, 4.5, 0}}}), -0.5 - 0.3, 1e-12);
  // The map counts as well.
  std::swap(scenario.obstacles, scenario.map);
  EXPECT_NEAR(true_clearance(scenario, std::vector<TimedPoint>{{0, {4, 4.5, 0}}}), -0.5 - 0.3, 1e-12);
  scenario.obstacles = {ball(0.5, config::LinearMotion{{0, 1, 0}})};
  EXPECT_NEAR(true_clearance(scenario, std::vector<TimedPoint>{{0, {0, 0, 0}}}), 0.5 - 0.3, 1e-12);
}

TEST(TrueClearance, WithoutObstaclesOrPathIsInfinite) {
  EXPECT_EQ(true_clearance(hall({}), std::vector<TimedPoint>{{0, {0, 0, 0}}, {1, {1, 0, 0}}}),
            planner::base::kInfinity);
  EXPECT_EQ(true_clearance(hall({ball(1, config::LinearMotion{})}), {}), planner::base::kInfinity);
}

// All motions, all shapes, against the simulator's own sweep, which works in another way.
TEST(TrueClearance, AgreesWithTheSimulator) {
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    planner::base::RandomStream random(60, seed);
    config::Scenario scenario = hall({});
    for (std::uint64_t i = 0; i < 3; ++i) {
      const config::Shape shape = sim::testing::random_shape(random, random.below(sim::testing::kShapeKinds));
      scenario.obstacles.push_back(
          {shape, sim::testing::random_motion(random, (seed + i) % sim::testing::kMotionKinds)});
    }
    std::vector<TimedPoint> path = {{0, sim::testing::random_vector(random, -3, 3)}};
    for (int i = 0; i < 3; ++i) {
      const double duration = random.uniform(0, 2);
      path.push_back({path.back().t + duration, sim::testing::random_vector(random, -3, 3)});
    }
    const sim::world::World world(scenario);
    double nearest = planner::base::kInfinity;
    for (std::size_t i = 1; i < path.size(); ++i) {
      nearest = std::min(nearest,
                         world.sweep(path[i - 1].position, path[i - 1].t, path[i].position, path[i].t).min_clearance);
    }
    EXPECT_NEAR(true_clearance(scenario, path), nearest, 1.1e-4) << seed;
    if (nearest < 0) ++contacts;
  }
  EXPECT_GT(contacts, 30);
  EXPECT_LT(contacts, 270);
}

TEST(TopSpeed, IsOfTheFastestPiece) {
  const std::vector<TimedPoint> path = {{0, {0, 0, 0}}, {2, {3, 0, 4}}, {3, {3, 1, 4}}, {4, {3, 1, 4}}};
  EXPECT_DOUBLE_EQ(top_speed(path), 2.5);
  EXPECT_DOUBLE_EQ(top_climb(path), 2.0);
  EXPECT_EQ(top_speed(std::vector<TimedPoint>{{0, {0, 0, 0}}, {0, {1, 0, 0}}}), planner::base::kInfinity);
}

// Against the definition, with rows of one word, of a whole number of words and of a part of one.
TEST(Cells, GrowByAllTheirNeighbours) {
  for (const int nx : {1, 5, 63, 64, 65, 128, 150}) {
    constexpr int kNy = 4;
    constexpr int kNz = 3;
    planner::base::RandomStream random(61, static_cast<std::uint64_t>(nx));
    Cells cells(nx, kNy, kNz);
    std::vector<Eigen::Array3i> added;
    for (int i = 0; i < 1 + nx / 10; ++i) {
      const auto below = [&](int n) { return static_cast<int>(random.below(static_cast<std::uint64_t>(n))); };
      added.emplace_back(Eigen::Array3i{below(nx), below(kNy), below(kNz)});
      cells.add(added.back().x(), added.back().y(), added.back().z());
    }
    cells.grow();
    for (int z = 0; z < kNz; ++z) {
      for (int y = 0; y < kNy; ++y) {
        for (int x = 0; x < nx; ++x) {
          const Eigen::Array3i cell(x, y, z);
          const bool expected = std::any_of(added.begin(), added.end(),
                                            [&](const auto& other) { return ((other - cell).abs() <= 1).all(); });
          ASSERT_EQ(cells.test(x, y, z), expected) << nx << ": " << x << ' ' << y << ' ' << z;
        }
      }
    }
  }
}

}  // namespace
}  // namespace jink::tools::lab::oracle
