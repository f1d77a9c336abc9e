// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/safe_intervals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/boxes.hpp"

namespace jink::planner::horizon {
namespace {

using support::box;

constexpr double kCell = 0.5;
constexpr double kEased = 0.7;  // of the cruise speed

/// A corridor of 3 m along x with a recess of 2.4 m about x = 4 on its left, and something in it that fills it.
std::vector<base::Track> corridor(double piston_x, double piston_speed) {
  std::vector<base::Track> tracks{box({10, -1.65, 1.65}, {28, 0.3, 4}),    box({-0.6, 1.65, 1.65}, {6.8, 0.3, 4}),
                                  box({14.6, 1.65, 1.65}, {18.8, 0.3, 4}), box({4, 4.15, 1.65}, {3, 0.3, 4}),
                                  box({2.65, 2.9, 1.65}, {0.3, 2.6, 4}),   box({5.35, 2.9, 1.65}, {0.3, 2.6, 4}),
                                  box({piston_x, 0, 1.8}, {1, 2.9, 2.9})};
  tracks.back().velocity = {piston_speed, 0, 0};
  return support::numbered(tracks);
}

PathRequest among(const std::vector<base::Track>& tracks) {
  PathRequest request;
  request.position = {0, 0, 1.5};
  request.target = {20, 0, 1.5};
  request.volume = {{-4, -5, 0.3}, {24, 5, 3.3}};
  request.margin = 0.35;
  request.tracks = tracks;
  return request;
}

WayInTime way(const PathRequest& request) {
  SafeIntervalSearch search;
  return search.find(request, {0.0, request.position, request.velocity, Vec3::Zero()}, kCell);
}

/// The least distance of the way's places, at their times, to boxes that do not turn.
double clearance(const WayInTime& way, const std::vector<base::Track>& boxes, const std::vector<Vec3>& edges) {
  double least = base::kInfinity;
  for (double t = 0.0; t <= way.path.back().t; t += 0.05) {
    const Vec3 place = base::sample(way.path, t).position;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 off = (place - boxes[i].position - t * boxes[i].velocity).cwiseAbs() - 0.5 * edges[i];
      least = std::min(least, off.cwiseMax(0.0).norm());
    }
  }
  return least;
}

TEST(SafeIntervals, AFreeWayIsStraightAndTakesNoLongerThanItMust) {
  const PathRequest request = among({});
  const WayInTime found = way(request);
  EXPECT_NEAR(found.arrival, 20.0 / (kEased * request.vehicle.cruise_speed), 1e-9);
  EXPECT_TRUE(found.stays);
  for (const base::TimedPoint& point : found.path) EXPECT_EQ(point.position.y(), 0.0);
}

TEST(SafeIntervals, StepsAsideWaitsAndGoesOn) {
  const std::vector<base::Track> tracks = corridor(12.0, -1.5);
  const WayInTime found = way(among(tracks));
  ASSERT_LT(found.arrival, base::kInfinity);
  EXPECT_NEAR((found.path.back().position - Vec3(20, 0, 1.5)).norm(), 0.0, kCell);
  double waits = 0.0;
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    if (found.path[i].position != found.path[i - 1].position) continue;
    EXPECT_GT(found.path[i].position.y(), 1.0);
    waits = std::max(waits, found.path[i].t - found.path[i - 1].t);
  }
  EXPECT_GT(waits, 2.0);
  const std::vector<Vec3> edges{{28, 0.3, 4},  {6.8, 0.3, 4}, {18.8, 0.3, 4}, {3, 0.3, 4},
                                {0.3, 2.6, 4}, {0.3, 2.6, 4}, {1, 2.9, 2.9}};
  // Between two places of the grid it may be nearer by some of the way between them.
  EXPECT_GT(clearance(found, tracks, edges), 0.3 + 0.35 - 0.5 * kCell);
}

// What comes fills the corridor and stops at its end, for all that is known: no way leads past it.
TEST(SafeIntervals, WhereNoWayLeadsOnItEndsWhereItStaysFree) {
  std::vector<base::Track> tracks = corridor(12.0, -1.0);
  tracks.back().body.solid = base::Solid::box({30, 2.9, 2.9}, {});
  tracks.back().radius = tracks.back().body.solid->reach();
  tracks.back().position.x() = 26.5;
  const WayInTime found = way(among(tracks));
  EXPECT_EQ(found.arrival, base::kInfinity);
  EXPECT_TRUE(found.stays);
  EXPECT_GT(found.path.back().position.y(), 1.0);
}

TEST(SafeIntervals, WhereNothingStaysFreeThereIsNoWay) {
  std::vector<base::Track> tracks = corridor(12.0, -1.0);
  tracks.erase(tracks.begin() + 3, tracks.begin() + 6);
  tracks[1] = box({10, 1.65, 1.65}, {28, 0.3, 4});  // no recess
  tracks.back().body.solid = base::Solid::box({60, 2.9, 2.9}, {});
  tracks.back().radius = tracks.back().body.solid->reach();
  tracks.back().position.x() = 40.0;
  const WayInTime found = way(among(tracks));
  EXPECT_FALSE(found.stays);
  EXPECT_EQ(found.path.size(), 1U);
}

// From later on, obstacles are where they are then, and times are the request's.
TEST(SafeIntervals, BeginsWhenItIsTold) {
  const std::vector<base::Track> tracks = corridor(12.0, -1.0);
  const PathRequest request = among(tracks);
  SafeIntervalSearch search;
  // It is past by then.
  const WayInTime late = search.find(request, {10.0, {8, 0, 1.5}, Vec3::Zero(), Vec3::Zero()}, kCell);
  EXPECT_NEAR(late.arrival, 10.0 + 12.0 / (kEased * request.vehicle.cruise_speed), 1e-9);
  EXPECT_EQ(late.path.front().t, 10.0);
  const WayInTime first = search.find(request, {0.0, request.position, Vec3::Zero(), Vec3::Zero()}, kCell);
  const WayInTime again = way(request);
  ASSERT_EQ(first.path.size(), again.path.size());
  EXPECT_EQ(first.arrival, again.arrival);
}

}  // namespace
}  // namespace jink::planner::horizon
