// SPDX-License-Identifier: BSD-3-Clause
// What no vehicle can reach: certainly_impossible() of judge.hpp.
#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "sim/world/world.hpp"
#include "tools/lab/oracle/cells.hpp"
#include "tools/lab/oracle/feasibility.hpp"
#include "tools/lab/oracle/standing.hpp"
#include "tools/lab/oracle/surface_distance.hpp"

namespace jink::tools::lab::oracle {
namespace {

constexpr double kReachStep = 0.05;  // s
constexpr double kRoundUp = 1.001;   // by which a cell is longer than the way of a step

/// What an obstacle that is no sphere blocks while it stands.
struct Blocked {
  bool known = false;
  Vec3 reference = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  std::vector<Index> cells;
};

class Reachability {
 public:
  explicit Reachability(const config::Scenario& scenario)
      : world_(with_map_as_obstacles(scenario)),
        cell_(kReachStep * kRoundUp *
              Vec3(scenario.vehicle.max_speed, scenario.vehicle.max_speed, scenario.vehicle.max_climb)),
        open_(!scenario.world),
        box_(box_of(scenario)),
        count_(((box_.max - box_.min).array() / cell_.array()).floor().cast<int>() + 1),
        reached_(count_.x(), count_.y(), count_.z()),
        blocked_(world_.scenario().obstacles.size()) {}

  /// Whether a cell within `acceptance` of the target is ever reached.
  bool reaches(double acceptance) {
    const config::Scenario& scenario = world_.scenario();
    if (world_.clearance(scenario.start, 0.0) < 0.0) return false;
    const Index start = cell_of(scenario.start);
    reached_.add(start.x(), start.y(), start.z());
    for (int step = 0; step * kReachStep <= scenario.time_limit; ++step) {
      if (open_) reached_.add_faces();
      for (int i = 0; i < world_.obstacle_count(); ++i) remove_blocked(i, step * kReachStep);
      if (reached_near(scenario.target, acceptance)) return true;
      reached_.grow();
    }
    return false;
  }

 private:
  static planner::base::Box box_of(const config::Scenario& scenario) {
    if (scenario.world) return *scenario.world;
    return {scenario.start.cwiseMin(scenario.target).array() - kAround,
            scenario.start.cwiseMax(scenario.target).array() + kAround};
  }

  [[nodiscard]] Index cell_of(const Vec3& p) const {
    const Eigen::Array3d place = (p - box_.min).array() / cell_.array();
    // Far away is as good as just outside, and fits an int.
    return place.max(-1.0).min(count_.cast<double>()).floor().cast<int>();
  }
  [[nodiscard]] Index first_of(const Vec3& p) const { return cell_of(p).max(0); }
  [[nodiscard]] Index last_of(const Vec3& p) const { return cell_of(p).min(count_ - 1); }
  [[nodiscard]] Vec3 low_corner(int x, int y, int z) const { return box_.min + cell_.cwiseProduct(Vec3(x, y, z)); }

