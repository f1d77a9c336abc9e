// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/initial_paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kPathClearance = 0.4;
const std::vector<double> kTimes{1, 2, 3, 4, 5, 6};

PathRequest straight_on(const std::vector<base::Track>& tracks) {
  PathRequest r;
  r.position = {0, 0, 5};
  r.velocity = {3, 0, 0};
  r.target = {30, 0, 5};
  r.tracks = tracks;
  r.margin = kPathClearance - base::HorizonSettings{}.seed_clearance;
  return r;
}

/// Straight on at 3 m/s.
base::TimedPath cruise() {
  base::TimedPath path;
  for (int i = 0; i <= 60; ++i) path.push_back({0.1 * i, {0.3 * i, 0, 5}, {3, 0, 0}, Vec3::Zero()});
  return path;
}

base::Track mover(const Vec3& at, double when, const Vec3& velocity) {
  base::Track track;
  track.id = 1;
  track.position = at - when * velocity;
  track.velocity = velocity;
  track.radius = 0.5;
  return track;
}

bool contains(const std::vector<base::TimedPath>& paths, double t, const Vec3& position, double tolerance = 1e-9) {
  return std::any_of(paths.begin(), paths.end(), [&](const base::TimedPath& path) {
    return (base::sample(path, t).position - position).norm() < tolerance;
  });
}

/// How many ways lead through openings: they come before the five for each encounter.
std::size_t ways_through(const std::vector<base::TimedPath>& paths, const std::vector<base::TimedPath>& without,
                         std::size_t encounters) {
  const std::size_t others = without.size() + 5 * encounters;
  EXPECT_GT(paths.size(), others);
  EXPECT_LE(paths.size(), others + 9);
  return paths.size() - others;
}

TEST(Manoeuvres, HavePointsAtTheTimesAskedFor) {
  const std::vector<base::Track> tracks{mover({9, 0, 5}, 3.0, {0, 2, 0})};
  for (const base::TimedPath& path : initial_paths(straight_on(tracks), cruise(), base::HorizonSettings{})) {
    ASSERT_EQ(path.size(), kTimes.size());
    for (std::size_t k = 0; k < path.size(); ++k) EXPECT_EQ(path[k].t, kTimes[k]);
  }
}

TEST(Manoeuvres, WaitSlowDownHurryAndStop) {
  const auto paths = initial_paths(straight_on({}), cruise(), base::HorizonSettings{});
  EXPECT_TRUE(contains(paths, 6.0, {12, 0, 5}));        // two seconds late
  EXPECT_TRUE(contains(paths, 6.0, {0.8 * 18, 0, 5}));  // at 80 %
  EXPECT_TRUE(contains(paths, 3.0, {1.3 * 9, 0, 5}));
  EXPECT_TRUE(contains(paths, 6.0, {0, 0, 5}));
}

TEST(Manoeuvres, GoAsideInFourDirectionsAndReturn) {
  const auto paths = initial_paths(straight_on({}), cruise(), base::HorizonSettings{});
  for (const Vec3& side : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    EXPECT_TRUE(contains(paths, 2.0, Vec3(6, 0, 5) + 1.5 * side));
  }
  for (const base::TimedPath& path : paths) EXPECT_NEAR(path.back().position.y(), 0.0, 1e-9);
}

// One that crosses from the right at 3 m/s, met dead on: the relative motion is diagonal, and so is the way past. At
// the meeting the vehicle is either behind its wake or before its nose by 1.2/sqrt(2) in both coordinates, or over or
// under.
TEST(Manoeuvres, LeadPastACrossingObstacleInRelativeMotion) {
  const std::vector<base::Track> tracks{mover({9, 0, 5}, 3.0, {0, 3, 0})};
  const double wanted = 0.5 + base::VehicleLimits{}.radius + kPathClearance;
  const auto paths = initial_paths(straight_on(tracks), cruise(), base::HorizonSettings{});
  const double s = wanted / std::sqrt(2.0);
  EXPECT_TRUE(contains(paths, 3.0, {9 - s, -s, 5}));
  EXPECT_TRUE(contains(paths, 3.0, {9 + s, s, 5}));
  EXPECT_TRUE(contains(paths, 3.0, {9, 0, 5 + wanted}));
  EXPECT_TRUE(contains(paths, 3.0, {9, 0, 5 - wanted}));
  EXPECT_TRUE(contains(paths, 6.0, {18 - s, 0, 5}, 0.2));  // what it fell behind stays, what it went aside does not
}

