// SPDX-License-Identifier: BSD-3-Clause
// Obstacles on known paths, as every part of the planner sees them.
#include "planner/geometry/known_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/geometry/validity.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/initial_paths.hpp"
#include "planner/horizon/nearby_obstacles.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/verify/verifier.hpp"
#include "tests/support/allocation_guard.hpp"

namespace jink::planner::geometry {
namespace {

const Vec3 kZero = Vec3::Zero();

Vec3 random_vector(base::RandomStream& random, double range) {
  const double x = random.uniform(-range, range);
  const double y = random.uniform(-range, range);
  return {x, y, random.uniform(-range, range)};
}

/// Points at random places and times from about -1 s on; the first and last are now and then far apart in time.
KnownPath random_path(base::RandomStream& random, std::uint64_t id, double range = 5.0) {
  KnownPath path;
  path.id = id;
  path.offset = random.uniform(-3.0, 3.0);
  double t = path.offset + random.uniform(-1.0, 2.0);
  const std::size_t points = 1 + random.below(12);
  Vec3 position = random_vector(random, range);
  for (std::size_t i = 0; i < points; ++i) {
    path.points.push_back({t, position, kZero, kZero});
    t += random.uniform(0.01, 1.2);
    if (random.below(4) > 0) position += random_vector(random, 2.0);
  }
  path.radius = random.uniform(0.2, 1.5);
  path.margin = random.uniform(0.0, 0.3);
  return path;
}

/// Straight at constant velocity for 100 s, in pieces of which the times do not match anybody's steps.
KnownPath straight(const base::Track& track) {
  KnownPath path;
  path.id = track.id;
  path.offset = 7.0;
  for (int i = 0; i <= 137; ++i) {
    const double t = -1.0 + 0.73 * i;
    path.points.push_back({7.0 + t, track.position + t * track.velocity, kZero, kZero});
  }
  path.radius = track.radius;
  path.position_sigma = track.position_sigma;
  path.velocity_sigma = track.velocity_sigma;
  path.age = track.age;
  return path;
}

base::Track random_track(base::RandomStream& random, std::uint64_t id) {
  base::Track track;
  track.id = id;
  track.position = Vec3(10, 0, 3) + random_vector(random, 6.0);
  track.velocity = random_vector(random, 2.0);
  track.radius = random.uniform(0.2, 1.0);
  track.position_sigma = random.uniform(0.0, 0.1);
  track.velocity_sigma = random.uniform(0.0, 0.1);
  track.age = random.uniform(0.0, 0.3);
  return track;
}

/// The same obstacles both ways.
struct Twins {
  std::vector<base::Track> tracks;
  std::vector<KnownPath> known;
};
Twins twins(base::RandomStream& random, std::uint64_t count) {
  Twins twins;
  for (std::uint64_t id = 0; id < count; ++id) {
    twins.tracks.push_back(random_track(random, id));
    twins.known.push_back(straight(twins.tracks.back()));
  }
  return twins;
}

horizon::PathRequest request() {
  horizon::PathRequest r;
  r.position = {0, 0, 2};
  r.velocity = {2, 0, 0};
  r.target = {20, 0, 2};
  r.volume = {{-5, -10, 0.3}, {25, 10, 8}};
  r.margin = base::HorizonSettings{}.margin;
  return r;
}

TEST(KnownPath, StandsBeforeItsFirstPointAndAfterItsLast) {
  KnownPath path;
  path.points = {{10.0, {1, 0, 0}, kZero, kZero}, {12.0, {1, 4, 0}, kZero, kZero}};
  path.offset = 9.0;
  EXPECT_EQ(path.position(0.0), Vec3(1, 0, 0));
  EXPECT_EQ(path.position(2.0), Vec3(1, 2, 0));
  EXPECT_EQ(path.position(50.0), Vec3(1, 4, 0));
  EXPECT_DOUBLE_EQ(path.fastest(), 2.0);
  EXPECT_TRUE(is_valid(path));
}

TEST(KnownPath, IsNotWellFormedWithoutFiniteNumbersInOrderOfTime) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  KnownPath good;
  good.points = {{0.0, {1, 0, 0}, kZero, kZero}, {1.0, {1, 4, 0}, kZero, kZero}};
  ASSERT_TRUE(is_valid(good));
  std::vector<KnownPath> bad(7, good);
  bad[0].points.clear();
  bad[1].points[1].t = 0.0;
  bad[2].points[0].t = nan;
  bad[3].points[0].position.y() = nan;
  bad[4].radius = nan;
  bad[5].until = nan;
  bad[6].points[0].position.x() = 1e308;  // so fast that its speed is infinite
  bad[6].points[0].t = 1.0 - 1e-9;
  const base::TimedPath path{{0.0, {50, 0, 0}, kZero, kZero}, {1.0, {51, 0, 0}, kZero, kZero}};
  for (const KnownPath& known : bad) {
    EXPECT_FALSE(is_valid(known));
    EXPECT_FALSE(verify::verify({path, {}, 0.0, 0.3, {}, base::kInfinity, base::kInfinity, {&known, 1}}).free());
    horizon::PathRequest r = request();
    r.paths = {&known, 1};
    base::WorkerPool pool(1);
    horizon::HorizonPlanner planner{base::HorizonSettings{}};
    EXPECT_EQ(planner.plan(r, {}, 1, 0, {5, base::Budget::Time::max()}, pool).status, verify::PlanStatus::kInvalid);
  }
}

TEST(VerifierOfKnownPaths, MatchesDenseSampling) {
  constexpr double kStep = 1e-3;
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    base::RandomStream random(seed);
    const double told = random.uniform(-1.0, 1.0);
    base::TimedPath path;
    double t = told + random.uniform(0.0, 1.0);
    for (int i = 0; i < 6; ++i) {
      path.push_back({t, random_vector(random, 5.0), kZero, kZero});
      t += random.uniform(0.2, 1.5);
    }
    std::vector<KnownPath> known;
    for (std::uint64_t id = 0; id < 4; ++id) {
      known.push_back(random_path(random, id));
      if (random.below(3) == 0) known.back().until = random.uniform(0.0, 6.0);
    }
    const verify::Verification v = verify::verify({path, {}, told, 0.3, {}, base::kInfinity, base::kInfinity, known});
    double lowest = base::kInfinity;
    double contact = base::kInfinity;
    double fastest = 0.0;
    for (const KnownPath& k : known) fastest = std::max(fastest, k.fastest());
    for (std::size_t i = 1; i < path.size(); ++i) {
      fastest = std::max(fastest, (path[i].position - path[i - 1].position).norm() / (path[i].t - path[i - 1].t));
    }
    for (double s = path.front().t; s <= path.back().t; s += kStep) {
      for (const KnownPath& k : known) {
        if (s - told >= k.until) continue;
        const double clearance = (base::sample(path, s).position - k.position(s - told)).norm() - k.radius - 0.3;
        lowest = std::min(lowest, clearance);
        if (clearance < 0.0) contact = std::min(contact, s);
      }
    }
    ASSERT_LE(v.min_clearance, lowest + 1e-9) << seed;
    ASSERT_GE(v.min_clearance, lowest - 2.0 * fastest * kStep) << seed;
    const KnownPath& nearest = known[v.nearest_id];
    const Vec3 gap = base::sample(path, v.t_min_clearance).position - nearest.position(v.t_min_clearance - told);
    ASSERT_NEAR(gap.norm() - nearest.radius - 0.3, v.min_clearance, 1e-9) << seed;
    if (contact < base::kInfinity) {
      ++contacts;
      ASSERT_TRUE(v.first_contact.has_value()) << seed;
      ASSERT_LE(*v.first_contact, contact + 1e-9) << seed;
    }
  }
  EXPECT_GT(contacts, 20);
  EXPECT_LT(contacts, 148);
}

