// SPDX-License-Identifier: BSD-3-Clause
// What is measured on several paths in lockstep, each for itself: the way and its time, the turns, the clearance.
#pragma once

#include <cmath>
#include <cstddef>

#include "planner/base/portable_math.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/lanes.hpp"
#include "planner/horizon/nearby_obstacles.hpp"
#include "planner/horizon/path_scene.hpp"

namespace jink::planner::horizon {

/// How far paths lead, and how long they take to the target.
template <std::size_t kLanes>
struct TravelLanes {
  Lanes<kLanes> length{0.0},  ///< flown, m
      deviation{0.0},         ///< distance from unobstructed flight, summed over the steps, m
      arrival{0.0},           ///< end of the last step that did not end near the target, s
      stay{0.0},              ///< steps for which it has been at the target
      visited{0.0},           ///< 1 once it has stayed there, where that is enough, else 0
      counts{1.0};            ///< 0 where it had by the end of the last stretch, else 1

  /// A step over `moved` to `to`, at whose end unobstructed flight is at `unobstructed`.
  [[gnu::always_inline]] void add(const PointLanes<kLanes>& to, const Lanes<kLanes>& moved, const Vec3& unobstructed) {
    const Vec3 base = unobstructed;  // NOLINT(performance-unnecessary-copy-initialization): kept in registers
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = to.x[i] - base.x();
      const double y = to.y[i] - base.y();
      const double z = to.z[i] - base.z();
      deviation[i] += std::sqrt(x * x + y * y + z * z);
      length[i] += counts[i] * moved[i];
    }
  }

  /// A stretch that ends at time `end`, s, and comes near the target nowhere.
  [[gnu::always_inline]] void pass(double end) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      arrival[i] = visited[i] > 0.0 ? arrival[i] : end;
      stay[i] = 0.0;
    }
  }

  /// A step over `moved` to `to`, until time `end`, s: it counts for the paths that are then not yet near the target,
  /// and its length does not for those that have visited it.
  [[gnu::always_inline]] void add_time(const PathScene& scene, const PointLanes<kLanes>& to, const Lanes<kLanes>& moved,
                                       double end) {
    const Vec3 target = scene.target;
    const double near = scene.near_target * scene.near_target;
    const double range = scene.visit_range * scene.visit_range;
    const double slow = scene.visit_speed * scene.step;
    const double steps_to_stay = scene.visit_steps;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = to.x[i] - target.x();
      const double y = to.y[i] - target.y();
      const double z = to.z[i] - target.z();
      const double squared = x * x + y * y + z * z;
      length[i] -= counts[i] * visited[i] * moved[i];
      arrival[i] = squared > near && visited[i] == 0.0 ? end : arrival[i];
      const bool at_target = squared <= range && moved[i] <= slow;
      stay[i] = at_target ? stay[i] + 1.0 : 0.0;
      visited[i] = stay[i] >= steps_to_stay ? 1.0 : visited[i];
    }
  }

  /// Ends a stretch that comes near the target: what follows does not count for the paths that have visited it.
  [[gnu::always_inline]] void settle() {
    for (std::size_t i = 0; i < kLanes; ++i) counts[i] = 1.0 - visited[i];
  }
};

/// How paths turn between their legs.
template <std::size_t kLanes>
struct SteeringLanes {
  PointLanes<kLanes> corner,    ///< where the last leg ended
      direction;                ///< the last leg's way, m; before the first leg the velocity
  Lanes<kLanes> steering{0.0};  ///< sum of the angles between legs, Eq. (3), rad
  double shortest = 0.0;        ///< leg that is turned at, m

  /// Begins at `start` with the scene's velocity.
  [[gnu::always_inline]] SteeringLanes(const PointLanes<kLanes>& start, const PathScene& scene)
      : shortest(scene.shortest_leg) {
    corner.copy(start);
    direction.set(scene.velocity);
  }

