// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/encounters.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "planner/horizon/horizon_planner.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kUp = 5.0;  // m, of the flight

PathRequest level_flight(const std::vector<base::Track>& tracks) {
  PathRequest r;
  r.position = {0, 0, kUp};
  r.velocity = {3, 0, 0};
  r.target = {30, 0, kUp};
  r.volume = {{-5, -20, 0.3}, {35, 20, 10}};
  r.tracks = tracks;
  r.margin = base::HorizonSettings{}.margin;
  return r;
}

/// Straight on at 3 m/s.
base::TimedPath level() {
  base::TimedPath path;
  for (int i = 0; i <= 60; ++i) path.push_back({0.1 * i, {0.3 * i, 0, kUp}, {3, 0, 0}, Vec3::Zero()});
  return path;
}

base::Track ball_at(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  base::Track track;
  track.position = position;
  track.velocity = velocity;
  track.radius = 0.5;
  return track;
}

/// Spheres across the way at x = 10, as high as the volume, `half` m to either side.
std::vector<base::Track> wall_of(double half) {
  std::vector<base::Track> tracks;
  for (double y = -half; y <= half + 1e-9; y += 0.7) {
    for (double z = 0.0; z <= 10.0; z += 0.7) tracks.push_back(ball_at({10, y, z}));
  }
  return tracks;
}

Extent extent(const std::vector<base::Track>& tracks, const base::HorizonSettings& settings = {}) {
  return extent_of(level_flight(tracks), level(), settings);
}

TEST(Encounters, AreTheFirstInOrderOfTime) {
  const std::vector<base::Track> tracks{ball_at({15, 0, kUp}), ball_at({6, 0.4, kUp}), ball_at({0, 10, kUp}),
                                        ball_at({9, -9, kUp}, {0, 3, 0}), ball_at({12, 0, kUp})};
  const auto met = encounters(level_flight(tracks), level(), 6.0, {});
  ASSERT_EQ(met.size(), 3U);
  EXPECT_NEAR(met[0].t, 2.0, 1e-9);
  EXPECT_NEAR(met[1].t, 3.0, 1e-9);
  EXPECT_NEAR(met[2].t, 4.0, 1e-9);
  EXPECT_NEAR((met[0].apart - Vec3(0, -0.4, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((met[1].closing - Vec3(3, -3, 0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(encounters(level_flight(tracks), level(), 2.5, {}).size(), 1U);
}

TEST(Extents, AreBriefWhereTheWayLeadsOnNearBy) {
  EXPECT_EQ(extent({}), Extent::kBrief);
  EXPECT_EQ(extent({ball_at({5, 0, kUp})}), Extent::kBrief);
  EXPECT_EQ(extent({ball_at({15, 0, kUp})}), Extent::kBrief);  // met after brief_time
  EXPECT_EQ(extent({ball_at({3, -3, kUp}, {0, 3, 0})}), Extent::kBrief);
  // As of who cannot be aside in time: no farther than a quarter of acceleration times brief_time squared.
  const std::vector<base::Track> tracks{ball_at({5, 0, kUp})};
  PathRequest sluggish = level_flight(tracks);
  sluggish.vehicle.max_acceleration = 1.0;
  EXPECT_EQ(extent_of(sluggish, level(), {}), Extent::kUsual);
  const base::HorizonSettings long_sighted = base::HorizonSettings{}.for_known_motion();
  EXPECT_EQ(extent({ball_at({5, 0, kUp})}, long_sighted), Extent::kUsual);
  EXPECT_EQ(extent({}, long_sighted), Extent::kUsual);
}

TEST(Extents, AreUsualOfWhoIsStuckOrToStayWhereItSoonIs) {
  const std::vector<base::Track> tracks{ball_at({5, 0, kUp})};
  PathRequest stuck = level_flight(tracks);
  stuck.stuck = true;
  EXPECT_EQ(extent_of(stuck, level(), {}), Extent::kUsual);
  stuck.way = {stuck.target};  // led
  EXPECT_EQ(extent_of(stuck, level(), {}), Extent::kBrief);
  PathRequest arrives = level_flight(tracks);
  arrives.target.x() = 5.5;  // at 3 m/s
  EXPECT_EQ(extent_of(arrives, level(), {}), Extent::kUsual);
  arrives.way = {arrives.target};  // a place that is passed
  EXPECT_EQ(extent_of(arrives, level(), {}), Extent::kBrief);
  arrives.visit = true;
  EXPECT_EQ(extent_of(arrives, level(), {}), Extent::kUsual);
}

TEST(Extents, AreBriefAlongAWayThatIsKnownToLeadOn) {
  const std::vector<base::Track> wall = wall_of(7.0);
  PathRequest led = level_flight({});
  led.standing = wall;
  led.way = {{9, 8, kUp}, led.target};
  EXPECT_EQ(extent_of(led, level(), {}), Extent::kBrief);
  EXPECT_EQ(extent_of(led, level(), base::HorizonSettings{}.for_known_motion()), Extent::kUsual);
  led.way.clear();
  EXPECT_EQ(extent_of(led, level(), {}), Extent::kFar);
  led = level_flight(wall);
  led.way = {{9, 8, kUp}, led.target};
  EXPECT_EQ(extent_of(led, level(), {}), Extent::kFar) << "what is not known to stand";
}

// Nobody flies far aside in a short horizon: to wait would be cheaper.
TEST(Extents, AreUsualWhereItLeadsOnFartherAside) {
  EXPECT_EQ(extent(wall_of(2.0)), Extent::kUsual);
  EXPECT_EQ(extent(wall_of(3.0)), Extent::kUsual);
  std::vector<base::Track> later = wall_of(3.0);
  for (base::Track& track : later) track.position.x() += 6.0;
  EXPECT_EQ(extent(later), Extent::kUsual);
}

TEST(Extents, AreFarWhereItLeadsOnFarAsideAlone) {
  EXPECT_EQ(extent(wall_of(7.0)), Extent::kFar);
  base::HorizonSettings narrow;
  narrow.far_range = narrow.lateral_range;
  EXPECT_EQ(extent(wall_of(7.0), narrow), Extent::kUsual);
  EXPECT_EQ(extent(wall_of(19.9)), Extent::kUsual);  // closed: to look far would show nothing more
}

TEST(Extents, OfFineStepsAreNoMoreThanTheMostSteps) {
  base::HorizonSettings fine;
  fine.step = 0.025;
  EXPECT_LE(fine.for_far().time, base::HorizonSettings::kMostSteps * fine.step + 1e-9);
  EXPECT_GT(fine.for_far().time, fine.time);
  EXPECT_NO_THROW(HorizonPlanner{fine});
}

// The cliff that was: from half a width of 5 m on, nothing led round.
TEST(Extents, LeadRoundAWideWall) {
  base::WorkerPool pool(2);
  for (const double half : {4.0, 5.0, 6.0, 7.0}) {
    const std::vector<base::Track> tracks = wall_of(half);
    HorizonPlanner planner{base::HorizonSettings{}};
    const verify::Plan plan = planner.plan(level_flight(tracks), {}, 1, 0, {100}, pool);
    EXPECT_TRUE(plan.verification.free());
    EXPECT_EQ(plan.status, verify::PlanStatus::kReaches) << half;
    EXPECT_GT(base::sample(plan.path, plan.horizon).position.x(), 10.0) << half;
  }
}

}  // namespace
}  // namespace jink::planner::horizon
