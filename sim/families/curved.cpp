// SPDX-License-Identifier: BSD-3-Clause
// The families whose obstacles bounce, swing or wait.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "planner/base/portable_math.hpp"
#include "sim/families/builders.hpp"
#include "sim/families/families.hpp"
#include "sim/world/obstacle_models.hpp"

namespace jink::sim::families {
namespace {

/// Bouncing in `box` such that it is at `place` at time `t`: the motion back from there, turned round.
config::BounceMotion bounce_through(const Vec3& place, const Vec3& velocity, double t, const planner::base::Box& box) {
  const world::ObstacleState before = world::state_at(config::BounceMotion{place, -velocity, box.min, box.max}, t);
  return {before.position, -before.velocity, box.min, box.max};
}

struct Swarm {
  int count;
  double min_radius;
  double max_radius;
  double min_speed;
  double max_speed;
};

/// Spheres that bounce off the walls of the world. Three of them are timed to meet the straight flight; none starts
/// near the vehicle.
void add_bouncing(config::Scenario& scenario, RandomStream& random, const Swarm& swarm) {
  constexpr int kMeeting = 3;
  const Mission mission = mission_of(scenario);
  for (int i = 0; i < swarm.count;) {
    const double radius = random.uniform(swarm.min_radius, swarm.max_radius);
    const planner::base::Box box{scenario.world->min.array() + radius, scenario.world->max.array() - radius};
    const Vec3 velocity = random_vector(random, {swarm.min_speed, swarm.max_speed, -60, 60});
    config::BounceMotion motion{random_point(random, box), velocity, box.min, box.max};
    if (i < kMeeting) {
      const double along = mission.random_place(random);
      const Vec3 place = (mission.at(along) + random_offset(random, radius)).cwiseMax(box.min).cwiseMin(box.max);
      motion = bounce_through(place, velocity, mission.time_at(along), box);
    }
    // The reflections may leave the position a rounding error outside.
    motion.position = motion.position.cwiseMax(box.min).cwiseMin(box.max);
    const double clear = (motion.position - scenario.start).norm() - radius - scenario.vehicle.radius;
    if (clear < kStartClearance) continue;
    scenario.obstacles.push_back({config::SphereShape{radius}, motion});
    ++i;
  }
}

/// A wall across the corridor, and the hole in it, which moves to and fro with the wall.
struct Wall {
  double along = 0.0;
  double half_width = 0.0;   ///< of the corridor
  double height = 0.0;       ///< of the corridor
  double hole_y = 0.0;       ///< across, from the corridor's middle, in the middle of the motion
  double hole_z = 0.0;       ///< above the floor
  double hole_radius = 0.0;  ///< free of the spheres' surfaces
  double amplitude = 0.0;    ///< of the motion across
  double speed = 0.0;        ///< the fastest of it
  double phase = 0.0;        ///< rad
  bool bounces = false;      ///< or swings
};

constexpr double kWallSphere = 0.5;    // m, radius
constexpr double kWallSpacing = 0.85;  // m; the vehicle's sphere does not pass between four of them

/// The motion of the wall's sphere that is at `center` in the middle of it; `across` is a unit vector along an axis.
config::Motion wall_motion(const Wall& wall, const Vec3& center, const Vec3& across) {
  if (!wall.bounces) {
    const double frequency = wall.speed / (kTwoPi * wall.amplitude);
    return config::SineMotion{center, wall.amplitude * across, frequency * across.cwiseAbs(), wall.phase * across};
  }
  const Vec3 one = center - wall.amplitude * across;
  const Vec3 other = center + wall.amplitude * across;
  const Vec3 position = center + wall.amplitude * std::sin(wall.phase) * across;
  return config::BounceMotion{position, wall.speed * across, one.cwiseMin(other), one.cwiseMax(other)};
}

void add_wall(config::Scenario& scenario, const Wall& wall) {
  const planner::base::Box& box = *scenario.world;
  const Vec3 along = (scenario.target - scenario.start).normalized().cwiseAbs();  // an axis
  const Vec3 across(along.y(), along.x(), 0.0);
  const Vec3 foot = scenario.start.cwiseProduct(along) + wall.along * (scenario.target - scenario.start).normalized();
  const double reach = wall.half_width + wall.amplitude;
  const int columns = static_cast<int>(std::ceil(2.0 * reach / kWallSpacing)) + 1;
  const int rows = static_cast<int>(std::ceil((wall.height - 0.3) / kWallSpacing)) + 1;
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const double y = -reach + 2.0 * reach * column / (columns - 1);
      const double z = 0.15 + (wall.height - 0.3) * row / (rows - 1);
      if (planner::base::hypotenuse(y - wall.hole_y, z - wall.hole_z) < wall.hole_radius + kWallSphere) continue;
      const Vec3 center = foot + y * across + (box.min.z() + z) * Vec3::UnitZ();
      scenario.obstacles.push_back({config::SphereShape{kWallSphere}, wall_motion(wall, center, across)});
    }
  }
}

}  // namespace

