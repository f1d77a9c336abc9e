// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/sensing.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tests/sim/examples.hpp"

namespace jink::sim::world {
namespace {

World world_of(std::vector<config::Obstacle> obstacles) {
  config::Scenario scenario;
  scenario.obstacles = std::move(obstacles);
  return World(std::move(scenario));
}

/// `count` balls of 0.5 m in a row along x, 10 m apart.
World row_of(int count) {
  std::vector<config::Obstacle> obstacles;
  for (int i = 0; i < count; ++i) obstacles.push_back(ball(0.5, {10.0 * i, 0, 0}, {1, 2, 3}, {0, 0, 1}));
  return world_of(std::move(obstacles));
}

std::set<std::uint64_t> ids_of(const std::vector<planner::base::Track>& tracks) {
  std::set<std::uint64_t> ids;
  for (const planner::base::Track& track : tracks) ids.insert(track.id);
  return ids;
}

TEST(Measure, PerfectSensingReportsTheTruth) {
  const World world = row_of(3);
  const std::vector<planner::base::Track> tracks = measure(world, {}, 1, 0, 2.0, Vec3::Zero());
  ASSERT_EQ(tracks.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const planner::base::Track& track = tracks[static_cast<std::size_t>(i)];
    EXPECT_EQ(track.id, World::id(i));
    EXPECT_EQ(track.position, Vec3(10.0 * i + 2, 4, 8));
    EXPECT_EQ(track.velocity, Vec3(1, 2, 5));
    EXPECT_EQ(track.acceleration, Vec3(0, 0, 1));
    EXPECT_EQ(track.radius, 0.5);
    EXPECT_EQ(track.position_sigma, 0.0);
    EXPECT_EQ(track.velocity_sigma, 0.0);
    EXPECT_EQ(track.age, 0.0);
  }
}

TEST(Measure, RangeIsFromTheVehiclesCentreToTheSurface) {
  const World world = row_of(4);
  config::Sensing sensing;
  sensing.range = 9.5;
  EXPECT_EQ(ids_of(measure(world, sensing, 1, 0, 0.0, Vec3::Zero())), (std::set<std::uint64_t>{1, 2}));
  sensing.range = 9.4999;
  EXPECT_EQ(ids_of(measure(world, sensing, 1, 0, 0.0, Vec3::Zero())), (std::set<std::uint64_t>{1}));
  EXPECT_EQ(ids_of(measure(world, sensing, 1, 0, 0.0, {25, 0, 0})), (std::set<std::uint64_t>{3, 4}));
  sensing.range = 0.0;  // sees what it is in
  EXPECT_EQ(ids_of(measure(world, sensing, 1, 0, 0.0, {30.2, 0, 0})), (std::set<std::uint64_t>{4}));
}

TEST(Measure, NoiseHasTheStatedDeviationOnEachAxisAndNoBias) {
  const World world = row_of(2);
  config::Sensing sensing;
  sensing.position_noise = 0.2;
  sensing.velocity_noise = 0.7;
  constexpr int kCount = 20000;
  std::array<double, 12> sums{};
  std::array<double, 12> squares{};
  double cross = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const auto tracks = measure(world, sensing, 5, static_cast<std::uint64_t>(k), 0.0, Vec3::Zero());
    ASSERT_EQ(tracks.size(), 2U);
    std::array<double, 12> errors{};
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(tracks[i].acceleration, Vec3(0, 0, 0));
      EXPECT_EQ(tracks[i].position_sigma, 0.2);
      EXPECT_EQ(tracks[i].velocity_sigma, 0.7);
      EXPECT_EQ(tracks[i].radius, 0.5);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const planner::base::Track exact = world.exact_track(static_cast<int>(i), 0.0);
        errors[6 * i + axis] = (tracks[i].position - exact.position)[a] / 0.2;
        errors[6 * i + 3 + axis] = (tracks[i].velocity - exact.velocity)[a] / 0.7;
      }
    }
    for (std::size_t j = 0; j < errors.size(); ++j) {
      sums[j] += errors[j];
      squares[j] += errors[j] * errors[j];
      cross += errors[j] * errors[(j + 1) % errors.size()];
    }
  }
  const double error = 5.0 / std::sqrt(double{kCount});  // five standard errors
  for (std::size_t j = 0; j < sums.size(); ++j) {
    EXPECT_NEAR(sums[j] / kCount, 0.0, error) << j;
    EXPECT_NEAR(squares[j] / kCount, 1.0, error * std::sqrt(2.0)) << j;
  }
  EXPECT_NEAR(cross / kCount / 12, 0.0, error / std::sqrt(12.0));
}