// Whatever is met: displaced as the manoeuvre says, the straight relative motion clears the obstacle.
TEST(Manoeuvres, ClearTheObstacleTheyAreMeantFor) {
  base::RandomStream random(4);
  int met = 0;
  for (int round = 0; round < 500; ++round) {
    const double when = random.uniform(1.0, 5.0);
    const Vec3 velocity{random.uniform(-3, 2), random.uniform(-3, 3), random.uniform(-1, 1)};
    const Vec3 miss{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
    const std::vector<base::Track> tracks{mover(Vec3(3 * when, 0, 5) + miss, when, velocity)};
    const Vec3 closing = Vec3(3, 0, 0) - velocity;
    const auto paths = initial_paths(straight_on(tracks), cruise(), base::HorizonSettings{});
    const auto without = initial_paths(straight_on({}), cruise(), base::HorizonSettings{});
    if (paths.size() == without.size()) continue;
    ++met;
    const std::size_t through = ways_through(paths, without, 1);
    const double t = std::round(when);  // a time at which the displacement is held in full
    if (std::abs(t - when) > 0.4) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 apart = base::sample(paths[through + i], t).position - (tracks[0].position + t * velocity);
      const double distance = (apart - apart.dot(closing) / closing.squaredNorm() * closing).norm();
      EXPECT_NEAR(distance, 0.5 + base::VehicleLimits{}.radius + kPathClearance, 0.02);
    }
  }
  EXPECT_GT(met, 400);
}

// One that hangs in the way at x = 9: the last point is short of it by what is wanted, and it is come to gently.
TEST(Manoeuvres, StopShortOfAnObstacle) {
  const std::vector<base::Track> tracks{mover({9, 0, 5}, 0.0, {0, 0, 0})};
  const double wanted = 0.5 + base::VehicleLimits{}.radius + kPathClearance;
  const auto paths = initial_paths(straight_on(tracks), cruise(), base::HorizonSettings{});
  const auto without = initial_paths(straight_on({}), cruise(), base::HorizonSettings{});
  const base::TimedPath& stop = paths[ways_through(paths, without, 1) + 4];
  EXPECT_NEAR(stop.back().position.x(), 9.0 - wanted, 0.05);
  for (std::size_t k = 1; k < stop.size(); ++k) {
    EXPECT_GE(stop[k].position.x(), stop[k - 1].position.x());
    EXPECT_LE(stop[k].position.x(), 9.0 - wanted + 1e-9);
  }
  EXPECT_NEAR(stop[1].position.x(), 6.0, 0.3);  // at cruise speed as long as that can be
}

TEST(Manoeuvres, LookAtTheFirstThreeEncounters) {
  std::vector<base::Track> tracks;
  for (const double when : {5.0, 2.0, 4.0, 1.0, 3.0}) tracks.push_back(mover({3 * when, 0, 5}, when, {0, 0, 0}));
  const auto all = initial_paths(straight_on(tracks), cruise(), base::HorizonSettings{});
  const auto none = initial_paths(straight_on({}), cruise(), base::HorizonSettings{});
  const base::TimedPath& third = all[ways_through(all, none, 3) + 10];
  EXPECT_GT(std::abs(third.at(2).position.y()) + std::abs(third.at(2).position.z() - 5.0), 0.5);  // the one at 3 s
}

}  // namespace
}  // namespace jink::planner::horizon
