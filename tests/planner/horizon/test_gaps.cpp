// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/initial_paths.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kClearance = 0.5;
const Vec3 kStart(0, 0, 3);
const Vec3 kMiddle(9, 0, 3);  // of the wall

struct Hole {
  double y = 0.0, z = 0.0;  // at time 0
  double radius = 1.0;      // free of the spheres' surfaces
};

/// Spheres of radius 0.5 side by side at x = 9, moving along y, but where there is a hole.
std::vector<base::Track> wall(const std::vector<Hole>& holes, double speed = 0.0) {
  std::vector<base::Track> tracks;
  for (double y = -15.0; y <= 15.0; y += 0.7) {
    for (double z = 0.0; z <= 6.0; z += 0.7) {
      bool free = false;
      for (const Hole& hole : holes) free = free || std::hypot(y - hole.y, z - hole.z) < hole.radius + 0.5;
      if (free) continue;
      base::Track track;
      track.id = tracks.size() + 1;
      track.position = {9, y, z};
      track.velocity = {0, speed, 0};
      track.radius = 0.5;
      tracks.push_back(track);
    }
  }
  return tracks;
}

PathRequest before_the_wall(const std::vector<base::Track>& tracks) {
  PathRequest r;
  r.position = kStart;
  r.velocity = {3, 0, 0};
  r.target = {20, 0, 3};
  r.volume = {{-1, -5, 0.3}, {21, 5, 6}};
  r.tracks = tracks;
  r.margin = kClearance - base::HorizonSettings{}.seed_clearance;
  return r;
}

std::vector<Gap> look(const std::vector<base::Track>& tracks, double t, std::size_t most) {
  const PathRequest r = before_the_wall(tracks);
  return find_gaps(r, geometry::PathFrame(r.position, r.target), kMiddle, t, base::HorizonSettings{}, most);
}

TEST(Openings, AreWhereTheHoleIs) {
  const auto found = look(wall({{2.6, 1.7}}), 0.0, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].lacking, 0.0);
  EXPECT_NEAR(found[0].position.x(), 9.0, 1e-9);
  EXPECT_LT(std::hypot(found[0].position.y() - 2.6, found[0].position.z() - 1.7), 0.4);
  EXPECT_LT(found[0].velocity.norm(), 1e-9);
}

TEST(Openings, MoveWithTheHole) {
  const auto found = look(wall({{-3.0, 3.2}}, 1.2), 2.0, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].lacking, 0.0);
  EXPECT_LT(std::hypot(found[0].position.y() + 0.6, found[0].position.z() - 3.2), 0.3);
  // A place that stays clear need not move for as long as the hole is wider than what passes.
  EXPECT_GE(found[0].velocity.y(), 0.0);
  EXPECT_LE(found[0].velocity.y(), 2.0);
}

// Nothing keeps the clearance in a hole that is too small for it: the middle of it lacks least.
TEST(Openings, AreTheLeastBadPlaceOfASmallHole) {
  const auto found = look(wall({{1.3, 3.9, 0.7}}), 0.0, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].lacking, 0.0);
  EXPECT_LT(found[0].lacking, base::VehicleLimits{}.radius + kClearance - 0.6);
  EXPECT_LT(std::hypot(found[0].position.y() - 1.3, found[0].position.z() - 3.9), 0.3);
}

TEST(Openings, AreTheNearestFirstAndApart) {
  const std::vector<base::Track> tracks = wall({{-1.5, 2.0}, {3.2, 3.5}});
  EXPECT_LT(look(tracks, 0.0, 1).at(0).position.y(), 0.0);
  const auto found = look(tracks, 0.0, 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_GT(found[1].position.y(), 0.0);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(before_the_wall(tracks).volume.contains(found[i].position));
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((found[i].position - found[j].position).norm(), 2.0 * base::HorizonSettings{}.gap_spacing);
    }
  }
}

// 300 spheres and one way through: what a pilot tries first has one that only just needs mending.
TEST(Openings, AreFlownThroughByAManoeuvre) {
  const std::vector<base::Track> tracks = wall({{2.6, 1.7}});
  const PathRequest r = before_the_wall(tracks);
  base::TimedPath unobstructed;
  for (int i = 0; i <= 60; ++i) unobstructed.push_back({0.1 * i, {0.3 * i, 0, 3}, {3, 0, 0}, Vec3::Zero()});
  int through = 0;
  for (const base::TimedPath& path : initial_paths(r, unobstructed, base::HorizonSettings{})) {
    if (path.back().position.x() < 9.5) continue;
    bool free = true;
    for (double t = 1.0; t <= 6.0; t += 0.05) {
      const Vec3 p = base::sample(path, t).position;
      for (const base::Track& track : tracks)
        free = free && (p - track.position).norm() > track.radius + r.vehicle.radius;
    }
    through += free ? 1 : 0;
  }
  EXPECT_GT(through, 0);
}

// A target right behind the wall is where the ways through lead, not beyond it and out of the volume.
TEST(Openings, AreFlownThroughAsFarAsTheTarget) {
  const std::vector<base::Track> tracks = wall({{2.6, 1.7}});
  PathRequest r = before_the_wall(tracks);
  r.target = {11, 0, 3};
  r.volume.max.x() = 11.5;
  PathProblem problem{base::HorizonSettings{}};
  problem.prepare(r);
  const base::TimedPath unobstructed = problem.motion(std::vector<double>(18, 0.0));
  int through = 0;
  for (const base::TimedPath& path : initial_paths(r, unobstructed, base::HorizonSettings{})) {
    const bool aside = std::any_of(path.begin(), path.end(), [](const base::TimedPoint& point) {
      return std::abs(point.position.x() - 9.0) < 1.0 && (point.position - Vec3(9, 2.6, 1.7)).norm() < 1.0;
    });
    if (!aside) continue;
    ++through;
    for (const base::TimedPoint& point : path) EXPECT_LE(point.position.x(), 11.0 + 1e-6);
  }
  EXPECT_GE(through, 3);
}

