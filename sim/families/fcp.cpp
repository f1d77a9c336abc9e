// SPDX-License-Identifier: BSD-3-Clause
// The crowded box of FCP-MPC, whose movers are random at every step.
#include <cmath>

#include "sim/families/builders.hpp"
#include "sim/families/families.hpp"

namespace jink::sim::families {
namespace {

constexpr double kTick = 0.1;     // s
constexpr int kTicks = 250;       // of an episode
constexpr double kMover = 0.1;    // m, radius
constexpr double kReached = 0.8;  // m, from the goal
constexpr double kLevel = 0.2;    // of what is random in height, to what is so along
constexpr double kSpread = 0.5;   // m/s, standard deviation of a velocity
constexpr double kNoise = 0.22;   // m/s, likewise, of what a velocity is off by in a step
constexpr double kTurn = 3.0;     // rad, standard deviation of a turn
constexpr double kTurns = 0.95;   // probability at a switch
constexpr double kStands = 0.6;   // likewise, until the next
constexpr double kSlow = 0.3;     // m/s, the least speed of those with a goal
constexpr double kFast = 0.7;     // m/s, the largest
constexpr double kSoon = 1.0;     // s, the least time from switch to switch
constexpr double kLate = 6.0;     // s, the longest

struct Drifter {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();  ///< when it goes, without the noise
  bool stands = false;
  Vec3 goal = Vec3::Zero();  ///< of one that has a speed
  double speed = 0.0;        ///< 0: it wanders
  double next_switch = 0.0;  ///< s
};

/// Normal along each axis, less so in height.
Vec3 random_normal(RandomStream& random, double deviation) {
  const double x = random.normal();
  const double y = random.normal();
  return deviation * Vec3(x, y, kLevel * random.normal());
}

/// On to its goal, or to another once it is there.
void steer(Drifter& drifter, RandomStream& random, const planner::base::Box& room) {
  if ((drifter.goal - drifter.position).norm() < drifter.speed * kTick) drifter.goal = random_point(random, room);
  drifter.velocity = drifter.speed * (drifter.goal - drifter.position).normalized();
}

/// Turns, stands or goes on.
void wander(Drifter& drifter, RandomStream& random, double t) {
  if (t < drifter.next_switch) return;
  drifter.next_switch = t + random.uniform(kSoon, kLate);
  if (random.uniform() < kTurns) {
    const double angle = kTurn * random.normal();
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const Vec3& v = drifter.velocity;
    drifter.velocity = Vec3(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
  }
  drifter.stands = random.uniform() < kStands;
}

/// One step, reflected at the faces of the room.
void advance(Drifter& drifter, RandomStream& random, const planner::base::Box& room) {
  const Vec3 going = drifter.stands ? Vec3(Vec3::Zero()) : drifter.velocity;
  drifter.position += kTick * (going + random_normal(random, kNoise));
  for (int axis = 0; axis < 3; ++axis) {
    double& place = drifter.position[axis];
    if (place >= room.min[axis] && place <= room.max[axis]) continue;
    place = 2.0 * (place < room.min[axis] ? room.min[axis] : room.max[axis]) - place;
    drifter.velocity[axis] = -drifter.velocity[axis];
  }
}

Drifter random_drifter(RandomStream& random, const planner::base::Box& room, bool directed) {
  Drifter drifter;
  drifter.position = random_point(random, room);
  if (directed) {
    drifter.goal = random_point(random, room);
    drifter.speed = random.uniform(kSlow, kFast);
  } else {
    drifter.velocity = random_normal(random, kSpread);
    drifter.next_switch = random.uniform(kSoon, kLate);
  }
  return drifter;
}

config::WaypointsMotion motion_of(Drifter drifter, RandomStream& random, const planner::base::Box& room) {
  config::WaypointsMotion motion{{0.0}, {drifter.position}};
  for (int k = 1; k <= kTicks; ++k) {
    if (drifter.speed > 0.0) {
      steer(drifter, random, room);
    } else {
      wander(drifter, random, kTick * (k - 1));
    }
    advance(drifter, random, room);
    motion.times.push_back(kTick * k);
    motion.points.push_back(drifter.position);
  }
  return motion;
}

}  // namespace

// J. Shin, Y. Ra, I. Yang, "From Prediction Uncertainty to Conformalized Distance Fields for Safe Motion Planning",
// arXiv 2607.00776, 2026, the quadrotor's task: box, start, goal, radii, speeds and the figures above.
// Chosen where the description leaves it open: a switch turns the level velocity by a normal angle; one that stands
// does so until its next switch; the noise is on each step's velocity alone and does not add up; goals and beginnings
// are uniform in the box; who has a goal has no switches; velocities are reflected at the faces. None begins within
// kStartClearance of the vehicle.
// differs: there an episode goes on after a contact. The vehicle's acceleration and jerk are the AR.Drone's.
void build_fcp(config::Scenario& scenario, RandomStream& random, int count) {
  set_limits(scenario, {0.2, 3.0, 0.7, scenario.vehicle.max_acceleration, scenario.vehicle.max_jerk});
  scenario.start = {0, 0, 1};
  scenario.target = {5, 5, 6.4};
  scenario.acceptance_radius = kReached;
  scenario.time_limit = kTicks * kTick;
  scenario.world = planner::base::Box{{-3, -3, 0}, {7, 7, 8}};
  const planner::base::Box room{scenario.world->min.array() + kMover, scenario.world->max.array() - kMover};
  const double clear = kStartClearance + scenario.vehicle.radius + kMover;
  while (static_cast<int>(scenario.obstacles.size()) < count) {
    const bool directed = 2 * static_cast<int>(scenario.obstacles.size()) < count;
    const Drifter drifter = random_drifter(random, room, directed);
    if ((drifter.position - scenario.start).norm() < clear) continue;
    scenario.obstacles.push_back({config::SphereShape{kMover}, motion_of(drifter, random, room)});
  }
}

}  // namespace jink::sim::families