TEST(VerifierOfKnownPaths, SeesAStraightOneAsTheEquivalentTrack) {
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    base::RandomStream random(seed);
    const auto [tracks, known] = twins(random, 5);
    base::TimedPath path{{0.0, {0, 0, 2}, kZero, kZero}};
    for (int i = 1; i < 40; ++i) {
      path.push_back({0.2 * i, path.back().position + Vec3(0.5, 0, 0) + random_vector(random, 0.2), kZero, kZero});
    }
    const verify::Verification a = verify::verify({path, tracks, 0.0, 0.3, {}});
    const verify::Verification b = verify::verify({path, {}, 0.0, 0.3, {}, base::kInfinity, base::kInfinity, known});
    ASSERT_NEAR(a.min_clearance, b.min_clearance, 1e-9) << seed;
    ASSERT_EQ(a.nearest_id, b.nearest_id) << seed;
    ASSERT_EQ(a.first_contact.has_value(), b.first_contact.has_value()) << seed;
    if (!a.first_contact) continue;
    ++contacts;
    ASSERT_NEAR(*a.first_contact, *b.first_contact, 1e-8) << seed;
  }
  EXPECT_GT(contacts, 10);
}

TEST(VerifierOfKnownPaths, ChecksAPathOfOnePoint) {
  KnownPath known;
  known.points = {{0.0, {5, 0, 0}, kZero, kZero}, {4.0, {1, 0, 0}, kZero, kZero}};
  known.radius = 1.0;
  const base::TimedPath path{{2.0, kZero, kZero, kZero}};  // 3 m away then
  EXPECT_NEAR(verify::verify({path, {}, 0.0, 0.5, {}, base::kInfinity, base::kInfinity, {&known, 1}}).min_clearance,
              1.5, 1e-12);
  known.until = 1.9;
  EXPECT_EQ(verify::verify({path, {}, 0.0, 0.5, {}, base::kInfinity, base::kInfinity, {&known, 1}}).min_clearance,
            base::kInfinity);
}