void build_walls(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(18, 32);
  const double width = random.uniform(7, 10);
  const double height = random.uniform(4, 6);
  corridor_mission(scenario, random, length, width, height);
  const int count = random_count(random, 1, 3);
  for (int i = 0; i < count; ++i) {
    Wall wall;
    wall.along = (length - 2.0) * (i + random.uniform(0.45, 0.75)) / count;
    wall.half_width = 0.5 * width;
    wall.height = height;
    wall.hole_radius = random.uniform(0.8, 1.2);
    wall.amplitude = random.uniform(0.5, 1.8);
    const double room = std::max(0.0, wall.half_width - wall.amplitude - wall.hole_radius);
    wall.hole_y = random.uniform(-room, room);
    wall.hole_z = random.uniform(wall.hole_radius, height - wall.hole_radius);
    wall.speed = random.uniform(0.3, 1.6);
    wall.phase = random.uniform(-std::numbers::pi, std::numbers::pi);
    wall.bounces = random.below(2) == 0;
    add_wall(scenario, wall);
  }
}

// Others cross the way; one of them passes where the vehicle might wait.
void build_target_occupied(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 15, 25);
  const Mission mission = mission_of(scenario);
  const double radius = random.uniform(0.4, 1.2);
  const double leaves = mission.duration() + random.uniform(2, 15);
  const Vec3 place = scenario.target + random_offset(random, radius);
  const Vec3 way = random_vector(random, {6, 12, -10, 60});
  const config::WaypointsMotion waits{{leaves, leaves + way.norm() / random.uniform(0.8, 3)}, {place, place + way}};
  scenario.obstacles.push_back({config::SphereShape{radius}, waits});
  const int count = random_count(random, 1, 6);
  for (int i = 0; i < count; ++i) {
    const double size = random.uniform(0.3, 0.7);
    const Vec3 velocity = random_vector(random, {0.4, 2.5, -20, 20});
    const double t =
        i == 0 ? random.uniform(mission.duration(), leaves) : mission.time_at(mission.random_place(random));
    const Vec3 met = mission.at(std::min(mission.along(t), mission.length() - random.uniform(2, 4)));
    scenario.obstacles.push_back({config::SphereShape{size}, config::LinearMotion{met - t * velocity, velocity}});
  }
}

void build_crowd(config::Scenario& scenario, RandomStream& random) {
  corridor_mission(scenario, random, 30, 6, 3);
  add_bouncing(scenario, random, {80, 0.12, random.uniform(0.2, 0.35), 0.2, random.uniform(0.5, 2.0)});
}

void build_cloud(config::Scenario& scenario, RandomStream& random) {
  const Vec3 size{random.uniform(22, 32), random.uniform(10, 14), random.uniform(6, 9)};
  corridor_mission(scenario, random, size.x(), size.y(), size.z());
  add_bouncing(scenario, random, {60, 0.2, random.uniform(0.5, 1.0), 0.3, random.uniform(0.8, 3.5)});
}

// Swings to and fro across the line. Those of the first half are at the line when the straight flight is.
void build_turning(config::Scenario& scenario, RandomStream& random) {
  free_mission(scenario, random, 18, 35);
  const Mission mission = mission_of(scenario);
  const int count = random_count(random, 5, 16);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.3, 0.8);
    const double along = mission.random_place(random, 0.1, 1.0);
    const double steep = random.uniform(-0.6, 0.6);
    const double oblique = random.uniform(-0.6, 0.6);
    const Vec3 direction = (mission.left() + steep * mission.up() + oblique * mission.forward()).normalized();
    const double amplitude = random.uniform(1.2, 3.5);
    const double frequency = random.uniform(0.8, 3.0) / (kTwoPi * amplitude);
    const double phase = random.uniform(-std::numbers::pi, std::numbers::pi);
    Vec3 center = mission.at(along) + random_offset(random, radius);
    if (2 * i < count) center -= amplitude * std::sin(kTwoPi * frequency * mission.time_at(along) + phase) * direction;
    scenario.obstacles.push_back(
        {config::SphereShape{radius},
         config::SineMotion{center, amplitude * direction, Vec3::Constant(frequency), Vec3::Constant(phase)}});
  }
}

}  // namespace jink::sim::families
