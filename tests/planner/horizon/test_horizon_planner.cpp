// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/horizon_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/horizon/path_check.hpp"

namespace jink::planner::horizon {
namespace {

base::Track sphere(std::uint64_t id, const Vec3& position, const Vec3& velocity, double radius = 0.5) {
  base::Track track;
  track.id = id;
  track.position = position;
  track.velocity = velocity;
  track.radius = radius;
  return track;
}

PathRequest request(const std::vector<base::Track>& tracks) {
  PathRequest r;
  r.position = {0, 0, 2};
  r.velocity = {2, 0, 0};
  r.target = {20, 0, 2};
  r.volume = {{-5, -10, 0.3}, {25, 10, 8}};
  r.tracks = tracks;
  r.margin = base::HorizonSettings{}.margin;
  return r;
}

/// That look `time` ahead in every case.
const base::HorizonSettings kLongSighted = base::HorizonSettings{}.for_known_motion();

/// Spheres of radius 1 side by side across the straight line at x = 8, with a way round at the sides alone.
std::vector<base::Track> wall() {
  std::vector<base::Track> tracks;
  std::uint64_t id = 1;
  for (const double z : {0.5, 2.0, 3.5, 5.0, 6.5}) {
    for (double y = -3.0; y <= 3.0; y += 1.5) tracks.push_back(sphere(id++, {8, y, z}, {0, 0, 0}, 1.0));
  }
  return tracks;
}

verify::Plan plan_once(const PathRequest& r, int threads = 2, const base::TimedPath& previous = {},
                       std::uint64_t seed = 1, const base::HorizonSettings& settings = kLongSighted) {
  base::WorkerPool pool(threads);
  HorizonPlanner planner(settings);
  return planner.plan(r, previous, seed, 0, {settings.generations, base::Budget::Time::max()}, pool);
}

verify::Verification check(const PathRequest& r, const base::TimedPath& path, double until = base::kInfinity) {
  return verify::verify({path, r.tracks, 0.0, r.vehicle.radius, r.volume, r.acceleration_trust, until});
}

void expect_same_path(const base::TimedPath& a, const base::TimedPath& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].t, b[i].t);
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].velocity, b[i].velocity);
    EXPECT_EQ(a[i].acceleration, b[i].acceleration);
  }
}

struct Case {
  const char* name;
  std::vector<base::Track> tracks;
};

std::vector<Case> blocked_lines() {
  return {{"head-on", {sphere(1, {16, 0, 2}, {-2, 0, 0}, 0.8)}},
          {"crossing", {sphere(1, {7.5, -5, 2}, {0, 2, 0}, 0.8)}},
          {"wall", wall()}};
}

TEST(HorizonPlanner, PlansAroundWhatBlocksTheStraightLine) {
  for (const Case& c : blocked_lines()) {
    const PathRequest r = request(c.tracks);
    const base::TimedPath straight{{0, r.position, r.velocity, Vec3::Zero()},
                                   {20.0 / 3.0, r.target, r.velocity, Vec3::Zero()}};
    ASSERT_FALSE(check(r, straight).free()) << c.name;  // the case is one
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const verify::Plan plan = plan_once(r, 2, {}, seed);
      ASSERT_TRUE(plan.status == verify::PlanStatus::kReaches || plan.status == verify::PlanStatus::kProgresses)
          << c.name;
      EXPECT_TRUE(check(r, plan.path, 6.0).free()) << c.name;
      EXPECT_EQ(plan.status == verify::PlanStatus::kReaches, check(r, plan.path).free()) << c.name;
      EXPECT_EQ(plan.path.front().position, r.position);
      EXPECT_EQ(plan.path.front().t, 0.0);
      EXPECT_EQ(plan.path.back().position, r.target) << c.name;
      EXPECT_FALSE(plan.kept_previous);
      const verify::Plan shorter = plan_once(r, 2, {}, seed, base::HorizonSettings{});
      EXPECT_TRUE(check(r, shorter.path, shorter.horizon).free()) << c.name;
    }
  }
}

// A gap of 1 m between two spheres, which the vehicle, 0.6 m wide, passes where they stand and less is to be kept; not
// where a third that moves is as near.
TEST(HorizonPlanner, KeepsLessFromWhatStandsThanFromWhatMoves) {
  const std::vector<base::Track> posts{sphere(1, {5, 2.5, 2}, {0, 0, 0}, 2.0), sphere(2, {5, -2.5, 2}, {0, 0, 0}, 2.0)};
  PathRequest r = request({});
  r.volume = {{-10, -2, 1}, {30, 2, 3}};
  r.standing = posts;
  r.margin = 0.35;
  r.standing_margin = 0.15;
  const base::TimedPath straight{{0, r.position, r.velocity, Vec3::Zero()},
                                 {20.0 / 3.0, r.target, r.velocity, Vec3::Zero()}};
  const verify::Verification seen = verify_until(straight, r, base::kInfinity);
  EXPECT_NEAR(seen.min_clearance, 0.2, 1e-9);
  EXPECT_TRUE(keeps_margins(straight, r, base::kInfinity, seen));
  const verify::Plan plan = plan_once(r);
  EXPECT_NE(plan.status, verify::PlanStatus::kBlocked);
  EXPECT_FALSE(plan.emergency);
  EXPECT_NEAR(plan.verification.min_clearance, 0.2, 0.05);
  EXPECT_GT(plan.path.back().position.x(), 15.0);
  const std::vector<base::Track> beside{sphere(3, {9, 1.0, 2}, {-0.1, 0, 0}, 0.5)};
  r.tracks = beside;
  const verify::Verification among = verify_until(straight, r, base::kInfinity);
  EXPECT_TRUE(among.free());
  EXPECT_FALSE(keeps_margins(straight, r, base::kInfinity, among));
  r.tracks = {};
  r.standing_margin = 0.25;
  EXPECT_FALSE(keeps_margins(straight, r, base::kInfinity, seen));
}