  /// A leg ends at `to`: the angle to the leg before it. Three loops: the compiler would make one of all that skips the
  /// arc tangent where it is not needed, lane by lane.
  [[gnu::always_inline]] void turn(const PointLanes<kLanes>& to) {
    constexpr double kNoDirection = 1e-9;  // m, m/s: as in angle_between
    PointLanes<kLanes> leg;
    Lanes<kLanes> across, along, angle;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double lx = to.x[i] - corner.x[i];
      const double ly = to.y[i] - corner.y[i];
      const double lz = to.z[i] - corner.z[i];
      const double cx = direction.y[i] * lz - direction.z[i] * ly;
      const double cy = direction.z[i] * lx - direction.x[i] * lz;
      const double cz = direction.x[i] * ly - direction.y[i] * lx;
      leg.x[i] = lx;
      leg.y[i] = ly;
      leg.z[i] = lz;
      across[i] = std::sqrt(cx * cx + cy * cy + cz * cz);
      along[i] = direction.x[i] * lx + direction.y[i] * ly + direction.z[i] * lz;
    }
    for (std::size_t i = 0; i < kLanes; ++i) angle[i] = base::arc_tangent2(across[i], along[i]);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double dx = direction.x[i];
      const double dy = direction.y[i];
      const double dz = direction.z[i];
      const bool straight = dx * dx + dy * dy + dz * dz < kNoDirection * kNoDirection;
      const double counted = straight ? 0.0 : angle[i];
      const bool none = leg.x[i] * leg.x[i] + leg.y[i] * leg.y[i] + leg.z[i] * leg.z[i] < shortest * shortest;
      steering[i] += none ? 0.0 : counted;
      direction.x[i] = none ? dx : leg.x[i];
      direction.y[i] = none ? dy : leg.y[i];
      direction.z[i] = none ? dz : leg.z[i];
      corner.x[i] = none ? corner.x[i] : to.x[i];
      corner.y[i] = none ? corner.y[i] : to.y[i];
      corner.z[i] = none ? corner.z[i] : to.z[i];
    }
  }
};

/// How near paths come to what they are to keep away from.
template <std::size_t kLanes>
struct ClearanceLanes {
  Lanes<kLanes> dip{0.0},  ///< into the soft distances, as f3 counts it
      violation{0.0};      ///< of the hard distances and the volume

  /// Violation for one step that ends at `to`: the distance outside the volume times the step's duration, m s.
  [[gnu::always_inline]] void add_outside(const PathScene& scene, const PointLanes<kLanes>& to) {
    for (std::size_t i = 0; i < kLanes; ++i)
      violation[i] += std::sqrt(squared_outside(scene.volume, to, i)) * scene.step;
  }

