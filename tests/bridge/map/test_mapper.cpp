// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/mapper.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "planner/base/solid.hpp"

namespace jink::bridge::map {
namespace {

using planner::geometry::StaticMap;

const Vec3 kHere(0, 0, 1.5);

CloudJob plate(double x, double time) {
  CloudJob job;
  job.time = time;
  job.sensor = job.vehicle = kHere;
  for (double y = -1.0; y < 1.0; y += 0.05)
    for (double z = 1.0; z < 2.0; z += 0.05) job.points.emplace_back(Vec3(x, y, z).cast<float>());
  return job;
}

std::shared_ptr<const StaticMap> known() {
  planner::base::Track pole;
  pole.position = {30, 0, 2};
  pole.radius = 0.5;
  return std::make_shared<const StaticMap>(std::vector{pole});
}

/// Whether something of a map is at a place.
bool stands(const Seen& seen, const Vec3& place) {
  std::vector<planner::base::Track> found;
  seen.map->near({place, place}, seen.up, found);
  return !found.empty();
}

TEST(Mapper, WhatIsSeenAndWhatIsKnownAreOneMap) {
  Mapper mapper({}, 0.3, known(), nullptr);
  EXPECT_EQ(mapper.seen(), nullptr);
  mapper.put(plate(4.1, 0.0));
  const auto seen = mapper.seen();
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(seen->number, 1U);
  EXPECT_EQ(seen->boxes.size(), 1U);
  EXPECT_EQ(seen->map->tracks().size(), 2U);
  EXPECT_TRUE(stands(*seen, {30, 0, 2}));
  EXPECT_TRUE(stands(*seen, {4.1, 0.9, 1.1}));
  EXPECT_FALSE(stands(*seen, {3.7, 0, 1.5}));
  EXPECT_EQ(seen->map->tracks()[1].body.solid->half(), Vec3(0.1, 1.0, 0.5));
}

// The room at the start, in the local frame, wherever that has jumped to; then what was seen.
TEST(Mapper, TellsHowFarUpAndDownIsFree) {
  Mapper mapper({}, 0.3, known(), nullptr);
  EXPECT_FALSE(mapper.column());
  CloudJob job = plate(4.1, 0.0);
  mapper.put(job);
  EXPECT_NEAR(mapper.column()->high, kHere.z() + Mapper::kRoomAtStart, 0.25);
  EXPECT_NEAR(mapper.column()->low, kHere.z() - Mapper::kRoomAtStart, 0.25);
  for (Vec3* place : {&job.sensor, &job.vehicle, &job.shift}) place->z() += 5.0;
  for (Eigen::Vector3f& point : job.points) point.z() += 5.0F;
  mapper.put(job);
  EXPECT_NEAR(mapper.column()->high, kHere.z() + 5.0 + Mapper::kRoomAtStart, 0.25);
  job.vehicle.y() = job.sensor.y() += 5.0;
  mapper.put(job);
  EXPECT_EQ(mapper.column()->high, job.vehicle.z()) << "where nothing is known";
}

// In the local frame, wherever that has jumped to.
TEST(Mapper, TellsWhichPlaceWasNotSeen) {
  Mapper mapper({}, 0.3, known(), nullptr);
  std::vector<Vec3> places{kHere, {1, 0, 1.5}, {2, 0, 1.5}, {5, 0, 1.5}, {1, 0, 1.5}};
  EXPECT_EQ(mapper.first_unseen(places), 1U) << "where it is it may stay";
  CloudJob job = plate(4.1, 0.0);
  mapper.put(job);
  EXPECT_EQ(mapper.first_unseen(places), 3U);
  EXPECT_EQ(mapper.first_unseen(std::span(places).first(3)), 3U) << "none";
  job.shift = {0, 0, 5};
  for (Vec3* place : {&job.sensor, &job.vehicle}) *place += job.shift;
  for (Eigen::Vector3f& point : job.points) point += job.shift.cast<float>();
  mapper.put(job);
  EXPECT_EQ(mapper.first_unseen(places), 1U);
  for (Vec3& place : places) place += job.shift;
  EXPECT_EQ(mapper.first_unseen(places), 3U);
}

TEST(Mapper, AMapThatIsTheSameStaysTheSame) {
  Mapper mapper({}, 0.3, known(), nullptr);
  mapper.put(plate(4.1, 0.0));
  const auto before = mapper.seen();
  mapper.put(plate(4.1, 0.1));
  EXPECT_EQ(mapper.seen(), before);
  EXPECT_EQ(mapper.counts().clouds, 2U);
  mapper.put(plate(3.1, 0.2));
  EXPECT_EQ(mapper.seen()->number, 2U);
}

TEST(Mapper, WhatIsTrackedLeavesNoTrail) {
  Mapper mapper({}, 0.3, known(), nullptr);
  CloudJob job = plate(4.1, 0.0);
  planner::base::Track ball;
  ball.position = {4.1, 0.6, 1.5};
  ball.radius = 0.3;
  planner::base::Track box;
  box.position = {4.1, -0.6, 1.5};
  box.body.solid = planner::base::Solid::box({0.2, 0.4, 0.2}, {});
  box.radius = 0.5;
  job.tracked = {ball, box};
  mapper.put(job);
  EXPECT_FALSE(stands(*mapper.seen(), {4.1, 0.7, 1.5}));
  EXPECT_FALSE(stands(*mapper.seen(), {4.1, -0.7, 1.5}));
  EXPECT_TRUE(stands(*mapper.seen(), {4.1, 0.0, 1.1}));
  EXPECT_TRUE(stands(*mapper.seen(), {4.1, -0.7, 1.9})) << "in the box's sphere, but not in the box";
}

// The vehicle did not move, and what it saw did not either: all is told in the frame of now.
TEST(Mapper, AJumpOfTheLocalFrameMovesNothing) {
  Mapper mapper({}, 0.3, std::make_shared<const StaticMap>(), nullptr);
  mapper.put(plate(4.1, 0.0));
  CloudJob later = plate(4.1, 0.1);
  later.shift = {1.0, 2.0, 0.5};
  later.up = 0.25;
  later.sensor += later.shift;
  later.vehicle += later.shift;
  for (Eigen::Vector3f& point : later.points) point += later.shift.cast<float>();
  mapper.put(later);
  const auto seen = mapper.seen();
  EXPECT_EQ(seen->boxes.size(), 1U) << "one plate, not two";
  EXPECT_EQ(seen->up, 0.25);
  EXPECT_TRUE(stands(*seen, Vec3(4.1, 0.5, 1.5) + later.shift));
  EXPECT_FALSE(stands(*seen, {4.1, 0.5, 1.5}));
}

TEST(Mapper, AnAutopilotThatBeganAnewHasSeenNothing) {
  Mapper mapper({}, 0.3, std::make_shared<const StaticMap>(), nullptr);
  mapper.put(plate(4.1, 0.0));
  CloudJob later = plate(-4.1, 0.1);
  later.anew = true;
  mapper.put(later);
  EXPECT_EQ(mapper.seen()->boxes.size(), 1U);
  EXPECT_TRUE(stands(*mapper.seen(), {-4.1, 0, 1.5}));
}

TEST(Mapper, OnAThreadTheNewestCloudCounts) {
  const base::SteadyClock clock;
  Mapper mapper({}, 0.3, known(), &clock);
  for (int i = 0; i < 20; ++i) mapper.put(plate(2.1 + 0.2 * i, 0.1 * i));
  const auto done = [&] { return mapper.counts().clouds + mapper.counts().skipped == 20; };
  for (int i = 0; i < 1000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(done());
  EXPECT_TRUE(stands(*mapper.seen(), {2.1 + 0.2 * 19, 0, 1.5}));
  EXPECT_GT(mapper.counts().most_ms, 0.0);
}

}  // namespace
}  // namespace jink::bridge::map