TEST(HorizonPlanner, FliesStraightWhereNothingIsInTheWay) {
  const std::vector<base::Track> none;
  const PathRequest r = request(none);
  const verify::Plan plan = plan_once(r);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  EXPECT_LT(base::path_length(plan.path), 20.0 * 1.01);
  EXPECT_FALSE(plan.emergency);
}

// Along the upper bound of a low volume: straight on it stays there nearly to the end.
TEST(HorizonPlanner, LeavesTheVolumesBoundsWhereARequestAsksForClearance) {
  PathRequest r = request({});
  r.position = {0, 0, 2.4};
  r.target = {20, 0, 1.5};
  r.volume = {{-5, -10, 0.6}, {25, 10, 2.4}};
  EXPECT_GT(base::sample(plan_once(r).path, 2.0).position.z(), 2.1);
  r.volume_clearance = 0.4;
  const verify::Plan plan = plan_once(r);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  EXPECT_LT(base::sample(plan.path, 2.0).position.z(), 2.04);  // 0.36 m off
  r.target.z() = 2.4;                                          // where it is sent to it may be
  EXPECT_NEAR(base::sample(plan_once(r).path, 2.0).position.z(), 2.4, 1e-9);
}

// Behind something slow whose place is known to 0.3 m: with a band of a share of the length alone, which is narrow near
// the target, the mean was 0.48 m.
TEST(HorizonPlanner, GivesRoomToWhatItFollowsNearTheTarget) {
  struct Following {
    Vec3 ahead;
    double speed, left;
  };
  double sum = 0.0;
  int plans = 0;
  for (const Following& f :
       {Following{{1.8, 0.0, 2.0}, 0.5, 10.0}, {{2.5, 0.6, 2.0}, 1.0, 10.0}, {{1.8, 0.6, 2.0}, 0.5, 5.0}}) {
    std::vector<base::Track> tracks{sphere(1, f.ahead, {f.speed, 0.0, 0.0})};
    tracks[0].position_sigma = 0.3;
    PathRequest r = request(tracks);
    r.velocity = {f.speed, 0, 0};
    r.target = {f.left, 0, 2};
    for (std::uint64_t seed = 1; seed <= 6; ++seed, ++plans)
      sum += plan_once(r, 2, {}, seed).verification.min_clearance;
  }
  EXPECT_GT(sum / plans, 0.59);
}

TEST(HorizonPlanner, SearchesForAllItsGenerations) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0, 2}, Vec3::Zero(), 0.5)};
  const PathRequest r = request(tracks);
  const verify::Plan plan = plan_once(r);
  const base::HorizonSettings defaults;
  EXPECT_EQ(plan.evaluations, defaults.generations * defaults.population);
  EXPECT_EQ(plan.generations, defaults.generations);
}

TEST(HorizonPlanner, SameBitsForAnyNumberOfThreads) {
  for (const Case& c : blocked_lines()) {
    const PathRequest r = request(c.tracks);
    const verify::Plan one = plan_once(r, 1);
    for (const int threads : {2, 8}) {
      const verify::Plan plan = plan_once(r, threads);
      expect_same_path(plan.path, one.path);
      EXPECT_EQ(plan.front, one.front);
      EXPECT_EQ(plan.status, one.status);
    }
  }
}

TEST(HorizonPlanner, DoesNotDependOnEarlierPlans) {
  const std::vector<Case> cases = blocked_lines();
  base::WorkerPool pool(1);
  HorizonPlanner planner{kLongSighted};
  const base::Budget budget{base::HorizonSettings{}.generations, base::Budget::Time::max()};
  const PathRequest wall_request = request(cases[2].tracks);
  const PathRequest crossing_request = request(cases[1].tracks);
  planner.plan(wall_request, {}, 5, 17, budget, pool);
  expect_same_path(planner.plan(crossing_request, {}, 1, 0, budget, pool).path, plan_once(crossing_request).path);
}

