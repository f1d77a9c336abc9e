// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/static_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/solid.hpp"

namespace jink::planner::geometry {
namespace {

base::Track ball(const Vec3& position, double radius) {
  base::Track track;
  track.position = position;
  track.radius = radius;
  return track;
}

base::Track box(const Vec3& position, const Vec3& edges) {
  base::Track track = ball(position, 0.5 * edges.norm());
  track.body.solid = base::Solid::box(edges, {});
  return track;
}

std::vector<base::Track> some(std::size_t count, base::RandomStream& random) {
  const auto vector = [&](double low, double high) {
    return Vec3(random.uniform(low, high), random.uniform(low, high), random.uniform(low, high));
  };
  std::vector<base::Track> tracks;
  for (std::size_t i = 0; i < count; ++i)
    tracks.push_back(i % 2 == 0 ? ball(vector(-50, 50), random.uniform(0, 3)) : box(vector(-50, 50), vector(0, 9)));
  return tracks;
}

base::Box room(base::RandomStream& random) {
  const Vec3 p(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-60, 60));
  return {p, p + Vec3(random.uniform(0, 30), random.uniform(0, 30), random.uniform(0, 30))};
}

TEST(StaticMap, GivesItsOwnIds) {
  const StaticMap map({ball({0, 0, 0}, 1), ball({5, 0, 0}, 1)});
  ASSERT_EQ(map.tracks().size(), 2U);
  EXPECT_EQ(map.tracks()[0].id, StaticMap::kFirstId);
  EXPECT_EQ(map.tracks()[1].id, StaticMap::kFirstId + 1);
}

TEST(StaticMap, BoxesAreThoseOfTheSolids) {
  base::Track turned = box({1, 2, 3}, {2, 4, 6});
  turned.body.yaw = 0.5 * 3.14159265358979323846;
  const base::Box around = box_around(turned);
  EXPECT_TRUE(around.min.isApprox(Vec3(-1, 1, 0), 1e-9)) << around.min.transpose();
  EXPECT_TRUE(around.max.isApprox(Vec3(3, 3, 6), 1e-9)) << around.max.transpose();
}

TEST(StaticMap, FindsWhatASearchOfAllFindsInItsOrder) {
  base::RandomStream random(5);
  for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 4, 5, 63, 700}) {
    const StaticMap map(some(count, random));
    for (int n = 0; n < 100; ++n) {
      const base::Box where = room(random);
      const double up = random.uniform(-5, 5);
      std::vector<std::uint64_t> expected;
      for (std::size_t i = 0; i < count; ++i) {
        base::Box lifted = map.box(i);
        lifted.min.z() += up;
        lifted.max.z() += up;
        if (distance(lifted, where) == 0.0) expected.push_back(map.tracks()[i].id);
      }
      std::vector<base::Track> found{ball({0, 0, 0}, 1)};
      map.near(where, up, found);
      ASSERT_EQ(found.size(), expected.size() + 1) << "what is there stays";
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const base::Track& track = found[i + 1];
        EXPECT_EQ(track.id, expected[i]);
        EXPECT_EQ(track.position.z(), map.tracks()[track.id - StaticMap::kFirstId].position.z() + up);
      }
    }
  }
}

TEST(StaticMap, FindsTheNearestWithFewLooks) {
  base::RandomStream random(6);
  const StaticMap map(some(2000, random));
  std::size_t looks = 0;
  for (int n = 0; n < 200; ++n) {
    const base::Box where = room(random);
    double expected = base::kInfinity;
    for (std::size_t i = 0; i < map.tracks().size(); ++i) expected = std::min(expected, distance(map.box(i), where));
    double nearest = base::kInfinity;
    map.visit(where, nearest, [&](std::size_t i) {
      ++looks;
      nearest = std::min(nearest, distance(map.box(i), where));
      return nearest;
    });
    EXPECT_EQ(nearest, expected);
  }
  EXPECT_LT(looks, 200U * 200U);
}

TEST(StaticMap, TakesManyInOnePlace) {
  const StaticMap map(std::vector<base::Track>(100, ball({1, 1, 1}, 0.5)));
  std::vector<base::Track> found;
  map.near({{0, 0, 0}, {1, 1, 1}}, 0.0, found);
  EXPECT_EQ(found.size(), 100U);
}

TEST(StaticMap, RefusesWhatMovesOrIsNone) {
  const auto refused = [](base::Track track) { EXPECT_THROW(StaticMap({track}), std::invalid_argument); };
  base::Track track = box({0, 0, 0}, {1, 1, 1});
  track.velocity.x() = 1e-9;
  refused(track);
  track = box({0, 0, 0}, {1, 1, 1});
  track.acceleration.z() = 1.0;
  refused(track);
  track = box({0, 0, 0}, {1, 1, 1});
  track.body.yaw_rate = 0.1;
  refused(track);
  track = box({0, 0, 0}, {1, 1, 1});
  track.position.x() = std::numeric_limits<double>::quiet_NaN();
  refused(track);
}

}  // namespace
}  // namespace jink::planner::geometry
