// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "config/solids.hpp"
#include "sim/world/shapes.hpp"

namespace jink::sim::world {
namespace {

/// The vehicle's constant velocity during a sweep. `u` runs from 0 at its beginning to 1 at its end.
struct Way {
  Vec3 p0;
  Vec3 p1;
  double t0 = 0.0;
  double t1 = 0.0;

  // At 0 and 1 these give the ends exactly, so that the end of one sweep is the beginning of the next.
  [[nodiscard]] Vec3 position(double u) const { return (1.0 - u) * p0 + u * p1; }
  [[nodiscard]] double time(double u) const { return (1.0 - u) * t0 + u * t1; }
};

/// A place on the way, and where the vehicle is from the obstacle's reference point there, along the obstacle's axes.
struct Place {
  double u = 0.0;
  Vec3 relative = Vec3::Zero();
};

/// The search for the smallest distance between one obstacle and the vehicle's centre: branch and bound over the way.
class Search {
 public:
  Search(const config::Obstacle& obstacle, const Way& way)
      : obstacle_(obstacle), way_(way), floor_(deepest(obstacle.shape)) {}

  /// Lowers `distance` to the minimum, to within the tolerance, if that is lower; `t` is then its time.
  /// Returns whether it did.
  bool lower(double& distance, double& t) {
    best_ = distance;
    refine(place(0.0), place(1.0));
    if (!(best_ < distance)) return false;
    distance = best_;
    t = best_t_;
    return true;
  }

 private:
  [[nodiscard]] Place place(double u) const {
    const double t = way_.time(u);
    return {u, axes_at(obstacle_, t).transpose() * (way_.position(u) - state_at(obstacle_.motion, t).position)};
  }

  /// Each level halves the interval, so the depth is at most that of a double's bits.
  void refine(const Place& from, const Place& to) {
    const SegmentDistance chord = segment_distance(obstacle_.shape, Vec3::Zero(), from.relative, to.relative);
    const double u = from.u + chord.fraction * (to.u - from.u);
    const double reached = world::distance(obstacle_.shape, Vec3::Zero(), place(u).relative);
    if (reached < best_) {
      best_ = reached;
      best_t_ = way_.time(u);
    }
    // Distance changes by no more than its point moves, so along the true motion it is no less than along the chord
    // minus the deviation from the chord.
    const double t0 = way_.time(from.u);
    const double t1 = way_.time(to.u);
    const double deviation =
        chord_deviation(obstacle_.motion, t0, t1) + turn_deviation(from.relative, to.relative, t0, t1);
    const double bound = std::max(chord.distance - deviation, floor_);
    if (!(bound < best_ - World::kSweepTolerance)) return;
    const double half = 0.5 * (from.u + to.u);
    if (half <= from.u || half >= to.u) return;
    const Place middle = place(half);
    refine(from, middle);
    refine(middle, to);
  }

  /// How far straight relative motion strays from its chord in axes that turn: an eighth of the square of the time by
  /// its acceleration there, twice the rate times the speed and the square of the rate times the distance. What motion
  /// strays from a chord is no longer in turning axes.
  [[nodiscard]] double turn_deviation(const Vec3& from, const Vec3& to, double t0, double t1) const {
    if (obstacle_.yaw_rate == 0.0 || t1 <= 0.0) return 0.0;
    const double turned = std::abs(obstacle_.yaw_rate) * (t1 - t0);
    const double far = std::max(from.norm(), to.norm());
    // The chord in ENU is as long as from one to the other, turned by as much.
    const double moved = (to - from).norm() + turned * far;
    const double turning = (2.0 * moved * turned + turned * turned * far) / 8.0;
    // One that begins to turn in between does so suddenly.
    return t0 < 0.0 ? turned * far + turning : turning;
  }