TEST(Measure, AccelerationIsGoneAsSoonAsAnythingIsNoisy) {
  config::Sensing sensing;
  sensing.velocity_noise = 1e-3;
  const auto tracks = measure(row_of(1), sensing, 1, 0, 0.0, Vec3::Zero());
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].acceleration, Vec3(0, 0, 0));
  EXPECT_EQ(tracks[0].position, Vec3(0, 0, 0));  // no position noise was asked for
  EXPECT_NE(tracks[0].velocity, Vec3(1, 2, 3));
}

TEST(Measure, DropoutHasItsProbabilityForEachTrackOnItsOwn) {
  const World world = row_of(2);
  config::Sensing sensing;
  sensing.dropout = 0.3;
  constexpr int kCount = 20000;
  std::map<std::set<std::uint64_t>, int> seen;
  for (int k = 0; k < kCount; ++k) {
    ++seen[ids_of(measure(world, sensing, 6, static_cast<std::uint64_t>(k), 0.0, Vec3::Zero()))];
  }
  const auto expect_share = [&](const std::set<std::uint64_t>& ids, double p) {
    EXPECT_NEAR(static_cast<double>(seen[ids]) / kCount, p, 5 * std::sqrt(p * (1 - p) / kCount));
  };
  expect_share({}, 0.09);
  expect_share({1}, 0.21);
  expect_share({2}, 0.21);
  expect_share({1, 2}, 0.49);
  sensing.dropout = 1.0;
  EXPECT_TRUE(measure(world, sensing, 6, 0, 0.0, Vec3::Zero()).empty());
}

TEST(Measure, RandomNumbersDependOnSeedSequenceAndObstacleAlone) {
  const World world = row_of(4);
  config::Sensing sensing;
  sensing.position_noise = 0.2;
  const auto all = measure(world, sensing, 1, 7, 0.0, Vec3::Zero());
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(measure(world, sensing, 1, 7, 0.0, Vec3::Zero())[3].position, all[3].position);
  EXPECT_NE(measure(world, sensing, 1, 8, 0.0, Vec3::Zero())[3].position, all[3].position);
  EXPECT_NE(measure(world, sensing, 2, 7, 0.0, Vec3::Zero())[3].position, all[3].position);
  EXPECT_NE((all[2].position - Vec3(20, 0, 0)).eval(), (all[3].position - Vec3(30, 0, 0)).eval());
  // Seen from the other end with a short range the last ball alone is there, with the same noise.
  sensing.range = 5.0;
  const auto last = measure(world, sensing, 1, 7, 0.0, {30, 0, 0});
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0].position, all[3].position);
  // Dropout takes tracks away and leaves the others as they are.
  sensing.range = planner::base::kInfinity;
  sensing.dropout = 0.5;
  for (const planner::base::Track& track : measure(world, sensing, 1, 7, 0.0, Vec3::Zero())) {
    EXPECT_EQ(track.position, all[track.id - 1].position);
  }
}

