// SPDX-License-Identifier: BSD-3-Clause
// Seeded random motions and shapes for the property tests of sim's world.
#pragma once

#include <cstdint>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/random.hpp"

namespace jink::sim::testing {

using planner::base::RandomStream;

inline constexpr std::uint64_t kMotionKinds = 5;
inline constexpr std::uint64_t kShapeKinds = 5;

inline Vec3 random_vector(RandomStream& random, double lo, double hi) {
  const double x = random.uniform(lo, hi);
  const double y = random.uniform(lo, hi);
  const double z = random.uniform(lo, hi);
  return {x, y, z};
}

/// Of the kind `kind` (index in config::Motion), within some ten metres of the origin for some ten seconds.
inline config::Motion random_motion(RandomStream& random, std::uint64_t kind) {
  switch (kind) {
    case 0:
      return config::LinearMotion{random_vector(random, -5, 5), random_vector(random, -3, 3),
                                  random_vector(random, -1, 1)};
    case 1:
      return config::TrefoilMotion{random_vector(random, -3, 3), random_vector(random, -2, 2), random.uniform(0.5, 4.0),
                                   random.uniform(-3, 3)};
    case 2:
      return config::SineMotion{random_vector(random, -3, 3), random_vector(random, -3, 3),
                                random_vector(random, 0, 0.6), random_vector(random, -3, 3)};
    case 3: {
      config::BounceMotion motion;
      motion.min = random_vector(random, -6, -1);
      motion.max = random_vector(random, 1, 6);
      motion.position = random_vector(random, -1, 1);
      motion.velocity = random_vector(random, -8, 8);
      return motion;
    }
    default: {
      config::WaypointsMotion motion;
      double t = random.uniform(0, 2);
      const std::uint64_t count = 1 + random.below(6);
      for (std::uint64_t i = 0; i < count; ++i) {
        motion.times.push_back(t);
        motion.points.push_back(random_vector(random, -5, 5));
        t += random.uniform(0.05, 3);
      }
      return motion;
    }
  }
}

/// Of the kind `kind` (index in config::Shape), about a metre in size.
inline config::Shape random_shape(RandomStream& random, std::uint64_t kind) {
  if (kind == 0) return config::SphereShape{random.uniform(0.05, 1.5)};
  if (kind == 1) return config::BoxShape{random_vector(random, 0.05, 2)};
  if (kind == 2) return config::CylinderShape{random.uniform(0.05, 1), random.uniform(0.05, 3)};
  if (kind == 3) {
    return config::CapsuleShape{random.uniform(0.05, 1), random_vector(random, -1, 1), random_vector(random, -1, 1)};
  }
  config::VertexShape shape;
  const std::uint64_t count = 1 + random.below(12);
  for (std::uint64_t i = 0; i < count; ++i) shape.vertices.push_back(random_vector(random, -1, 1));
  return shape;
}

/// Half of them turned somehow, half of these turning.
inline config::Obstacle random_obstacle(RandomStream& random, const config::Shape& shape,
                                        const config::Motion& motion) {
  config::Obstacle obstacle{shape, motion};
  const std::uint64_t turned = random.below(4);
  if (turned > 1) obstacle.orientation = random_vector(random, -3, 3);
  if (turned > 2) obstacle.yaw_rate = random.uniform(-4, 4);
  return obstacle;
}

}  // namespace jink::sim::testing
