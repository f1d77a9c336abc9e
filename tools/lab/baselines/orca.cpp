// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/orca.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/lab/baselines/path_builder.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr double kShort = 1e-9;         // m, m/s
constexpr double kUnobstructed = 1e-6;  // m/s
constexpr double kToTheRight = 0.1;     // of the wished velocity
constexpr double kSlow = 0.3;           // of it

/// A direction square to the unit vector `axis`: of `wished` where that has one, else level, else north.
Vec3 square_to(const Vec3& axis, const Vec3& wished) {
  for (const Vec3& candidate : {wished, Vec3(Vec3::UnitZ().cross(axis)), Vec3(Vec3::UnitY())}) {
    const Vec3 part = candidate - candidate.dot(axis) * axis;
    if (part.norm() > kShort) return part.normalized();
  }
  return Vec3::UnitX();
}

/// Half-spaces for |vertical speed| and for the flight volume, from whose walls the margin is kept too, or what the
/// target leaves of it.
std::vector<HalfSpace> limits(const planner::horizon::PathRequest& request, double braking) {
  std::vector<HalfSpace> result{{Vec3::UnitZ(), -request.vehicle.max_climb},
                                {-Vec3::UnitZ(), -request.vehicle.max_climb}};
  const auto towards = [&](const Vec3& direction, double distance, double of_target) {
    if (!std::isfinite(distance)) return;
    const double left = std::max(0.0, distance - std::clamp(of_target, 0.0, request.margin));
    result.push_back({-direction, -std::min(std::sqrt(2.0 * braking * left), left / kCatchUp)});
  };
  const planner::base::Box& volume = request.volume;
  for (int axis = 0; axis < 3; ++axis) {
    towards(Vec3::Unit(axis), volume.max[axis] - request.position[axis], volume.max[axis] - request.target[axis]);
    towards(-Vec3::Unit(axis), request.position[axis] - volume.min[axis], request.target[axis] - volume.min[axis]);
  }
  return result;
}

/// Spheres as they are; of a body the part that is nearest now, and those that would be nearest or entered at the
/// present velocities up to `time`: each is a sphere within what is to be kept clear of.
std::vector<planner::base::Track> in_parts(const std::vector<planner::base::Track>& obstacles,
                                           const planner::horizon::PathRequest& request, double time) {
  constexpr int kLooks = 4;
  std::vector<planner::base::Track> parts;
  for (const planner::base::Track& obstacle : obstacles) {
    if (!obstacle.body.solid) {
      parts.push_back(obstacle);
      continue;
    }
    for (int look = 0; look < kLooks; ++look) {
      const double t = time * look / (kLooks - 1);
      const Vec3 place = request.position + t * (request.velocity - obstacle.velocity);
      parts.push_back(nearest_part(obstacle, place));
      if (look > 0 && body_distance(obstacle, obstacle.position, 0.0, place) < 0.0) parts.back().position = place;
    }
  }
  return parts;
}

}  // namespace

HalfSpace orca_half_space(const Vec3& offset, double radius, const Vec3& velocity, const Vec3& other, double time,
                          double contact_time) {
  const double distance = offset.norm();
  const Vec3 relative = velocity - other;
  const bool overlap = distance <= radius;
  // The velocity obstacle is a cone along `offset` that begins with the ball of the velocities of contact at `time`.
  const double tau = overlap ? contact_time : time;
  const Vec3 from_ball = relative - offset / tau;
  const Vec3 axis = distance > kShort ? Vec3(offset / distance) : Vec3::UnitX();
  const Vec3 aside = square_to(axis, relative);
  const double sine = overlap ? 1.0 : radius / distance;
  const double cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
  const Vec3 leg = cosine * axis + sine * aside;
  HalfSpace result;
  double depth = 0.0;  // of the relative velocity in the velocity obstacle: the length of u
  if (overlap || from_ball.dot(leg) < 0.0) {
    const double length = from_ball.norm();
    result.normal = length > kShort ? Vec3(from_ball / length) : Vec3(-axis);
    depth = radius / tau - length;
  } else {
    result.normal = cosine * aside - sine * axis;
    depth = -relative.dot(result.normal);
  }
  result.offset = result.normal.dot(velocity + depth * result.normal);
  return result;
}

planner::verify::Plan OrcaPilot::plan(const bridge::companion::PlanJob& job) {
  const planner::horizon::PathRequest& request = job.request;
  const double normal = normal_acceleration(request, settings_);
  const Vec3 wished = unobstructed_velocity(request, settings_.braking, request.position);

  std::vector<HalfSpace> half_spaces;
  bool urgent = false;
  for (const planner::base::Track& sphere :
       in_parts(inflated_obstacles(request, settings_), request, orca_.time_horizon)) {
    const Vec3 offset = sphere.position - request.position;
    const double closing = request.vehicle.max_speed + sphere.velocity.norm();
    if (offset.norm() - sphere.radius > closing * orca_.time_horizon) continue;
    half_spaces.push_back(orca_half_space(offset, sphere.radius, request.velocity, sphere.velocity, orca_.time_horizon,
                                          orca_.contact_time));
    urgent = urgent || half_spaces.back().normal.dot(request.velocity) < half_spaces.back().offset;
  }
  const std::vector<HalfSpace> hard = limits(request, std::min(settings_.braking, normal));
  const auto nearest_to = [&](const Vec3& velocity) {
    return least_violating_velocity(hard, half_spaces, request.vehicle.max_speed, velocity);
  };
  Vec3 chosen = nearest_to(wished);
  // Exactly head on, ORCA only slows down: what nearly stands keeps to the right.
  if ((chosen - wished).norm() >= kUnobstructed && chosen.norm() < kSlow * wished.norm())
    chosen = nearest_to(wished + kToTheRight * wished.cross(Vec3::UnitZ()));

  PathBuilder motion(request, settings_, urgent ? hardest_acceleration(request, settings_) : normal);
  if ((chosen - wished).norm() < kUnobstructed) {
    motion.fly_to_target();
  } else {
    while (motion.t() < orca_.time_horizon) motion.steer(chosen);
    motion.stop();
  }
  return verified_plan(motion.path(), request, settings_.time);
}

}  // namespace jink::tools::lab::baselines