TEST(SensingPipeline, KeepsItsRateWithoutDrift) {
  const World world = row_of(1);
  config::Sensing sensing;
  sensing.rate = 30.0;  // no whole number of steps, and no finite binary fraction
  SensingPipeline pipeline(sensing, 1);
  TrackMessage message;
  std::uint64_t received = 0;
  double t = 0.0;
  for (int step = 0; step <= 400'000; ++step) {  // 1000 s at 400 Hz
    t = step / 400.0;
    pipeline.step(t, world, Vec3::Zero());
    while (pipeline.poll(t, message)) {
      ASSERT_EQ(message.sequence, received);
      ASSERT_EQ(message.stamp, static_cast<double>(received) / 30.0);
      ASSERT_LE(message.stamp, t + 1e-9);
      ASSERT_GT(message.stamp, t - 1.0 / 400 - 1e-9);
      ++received;
    }
  }
  EXPECT_EQ(received, 30'001U);
}

TEST(SensingPipeline, DueMeasurementIsNotPutOffByRoundingOfTheCallersClock) {
  const World world = row_of(1);
  SensingPipeline pipeline({}, 1);  // 20 Hz
  TrackMessage message;
  double t = 0.0;
  for (int step = 0; step < 1000; ++step, t += 0.01) {  // the sum is soon below the multiple of 0.05 s
    pipeline.step(t, world, Vec3::Zero());
    EXPECT_EQ(pipeline.poll(t, message), step % 5 == 0) << step;
  }
}

TEST(SensingPipeline, MeasuresAtTheDueTimeNotAtTheStep) {
  const World world = world_of({ball(0.5, {0, 0, 0}, {10, 0, 0})});
  SensingPipeline pipeline({}, 1);
  pipeline.step(0.12, world, Vec3::Zero());
  TrackMessage message;
  for (const double due : {0.0, 0.05, 0.1}) {
    ASSERT_TRUE(pipeline.poll(0.12, message));
    EXPECT_DOUBLE_EQ(message.stamp, due);
    EXPECT_DOUBLE_EQ(message.tracks.at(0).position.x(), 10 * due);
  }
  EXPECT_FALSE(pipeline.poll(0.12, message));
}

TEST(SensingPipeline, HoldsMessagesBackForTheDelayAndKeepsTheirStamp) {
  const World world = world_of({ball(0.5, {0, 0, 0}, {10, 0, 0})});
  config::Sensing sensing;
  sensing.delay = 0.12;  // longer than the period: several are on their way
  SensingPipeline pipeline(sensing, 1);
  TrackMessage message;
  std::vector<int> published_at_step;
  for (int step = 0; step <= 30; ++step) {
    const double t = step * 0.01;
    pipeline.step(t, world, Vec3::Zero());
    while (pipeline.poll(t, message)) {
      EXPECT_DOUBLE_EQ(message.stamp, 0.05 * static_cast<double>(published_at_step.size()));
      EXPECT_DOUBLE_EQ(message.publication, message.stamp + 0.12);
      EXPECT_DOUBLE_EQ(message.tracks.at(0).position.x(), 10 * message.stamp);
      published_at_step.push_back(step);
    }
  }
  EXPECT_EQ(published_at_step, (std::vector<int>{12, 17, 22, 27}));
}

TEST(SensingPipeline, EmptyMessageSaysThatNothingIsSeen) {
  config::Sensing sensing;
  sensing.range = 1.0;
  SensingPipeline pipeline(sensing, 1);
  pipeline.step(0.0, row_of(2), {0, 50, 0});
  TrackMessage message;
  ASSERT_TRUE(pipeline.poll(0.0, message));
  EXPECT_TRUE(message.tracks.empty());
}

TEST(SensingPipeline, ObstaclesStandUntilTheClockStarts) {
  const World world = world_of({ball(0.5, {1, 0, 0}, {10, 0, 0})});
  SensingPipeline pipeline({}, 1);
  TrackMessage message;
  pipeline.step(0.0, world, Vec3::Zero(), planner::base::kInfinity);
  pipeline.step(0.05, world, Vec3::Zero(), planner::base::kInfinity);
  pipeline.step(0.1, world, Vec3::Zero(), 0.08);
  for (const double x : {1.0, 1.0, 1.2}) {
    ASSERT_TRUE(pipeline.poll(0.1, message));
    ASSERT_EQ(message.tracks.size(), 1U);
    EXPECT_NEAR(message.tracks[0].position.x(), x, 1e-12);
    EXPECT_EQ(message.tracks[0].velocity.x(), x > 1.1 ? 10.0 : 0.0);
  }
}

TEST(SensingPipeline, IsTheSameHoweverItIsStepped) {
  const World world = row_of(5);
  config::Sensing sensing;
  sensing.position_noise = 0.1;
  sensing.velocity_noise = 0.1;
  sensing.dropout = 0.2;
  sensing.delay = 0.03;
  SensingPipeline fine(sensing, 9);
  SensingPipeline coarse(sensing, 9);
  for (int step = 0; step <= 1000; ++step) fine.step(step * 0.002, world, Vec3::Zero());
  for (int step = 0; step <= 4; ++step) coarse.step(step * 0.5, world, Vec3::Zero());
  TrackMessage a;
  TrackMessage b;
  int messages = 0;
  while (fine.poll(3.0, a)) {
    ASSERT_TRUE(coarse.poll(3.0, b));
    ++messages;
    EXPECT_EQ(a.stamp, b.stamp);
    ASSERT_EQ(ids_of(a.tracks), ids_of(b.tracks));
    for (std::size_t i = 0; i < a.tracks.size(); ++i) {
      EXPECT_EQ(a.tracks[i].position, b.tracks[i].position);
      EXPECT_EQ(a.tracks[i].velocity, b.tracks[i].velocity);
    }
  }
  EXPECT_EQ(messages, 41);
  EXPECT_FALSE(coarse.poll(3.0, b));
}

}  // namespace
}  // namespace jink::sim::world