// Past a sphere on either side: as good as it gets, the side that was begun with is kept.
TEST(HorizonPlanner, HoldsOnToTheWayItHasBegun) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0, 2}, Vec3::Zero())};
  const PathRequest r = request(tracks);
  const verify::Plan first = plan_once(r);
  base::TimedPath mirrored = first.path;
  for (base::TimedPoint& point : mirrored) {
    for (Vec3* v : {&point.position, &point.velocity, &point.acceleration}) v->y() = -v->y();
  }
  for (const base::TimedPath& previous : {first.path, mirrored}) {
    const Vec3 aside = base::sample(previous, 4.0).position - Vec3(10, 0, 2);
    for (std::uint64_t seed = 2; seed < 6; ++seed) {
      const verify::Plan plan = plan_once(r, 2, previous, seed);
      const Vec3 now = base::sample(plan.path, 4.0).position - Vec3(10, 0, 2);
      EXPECT_GT(aside.y() * now.y() + aside.z() * now.z(), 0.0) << seed;
    }
  }
}

// Along the way that was begun a plan is flown that is shorter and no less clear, by however little.
TEST(HorizonPlanner, GetsBetterAlongTheWayItHasBegun) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0.4, 2}, Vec3::Zero())};
  const PathRequest r = request(tracks);
  base::HorizonSettings hasty = kLongSighted;
  hasty.generations = 2;
  PathProblem problem{base::HorizonSettings{}};
  problem.prepare(r);
  verify::Plan plan = plan_once(r, 2, {}, 1, hasty);
  ASSERT_TRUE(plan.verification.free());
  const double first = problem.cost_of(plan.path).f[0];
  int kept = 0;
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    const base::TimedPath previous = plan.path;
    const optimizer::Cost before = problem.cost_of(previous);
    plan = plan_once(r, 2, previous, seed);
    const optimizer::Cost now = problem.cost_of(plan.path);
    if (plan.kept_previous) {
      ++kept;
      expect_same_path(plan.path, previous);
    } else {
      EXPECT_LT(now.f[0], before.f[0]);
      EXPECT_LE(now.f[2], before.f[2]);
    }
  }
  EXPECT_GT(kept, 0);  // where nothing is better
  EXPECT_LT(problem.cost_of(plan.path).f[0], first);
  EXPECT_GT(problem.cost_of(plan.path).f[0] * (1.0 + base::HorizonSettings{}.keep_ratio), first);
}

TEST(HorizonPlanner, DropsAPreviousPlanThatIsNoLongerFree) {
  const std::vector<base::Track> none;
  const verify::Plan first = plan_once(request(none));
  const std::vector<base::Track> tracks = blocked_lines()[1].tracks;
  const PathRequest r = request(tracks);
  ASSERT_FALSE(check(r, first.path).free());
  const verify::Plan second = plan_once(r, 2, first.path);
  EXPECT_FALSE(second.kept_previous);
  EXPECT_TRUE(check(r, second.path, 6.0).free());
}

TEST(HorizonPlanner, DropsAPreviousPlanThatIsClearlyWorse) {
  const std::vector<base::Track> none;
  const PathRequest r = request(none);
  base::TimedPath detour;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    const double share = std::min(t, 10.0 - t) / 5.0;
    detour.push_back({t, {2.0 * t, 8.0 * share * share * (3.0 - 2.0 * share), 2}, Vec3::Zero(), Vec3::Zero()});
  }
  ASSERT_TRUE(continues(detour, r, base::HorizonSettings{}.step));
  const verify::Plan plan = plan_once(r, 2, detour);
  EXPECT_FALSE(plan.kept_previous);
  EXPECT_LT(base::path_length(plan.path), 20.2);
}

// What begins elsewhere, at another velocity or later is not what is flown now: kept, it would be a jump.
TEST(HorizonPlanner, RefusesAPreviousPlanThatDoesNotBeginInTheRequestsState) {
  const std::vector<base::Track> tracks = blocked_lines()[1].tracks;
  const PathRequest r = request(tracks);
  const verify::Plan first = plan_once(r);
  const verify::Plan afresh = plan_once(r, 2, {}, 2);
  ASSERT_NE(base::sample(plan_once(r, 2, first.path, 2).path, 3.0).position, base::sample(afresh.path, 3.0).position);
  const auto expect_refused = [&](const base::TimedPath& previous, const char* what) {
    SCOPED_TRACE(what);
    const verify::Plan plan = plan_once(r, 2, previous, 2);
    EXPECT_FALSE(plan.kept_previous);
    expect_same_path(plan.path, afresh.path);  // nor does it seed the search
  };
  base::TimedPath beside = first.path;
  for (base::TimedPoint& point : beside) point.position.y() += 1e-3;
  expect_refused(beside, "1 mm beside");
  base::TimedPath late = first.path;
  for (base::TimedPoint& point : late) point.t += 0.05;
  expect_refused(late, "begins later");
  base::TimedPath fast = first.path;
  for (base::TimedPoint& point : fast) point.t /= 3.0;
  expect_refused(fast, "three times as fast");
  base::TimedPath sideways = first.path;
  sideways[1].position.y() += 0.3;
  expect_refused(sideways, "to the side at 3 m/s");
  base::TimedPath not_a_path = first.path;
  not_a_path.back().t = std::numeric_limits<double>::quiet_NaN();
  expect_refused(not_a_path, "a time that is none");
}