/// Boxes as a plan's: growing about a start.
std::vector<base::Box> growing(const Vec3& start, int steps, double step, double speed) {
  std::vector<base::Box> where;
  for (int n = 0; n < steps; ++n) {
    const double reach = speed * step * (n + 1);
    where.push_back({(start.array() - reach).matrix(), (start.array() + reach).matrix()});
  }
  return where;
}

// For every obstacle and instant: a place in the step's box from which the true obstacle is nearer than its hard (or
// soft) distance is also nearer than that to the even motion that stands for it.
TEST(MetObstaclesOnKnownPaths, NeverMissesAny) {
  constexpr int kSteps = 60;
  constexpr double kStep = 0.1;
  const horizon::Clearance clearance{0.65, 2.0, 0.4, 0.0, 0.8, base::kInfinity};
  int met = 0;
  int spared = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    base::RandomStream random(seed);
    const Vec3 start = random_vector(random, 3.0);
    const std::vector<base::Box> where = growing(start, kSteps, kStep, random.uniform(0.2, 4.0));
    KnownPath path = random_path(random, 1, 20.0);
    path.position_sigma = random.uniform(0.0, 0.2);
    path.velocity_sigma = random.uniform(0.0, 0.1);
    horizon::NearbyObstacles obstacles;
    obstacles.build({}, {&path, 1}, {}, clearance, kStep, 5.0, where);
    for (int n = 0; n < kSteps; ++n) {
      const auto during = obstacles.during(n);
      ASSERT_LE(during.size(), 1U);
      const base::Box& box = where[static_cast<std::size_t>(n)];
      for (int i = 0; i <= 20; ++i) {
        const double share = i / 20.0;
        const Vec3 truth = path.position((n + share) * kStep);
        // The place in the box that is nearest to the obstacle.
        const double distance = (truth - truth.cwiseMax(box.min).cwiseMin(box.max)).norm();
        if (during.empty()) {
          ++spared;
          ASSERT_GE(distance, path.radius + path.margin + clearance.hard) << seed << " step " << n;
          continue;
        }
        ++met;
        const horizon::NearbyObstacle& o = during[0];
        const double strays = (truth - (o.from + share * (o.to - o.from))).norm();
        ASSERT_LE(path.radius + path.margin + clearance.hard + strays, o.hard + 1e-9) << seed << " step " << n;
        ASSERT_GE(o.soft, o.hard);
      }
    }
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(spared, 1000);
}

