// SPDX-License-Identifier: BSD-3-Clause
#include "planner/waypoint_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/obstacle_motion.hpp"

namespace jink::planner {

double segment_duration(const Vec3& from, const Vec3& to, const VehicleLimits& vehicle) {
  return std::max((to - from).norm() / vehicle.cruise_speed, std::abs(to.z() - from.z()) / vehicle.max_climb);
}

void WaypointProblem::prepare(const Step& step, std::span<const Track> tracks) {
  step_ = step;
  near_.clear();
  virtual_spheres_.clear();
  // The farthest corner of the search box bounds how far and how long the step can go.
  double reach = 0.0;
  double longest = 0.0;
  for (const double u : {step.lower[0], step.upper[0]}) {
    for (const double v : {step.lower[1], step.upper[1]}) {
      reach = std::max(reach, (waypoint(u, v) - step.from).norm());
      longest = std::max(longest, segment_duration(step.from, waypoint(u, v), vehicle_));
    }
  }
  for (const Track& track : tracks) {
    const double moved = longest * (track.velocity.norm() + 0.5 * longest * track.acceleration.norm());
    const double touch = reach + moved + track.radius + vehicle_.radius + settings_.margin;
    // The paper's constraint sees the infinite line, so there every obstacle counts.
    if (settings_.constraint == Constraint::kPaper || (track.position - step.from).norm() <= touch)
      near_.push_back(track);
  }
  find_narrow_passes(tracks);
}

void WaypointProblem::find_narrow_passes(std::span<const Track> tracks) {
  for (std::size_t a = 0; a < tracks.size(); ++a) {
    for (std::size_t b = a + 1; b < tracks.size(); ++b) {
      if (std::abs(tracks[a].position.z() - tracks[b].position.z()) > settings_.narrow_altitude) continue;
      const double gap = (tracks[a].position - tracks[b].position).norm() - tracks[a].radius - tracks[b].radius;
      if (gap >= settings_.narrow_gap) continue;
      Track sphere;
      sphere.position = 0.5 * (tracks[a].position + tracks[b].position);
      sphere.velocity = 0.5 * (tracks[a].velocity + tracks[b].velocity);
      sphere.acceleration = 0.5 * (tracks[a].acceleration + tracks[b].acceleration);
      sphere.radius = 0.5 * vehicle_.length;  // r_v of Eq. (15)
      virtual_spheres_.push_back(sphere);
    }
  }
}

double WaypointProblem::sphere_violation(const Vec3& to, double duration, const Track& sphere, double radius) const {
  double g = 0.0;
  if (settings_.constraint == Constraint::kPaper) {
    g = line_discriminant(step_.from, to, sphere.position, radius);
  } else {
    const Vec3 end = predict_position(sphere, duration);
    // The obstacle's path leaves its chord by at most a·Δt²/8.
    const double bulge = sphere.acceleration.norm() * duration * duration / 8.0;
    g = radius + bulge - std::sqrt(swept_distance_squared(step_.from, to, sphere.position, end));
  }
  return g > 0.0 ? g * g : 0.0;
}

double WaypointProblem::violation(const Vec3& to) const {
  const double duration = segment_duration(step_.from, to, vehicle_);
  double sum = 0.0;
  for (const Track& track : near_) {
    sum += sphere_violation(to, duration, track, track.radius + vehicle_.radius + settings_.margin);
  }
  for (const Track& sphere : virtual_spheres_) sum += sphere_violation(to, duration, sphere, sphere.radius);
  return sum;
}

void WaypointProblem::evaluate(std::span<const double> x, std::span<Cost> costs) const {
  const double steering_limit = settings_.steering_limit_deg * std::numbers::pi / 180.0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const Vec3 to = waypoint(x[2 * i], x[2 * i + 1]);
    const double f1 = (to - step_.from).norm() + (step_.target - to).norm();             // Eq. (2)
    const double f2 = angle_between(step_.direction, to - step_.from) - steering_limit;  // Eq. (3)
    const double penalty = settings_.penalty * violation(to);                            // Eq. (17)
    costs[i] = {{f1 + penalty, f2 + penalty, 0.0}, 0.0};
  }
}

}  // namespace jink::planner