// A plan is cut where the vehicle is now, which may be a moment before one of its points or at its very end.
TEST(HorizonPlanner, KeepsAPreviousPlanWhereverItIsCut) {
  const std::vector<base::Track> tracks = blocked_lines()[1].tracks;
  const PathRequest begun = request(tracks);
  const verify::Plan first = plan_once(begun);
  const double end = first.path.back().t;
  for (const double t : {1e-12, 0.05, 0.1 - 1e-13, 0.1, 0.73, 2.0, 3.999, end - 0.1, end - 0.05, end - 1e-9}) {
    std::vector<base::Track> now = tracks;
    for (base::Track& track : now) track = geometry::predict(track, t);
    PathRequest r = request(now);
    const base::TimedPoint state = base::sample(first.path, t);
    r.position = state.position;
    r.velocity = state.velocity;
    EXPECT_TRUE(continues(base::later(first.path, t), r, base::HorizonSettings{}.step)) << t;
  }
}

// Past the wall at less than its uncertainty asks for, but more than the margin; the search, which cannot go so
// far aside, waits in front of it with all the clearance that anybody asks for.
TEST(HorizonPlanner, KeepsAWayPastWhereTheSearchFoundOnlyToWait) {
  std::vector<base::Track> tracks = wall();
  std::erase_if(tracks, [](const base::Track& track) { return track.position.y() > 0.0; });
  PathRequest r = request(tracks);
  r.track_acceleration = base::HorizonSettings{}.track_acceleration;
  const double aside = 1.0 + r.vehicle.radius + r.margin + 0.02;
  base::TimedPath past;
  for (int i = 0; i < 110; ++i) {  // at 2 m/s, braking at 1 m/s² for the last 2 m
    const double t = 0.1 * i;
    const double braking = std::max(0.0, t - 9.0);
    const double x = 2.0 * t - 0.5 * braking * braking;
    const double share = std::clamp(std::min(x, 16.0 - x) / 6.0, 0.0, 1.0);
    past.push_back({t, {x, aside * share * share * (3.0 - 2.0 * share), 2}, Vec3::Zero(), Vec3::Zero()});
  }
  past.push_back({11.0, r.target, Vec3::Zero(), Vec3::Zero()});
  ASSERT_GE(check(r, past).min_clearance, r.margin);
  base::HorizonSettings narrow = kLongSighted;
  narrow.lateral_range = narrow.far_range = 0.5;
  narrow.weight_clearance = 1.0;
  narrow.weight_length = 0.1;
  base::WorkerPool pool(2);
  HorizonPlanner planner(narrow);
  const verify::Plan found = planner.plan(r, {}, 1, 0, {narrow.generations}, pool);
  ASSERT_LT(found.path[60].position.x(), 8.0);
  const verify::Plan plan = planner.plan(r, past, 1, 0, {narrow.generations}, pool);
  EXPECT_TRUE(plan.kept_previous);
}

// What asks for more than the acceleration that plans normally use gets it, and says so: a sphere of 1.5 m at 8 m/s,
// met in 0.85 s.
TEST(HorizonPlanner, UsesMoreAccelerationWhereNothingElseHelps) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0, 2}, {-8, 0, 0}, 1.5)};
  const PathRequest r = request(tracks);
  const verify::Plan plan = plan_once(r);
  EXPECT_TRUE(plan.emergency);
  EXPECT_TRUE(check(r, plan.path, 6.0).free());
  base::HorizonSettings calm = kLongSighted;
  calm.emergency_share = calm.acceleration_share;
  base::WorkerPool pool(2);
  const verify::Plan without = HorizonPlanner(calm).plan(r, {}, 1, 0, {calm.generations}, pool);
  EXPECT_FALSE(without.emergency);
  EXPECT_LT(without.verification.min_clearance, plan.verification.min_clearance);
}

// Faster than the vehicle can get out of the way of: a sphere of 6 m at 14 m/s, 10 m ahead.
TEST(HorizonPlanner, GivesTheLeastBadManoeuvreWhereNothingIsFree) {
  const std::vector<base::Track> tracks{sphere(1, {16, 0, 2}, {-14, 0, 0}, 6.0)};
  PathRequest r = request(tracks);
  const verify::Plan plan = plan_once(r);
  EXPECT_EQ(plan.status, verify::PlanStatus::kBlocked);
  ASSERT_TRUE(plan.verification.first_contact.has_value());
  const base::TimedPath straight{{0, r.position, r.velocity, Vec3::Zero()},
                                 {10, {20, 0, 2}, Vec3::Zero(), Vec3::Zero()}};
  EXPECT_GT(*plan.verification.first_contact, *check(r, straight).first_contact);  // it stays free for longer
}

