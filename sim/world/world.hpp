// SPDX-License-Identifier: BSD-3-Clause
// The simulated world: where every obstacle truly is, and whether the vehicle touches one. It is the judge; planner and
// bridge never see it, only what sim/world/sensing measures of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/enclosing_sphere.hpp"
#include "planner/geometry/static_map.hpp"
#include "sim/world/obstacle_models.hpp"

namespace jink::sim::world {

/// The true motion of one vehicle, ENU.
struct VehicleTruth {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

/// The nearest that the vehicle came to any obstacle, or another vehicle, on a straight way.
struct SweepResult {
  double min_clearance = planner::base::kInfinity;  ///< m, from the vehicle's sphere to the obstacle's true surface
  double t_min = 0.0;                               ///< scenario time of it; one of several if it is held for a while
  int obstacle = -1;                                ///< index of that obstacle or solid, -1: there is none
};

/// The straight way of a sphere during one step.
struct SphereSegment {
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  double radius = 0.0;
};

/// The smallest distance between the surfaces of two spheres in continuous time while both go at constant velocity from
/// `t0` to `t1`, negative where they overlap; `obstacle` stays -1. O(1).
[[nodiscard]] SweepResult sweep(const SphereSegment& a, const SphereSegment& b, double t0, double t1);

/// A scenario brought to life. All times are scenario time in seconds; for t < 0 the clock does not run yet and the
/// obstacles stand at their t = 0 positions. ENU, m. Immutable but for advance(), so all other members are thread safe.
/// Obstacle indices run from 0 in the order of the scenario file, and on with the solids of its map, which stand still;
/// an index out of range is a programming error.
class World {
 public:
  /// sweep() finds the minimum to within this, in metres.
  static constexpr double kSweepTolerance = 1e-6;
  /// inside() forgives this much, in metres.
  static constexpr double kVolumeTolerance = 1e-9;

  /// Copies the scenario, which must be as config::load_scenario checks it. O(obstacles).
  explicit World(config::Scenario scenario);

  /// Tells those that chase where the vehicles are at `t`, which must not decrease. To be called at every step, before
  /// anything is asked of that instant. One that chases flies straight, for kChaseLeg, to where the nearest vehicle was
  /// last seen, and stands once it is there, or where there are no vehicles. Until told it stands.
  void advance(double t, std::span<const VehicleTruth> vehicles);
  static constexpr double kChaseLeg = 0.5;  ///< s

  /// As it was given, but that those that chase have the way that they have come so far.
  [[nodiscard]] const config::Scenario& scenario() const { return scenario_; }
  /// How many obstacles there are to be sensed: the solids of the map are none.
  [[nodiscard]] int obstacle_count() const { return static_cast<int>(scenario_.obstacles.size()); }
  /// The solids of the map, index obstacle_count() being the first: what is known of the world without sensing.
  [[nodiscard]] const std::shared_ptr<const planner::geometry::StaticMap>& map() const { return map_; }

  /// The identity by which tracks and logs name obstacle `i`: its place in the file, counted from 1.
  [[nodiscard]] static std::uint64_t id(int i) { return static_cast<std::uint64_t>(i) + 1; }
  /// For people: "obstacle 1" is the first of the file, "map solid 1" the first of the map.
  [[nodiscard]] std::string name(int i) const;

  /// Obstacle or solid `i` as the file has it.
  [[nodiscard]] const config::Obstacle& spec(int i) const {
    const auto place = static_cast<std::size_t>(i);
    const std::size_t moving = scenario_.obstacles.size();
    return place < moving ? scenario_.obstacles[place] : scenario_.map[place - moving];
  }

  /// The state of the reference point of obstacle `i`. See state_at().
  [[nodiscard]] ObstacleState obstacle(int i, double t) const;

  /// Centre and radius of the smallest sphere around obstacle `i` at `t`.
  [[nodiscard]] planner::geometry::Sphere sphere(int i, double t) const;

  /// From a point to the true surface of obstacle `i` at `t`, m; negative inside.
  [[nodiscard]] double distance(int i, const Vec3& p, double t) const;

  /// What perfect sensing would report of obstacle `i`: its enclosing sphere, and in it its shape, with the true
  /// velocity and acceleration, no uncertainty, age 0.
  [[nodiscard]] planner::base::Track exact_track(int i, double t) const;

  /// Smallest distance at `t` from the vehicle's sphere, centred at `p`, to the true surface of any obstacle; negative
  /// where they overlap, infinite without obstacles. In a hull of vertices it is minus the vehicle's radius however
  /// deep.
  [[nodiscard]] double clearance(const Vec3& p, double t) const { return clearance(p, t, scenario_.vehicle.radius); }
  /// The same for a vehicle of that radius.
  [[nodiscard]] double clearance(const Vec3& p, double t, double radius) const;

  /// The minimum of clearance() in continuous time while the vehicle goes at constant velocity from `p0` at `t0` to
  /// `p1` at `t1` >= t0 (if they are equal: along that way in the world as it is then). No contact is missed, however
  /// short: every piece of the interval is either shown to be no nearer than the result, or split, by the exact
  /// distance of the obstacle's shape from the chord of the relative motion and a bound on the way the motion leaves
  /// that chord.
  [[nodiscard]] SweepResult sweep(const Vec3& p0, double t0, const Vec3& p1, double t1) const {
    return sweep(p0, t0, p1, t1, scenario_.vehicle.radius);
  }
  /// The same for a vehicle of that radius.
  [[nodiscard]] SweepResult sweep(const Vec3& p0, double t0, const Vec3& p1, double t1, double radius) const;

  /// The flight volume; unbounded where the scenario states none.
  [[nodiscard]] planner::base::Box volume() const { return scenario_.world.value_or(planner::base::Box{}); }

  /// Whether `p`, the vehicle's centre, is in the flight volume, bounds included.
  [[nodiscard]] bool inside(const Vec3& p) const { return volume().contains(p, kVolumeTolerance); }

  /// Whether the vehicle overlaps an obstacle where it starts, at t = 0. To touch is not to overlap.
  [[nodiscard]] bool start_blocked() const { return clearance(scenario_.start, 0.0) < 0.0; }

 private:
  [[nodiscard]] const planner::geometry::Sphere& bound(int i) const { return bounds_[static_cast<std::size_t>(i)]; }

  struct Chaser {
    std::size_t obstacle = 0;
    double speed = 0.0;
  };

  config::Scenario scenario_;
  std::vector<Chaser> chasers_;
  std::vector<planner::geometry::Sphere> bounds_;                    ///< one per index, relative to its reference point
  std::vector<std::shared_ptr<const planner::base::Solid>> solids_;  ///< one per obstacle, about its bound's centre
  std::shared_ptr<const planner::geometry::StaticMap> map_;
};

}  // namespace jink::sim::world
