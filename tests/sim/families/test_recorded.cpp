// SPDX-License-Identifier: BSD-3-Clause
#include "sim/families/recorded.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <variant>

#include "config/scenario_writer.hpp"
#include "sim/families/families.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

const recorded::Recording& square() {
  static const recorded::Recording recording =
      recorded::load_recording(std::filesystem::path(JINK_SOURCE_DIR) / "config/recordings/square.csv");
  return recording;
}

/// One bird on a straight way at constant velocity, seen for `seen` seconds.
recorded::Recording bird(const Vec3& velocity, double seen) {
  recorded::Mover mover{"bird", {}, {}, 0.5, 0.0};
  for (double t = 100.0; t < 100.0 + seen; t += 1.0) {
    mover.times.push_back(t);
    mover.points.emplace_back(Vec3(1e4, -2e4, 30.0) + t * velocity);
  }
  recorded::Recording recording;
  recording.movers.push_back(mover);
  return recording;
}

TEST(RecordedWorld, IsASquareOfPeople) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const config::Scenario scenario = make_recorded_world(square(), seed);
    EXPECT_EQ(scenario.name, "recorded-" + std::to_string(seed));
    const double length = (scenario.target - scenario.start).norm();
    EXPECT_GE(length, 15.0);
    EXPECT_LE(length, 40.0);
    EXPECT_EQ(scenario.start.z(), scenario.target.z());
    ASSERT_TRUE(scenario.world.has_value());
    EXPECT_EQ(scenario.world->min.z(), 0.0);
    EXPECT_GT(scenario.world->max.z(), 2.6);
    EXPECT_LT(scenario.world->max.z(), 3.4);
    EXPECT_GE(scenario.obstacles.size(), 1U);
    EXPECT_LE(scenario.obstacles.size(), 18U);
    for (const config::Obstacle& obstacle : scenario.obstacles)
      EXPECT_TRUE(std::holds_alternative<config::CylinderShape>(obstacle.shape));
    EXPECT_EQ(config::to_yaml(scenario), config::to_yaml(make_recorded_world(square(), seed)));
  }
  EXPECT_NE(config::to_yaml(make_recorded_world(square(), 1)), config::to_yaml(make_recorded_world(square(), 2)));
}

TEST(RecordedWorld, IsAScenarioFileToo) {
  const auto file = std::filesystem::temp_directory_path() / ("recorded-" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << config::to_yaml(make_recorded_world(square(), 3));
  const config::Scenario again = config::load_scenario(file);
  std::filesystem::remove(file);
  EXPECT_EQ(again.obstacles.size(), make_recorded_world(square(), 3).obstacles.size());
}

// Where it is at t = 0 tells when that is in the recording; from then on it is where the recording has it, before and
// after, too.
TEST(RecordedWorld, MoversDoWhatTheyDidAndGoOnAsTheyDid) {
  const Vec3 velocity(4, 3, -0.1);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const config::Scenario scenario = make_recorded_world(bird(velocity, 4.0), seed);
    EXPECT_FALSE(scenario.world.has_value());
    const world::World world(scenario);
    ASSERT_EQ(world.obstacle_count(), 1);
    EXPECT_EQ(world.sphere(0, 0.0).radius, 0.5);
    for (const double t : {0.5, 3.0, 10.0, 0.99 * scenario.time_limit})
      EXPECT_LT((world.sphere(0, t).center - world.sphere(0, 0.0).center - t * velocity).norm(), 1e-6) << t;
  }
}

TEST(RecordedWorld, WhoIsFarAwayOrLongGoneIsLeftOut) {
  recorded::Recording recording = bird({4, 3, 0}, 4.0);
  recorded::Mover far = recording.movers[0], later = recording.movers[0];
  far.id = "far";
  for (Vec3& point : far.points) point.x() += 800.0;
  later.id = "later";
  for (double& t : later.times) t += 1000.0;
  recording.movers.push_back(far);
  recording.movers.push_back(later);
  for (std::uint64_t seed = 0; seed < 20; ++seed) EXPECT_EQ(make_recorded_world(recording, seed).obstacles.size(), 1U);
}

TEST(RecordedWorld, SaysWhereThereIsNone) {
  recorded::Recording crowd = bird({0, 0, 0}, 4.0);
  crowd.movers[0].radius = 100.0;  // no start is clear of it
  EXPECT_THROW((void)make_recorded_world(crowd, 1), std::runtime_error);
}

}  // namespace
}  // namespace jink::sim::families