TEST(HorizonPlanner, DropsAPreviousPlanThatIsHitSoonerWhereNothingIsFree) {
  const std::vector<base::Track> tracks{sphere(1, {16, 0, 2}, {-14, 0, 0}, 6.0)};
  const PathRequest r = request(tracks);
  const base::TimedPath into_it{{0, r.position, r.velocity, Vec3::Zero()}, {5, r.target, Vec3::Zero(), Vec3::Zero()}};
  const verify::Plan plan = plan_once(r, 2, into_it);
  EXPECT_FALSE(plan.kept_previous);
  EXPECT_GT(*plan.verification.first_contact, *check(r, into_it).first_contact);
}

TEST(HorizonPlanner, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<base::Track> tracks{sphere(1, {8, 0, 2}, {0, 0, 0})};
  PathRequest r = request(tracks);
  r.velocity.y() = nan;
  EXPECT_EQ(plan_once(r).status, verify::PlanStatus::kInvalid);
  EXPECT_TRUE(plan_once(r).path.empty());
  r = request(tracks);
  r.target.z() = base::kInfinity;
  EXPECT_EQ(plan_once(r).status, verify::PlanStatus::kInvalid);
  tracks[0].age = nan;
  EXPECT_EQ(plan_once(request(tracks)).status, verify::PlanStatus::kInvalid);
}

TEST(HorizonPlanner, RefusesSettingsThatPmomvoRefuses) {
  base::HorizonSettings s;
  s.population = 1;
  EXPECT_THROW(HorizonPlanner{s}, std::invalid_argument);
}

TEST(HorizonPlanner, ExpiredDeadlineStillGivesAPlan) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0, 2}, Vec3::Zero(), 0.5)};
  const PathRequest r = request(tracks);
  base::WorkerPool pool(1);
  HorizonPlanner planner{kLongSighted};
  const verify::Plan plan = planner.plan(r, {}, 1, 0, {40, base::Budget::Time::min()}, pool);
  EXPECT_TRUE(plan.deadline_reached);
  EXPECT_EQ(plan.schedule, 40);
  EXPECT_EQ(plan.generations, 1);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
}

// With a pace known, a deadline becomes a number of generations, and with that number the plan is repeated.
TEST(HorizonPlanner, PlanUnderADeadlineIsRepeatedByItsSchedule) {
  const std::vector<base::Track> tracks = wall();
  const PathRequest r = request(tracks);
  base::WorkerPool pool(2);
  HorizonPlanner planner{kLongSighted};
  planner.plan(r, {}, 1, 0, {40}, pool);
  const auto soon = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
  const verify::Plan cut = planner.plan(r, {}, 1, 1, {1000000, soon}, pool);
  EXPECT_LT(cut.schedule, 1000000);
  EXPECT_LE(cut.generations, cut.schedule);
  const verify::Plan again = HorizonPlanner{base::HorizonSettings{}}.repeat(r, {}, 1, 1, cut.searches, pool);
  expect_same_path(again.path, cut.path);
  EXPECT_EQ(again.searches, cut.searches);
}

// The search with more acceleration goes its own way under a deadline. Here that has passed already: the first search,
// which knows no pace, is stopped after one of its 40 generations, the second is scheduled for one.
TEST(HorizonPlanner, RepeatsTheSearchWithMoreAccelerationAsFarAsItWent) {
  const std::vector<base::Track> tracks{sphere(1, {16, 0, 2}, {-14, 0, 0}, 6.0)};
  const PathRequest r = request(tracks);
  base::WorkerPool pool(2);
  const verify::Plan cut =
      HorizonPlanner{base::HorizonSettings{}}.plan(r, {}, 1, 0, {40, std::chrono::steady_clock::now()}, pool);
  ASSERT_EQ(cut.searches[0], (verify::SearchExtent{40, 1}));
  ASSERT_EQ(cut.searches[1], (verify::SearchExtent{1, 1}));
  HorizonPlanner other{base::HorizonSettings{}};
  const verify::Plan again = other.repeat(r, {}, 1, 0, cut.searches, pool);
  expect_same_path(again.path, cut.path);
  EXPECT_EQ(again.status, cut.status);
  EXPECT_EQ(again.searches, cut.searches);
}

// Twice as many meetings take twice the time: half the generations then. What is repeated goes as far as it went.
TEST(HorizonPlanner, SearchesLessWhereThereIsMoreToMeet) {
  std::vector<base::Track> tracks = wall();
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto n = static_cast<double>(i);
    tracks.push_back(sphere(1000 + i, {-4 + 0.04 * n, i % 2 == 0 ? 3.0 : -3.0, 2}, {0.01, 0, 0}, 0.1));
  }
  const PathRequest r = request(tracks);
  PathProblem problem{base::HorizonSettings{}};
  problem.prepare(r);
  ASSERT_GT(problem.meetings(), 10000U);
  base::WorkerPool pool(2);
  HorizonPlanner planner{kLongSighted};
  const verify::Plan plan = planner.plan(r, {}, 1, 0, {400}, pool);
  EXPECT_EQ(plan.schedule, 400 * 500 / static_cast<int>(1 + problem.meetings()));
  EXPECT_EQ(plan.generations, plan.schedule);
  expect_same_path(planner.repeat(r, {}, 1, 0, plan.searches, pool).path, plan.path);
  const verify::Plan longer = planner.repeat(r, {}, 1, 0, {{{40, 40}, {40, 40}}}, pool);
  EXPECT_EQ(longer.generations, 40);
}

