// SPDX-License-Identifier: BSD-3-Clause
// How near a path comes to the true obstacles: judge.hpp.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "sim/world/world.hpp"
#include "tools/lab/oracle/feasibility.hpp"
#include "tools/lab/oracle/standing.hpp"
#include "tools/lab/oracle/surface_distance.hpp"

namespace jink::tools::lab::oracle {
namespace {

constexpr double kTolerance = 1e-4;  // m

/// A speed that the obstacle does not exceed from `begin` to `end`, at 0 s or later.
struct FastestDuring {
  double begin;
  double end;

  double operator()(const config::LinearMotion& m) const { return m.velocity.norm() + end * m.acceleration.norm(); }
  double operator()(const config::TrefoilMotion& m) const {
    return (m.scale.cwiseProduct(Vec3(5, 5, 3)) / m.slower).norm();  // the derivatives of its sines, added up
  }
  double operator()(const config::SineMotion& m) const {
    return 2.0 * std::numbers::pi * m.amplitude.cwiseProduct(m.frequency_hz).norm();
  }
  double operator()(const config::BounceMotion& m) const { return m.velocity.norm(); }
  double operator()(const config::WaypointsMotion& m) const {
    double fastest = 0.0;
    for (std::size_t i = 1; i < m.points.size(); ++i) {
      if (m.times[i] < begin || m.times[i - 1] > end) continue;
      fastest = std::max(fastest, (m.points[i] - m.points[i - 1]).norm() / (m.times[i] - m.times[i - 1]));
    }
    return fastest;
  }
  double operator()(const config::ChaseMotion& /*m*/) const { return 0.0; }  // it stands where it began
};

/// One straight piece of the path against one obstacle.
class Piece {
 public:
  Piece(const sim::world::World& world, int obstacle, const TimedPoint& from, const TimedPoint& to)
      : world_(world),
        obstacle_(obstacle),
        spec_(world.scenario().obstacles[static_cast<std::size_t>(obstacle)]),
        from_(from),
        to_(to),
        length_((to.position - from.position).norm()) {}

  /// Lowers `nearest` to this piece's smallest distance between the vehicle's centre and the surface.
  void lower(double& nearest) const {
    const planner::geometry::Sphere around = world_.sphere(obstacle_, time_at(0.5));
    const Vec3 middle = 0.5 * (from_.position + to_.position);
    if ((middle - around.center).norm() - around.radius - 0.5 * change(0.0, 1.0) >= nearest) return;
    refine(0.0, distance_at(0.0), 1.0, distance_at(1.0), nearest);
  }

 private:
  [[nodiscard]] double distance_at(double u) const {
    const Vec3 centre = (1.0 - u) * from_.position + u * to_.position;
    const Vec3 relative = centre - world_.obstacle(obstacle_, time_at(u)).position;
    return surface_distance(spec_.shape, sim::world::axes_at(spec_, time_at(u)).transpose() * relative);
  }
  [[nodiscard]] double time_at(double u) const { return (1.0 - u) * from_.t + u * to_.t; }

  /// The most that the distance can change from `u0` to `u1`.
  [[nodiscard]] double change(double u0, double u1) const {
    const double t0 = time_at(u0);
    const double t1 = time_at(u1);
    const double turning = std::abs(spec_.yaw_rate) * sim::world::bounding_sphere(spec_).radius;
    return (u1 - u0) * length_ + (std::visit(FastestDuring{t0, t1}, spec_.motion) + turning) * (t1 - t0);
  }

  // In between, the distance is at least what falling from both ends until they meet gives.
  void refine(double u0, double d0, double u1, double d1, double& nearest) const {
    nearest = std::min({nearest, d0, d1});
    if (0.5 * (d0 + d1 - change(u0, u1)) >= nearest - kTolerance) return;
    const double middle = 0.5 * (u0 + u1);
    const double d = distance_at(middle);
    refine(u0, d0, middle, d, nearest);
    refine(middle, d, u1, d1, nearest);
  }

  const sim::world::World& world_;
  int obstacle_;
  const config::Obstacle& spec_;
  const TimedPoint& from_;
  const TimedPoint& to_;
  double length_;  ///< m
};

}  // namespace

double true_clearance(const config::Scenario& scenario, std::span<const TimedPoint> path) {
  return true_clearance(sim::world::World(with_map_as_obstacles(scenario)), path);
}

double true_clearance(const sim::world::World& world, std::span<const TimedPoint> path) {
  double nearest = planner::base::kInfinity;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const TimedPoint& from = path[i];
    const TimedPoint& to = path[std::min(i + 1, path.size() - 1)];
    for (int obstacle = 0; obstacle < world.obstacle_count(); ++obstacle) {
      Piece(world, obstacle, from, to).lower(nearest);
    }
  }
  return nearest - world.scenario().vehicle.radius;
}

}  // namespace jink::tools::lab::oracle