TEST(Openings, AreWhereTheWayLeadsOn) {
  const auto on = [](const std::vector<base::Track>& tracks) {
    const PathRequest r = before_the_wall(tracks);
    base::TimedPath unobstructed;
    for (int i = 0; i <= 60; ++i) unobstructed.push_back({0.1 * i, {0.3 * i, 0, 3}, {3, 0, 0}, Vec3::Zero()});
    return gap_ahead(r, unobstructed, base::HorizonSettings{});
  };
  const std::optional<Vec3> place = on(wall({{2.6, 1.7}}));
  ASSERT_TRUE(place);
  EXPECT_LT((*place - Vec3(9, 2.6, 1.7)).norm(), 0.5);
  EXPECT_FALSE(on(wall({{1.3, 3.9, 0.7}})));  // too small to pass
  EXPECT_FALSE(on({}));
}

// With little weight of lost time, to wait for a wall to go away is for ever cheaper than the way to a hole far aside,
// until waiting has not helped.
TEST(Openings, AreTakenByAVehicleThatIsStuck) {
  const std::vector<base::Track> tracks = wall({{2.6, 4.5}});
  PathRequest r = before_the_wall(tracks);
  r.position = {5, -2.8, 1.5};
  r.velocity = Vec3::Zero();
  r.target = {11, -2.8, 1.5};
  r.margin = base::HorizonSettings{}.margin;
  base::HorizonSettings settings = base::HorizonSettings{}.for_known_motion();
  settings.far_range = settings.lateral_range;
  settings.far_time = settings.time;
  settings.time_weight = 0.5;
  HorizonPlanner planner{settings};
  base::WorkerPool pool(2);
  const auto reaches = [&] {
    const verify::Plan plan = planner.plan(r, {}, 1, 0, {base::HorizonSettings{}.generations}, pool);
    EXPECT_TRUE(plan.verification.free());
    return base::sample(plan.path, base::HorizonSettings{}.horizon()).position.x();
  };
  EXPECT_LT(reaches(), 8.0);
  r.stuck = true;
  EXPECT_GT(reaches(), 10.0);
}

// Nobody gets there: to come nearer to who may set off helps nothing, and room costs nothing.
TEST(HorizonPlanner, WhoWaitsForATakenTargetIsNotStuckAndMakesRoom) {
  base::Track occupant;
  occupant.radius = 0.5;
  occupant.position = {11, -2.8, 1.5};
  occupant.position_sigma = 0.1;
  std::vector<base::Track> tracks{occupant};
  PathRequest r = before_the_wall(tracks);
  r.position = {9.4, -2.8, 1.5};
  r.velocity = Vec3::Zero();
  r.target = occupant.position;
  r.margin = base::HorizonSettings{}.margin;
  r.sudden_change = 1.5;
  HorizonPlanner planner{base::HorizonSettings{}};
  base::WorkerPool pool(2);
  const auto make_plan = [&] { return planner.plan(r, {}, 1, 0, {base::HorizonSettings{}.generations}, pool); };
  const auto room = [&] {
    const verify::Plan plan = make_plan();
    EXPECT_TRUE(plan.verification.free());
    const Vec3 end = base::sample(plan.path, plan.horizon).position;
    return (end - occupant.position).norm() - occupant.radius - r.vehicle.radius;
  };
  const double waiting = room();
  r.stuck = true;
  const double stuck = room();
  EXPECT_GT(stuck, waiting + 0.5);
  r.sudden_change = 0.0;
  EXPECT_LT(room(), stuck - 0.5) << "no more than is asked for";
  // Where all keep what is asked for, the choice is the usual one.
  tracks[0].position_sigma = 0.0;
  r.position = {8, -2.8, 1.5};
  const base::TimedPath same = make_plan().path;
  r.stuck = false;
  const base::TimedPath usual = make_plan().path;
  ASSERT_EQ(same.size(), usual.size());
  for (std::size_t i = 0; i < same.size(); ++i) EXPECT_EQ(same[i].position, usual[i].position) << i;
}

TEST(Taken, ThroughoutAtTimesOrNever) {
  const base::HorizonSettings settings;
  base::Track occupant;
  occupant.radius = 0.5;
  occupant.position = {11, -2.8, 1.5};
  std::vector<base::Track> tracks{occupant};
  const PathRequest r = before_the_wall(tracks);
  const Vec3 beside = occupant.position + Vec3(0.51 + r.vehicle.radius, 0, 0);
  EXPECT_EQ(taken(r, occupant.position, 0.0, settings), Taken::kThroughout);
  EXPECT_EQ(taken(r, beside, 0.0, settings), Taken::kNever);
  EXPECT_EQ(taken(r, beside, 0.1, settings), Taken::kThroughout);
  tracks.front().velocity = {0, 0.2, 0};  // it leaves after 5 s
  EXPECT_EQ(taken(r, occupant.position, 0.0, settings), Taken::kAtTimes);
  tracks.front().position.y() -= 2.1;  // it comes after 6.5 s
  EXPECT_EQ(taken(r, occupant.position, 0.0, settings), Taken::kNever);
}

}  // namespace
}  // namespace jink::planner::horizon