// Unobstructed flight is the shortest: where it keeps every clearance there is nothing to search for.
TEST(HorizonPlanner, SearchesNothingWhereUnobstructedFlightIsTheAnswer) {
  const std::vector<base::Track> far{sphere(1, {8, 9, 2}, Vec3::Zero(), 0.5)};
  const PathRequest r = request(far);
  base::WorkerPool pool(1);
  HorizonPlanner planner{kLongSighted};
  const verify::Plan plan = planner.plan(r, {}, 1, 0, {40}, pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  EXPECT_EQ(plan.evaluations, 0);
  EXPECT_EQ(plan.searches, (std::array<verify::SearchExtent, 2>{}));
  EXPECT_NEAR(base::path_length(plan.path), (r.target - r.position).norm(), 1e-6);
  expect_same_path(planner.repeat(r, {}, 1, 0, plan.searches, pool).path, plan.path);
}

TEST(HorizonPlanner, KeepsWithoutASearchWhatNoSearchCouldReplace) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0.9, 2}, Vec3::Zero(), 0.4)};
  const PathRequest r = request(tracks);
  base::WorkerPool pool(1);
  HorizonPlanner planner{kLongSighted};
  const verify::Plan first = planner.plan(r, {}, 1, 0, {40}, pool);
  ASSERT_GT(first.evaluations, 0);
  ASSERT_EQ(first.status, verify::PlanStatus::kReaches);
  const verify::Plan second = planner.plan(r, first.path, 1, 1, {40}, pool);
  EXPECT_TRUE(second.kept_previous);
  EXPECT_EQ(second.evaluations, 0);
  expect_same_path(second.path, first.path);
}

/// What a path that begins in the request's state asks for, of the vehicle's limits.
verify::LimitsUse use(const PathRequest& r, const base::TimedPath& path) {
  const base::VehicleLimits& v = r.vehicle;
  return verify::use_of_limits(path, {r.velocity, v.max_speed, v.max_climb, v.max_acceleration,
                                      base::HorizonSettings{}.step, path.back().position == r.target});
}

struct Vehicle {
  double max_speed, cruise_speed, max_climb, max_acceleration;
};
constexpr std::array<Vehicle, 9> kVehicles{{{0.1, 0.1, 0.1, 0.5},
                                            {0.3, 0.2, 0.1, 1.0},
                                            {0.5, 0.5, 0.15, 0.5},
                                            {1.0, 0.7, 0.3, 30.0},
                                            {3.0, 3.0, 0.15, 1.0},
                                            {5.0, 3.0, 2.0, 6.0},
                                            {5.0, 5.0, 5.0, 20.0},
                                            {12.0, 8.0, 1.5, 2.0},
                                            {20.0, 15.0, 5.0, 30.0}}};

/// As far as the vehicle comes in some ten seconds, with a sphere on the way.
PathRequest request_for(const Vehicle& vehicle, std::uint64_t seed, std::vector<base::Track>& tracks) {
  base::RandomStream random(seed);
  PathRequest r;
  r.vehicle.max_speed = vehicle.max_speed;
  r.vehicle.cruise_speed = vehicle.cruise_speed;
  r.vehicle.max_climb = vehicle.max_climb;
  r.vehicle.max_acceleration = vehicle.max_acceleration;
  r.margin = base::HorizonSettings{}.margin;
  r.position = {0, 0, 5};
  const double far = random.uniform(1.0, 12.0) * vehicle.cruise_speed;
  const double angle = random.uniform(0.0, 6.28);
  r.target = {far * std::cos(angle), far * std::sin(angle), 5.0 + random.uniform(-6.0, 6.0) * vehicle.max_climb};
  r.volume = {{-300, -300, -30}, {300, 300, 40}};
  const double blocked = random.uniform(0.3, 0.8);
  const Vec3 way = r.target - r.position;
  tracks = {sphere(1, r.position + blocked * way + Vec3(0, 0, 0.3), Vec3::Zero(), 0.1 + 0.05 * far)};
  if (random.below(2) == 0) tracks[0].velocity = -0.1 * way;
  r.tracks = tracks;
  return r;
}