  /// Calls `visit` for each cell of the grid that has a part in the box from `low` to `high`.
  template <typename Visit>
  void for_cells(const Vec3& low, const Vec3& high, const Visit& visit) const {
    const Index first = first_of(low);
    const Index last = last_of(high);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) visit(x, y, z);
      }
    }
  }

  /// Removes the cells in all of which the vehicle's centre is too near to obstacle `i` at time `t`.
  void remove_blocked(int i, double t) {
    const config::Shape& shape = world_.scenario().obstacles[static_cast<std::size_t>(i)].shape;
    if (!std::holds_alternative<config::SphereShape>(shape)) {
      for (const Index& cell : blocked_by(i, t)) reached_.remove(cell.x(), cell.y(), cell.z());
      return;
    }
    const planner::geometry::Sphere ball = too_near(i, t);
    const Vec3 reach = Vec3::Constant(ball.radius);
    for_cells(ball.center - reach, ball.center + reach, [&](int x, int y, int z) {
      if (reached_.test(x, y, z) && in_ball(low_corner(x, y, z), ball)) reached_.remove(x, y, z);
    });
  }

  /// The same cells for a solid, reached or not; worked out again only where it has moved.
  const std::vector<Index>& blocked_by(int i, double t) {
    const config::Obstacle& obstacle = world_.scenario().obstacles[static_cast<std::size_t>(i)];
    const Vec3 reference = world_.obstacle(i, t).position;
    const Eigen::Matrix3d axes = sim::world::axes_at(obstacle, t);
    Blocked& blocked = blocked_[static_cast<std::size_t>(i)];
    if (blocked.known && blocked.reference == reference && blocked.axes == axes) return blocked.cells;
    blocked = {true, reference, axes, {}};
    const planner::geometry::Sphere ball = too_near(i, t);
    const planner::base::Box around = box_around(obstacle.shape, axes);
    const Vec3 reach = Vec3::Constant(world_.scenario().vehicle.radius);
    for_cells(reference + around.min - reach, reference + around.max + reach, [&](int x, int y, int z) {
      const Vec3 low = low_corner(x, y, z);
      if (in_ball(low, ball) && in_shape(low - reference, obstacle.shape, axes)) blocked.cells.emplace_back(x, y, z);
    });
    return blocked.cells;
  }

  /// Around obstacle `i`: outside of it the vehicle's centre is not too near. For a sphere, inside it is.
  [[nodiscard]] planner::geometry::Sphere too_near(int i, double t) const {
    planner::geometry::Sphere ball = world_.sphere(i, t);
    ball.radius += world_.scenario().vehicle.radius;
    return ball;
  }

  /// Whether all of the cell is in the open ball.
  [[nodiscard]] bool in_ball(const Vec3& low, const planner::geometry::Sphere& ball) const {
    const Vec3 farthest = (low - ball.center).cwiseAbs().cwiseMax((low + cell_ - ball.center).cwiseAbs());
    return farthest.squaredNorm() < ball.radius * ball.radius;
  }

  /// Whether all of the cell is too near to the shape, which is convex, so that its corners tell, and for a box that is
  /// not turned, which is symmetric, the farthest of them. `low` is relative to the reference point.
  [[nodiscard]] bool in_shape(const Vec3& low, const config::Shape& shape, const Eigen::Matrix3d& axes) const {
    const auto* box = std::get_if<config::BoxShape>(&shape);
    if (box != nullptr && axes.isIdentity(0.0)) {
      const Vec3 farthest = low.cwiseAbs().cwiseMax((low + cell_).cwiseAbs());
      return surface_distance(*box, farthest) < world_.scenario().vehicle.radius;
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3 place = low + cell_.cwiseProduct(Vec3(corner & 1U, corner >> 1U & 1U, corner >> 2U));
      if (surface_distance(shape, axes.transpose() * place) >= world_.scenario().vehicle.radius) return false;
    }
    return true;
  }

  [[nodiscard]] bool reached_near(const Vec3& target, double acceptance) const {
    bool found = false;
    for_cells(target.array() - acceptance, target.array() + acceptance, [&](int x, int y, int z) {
      const Vec3 low = low_corner(x, y, z);
      const Vec3 nearest = target.cwiseMax(low).cwiseMin(low + cell_);
      found = found || (reached_.test(x, y, z) && (nearest - target).norm() <= acceptance);
    });
    return found;
  }

  sim::world::World world_;
  Vec3 cell_;  ///< its edges; the vehicle needs longer than a step from one to the next but one
  bool open_;  ///< what is beyond the grid can be reached
  planner::base::Box box_;
  Index count_;
  Cells reached_;
  std::vector<Blocked> blocked_;  ///< by each obstacle that is not a sphere
};

}  // namespace

bool certainly_impossible(const config::Scenario& scenario, const OracleOptions& options) {
  return !Reachability(scenario).reaches(options.acceptance);
}

}  // namespace jink::tools::lab::oracle
