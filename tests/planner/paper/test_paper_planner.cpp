// SPDX-License-Identifier: BSD-3-Clause
#include "planner/paper/paper_planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "planner/optimizer/indicators.hpp"

namespace jink::planner::paper {
namespace {

base::Track sphere(std::uint64_t id, const Vec3& position, const Vec3& velocity, double radius = 0.5) {
  base::Track track;
  track.id = id;
  track.position = position;
  track.velocity = velocity;
  track.radius = radius;
  return track;
}

/// [Paper] Table 2, scenario 1.
std::vector<base::Track> table2_1() {
  return {sphere(1, {5, 5, 2}, {4, -2, 1}), sphere(2, {3, 3, 2}, {2, -2, -2}), sphere(3, {5, 3, 1}, {4, 2, 2}),
          sphere(4, {2, 1, 1}, {2, 2, 2}), sphere(5, {6, 2, 2}, {-2, 2, -2})};
}

PaperRequest request(const Vec3& start, const Vec3& target, const std::vector<base::Track>& tracks) {
  PaperRequest r;
  r.start = start;
  r.target = target;
  r.tracks = tracks;
  return r;
}

double slr(const verify::Plan& plan, const PaperRequest& r) {
  return optimizer::straight_line_rate(base::path_length(plan.path), (r.target - r.start).norm());
}

void expect_reaches(const verify::Plan& plan, const PaperRequest& r) {
  ASSERT_EQ(plan.status, verify::PlanStatus::kReaches) << verify::to_string(plan.status);
  EXPECT_EQ(plan.path.front().position, r.start);
  EXPECT_EQ(plan.path.back().position, r.target);
  const verify::Verification v = verify::verify({plan.path, r.tracks, 0.0, r.vehicle.radius, r.volume});
  EXPECT_TRUE(v.free());
  EXPECT_EQ(v.min_clearance, plan.verification.min_clearance);
  for (std::size_t i = 1; i < plan.path.size(); ++i) {
    const double dt = plan.path[i].t - plan.path[i - 1].t;
    ASSERT_GT(dt, 0.0);
    EXPECT_LE((plan.path[i].position - plan.path[i - 1].position).norm() / dt, r.vehicle.cruise_speed + 1e-9);
  }
}

TEST(PaperPlanner, ReachesTheTargetOfTable2Scenario1AlmostStraight) {
  base::WorkerPool pool(2);
  const std::vector<base::Track> tracks = table2_1();
  PaperRequest r = request({0, 0, 0}, {9, 8, 0}, tracks);
  for (r.seed = 1; r.seed <= 3; ++r.seed) {
    const verify::Plan plan = plan_paper(r, pool);
    expect_reaches(plan, r);
    EXPECT_LT(slr(plan, r), 1.005) << r.seed;
    EXPECT_EQ(plan.path.size(), 20U);
    EXPECT_EQ(plan.evaluations, 18 * 100 * 50);
    EXPECT_FALSE(plan.front.empty());
    for (std::size_t i = 0; i < plan.path.size(); ++i) {  // X in equal parts
      EXPECT_NEAR(plan.path[i].position.x(), 9.0 * static_cast<double>(i) / 19.0, 1e-9);
    }
  }
}

TEST(PaperPlanner, SameBitsForAnyNumberOfThreads) {
  const std::vector<base::Track> tracks = table2_1();
  PaperRequest r = request({0, 0, 0}, {9, 8, 0}, tracks);
  r.settings.waypoints = 6;
  r.optimizer.iterations = 20;
  base::WorkerPool one(1);
  const verify::Plan expected = plan_paper(r, one);
  for (const int threads : {2, 8}) {
    base::WorkerPool pool(threads);
    const verify::Plan plan = plan_paper(r, pool);
    ASSERT_EQ(plan.path.size(), expected.path.size());
    for (std::size_t i = 0; i < plan.path.size(); ++i) {
      EXPECT_EQ(plan.path[i].t, expected.path[i].t);
      EXPECT_EQ(plan.path[i].position, expected.path[i].position);
    }
    EXPECT_EQ(plan.front, expected.front);
  }
}

TEST(PaperPlanner, FliesAroundASphereInTheWay) {
  base::WorkerPool pool(2);
  for (const base::Constraint constraint : {base::Constraint::kSwept, base::Constraint::kPaper}) {
    const std::vector<base::Track> tracks{sphere(1, {5, 0.1, 2}, {0, 0, 0}, 0.8)};
    PaperRequest r = request({0, 0, 2}, {10, 0, 2}, tracks);
    r.settings.constraint = constraint;
    const verify::Plan plan = plan_paper(r, pool);
    expect_reaches(plan, r);
    EXPECT_GT(slr(plan, r), 1.005);
    EXPECT_LT(slr(plan, r), 1.3);
  }
}

TEST(PaperPlanner, FliesVerticalAndBackwardMissionsAndThoseWithoutExtentInX) {
  base::WorkerPool pool(2);
  const std::vector<base::Track> none;
  for (const Vec3& target : {Vec3(0, 0, 9), Vec3(0, 9, 2), Vec3(-9, 0, 1), Vec3(0, -5, 6)}) {
    PaperRequest r = request({0, 0, 1}, target, none);
    r.settings.waypoints = 8;
    r.optimizer.iterations = 40;
    const verify::Plan plan = plan_paper(r, pool);
    expect_reaches(plan, r);
    EXPECT_LT(slr(plan, r), 1.01) << target.transpose();
  }
}

TEST(PaperPlanner, TakesThePathsAxisWhereWorldXDoesNotCarryTheMission) {
  const std::vector<base::Track> none;
  EXPECT_EQ(effective_axis(request({0, 0, 0}, {9, 8, 0}, none)), base::Axis::kWorldX);
  EXPECT_EQ(effective_axis(request({0, 0, 0}, {0, 8, 0}, none)), base::Axis::kPath);
  EXPECT_EQ(effective_axis(request({0, 0, 0}, {-9, 8, 0}, none)), base::Axis::kWorldX);
  PaperRequest r = request({0, 0, 0}, {9, 8, 0}, none);
  r.settings.axis = base::Axis::kPath;
  EXPECT_EQ(effective_axis(r), base::Axis::kPath);
}

TEST(PaperPlanner, WorksWhereStartAndTargetCoincide) {
  base::WorkerPool pool(1);
  const std::vector<base::Track> none;
  PaperRequest r = request({1, 2, 3}, {1, 2, 3}, none);
  r.settings.waypoints = 4;
  const verify::Plan plan = plan_paper(r, pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kReaches);
  EXPECT_EQ(plan.path.back().position, r.target);
}

TEST(PaperPlanner, StaysInTheVolume) {
  base::WorkerPool pool(2);
  const std::vector<base::Track> tracks{sphere(1, {5, 0.5, 2}, {0, 0, 0}, 0.8)};
  PaperRequest r = request({0, 0, 2}, {10, 0, 2}, tracks);
  r.volume = {{-1, -2, 1.9}, {11, 0.5, 2.1}};  // one way only: to the right
  const verify::Plan plan = plan_paper(r, pool);
  expect_reaches(plan, r);
  for (const base::TimedPoint& point : plan.path) EXPECT_TRUE(r.volume.contains(point.position, 1e-12));
}

TEST(PaperPlanner, SaysThatTheStartIsBlocked) {
  base::WorkerPool pool(1);
  const std::vector<base::Track> tracks{sphere(1, {0.5, 0, 0}, {0, 0, 0})};
  const verify::Plan plan = plan_paper(request({0, 0, 0}, {9, 8, 0}, tracks), pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kStartBlocked);
  EXPECT_EQ(plan.path.size(), 1U);
  EXPECT_FALSE(plan.verification.free());
}

TEST(PaperPlanner, DoesNotReachABlockedTarget) {
  base::WorkerPool pool(1);
  const std::vector<base::Track> tracks{sphere(1, {9, 8, 0}, {0, 0, 0})};
  const verify::Plan plan = plan_paper(request({0, 0, 0}, {9, 8, 0}, tracks), pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kBlocked);
}

TEST(PaperPlanner, RefusesNumbersThatAreNotFinite) {
  base::WorkerPool pool(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<base::Track> tracks = table2_1();
  EXPECT_EQ(plan_paper(request({nan, 0, 0}, {9, 8, 0}, tracks), pool).status, verify::PlanStatus::kInvalid);
  EXPECT_EQ(plan_paper(request({0, 0, 0}, {9, base::kInfinity, 0}, tracks), pool).status, verify::PlanStatus::kInvalid);
  tracks[2].velocity.y() = nan;
  const verify::Plan plan = plan_paper(request({0, 0, 0}, {9, 8, 0}, tracks), pool);
  EXPECT_EQ(plan.status, verify::PlanStatus::kInvalid);
  EXPECT_TRUE(plan.path.empty());
}

TEST(PaperPlanner, RefusesFewerThanTwoWaypoints) {
  base::WorkerPool pool(1);
  const std::vector<base::Track> none;
  PaperRequest r = request({0, 0, 0}, {9, 8, 0}, none);
  r.settings.waypoints = 1;
  EXPECT_THROW(plan_paper(r, pool), std::invalid_argument);
}

TEST(PaperPlanner, FliesStraightOnAfterTheDeadline) {
  base::WorkerPool pool(1);
  const std::vector<base::Track> none;
  PaperRequest r = request({0, 0, 0}, {9, 8, 0}, none);
  r.deadline = base::Budget::Time::min();
  const verify::Plan plan = plan_paper(r, pool);
  EXPECT_TRUE(plan.deadline_reached);
  EXPECT_EQ(plan.path.size(), 2U);
  EXPECT_EQ(plan.path.back().position, r.target);
}

}  // namespace
}  // namespace jink::planner::paper
