// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/contingency.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "planner/horizon/path_check.hpp"

namespace jink::planner::horizon {
namespace {

const base::HorizonSettings kSettings;

// At 3 m/s along x from the origin, 5 m up; the straight stop ends at (2.25, 0, 5).
PathRequest moving() {
  PathRequest r;
  r.position = {0, 0, 5};
  r.velocity = {3, 0, 0};
  r.volume = {{-20, -20, 1}, {20, 20, 12}};
  r.margin = kSettings.margin;
  return r;
}

base::TimedPath straight_stop() {
  base::TimedPath path;
  for (double t = 0.0; t < 1.55; t += 0.1) path.push_back({t, {3 * t - t * t, 0, 5}, {3 - 2 * t, 0, 0}, {-2, 0, 0}});
  return path;
}

base::Track mover(const Vec3& position, const Vec3& velocity) {
  base::Track t;
  t.id = 7;
  t.position = position;
  t.velocity = velocity;
  t.radius = 0.5;
  return t;
}

Stop choose_stop(const PathRequest& r, const std::vector<base::TimedPath>& stops = {straight_stop()}) {
  Contingency contingency(kSettings);
  return contingency.choose(r, stops);
}

TEST(Contingency, IsTheStraightStopWhereThatStaysFree) {
  PathRequest r = moving();
  const std::vector<base::Track> behind{mover({-8, 0, 5}, {0.5, 0, 0})};
  r.tracks = behind;
  const Stop stop = choose_stop(r);
  EXPECT_EQ(stop.choice, 0);
  ASSERT_EQ(stop.path.size(), straight_stop().size());
  EXPECT_EQ(stop.path.back().position, straight_stop().back().position);
  EXPECT_TRUE(stop.verification.free());
}

TEST(Contingency, LeavesOutWhatIsNotAllowed) {
  PathRequest r = moving();
  const std::vector<base::Track> comes{mover(straight_stop().back().position + Vec3(8, 0, 0), Vec3(-2, 0, 0))};
  r.tracks = comes;
  Contingency contingency(kSettings);
  const std::vector<base::TimedPath> straight{straight_stop()};
  const Vec3 highest = contingency.choose(r, straight).path.back().position;
  ASSERT_GT(highest.z(), r.position.z() + 0.5) << "it climbs, where it may";
  const auto stays_low = [&](const base::TimedPath& path) { return path.back().position.z() < r.position.z() + 0.5; };
  const Stop low = contingency.choose(r, straight, stays_low);
  EXPECT_TRUE(low.verification.free());
  EXPECT_TRUE(stays_low(low.path));
  const Stop none = contingency.choose(r, straight, [](const auto&) { return false; });
  EXPECT_EQ(none.choice, 0) << "what is given is not asked for";
  EXPECT_FALSE(none.verification.free());
}

// What comes where the vehicle would stand, even long after it has stopped.
TEST(Contingency, GetsOutOfTheWayOfWhatComesWhereItWouldStand) {
  for (const Vec3& velocity : {Vec3(-2, 0, 0), Vec3(0, 1, 0), Vec3(0, -3, 0), Vec3(0, 0, 2), Vec3(0, 0, -1)}) {
    SCOPED_TRACE(velocity.transpose());
    PathRequest r = moving();
    const std::vector<base::Track> comes{mover(straight_stop().back().position - 4.0 * velocity, velocity)};
    r.tracks = comes;
    ASSERT_TRUE(verify_until(straight_stop(), r, 6.0).first_contact);
    const Stop stop = choose_stop(r);
    EXPECT_GT(stop.choice, 0);
    EXPECT_TRUE(stop.verification.free());
    EXPECT_GE(stop.verification.min_clearance, r.margin);
    EXPECT_EQ(stop.path.front().position, r.position);
    EXPECT_EQ(stop.path.front().velocity, r.velocity);
    EXPECT_EQ(stop.path.back().velocity, Vec3::Zero());
    const verify::Verification again = verify_until(stop.path, r, 6.0);
    EXPECT_TRUE(again.free());
    EXPECT_EQ(again.min_clearance, stop.verification.min_clearance);
  }
}

TEST(Contingency, PrefersWhatItIsGivenInItsOrder) {
  PathRequest r = moving();
  const std::vector<base::Track> stands{mover({2.25, 0, 5}, {0, 0, 0})};
  r.tracks = stands;
  base::TimedPath up, aside;
  for (double t = 0.0; t < 3.05; t += 0.1) {
    up.push_back({t, {0, 0, 5 + t}, {3, 0, 0}, {}});
    aside.push_back({t, {0, t, 5}, {3, 0, 0}, {}});
  }
  EXPECT_EQ(choose_stop(r, {straight_stop(), aside, up}).choice, 1);
  EXPECT_EQ(choose_stop(r, {straight_stop(), aside, up}).path.back().position, aside.back().position);
  EXPECT_EQ(choose_stop(r, {straight_stop(), up, aside}).path.back().position, up.back().position);
}

TEST(Contingency, StaysInTheVolumeWhereItCan) {
  PathRequest r = moving();
  r.volume.max.z() = 5.5;  // no way up
  const std::vector<base::Track> comes{mover({14.25, 0, 5}, {-3, 0, 0})};
  r.tracks = comes;
  const Stop stop = choose_stop(r);
  EXPECT_TRUE(stop.verification.free());
  for (const base::TimedPoint& point : stop.path) EXPECT_TRUE(r.volume.contains(point.position, 1e-9));
}

// Walled in by what closes in from all sides: the longest time without contact.
TEST(Contingency, DoesTheLeastHarmWhereNothingIsFree) {
  PathRequest r = moving();
  std::vector<base::Track> closing;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vec3 from = Vec3(x, y, z).normalized();
        closing.push_back(mover(Vec3(1, 0, 5) + 6.0 * from, -1.0 * from));
        closing.back().radius = 2.5;
      }
    }
  }
  r.tracks = closing;
  const Stop stop = choose_stop(r);
  ASSERT_TRUE(stop.verification.first_contact);
  const verify::Verification straight_on = verify_until(straight_stop(), r, 6.0);
  ASSERT_TRUE(straight_on.first_contact);
  EXPECT_FALSE(is_safer(straight_on, stop.verification));
  EXPECT_GE(*stop.verification.first_contact, *straight_on.first_contact - 1e-6);
}

}  // namespace
}  // namespace jink::planner::horizon