// Whatever becomes of a plan in flight, within a step too: what is called reached is within the limits.
TEST(HorizonPlanner, WhatReachesKeepsTheLimitsOfAnyVehicle) {
  base::WorkerPool pool(2);
  HorizonPlanner planner{base::HorizonSettings{}};
  int reached = 0;
  int kept = 0;
  int emergencies = 0;
  for (std::uint64_t seed = 0; seed < 12 * kVehicles.size(); ++seed) {
    std::vector<base::Track> tracks;
    PathRequest r = request_for(kVehicles[seed % kVehicles.size()], seed, tracks);
    base::TimedPath previous;
    for (std::uint64_t number = 0; number < 6; ++number) {
      const verify::Plan plan = planner.plan(r, previous, seed, number, {12}, pool);
      ASSERT_NE(plan.status, verify::PlanStatus::kInvalid);
      const verify::LimitsUse asked = use(r, plan.path);
      EXPECT_TRUE(asked.within()) << seed << "." << number << ": " << asked.speed << ", " << asked.climb << ", "
                                  << asked.acceleration << (plan.kept_previous ? ", kept" : "");
      EXPECT_EQ(plan.verification.limits.acceleration, asked.acceleration);
      reached += plan.status == verify::PlanStatus::kReaches ? 1 : 0;
      kept += plan.kept_previous ? 1 : 0;
      emergencies += plan.emergency ? 1 : 0;
      const double later = number % 2 == 0 ? 0.237 : 0.5;
      const base::TimedPoint next = base::sample(plan.path, later);
      r.position = next.position;
      r.velocity = next.velocity;
      for (base::Track& track : tracks) track.position += later * track.velocity;
      previous = base::later(plan.path, later);
    }
  }
  EXPECT_GT(reached, 200);
  EXPECT_GT(kept, 100);
  EXPECT_GT(emergencies, 5);
}

// Flying at 2 m/s, and the plan until now says 8 m/s of a vehicle of 5: it is not kept, and not said to reach.
TEST(HorizonPlanner, DropsAPreviousPlanThatBreaksTheLimits) {
  const std::vector<base::Track> tracks{sphere(1, {10, 0.9, 2}, Vec3::Zero(), 0.4)};
  const PathRequest r = request(tracks);
  const base::TimedPath hasty{{0, r.position, r.velocity, Vec3::Zero()},
                              {0.8, {8, -1, 2}, Vec3::Zero(), Vec3::Zero()},
                              {2.5, r.target, Vec3::Zero(), Vec3::Zero()}};
  ASSERT_TRUE(check(r, hasty).free());
  const verify::Plan plan = plan_once(r, 2, hasty);
  EXPECT_FALSE(plan.kept_previous);
  EXPECT_TRUE(plan.verification.limits.within());
}

verify::Plan open_loop(const PathRequest& r, int threads = 2, double time_limit = 60.0, double commit = 0.5) {
  base::WorkerPool pool(threads);
  return plan_open_loop({}, {}, {r, time_limit, commit}, 1, {40, base::Budget::Time::max()}, pool);
}

PathRequest from_rest(const std::vector<base::Track>& tracks) {
  PathRequest r = request(tracks);
  r.velocity = Vec3::Zero();
  return r;
}

void expect_flyable(const verify::Plan& plan, const PathRequest& r) {
  ASSERT_FALSE(plan.path.empty());
  EXPECT_EQ(plan.path.front().t, 0.0);
  EXPECT_EQ(plan.path.front().position, r.position);
  for (std::size_t i = 0; i < plan.path.size(); ++i) {
    EXPECT_TRUE(r.volume.contains(plan.path[i].position, 1e-9));
    if (i == 0) continue;
    const double dt = plan.path[i].t - plan.path[i - 1].t;
    ASSERT_GT(dt, 1e-6);
    EXPECT_LE((plan.path[i].position - plan.path[i - 1].position).norm(), r.vehicle.max_speed * dt + 1e-9);
  }
  EXPECT_TRUE(use(r, plan.path).within());
}

TEST(PlanOpenLoop, ReachesTheTargetFreeContinuousAndInsideTheVolume) {
  std::vector<Case> cases = blocked_lines();
  cases.push_back({"accelerating", {sphere(1, {10, -12, 2}, {0, 0, 0}, 0.8)}});
  cases.back().tracks[0].acceleration = {0, 1.5, 0};
  for (const Case& c : cases) {
    const PathRequest r = from_rest(c.tracks);
    const verify::Plan plan = open_loop(r);
    EXPECT_EQ(plan.status, verify::PlanStatus::kReaches) << c.name << ": " << verify::to_string(plan.status);
    EXPECT_TRUE(check(r, plan.path).free()) << c.name;
    EXPECT_EQ(plan.path.back().position, r.target) << c.name;
    expect_flyable(plan, r);
  }
}

TEST(PlanOpenLoop, CommitNeedNotBeAWholeNumberOfSteps) {
  const std::vector<base::Track> tracks = blocked_lines()[0].tracks;
  const PathRequest r = from_rest(tracks);
  const verify::Plan plan = open_loop(r, 2, 60.0, 0.33);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  expect_flyable(plan, r);
}