  const config::Obstacle& obstacle_;
  const Way& way_;
  double floor_;
  double best_ = planner::base::kInfinity;
  double best_t_ = 0.0;
};

/// A lower bound of the distance from the obstacle to the vehicle's centre, for one evaluation of the motion at each
/// end.
double quick_bound(const config::Obstacle& obstacle, const Sphere& bound, const Way& way) {
  const Vec3 from = way.p0 - state_at(obstacle.motion, way.t0).position;
  const Vec3 to = way.p1 - state_at(obstacle.motion, way.t1).position;
  const double chord = segment_distance(config::SphereShape{bound.radius}, bound.center, from, to).distance;
  return chord - chord_deviation(obstacle.motion, way.t0, way.t1);
}

}  // namespace

SweepResult sweep(const SphereSegment& a, const SphereSegment& b, double t0, double t1) {
  const Vec3 from = a.from - b.from;
  const Vec3 change = (a.to - b.to) - from;
  const double square = change.squaredNorm();
  const double u = square > 0.0 ? std::clamp(-from.dot(change) / square, 0.0, 1.0) : 0.0;
  return {(from + u * change).norm() - a.radius - b.radius, t0 + u * (t1 - t0), -1};
}

World::World(config::Scenario scenario) : scenario_(std::move(scenario)) {
  for (std::size_t i = 0; i < scenario_.obstacles.size(); ++i) {
    config::Motion& motion = scenario_.obstacles[i].motion;
    const auto* chase = std::get_if<config::ChaseMotion>(&motion);
    if (chase == nullptr) continue;
    chasers_.push_back({i, chase->speed});
    motion = config::WaypointsMotion{{0.0}, {chase->position}};
  }
  bounds_.reserve(scenario_.obstacles.size());
  for (const config::Obstacle& obstacle : scenario_.obstacles) {
    bounds_.push_back(bounding_sphere(obstacle));
    solids_.push_back(solid_of(obstacle, bounds_.back().center));
  }
  for (const config::Obstacle& solid : scenario_.map) bounds_.push_back(bounding_sphere(solid));
  map_ = config::make_map(scenario_.map);
}

void World::advance(double t, std::span<const VehicleTruth> vehicles) {
  for (const Chaser& chaser : chasers_) {
    auto& way = std::get<config::WaypointsMotion>(scenario_.obstacles[chaser.obstacle].motion);
    while (way.times.back() <= t) {
      const Vec3 from = way.points.back();
      const auto distance = [&](const VehicleTruth& vehicle) { return (vehicle.position - from).norm(); };
      const auto nearest = std::min_element(vehicles.begin(), vehicles.end(),
                                            [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
      const Vec3 to = vehicles.empty() ? from : nearest->position;
      const double left = (to - from).norm();
      const double begin = way.times.back();
      const double end = begin + kChaseLeg;
      const double there = left > 0.0 ? begin + left / chaser.speed : begin;
      if (there > begin && there < end) {  // where it stands for the rest
        way.times.push_back(there);
        way.points.push_back(to);
      }
      way.times.push_back(end);
      way.points.push_back(there > end ? Vec3(from + chaser.speed * kChaseLeg / left * (to - from)) : to);
    }
  }
}

std::string World::name(int i) const {
  return i < obstacle_count() ? "obstacle " + std::to_string(id(i))
                              : "map solid " + std::to_string(id(i - obstacle_count()));
}

double World::distance(int i, const Vec3& p, double t) const {
  return world::distance(spec(i).shape, Vec3::Zero(), axes_at(spec(i), t).transpose() * (p - obstacle(i, t).position));
}

ObstacleState World::obstacle(int i, double t) const {
  return state_at(spec(i).motion, t);
}

planner::geometry::Sphere World::sphere(int i, double t) const {
  return {obstacle(i, t).position + bound(i).center, bound(i).radius};
}

planner::base::Track World::exact_track(int i, double t) const {
  const ObstacleState state = obstacle(i, t);
  planner::base::Track track;
  track.id = id(i);
  track.position = state.position + bound(i).center;
  track.velocity = state.velocity;
  track.acceleration = state.acceleration;
  track.radius = bound(i).radius;
  if (const auto& solid = solids_[static_cast<std::size_t>(i)]) {
    const double rate = spec(i).yaw_rate;
    track.body = {solid, std::remainder(rate * std::max(t, 0.0), 2.0 * std::numbers::pi), t < 0.0 ? 0.0 : rate};
  }
  return track;
}

double World::clearance(const Vec3& p, double t, double radius) const {
  double nearest = planner::base::kInfinity;
  for (int i = 0; i < obstacle_count(); ++i) {
    const Vec3 reference = obstacle(i, t).position;
    // The shape is inside its sphere, so where the sphere is farther than the nearest so far, the shape is too.
    if ((p - reference - bound(i).center).norm() - bound(i).radius >= nearest) continue;
    nearest = std::min(nearest, distance(i, p, t));
  }
  map_->visit({p, p}, nearest, [&](std::size_t solid) {
    nearest = std::min(nearest, distance(obstacle_count() + static_cast<int>(solid), p, t));
    return nearest;
  });
  return nearest - radius;
}

SweepResult World::sweep(const Vec3& p0, double t0, const Vec3& p1, double t1, double radius) const {
  assert(t0 <= t1 && p0.allFinite() && p1.allFinite());
  const Way way{p0, p1, t0, t1};
  SweepResult result{planner::base::kInfinity, t0, -1};
  double nearest = planner::base::kInfinity;
  const auto consider = [&](int i) {
    if (quick_bound(spec(i), bound(i), way) >= nearest) return;
    if (Search(spec(i), way).lower(nearest, result.t_min)) result.obstacle = i;
  };
  for (int i = 0; i < obstacle_count(); ++i) consider(i);
  map_->visit({p0.cwiseMin(p1), p0.cwiseMax(p1)}, nearest, [&](std::size_t solid) {
    consider(obstacle_count() + static_cast<int>(solid));
    return nearest;
  });
  result.min_clearance = nearest - radius;
  return result;
}

}  // namespace jink::sim::world