  /// Dip into the clearance of the volume's bounds for one step that ends at `to`.
  [[gnu::always_inline]] void add_near_bounds(const PathScene& scene, const PointLanes<kLanes>& to, double weight) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double depth = squared_outside(scene.inner_volume, to, i) * (scene.per_clearance * scene.per_clearance);
      dip[i] += weight * (depth < 1.0 ? depth : 1.0);
    }
  }

  /// The swept test of geometry.hpp in those lanes that are `near`, below 0.
  [[gnu::always_inline]] void add_sphere(const NearbyObstacle& obstacle, const PointLanes<kLanes>& from,
                                         const PointLanes<kLanes>& to, const Lanes<kLanes>& near, double weight) {
    const Weights weights(obstacle, weight);
    for (std::size_t first = 0; first < kLanes; first += kPart) {
      if (smallest_of<kPart>(near, first) < 0.0) add_near_sphere(obstacle, from, to, first, weights);
    }
  }

  /// The same for a solid in a step over `moved`, for those lanes alone that may come near.
  [[gnu::always_inline]] void add_solid(const NearbyObstacle& obstacle, const NearbySolid& solid,
                                        const PointLanes<kLanes>& from, const PointLanes<kLanes>& to,
                                        const Lanes<kLanes>& moved, double weight) {
    PointLanes<kLanes> own;
    Lanes<kLanes> before, after, nearer, near;
    solid.middle.to_own(from, own);
    solid.middle.distances(own, before);
    solid.middle.to_own(to, own);
    solid.middle.distances(own, after);
    // No place between is nearer than that of who flew straight at it and straight away.
    for (std::size_t i = 0; i < kLanes; ++i) {
      nearer[i] = before[i] - after[i];
      const double least = 0.5 * (before[i] + after[i] - moved[i]);
      near[i] = least < solid.near + obstacle.advance(nearer[i]) ? -1.0 : 1.0;
    }
    const Weights weights(obstacle, weight);
    for (std::size_t first = 0; first < kLanes; first += kPart) {
      if (smallest_of<kPart>(near, first) < 0.0) add_near_solid(solid, from, to, nearer, first, weights);
    }
  }

 private:
  static constexpr std::size_t kPart = kLanes < 4 ? kLanes : 4;  ///< lanes that are left out together

  /// Of lane i, m².
  [[gnu::always_inline]] static double squared_outside(const base::Box& box, const PointLanes<kLanes>& at,
                                                       std::size_t i) {
    const double x = PlainBox::outside(box.min.x(), box.max.x(), at.x[i]);
    const double y = PlainBox::outside(box.min.y(), box.max.y(), at.y[i]);
    const double z = PlainBox::outside(box.min.z(), box.max.z(), at.z[i]);
    return x * x + y * y + z * z;
  }

  /// Of lane i, m.
  [[gnu::always_inline]] static double distance_from(const Vec3& place, const PointLanes<kLanes>& at, std::size_t i) {
    const double x = at.x[i] - place.x();
    const double y = at.y[i] - place.y();
    const double z = at.z[i] - place.z();
    return std::sqrt(x * x + y * y + z * z);
  }

  /// What a distance from an obstacle's centre counts.
  struct Weights {
    const NearbyObstacle& obstacle;
    double hard, soft, per_extra, dip_weight, weight;

    [[gnu::always_inline]] Weights(const NearbyObstacle& obstacle_, double weight_)
        : obstacle(obstacle_),
          hard(obstacle.hard),
          soft(obstacle.soft),
          per_extra(soft > hard ? 1.0 / (soft - hard) : 1.0),
          dip_weight(soft > hard ? weight_ : 0.0),
          weight(weight_) {}

    /// For who comes nearer by `nearer` in the step by its own motion, m.
    [[gnu::always_inline]] void add(double distance, double nearer, double& dips, double& violations) const {
      const double depth = (soft + obstacle.advance(nearer) - distance) * per_extra;
      const double positive = depth > 0.0 ? depth : 0.0;
      const double bounded = positive < 1.0 ? positive : 1.0;
      dips += dip_weight * (bounded * bounded);
      const double deep = hard - distance;
      violations += weight * (deep > 0.0 ? deep : 0.0);
    }
  };

  /// Of add_sphere(), kPart lanes from `first` on.
  [[gnu::always_inline]] void add_near_sphere(const NearbyObstacle& obstacle, const PointLanes<kLanes>& from,
                                              const PointLanes<kLanes>& to, std::size_t first, const Weights& weights) {
    const Vec3 c = obstacle.from;
    const Vec3 d = obstacle.to;
    const Vec3 m = obstacle.middle;
    for (std::size_t i = first; i < first + kPart; ++i) {
      const double px = from.x[i] - c.x();
      const double py = from.y[i] - c.y();
      const double pz = from.z[i] - c.z();
      const double dx = to.x[i] - d.x() - px;
      const double dy = to.y[i] - d.y() - py;
      const double dz = to.z[i] - d.z() - pz;
      const double lengths = dx * dx + dy * dy + dz * dz + 1e-300;
      const double nearest = -(dx * px + dy * py + dz * pz) / lengths;
      const double from_0 = nearest > 0.0 ? nearest : 0.0;
      const double s = from_0 < 1.0 ? from_0 : 1.0;
      const double qx = px + s * dx;
      const double qy = py + s * dy;
      const double qz = pz + s * dz;
      const double nearer = distance_from(m, from, i) - distance_from(m, to, i);
      weights.add(std::sqrt(qx * qx + qy * qy + qz * qz), nearer, dip[i], violation[i]);
    }
  }

  /// Of add_solid(): at some places of the step, between two of which, in a step of a metre, the distance from an edge
  /// that is kept 0.65 m away is less by 0.01 m.
  [[gnu::always_inline]] void add_near_solid(const NearbySolid& solid, const PointLanes<kLanes>& from,
                                             const PointLanes<kLanes>& to, const Lanes<kLanes>& nearer,
                                             std::size_t first, const Weights& weights) {
    constexpr std::size_t kPlaces = 3;
    PointLanes<kPart> a, b;
    Lanes<kPart> least;
    a.copy(from, first);
    b.copy(to, first);
    solid.from.to_own(a, a);
    solid.to.to_own(b, b);
    solid.from.template least_distances<kPlaces>(a, b, least);
    for (std::size_t i = 0; i < kPart; ++i)
      weights.add(solid.radius + least[i], nearer[first + i], dip[first + i], violation[first + i]);
  }
};

}  // namespace jink::planner::horizon
