// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/bench/moving_world.hpp"

#include <algorithm>
#include <numbers>
#include <utility>
#include <variant>

#include "planner/base/random.hpp"
#include "sim/world/shapes.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr double kLeastRadius = 0.3;  // m
constexpr double kLargestRadius = 0.6;
constexpr double kLargestSpeed = 3.0;     // m/s
constexpr double kLeastEdge = 0.5;        // m
constexpr double kLargestEdge = 4.0;      // m
constexpr double kLeastStanding = 0.4;    // m
constexpr double kLargestStanding = 1.2;  // m
constexpr double kFastestTurn = 0.5;      // rad/s
constexpr double kStartClearance = 3.0;

Vec3 uniform(const Vec3& min, const Vec3& max, planner::base::RandomStream& random) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = random.uniform(min[k], max[k]);
  return p;
}

Vec3 direction(planner::base::RandomStream& random) {
  Vec3 d;
  for (int k = 0; k < 3; ++k) d[k] = random.normal();
  return d.normalized();
}

config::Scenario scenario_of(const MovingWorldShape& shape, std::uint64_t seed) {
  config::Scenario scenario;
  const Vec3 half = 0.5 * shape.size;
  const Vec3 centre(0.0, 0.0, half.z());
  scenario.name = "moving world";
  scenario.world = planner::base::Box{centre - half, centre + half};
  scenario.start = centre - Vec3(0.5 * shape.mission, 0.0, 0.0);
  scenario.target = centre + Vec3(0.5 * shape.mission, 0.0, 0.0);
  planner::base::RandomStream random(seed);
  while (scenario.obstacles.size() < static_cast<std::size_t>(shape.obstacles)) {
    config::Obstacle obstacle{config::SphereShape{random.uniform(kLeastRadius, kLargestRadius)}, {}};
    if (shape.boxes) {
      obstacle.shape = config::BoxShape{uniform(Vec3::Constant(kLeastEdge), Vec3::Constant(kLargestEdge), random)};
      obstacle.orientation = uniform(Vec3::Constant(-std::numbers::pi), Vec3::Constant(std::numbers::pi), random);
      obstacle.yaw_rate = random.uniform(-kFastestTurn, kFastestTurn);
    }
    const double radius = sim::world::bounding_sphere(obstacle).radius;
    config::BounceMotion motion;
    motion.min = scenario.world->min + Vec3::Constant(radius);
    motion.max = scenario.world->max - Vec3::Constant(radius);
    motion.position = uniform(motion.min, motion.max, random);
    motion.velocity = random.uniform(0.0, kLargestSpeed) * direction(random);
    if ((motion.position - scenario.start).norm() < kStartClearance) continue;
    obstacle.motion = motion;
    scenario.obstacles.push_back(obstacle);
  }
  while (scenario.map.size() < static_cast<std::size_t>(shape.standing)) {
    config::Obstacle box{
        config::BoxShape{uniform(Vec3::Constant(kLeastStanding), Vec3::Constant(kLargestStanding), random)},
        config::LinearMotion{uniform(scenario.world->min, scenario.world->max, random)}};
    const Vec3& place = std::get<config::LinearMotion>(box.motion).position;
    if (std::min((place - scenario.start).norm(), (place - scenario.target).norm()) < kStartClearance) continue;
    scenario.map.push_back(std::move(box));
  }
  return scenario;
}

}  // namespace

MovingWorld::MovingWorld(const MovingWorldShape& shape, std::uint64_t seed) : world_(scenario_of(shape, seed)) {}

std::vector<planner::base::Track> MovingWorld::tracks(double t) const {
  std::vector<planner::base::Track> tracks;
  tracks.reserve(static_cast<std::size_t>(world_.obstacle_count()));
  for (int i = 0; i < world_.obstacle_count(); ++i) tracks.push_back(world_.exact_track(i, t));
  return tracks;
}

planner::horizon::PathRequest MovingWorld::request(const planner::base::HorizonSettings& settings) const {
  auto request = planner::horizon::PathRequest::with(settings);
  request.position = world_.scenario().start;
  request.target = world_.scenario().target;
  request.volume = world_.volume();
  request.vehicle = world_.scenario().vehicle;
  return request;
}

}  // namespace jink::tools::lab::bench