TEST(PlanOpenLoop, KeepsTheLimitsOfAnyVehicle) {
  int reached = 0;
  for (std::uint64_t seed = 0; seed < kVehicles.size(); ++seed) {
    std::vector<base::Track> tracks;
    const PathRequest r = request_for(kVehicles[seed % kVehicles.size()], 1000 + seed, tracks);
    if (verify::start_blocked(r.position, r.vehicle.radius, tracks)) continue;
    const verify::Plan plan = open_loop(r, 2, 60.0, seed % 2 == 0 ? 0.5 : 0.33);
    reached += plan.status == verify::PlanStatus::kReaches ? 1 : 0;
    const verify::LimitsUse asked = use(r, plan.path);
    EXPECT_TRUE(asked.within()) << seed << ": " << asked.speed << ", " << asked.climb << ", " << asked.acceleration;
    for (std::size_t i = 1; i + 1 < plan.path.size(); ++i) {  // whole steps, and no short ones at the joints
      EXPECT_NEAR(plan.path[i].t - plan.path[i - 1].t, plan.path[1].t, 1e-9) << seed;
    }
  }
  EXPECT_GE(reached, 5);
}

TEST(PlanOpenLoop, SameBitsForAnyNumberOfThreads) {
  const std::vector<base::Track> tracks = blocked_lines()[1].tracks;
  const PathRequest r = from_rest(tracks);
  const verify::Plan one = open_loop(r, 1);
  for (const int threads : {2, 8}) expect_same_path(open_loop(r, threads).path, one.path);
}

TEST(PlanOpenLoop, SaysThatTheStartIsBlocked) {
  const std::vector<base::Track> tracks{sphere(1, {0.5, 0, 2}, {0, 0, 0})};
  const verify::Plan plan = open_loop(from_rest(tracks));
  EXPECT_EQ(plan.status, verify::PlanStatus::kStartBlocked);
  EXPECT_EQ(plan.path.size(), 1U);
}

// The target is inside a resting sphere: the vehicle comes near and waits clear of it.
TEST(PlanOpenLoop, DoesNotReachABlockedTarget) {
  const std::vector<base::Track> tracks{sphere(1, {20, 0, 2}, {0, 0, 0}, 1.0)};
  const PathRequest r = from_rest(tracks);
  const verify::Plan plan = open_loop(r, 2, 15.0);
  EXPECT_NE(plan.status, verify::PlanStatus::kReaches);
  EXPECT_TRUE(plan.verification.free());
  EXPECT_LT((plan.path.back().position - r.target).norm(), 15.0);  // of 20; how near depends on the tuning
  EXPECT_LE(plan.path.back().t, 15.0 + 0.5 + 1e-9);
}

// No time for more than one plan: what that one has verified is the result, not the half second that is committed to.
TEST(PlanOpenLoop, ExpiredDeadlineStillGivesAFreePath) {
  const std::vector<base::Track> tracks = blocked_lines()[1].tracks;
  PathRequest r = from_rest(tracks);
  r.target = {60, 0, 2};  // farther than a plan looks
  r.volume.max.x() = 65;
  base::WorkerPool pool(1);
  const verify::Plan plan = plan_open_loop({}, {}, {r, 60.0, 0.5}, 1, {40, base::Budget::Time::min()}, pool);
  EXPECT_TRUE(plan.deadline_reached);
  EXPECT_TRUE(check(r, plan.path).free());
  EXPECT_GE(plan.path.back().t, 6.0 - 1e-9);
  expect_flyable(plan, r);
}

TEST(PlanOpenLoop, RefusesNumbersThatAreNotFinite) {
  std::vector<base::Track> tracks{sphere(1, {8, 0, 2}, {0, 0, 0})};
  tracks[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  const verify::Plan plan = open_loop(from_rest(tracks));
  EXPECT_EQ(plan.status, verify::PlanStatus::kInvalid);
  EXPECT_TRUE(plan.path.empty());
}

}  // namespace

// A sphere sweeps the target two seconds after the vehicle could be there: to have arrived is not to be safe.
TEST(HorizonPlanner, WhoHasArrivedIsStillWatchedUntilTheHorizonEnds) {
  HorizonPlanner planner{base::HorizonSettings{}};
  base::WorkerPool pool(2);
  PathRequest request;
  request.position = {0, 0, 5};
  request.target = {0.5, 0, 5};
  base::Track sweeper;
  sweeper.id = 1;
  sweeper.position = {0.25, -12, 5};
  sweeper.velocity = {0, 4, 0};
  sweeper.radius = 0.6;
  const std::vector<base::Track> tracks{sweeper};
  request.tracks = tracks;
  request.margin = 0.35;
  const verify::Plan plan = planner.plan(request, {}, 1, 0, {40}, pool);
  ASSERT_TRUE(plan.verification.free());
  double least = base::kInfinity;
  for (double t = 0.0; t <= 6.0; t += 0.01) {
    const Vec3 obstacle = sweeper.position + t * sweeper.velocity;
    least = std::min(least, (base::sample(plan.path, t).position - obstacle).norm() - 0.6 - request.vehicle.radius);
  }
  EXPECT_GT(least, 0.0);
}

}  // namespace jink::planner::horizon
