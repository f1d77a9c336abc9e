// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/world/shapes.hpp"

namespace jink::sim::world {
namespace {

config::Scenario among(std::vector<config::Obstacle> solids) {
  config::Scenario scenario;
  scenario.start = {0, 0, 1.5};
  scenario.target = {10, 0, 1.5};
  scenario.sensing.scan = config::depth_camera();
  scenario.map = std::move(solids);
  return scenario;
}

const Eigen::Isometry3d kBody(Eigen::Translation3d(0.0, 0.0, 1.5));

/// A ray's end is on the surface, and nothing of the shape is before it.
TEST(RayLength, EndsWhereTheShapeBegins) {
  const config::Shape shapes[] = {config::SphereShape{0.8}, config::BoxShape{{1, 2, 0.5}},
                                  config::CylinderShape{0.5, 2}, config::CapsuleShape{0.3, {-1, 0, 0}, {1, 0.5, 0}},
                                  config::VertexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const config::Shape& shape : shapes) {
    int hits = 0;
    for (int n = 0; n < 300; ++n) {
      const Vec3 from = 3.0 * Vec3(normal(random), normal(random), normal(random)).normalized();
      const Vec3 to = 0.5 * Vec3(normal(random), normal(random), normal(random));
      const Vec3 direction = (to - from).normalized();
      const double length = ray_length(shape, from, direction, 10.0);
      const double nearest = segment_distance(shape, Vec3::Zero(), from, from + 10.0 * direction).distance;
      if (std::isinf(length)) {
        EXPECT_GT(nearest, -1e-6);
        continue;
      }
      ++hits;
      EXPECT_NEAR(distance(shape, Vec3::Zero(), from + length * direction), 0.0, 2e-3);
      EXPECT_GT(segment_distance(shape, Vec3::Zero(), from, from + 0.99 * length * direction).distance, 0.0);
    }
    EXPECT_GT(hits, 50);
  }
}

TEST(RayLength, IsNoneFromWithinAndInfiniteOutOfRange) {
  EXPECT_EQ(ray_length(config::BoxShape{{1, 1, 1}}, {0.1, 0, 0}, Vec3::UnitX(), 5.0), 0.0);
  EXPECT_EQ(ray_length(config::SphereShape{1}, {0.1, 0, 0}, Vec3::UnitX(), 5.0), 0.0);
  EXPECT_TRUE(std::isinf(ray_length(config::BoxShape{{1, 1, 1}}, {-6, 0, 0}, Vec3::UnitX(), 5.0)));
  EXPECT_TRUE(std::isinf(ray_length(config::BoxShape{{1, 1, 1}}, {-6, 0, 0}, -Vec3::UnitX(), 50.0)));
}

TEST(Scan, SeesAWallAheadAndTheGroundAndNothingElse) {
  const World world(among({{config::BoxShape{{0.2, 4, 6}}, config::LinearMotion{{5, 0, 3}}}}));
  const config::Scan camera = config::depth_camera();
  const auto points = scan(world, camera, 1, 0, 0.0, 0.0, kBody);
  ASSERT_EQ(points.size(), 3500U);
  int wall = 0;
  int ground = 0;
  int none = 0;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) {
      ++none;
    } else if (std::abs(point.x() - 4.9F) < 1e-4F && std::abs(point.y()) <= 2.0F) {
      ++wall;
    } else {
      ++ground;
      EXPECT_NEAR(point.z(), -1.5F, 1e-4F);
    }
  }
  EXPECT_GT(wall, 1000);
  EXPECT_GT(ground, 300);
  EXPECT_GT(none, 300);
}

TEST(Scan, TurnsWithTheBodyAndIsNoisyAlongItsRays) {
  const World world(among({{config::BoxShape{{4, 0.2, 6}}, config::LinearMotion{{0, 5, 3}}}}));
  config::Scan camera = config::depth_camera();
  const Eigen::Isometry3d left = kBody * Eigen::AngleAxisd(0.5 * 3.14159265358979, Vec3::UnitZ());
  const auto exact = scan(world, camera, 1, 7, 0.0, 0.0, left);
  camera.noise = 0.05;
  const auto noisy = scan(world, camera, 1, 7, 0.0, 0.0, left);
  const auto again = scan(world, camera, 1, 7, 0.0, 0.0, left);
  double square = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!exact[i].allFinite() || std::abs(exact[i].x() - 4.9F) > 1e-3F) continue;
    ++count;
    EXPECT_EQ(again[i], noisy[i]);
    square += std::pow((noisy[i] - exact[i]).norm(), 2);
    EXPECT_NEAR(noisy[i].normalized().dot(exact[i].normalized()), 1.0, 1e-5);
  }
  EXPECT_GT(count, 500);
  EXPECT_NEAR(std::sqrt(square / count), 0.05, 0.01);
}

TEST(ScanPipeline, KeepsItsRateAndItsDelay) {
  config::Scenario scenario = among({});
  scenario.sensing.delay = 0.1;
  scenario.sensing.scan->rate = 10.0;
  const World world(scenario);
  ScanPipeline pipeline(world, 1, 0);
  int taken = 0;
  ScanMessage message;
  for (int step = 0; step <= 250; ++step) {
    const double t = 0.004 * step;
    pipeline.step(t, kBody);
    while (pipeline.poll(t, message)) {
      EXPECT_NEAR(message.stamp, 0.1 * taken, 1e-9);
      EXPECT_NEAR(message.publication, message.stamp + 0.1, 1e-9);
      ++taken;
    }
  }
  EXPECT_EQ(taken, 10);
}

}  // namespace
}  // namespace jink::sim::world