TEST(MetObstaclesOnKnownPaths, SeesAStraightOneAsTheEquivalentTrack) {
  const horizon::Clearance clearance{0.65, 2.0, 0.0, 0.0, 0.8, base::kInfinity};
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    base::RandomStream random(seed);
    const base::Track track = random_track(random, 1);
    const KnownPath path = straight(track);
    const std::vector<base::Box> where = growing({4, 0, 2}, 60, 0.1, 3.0);
    horizon::NearbyObstacles of_track;
    horizon::NearbyObstacles of_path;
    of_track.build({&track, 1}, {}, {}, clearance, 0.1, 3.0, where);
    of_path.build({}, {&path, 1}, {}, clearance, 0.1, 3.0, where);
    for (int n = 0; n < 60; ++n) {
      ASSERT_EQ(of_track.during(n).size(), of_path.during(n).size()) << seed << " step " << n;
      if (of_track.during(n).empty()) continue;
      const horizon::NearbyObstacle& a = of_track.during(n)[0];
      const horizon::NearbyObstacle& b = of_path.during(n)[0];
      EXPECT_NEAR((a.from - b.from).norm(), 0.0, 1e-9);
      EXPECT_NEAR((a.to - b.to).norm(), 0.0, 1e-9);
      EXPECT_NEAR(a.hard, b.hard, 1e-9);
      EXPECT_NEAR(a.soft, b.soft, 1e-9);
    }
  }
}

TEST(MetObstaclesOnKnownPaths, RegardsItUpToItsTimeAndGrowsItAfterItsEnd) {
  KnownPath path;
  path.points = {{0.0, {2, 0, 0}, kZero, kZero}, {1.0, {3, 0, 0}, kZero, kZero}};
  path.radius = 0.5;
  path.until = 3.05;
  const horizon::Clearance clearance{0.65, 2.0, 0.4, 0.0, 0.8, base::kInfinity};
  horizon::NearbyObstacles obstacles;
  obstacles.build({}, {&path, 1}, {}, clearance, 0.1, 3.0, growing(kZero, 60, 0.1, 3.0));
  EXPECT_EQ(obstacles.obstacles(), 1U);
  EXPECT_EQ(obstacles.during(30).size(), 1U);
  EXPECT_TRUE(obstacles.during(31).empty());
  EXPECT_DOUBLE_EQ(obstacles.during(9)[0].soft, obstacles.during(9)[0].hard);  // ends at 1 s
  EXPECT_NEAR(obstacles.during(19)[0].soft - obstacles.during(19)[0].hard, 0.2, 1e-9);
  EXPECT_NEAR(obstacles.during(29)[0].soft - obstacles.during(29)[0].hard, 0.8, 1e-9);
}

TEST(PathProblemOfKnownPaths, CostsAStraightOneAsTheEquivalentTrack) {
  int costly = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    base::RandomStream random(seed);
    const auto [tracks, known] = twins(random, 6);
    horizon::PathRequest r = request();
    horizon::PathProblem of_tracks{base::HorizonSettings{}};
    horizon::PathProblem of_paths{base::HorizonSettings{}};
    r.tracks = tracks;
    of_tracks.prepare(r);
    r.tracks = {};
    r.paths = known;
    of_paths.prepare(r);
    EXPECT_EQ(of_tracks.obstacles(), of_paths.obstacles());
    for (int i = 0; i < 20; ++i) {
      std::vector<double> x(static_cast<std::size_t>(of_tracks.dimension()));
      for (double& value : x) value = random.uniform(-0.5, 0.5);
      optimizer::Cost a;
      optimizer::Cost b;
      of_tracks.evaluate(x, {&a, 1});
      of_paths.evaluate(x, {&b, 1});
      EXPECT_EQ(a.f[0], b.f[0]);
      EXPECT_NEAR(a.f[2], b.f[2], 1e-6);
      EXPECT_NEAR(a.violation, b.violation, 1e-6);
      EXPECT_NEAR(of_paths.cost_of(of_paths.motion(x)).violation, b.violation, 1e-6);
      costly += b.violation > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(costly, 50);
}

TEST(PathProblemOfKnownPaths, PreparesWithoutTheHeap) {
  base::RandomStream random(1);
  const auto known = twins(random, 6).known;
  horizon::PathRequest r = request();
  r.paths = known;
  horizon::PathProblem problem{base::HorizonSettings{}};
  problem.prepare(r);
  const test::AllocationGuard guard;
  problem.prepare(r);
  EXPECT_EQ(guard.count(), 0U);
}

TEST(ManoeuvresOfKnownPaths, LeadPastAnEncounterAsPastTheEquivalentTrack) {
  base::Track track;
  track.position = {16, 0, 2};
  track.velocity = {-2, 0.1, 0};
  track.radius = 0.5;
  horizon::PathRequest r = request();
  horizon::PathProblem problem{base::HorizonSettings{}};
  problem.prepare(r);
  const base::TimedPath unobstructed = problem.motion(std::vector<double>(18, 0.0));
  r.margin = 0.2;
  r.tracks = {&track, 1};
  const auto expected = horizon::initial_paths(r, unobstructed, base::HorizonSettings{});
  const KnownPath path = straight(track);
  r.tracks = {};
  r.paths = {&path, 1};
  const auto found = horizon::initial_paths(r, unobstructed, base::HorizonSettings{});
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < found[i].size(); ++k) {
      EXPECT_NEAR((found[i][k].position - expected[i][k].position).norm(), 0.0, 1e-6);
    }
  }
  r.paths = {};
  EXPECT_LT(horizon::initial_paths(r, unobstructed, base::HorizonSettings{}).size(), found.size());
}

