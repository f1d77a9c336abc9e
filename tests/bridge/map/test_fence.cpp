// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/fence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridge/frames/conversions.hpp"
#include "config/solids.hpp"
#include "planner/base/random.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::bridge::map {
namespace {

using Items = std::vector<mavlink::MissionItem>;
using planner::geometry::Vec2;

const frames::Geodetic kOrigin{47.397742, 8.545594, 488.0};

mavlink::MissionItem item(std::uint32_t command, double param1, const Vec2& p) {
  const frames::Geodetic place = frames::LocalFrame(kOrigin).to_geodetic({p.x(), p.y(), 0.0});
  mavlink::MissionItem result;
  result.command = command;
  result.param1 = param1;
  result.latitude_deg = place.latitude_deg;
  result.longitude_deg = place.longitude_deg;
  return result;
}

Items polygon(std::uint32_t command, const std::vector<Vec2>& corners) {
  Items items;
  for (const Vec2& corner : corners) items.push_back(item(command, static_cast<double>(corners.size()), corner));
  return items;
}

Items joined(Items a, const Items& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::vector<Vec2> kAngle{{-10, -10}, {40, -10}, {40, 10}, {10, 10}, {10, 40}, {-10, 40}};  // an L
const Items kInclusion = polygon(5001, kAngle);

/// Whether the straight way of a small vehicle is free of the fence.
bool free_way(const Fence& fence, const Vec2& from, const Vec2& to) {
  std::vector<planner::base::Track> tracks;
  for (const config::Obstacle& solid : fence.solids) tracks.push_back(config::track_at_rest(solid));
  planner::verify::VerifierInput input;
  const planner::base::TimedPath path{{0.0, {from.x(), from.y(), 5.0}, Vec3::Zero(), Vec3::Zero()},
                                      {10.0, {to.x(), to.y(), 5.0}, Vec3::Zero(), Vec3::Zero()}};
  input.path = path;
  input.tracks = tracks;
  input.vehicle_radius = 0.01;
  return planner::verify::verify(input).free();
}

bool in_angle(const Vec2& p, double inset) {
  const bool low = p.x() > -10 + inset && p.x() < 40 - inset && p.y() > -10 + inset && p.y() < 10 - inset;
  const bool left = p.x() > -10 + inset && p.x() < 10 - inset && p.y() > -10 + inset && p.y() < 40 - inset;
  return low || left;
}

TEST(Fence, WhatLiesOutsideIsClosedAndWhatLiesInsideIsNot) {
  for (const Items& items : {kInclusion, Items(kInclusion.rbegin(), kInclusion.rend())}) {
    const Fence fence = fence_of(items, kOrigin, -100, 100);
    EXPECT_EQ(fence.solids.size(), 6U);
    ASSERT_EQ(fence.inside.size(), 1U);
    planner::base::RandomStream random(2);
    for (int n = 0; n < 1000; ++n) {
      const Vec2 from(random.uniform(-9.9, 9.9), random.uniform(-9.9, 9.9));  // the corner of the L sees all of it
      const Vec2 to(random.uniform(-60, 60), random.uniform(-60, 60));
      EXPECT_TRUE(fence.holds({from.x(), from.y(), 0}));
      EXPECT_EQ(fence.holds({to.x(), to.y(), 0}), in_angle(to, 0.0));
      EXPECT_TRUE(in_angle(to, -0.1) || !free_way(fence, from, to)) << to.transpose();
      const Vec2 inside = to.x() > 10 ? Vec2(to.x(), from.y()) : Vec2(from.x(), to.y());
      EXPECT_TRUE(!in_angle(inside, 0.1) || free_way(fence, from, inside)) << inside.transpose();
    }
  }
}

TEST(Fence, ACircleToBeInIsAPolygonWithinIt) {
  const Fence fence = fence_of(Items{item(5003, 30.0, {5, 5})}, kOrigin, -100, 100);
  EXPECT_GE(fence.solids.size(), 32U);
  for (double angle = 0.0; angle < 6.3; angle += 0.01) {
    const Vec2 out(std::cos(angle), std::sin(angle));
    EXPECT_TRUE(free_way(fence, {5, 5}, Vec2(5, 5) + 29.9 * out));
    EXPECT_FALSE(free_way(fence, {5, 5}, Vec2(5, 5) + 30.0 * out));
  }
}

TEST(Fence, AreasToBeOutOfAreSolid) {
  const Fence fence = fence_of(joined(polygon(5002, kAngle), {item(5004, 3.0, {60, 60})}), kOrigin, -100, 100);
  EXPECT_TRUE(fence.inside.empty());
  EXPECT_EQ(fence.outside, 2U);
  EXPECT_TRUE(fence.holds({0, 0, 0})) << "where it is to be in nothing, it may be anywhere";
  EXPECT_FALSE(free_way(fence, {-20, 0}, {20, 0}));
  EXPECT_TRUE(free_way(fence, {12, 50}, {12, 11}));
  EXPECT_FALSE(free_way(fence, {60, 50}, {60, 70}));
  EXPECT_TRUE(free_way(fence, {64, 50}, {64, 70}));
}

TEST(Fence, RefusesWhatMakesNoSense) {
  const auto refused = [](const Items& items, const std::string& expected) {
    try {
      (void)fence_of(items, kOrigin, 0, 1);
      ADD_FAILURE() << "no error: " << expected;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  Items cut = kInclusion;
  cut.pop_back();
  refused(cut, "item 0 begins a polygon whose corners are not all there");
  Items mixed = kInclusion;
  mixed[2].command = 5002;
  refused(mixed, "item 2 is no corner");
  refused(polygon(5001, {{0, 0}, {9, 9}, {9, 0}, {0, 9}}), "crosses itself");
  refused(polygon(5001, {{0, 0}, {9, 9}}), "not all there");
  refused({item(5003, 0.0, {0, 0})}, "radius");
  refused({item(5004, std::nan(""), {0, 0})}, "radius");
  refused({item(16, 0.0, {0, 0})}, "command 16");
  refused({item(5004, 1.0, {0, 200e3})}, "100 km");
  EXPECT_TRUE(fence_of(Items{item(5000, 0.0, {0, 0})}, kOrigin, 0, 1).solids.empty())
      << "the return point bounds nothing";
}

TEST(Fence, BecomesAPartOfTheMissionsMap) {
  config::Mission mission;
  mission.waypoints = {{5, 5, 2}, {0, 30, 2}};
  mission.geofence = {{-50, -50, 0}, {50, 50, 20}};
  const std::vector<config::Obstacle> own{{config::SphereShape{1.0}, config::LinearMotion{{5, -5, 2}}}};
  mission.map = config::make_map(own);
  const config::Mission with = fenced(mission, kInclusion, kOrigin);
  ASSERT_EQ(with.map->tracks().size(), 7U);
  EXPECT_EQ(with.map->tracks()[0].position, Vec3(5, -5, 2));
  EXPECT_DOUBLE_EQ(with.map->box(3).min.z(), -10.0);
  EXPECT_DOUBLE_EQ(with.map->box(3).max.z(), 30.0);
  mission.waypoints.push_back({30, 30, 2});
  EXPECT_THROW((void)fenced(mission, kInclusion, kOrigin), std::runtime_error);
}

}  // namespace
}  // namespace jink::bridge::map
