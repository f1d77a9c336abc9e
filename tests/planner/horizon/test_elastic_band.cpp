// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/elastic_band.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kRadius = 2.0;  // m, of the obstacle and the vehicle together
const Vec3 kEnd(20, 0, 0);

base::Track ball(const Vec3& center, const Vec3& velocity = Vec3::Zero()) {
  base::Track track;
  track.position = center;
  track.velocity = velocity;
  track.radius = kRadius - base::VehicleLimits{}.radius;
  return track;
}

PathRequest across_from_rest(const std::vector<base::Track>& tracks) {
  PathRequest r;
  r.target = kEnd;
  r.tracks = tracks;
  r.margin = 0.05;
  return r;
}

/// From rest to rest in 10 s along the straight line, `aside` of it in the middle.
base::TimedPath bow(double aside) {
  base::TimedPath path;
  for (int i = 0; i <= 100; ++i) {
    const double s = 0.01 * i;
    const double along = s * s * (3.0 - 2.0 * s);
    const double side = 16.0 * s * s * (1.0 - s) * (1.0 - s);
    path.push_back({10.0 * s, {20.0 * along, aside * side, 0.0}, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

TEST(ElasticBand, IsStraightWhereNothingIsInTheWay) {
  const std::vector<base::Track> none;
  const base::TimedPath path = bow(3.0);
  const base::TimedPath tight = elastic_band(path, across_from_rest(none), 3.0);
  ASSERT_EQ(tight.size(), path.size());
  EXPECT_LT(base::path_length(tight), 20.0 * 1.0001);
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_EQ(tight[i].t, path[i].t);
  EXPECT_EQ(tight.front().position, path.front().position);
  EXPECT_EQ(tight.back().position, path.back().position);
}

// Both tangents to a sphere of 2 m on the line, and the arc between them.
TEST(ElasticBand, IsTheTangentPathRoundASphere) {
  const std::vector<base::Track> tracks{ball({10, 0, 0})};
  const base::TimedPath tight = elastic_band(bow(3.0), across_from_rest(tracks), 3.0);
  const double exact = 2.0 * std::sqrt(100.0 - kRadius * kRadius) + kRadius * 2.0 * std::asin(kRadius / 10.0);
  EXPECT_GT(base::path_length(tight), exact);
  EXPECT_LT(base::path_length(tight), 1.003 * exact);
  const PathRequest r = across_from_rest(tracks);
  const verify::Verification checked = verify::verify({tight, r.tracks, 0.0, r.vehicle.radius, r.volume});
  EXPECT_GE(checked.min_clearance, r.margin);
}

TEST(ElasticBand, IsPushedByWhatMoves) {
  const std::vector<base::Track> tracks{ball({10, 5, 0}, {0, -1, 0})};
  const PathRequest r = across_from_rest(tracks);
  const base::TimedPath tight = elastic_band(bow(-3.0), r, 3.0);
  EXPECT_GE(verify::verify({tight, r.tracks, 0.0, r.vehicle.radius, r.volume}).min_clearance, r.margin);
  EXPECT_LT(base::path_length(tight), base::path_length(bow(-3.0)));
}

// Along the sphere of 2 m it would take 4.5 m/s² at 3 m/s.
TEST(ElasticBand, GoesNoFasterAndBendsLittleHarderThanAsked) {
  const std::vector<base::Track> tracks{ball({10, 0.5, 0})};
  const base::TimedPath path = bow(-4.0);
  const double most = 3.0;
  const base::TimedPath tight = elastic_band(path, across_from_rest(tracks), most);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Vec3 bend = (tight[i + 1].position - 2.0 * tight[i].position + tight[i - 1].position) / 0.01;
    EXPECT_LE(bend.norm(), 1.1 * most) << tight[i].t;
    EXPECT_LE((tight[i].position - tight[i - 1].position).norm(),
              (path[i].position - path[i - 1].position).norm() + 0.02);
  }
}

TEST(ElasticBand, StaysInTheVolume) {
  const std::vector<base::Track> tracks{ball({10, 0, 0})};
  PathRequest r = across_from_rest(tracks);
  r.volume.min.y() = -0.5;
  for (const base::TimedPoint& point : elastic_band(bow(4.0), r, 3.0))
    EXPECT_TRUE(r.volume.contains(point.position, 1e-3));
}

/// As `jink plan` plans among resting spheres, grown by the vehicle's radius.
verify::Plan plan_among(const std::vector<std::pair<Vec3, double>>& spheres) {
  std::vector<base::Track> tracks;
  for (const auto& [center, radius] : spheres) {
    tracks.push_back({});
    tracks.back().id = tracks.size();
    tracks.back().position = center;
    tracks.back().radius = radius - base::VehicleLimits{}.radius;
  }
  OpenLoopRequest request;
  request.path = across_from_rest(tracks);
  request.time_limit = 60.0;
  base::WorkerPool pool(1);
  const base::HorizonSettings settings;
  return plan_open_loop(settings, {}, request, 1, {settings.generations}, pool);
}

// The table of docs/planner.md has 500 of each (tools/lab/bench/tangent.cpp).
TEST(OpenLoopPlan, IsNearlyTheShortestRoundASphere) {
  base::RandomStream random(7);
  double sum = 0.0;
  constexpr int kCases = 12;
  for (int n = 0; n < kCases; ++n) {
    const double radius = random.uniform(1.0, 4.0);
    const Vec3 center(random.uniform(6.0, 14.0), random.uniform(-0.9, 0.9) * radius, 0.0);
    const verify::Plan plan = plan_among({{center, radius}});
    ASSERT_EQ(plan.status, verify::PlanStatus::kReaches);
    const double a = center.norm();
    const double b = (kEnd - center).norm();
    const double angle =
        std::acos(-center.dot(kEnd - center) / (a * b)) - std::acos(radius / a) - std::acos(radius / b);
    const double exact = std::sqrt(a * a - radius * radius) + std::sqrt(b * b - radius * radius) + radius * angle;
    const double excess = base::path_length(plan.path) / exact - 1.0;
    EXPECT_LT(excess, 0.03) << radius << " at " << center.transpose();
    EXPECT_GT(excess, 0.0);
    sum += excess;
  }
  EXPECT_LT(sum / kCases, 0.01);
}

// Round the first of two the search prefers a side from which the way round the second is long, or there is no time to
// bend as sharply as the shortest way does. The exact lengths are those of tools/lab/bench/tangent.cpp.
TEST(OpenLoopPlan, IsNearlyTheShortestRoundTwoSpheres) {
  const double first = base::path_length(plan_among({{{5.69, 0.87, 1.20}, 2.78}, {{12.42, -0.37, -0.47}, 3.06}}).path);
  EXPECT_LT(first / 21.04, 1.03);
  const double second = base::path_length(plan_among({{{5.71, 1.72, -0.43}, 2.23}, {{13.28, -0.28, 0.16}, 2.97}}).path);
  EXPECT_LT(second / 20.91, 1.03);
}

// Something crosses the way: pulled tight, with more time or less, the plan is still clear of it, and in time.
TEST(OpenLoopPlan, IsPulledTightWhereWhatMovesAllowsIt) {
  base::WorkerPool pool(1);
  const base::HorizonSettings settings;
  for (int n = 0; n < 8; ++n) {
    OpenLoopRequest request;
    const std::vector<base::Track> tracks{ball({6.0 + n, -9.0, 0.0}, {0.0, 3.0, 0.0})};
    request.path = across_from_rest(tracks);
    request.time_limit = 9.0;
    const verify::Plan plan = plan_open_loop(settings, {}, request, 1, {settings.generations}, pool);
    ASSERT_EQ(plan.status, verify::PlanStatus::kReaches) << n;
    EXPECT_LE(plan.path.back().t, request.time_limit) << n;
    EXPECT_GE(plan.verification.min_clearance, request.path.margin - 1e-9) << n;
    EXPECT_LT(base::path_length(plan.path), 1.05 * kEnd.norm()) << n;
  }
}

}  // namespace
}  // namespace jink::planner::horizon