/// One that comes head-on, then turns across the line and back: no track could say so.
KnownPath weaving() {
  KnownPath path;
  path.id = 9;
  path.points = {{0, {14, 0, 2}, kZero, kZero},
                 {3, {10, 0, 2}, kZero, kZero},
                 {4.5, {7, 3, 2}, kZero, kZero},
                 {6, {5, -3, 2}, kZero, kZero}};
  path.radius = 0.5;
  return path;
}

/// By dense sampling.
void expect_apart(const base::TimedPath& plan, const KnownPath& path, double until) {
  for (double t = 0.0; t < until; t += 0.01) {
    ASSERT_GT((base::sample(plan, t).position - path.position(t)).norm(), 0.8) << t;
  }
}

TEST(HorizonPlannerAmongKnownPaths, KeepsClearOfOneThatTurns) {
  const KnownPath path = weaving();
  horizon::PathRequest r = request();
  base::WorkerPool pool(2);
  horizon::HorizonPlanner planner{base::HorizonSettings{}.for_known_motion()};
  const base::Budget budget{base::HorizonSettings{}.generations, base::Budget::Time::max()};
  const verify::Plan straight_on = planner.plan(r, {}, 1, 0, budget, pool);
  ASSERT_FALSE(
      verify::verify(
          {straight_on.path, {}, 0.0, r.vehicle.radius, r.volume, base::kInfinity, base::kInfinity, {&path, 1}})
          .free());
  r.paths = {&path, 1};
  const verify::Plan plan = planner.plan(r, {}, 1, 0, budget, pool);
  EXPECT_NE(plan.status, verify::PlanStatus::kBlocked);
  EXPECT_GE(plan.verification.min_clearance, r.margin - 0.05);
  EXPECT_EQ(plan.verification.nearest_id, 9U);
  expect_apart(plan.path, path, 6.0);
  // The plan that was good without it is not kept.
  const verify::Plan next = planner.plan(r, straight_on.path, 1, 1, budget, pool);
  EXPECT_FALSE(next.kept_previous);
  EXPECT_TRUE(next.verification.free());
}

TEST(OpenLoopAmongKnownPaths, ArrivesClearOfThem) {
  const KnownPath path = weaving();
  horizon::OpenLoopRequest r;
  r.path = request();
  r.path.velocity.setZero();
  r.path.paths = {&path, 1};
  r.time_limit = 40.0;
  base::WorkerPool pool(2);
  const verify::Plan plan = horizon::plan_open_loop({}, {}, r, 1, {60, base::Budget::Time::max()}, pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  expect_apart(plan.path, path, plan.path.back().t);
  KnownPath here = path;
  here.points = {{0.0, r.path.position, kZero, kZero}};
  r.path.paths = {&here, 1};
  EXPECT_EQ(horizon::plan_open_loop({}, {}, r, 1, {5, base::Budget::Time::max()}, pool).status,
            verify::PlanStatus::kStartBlocked);
}

}  // namespace
}  // namespace jink::planner::geometry
