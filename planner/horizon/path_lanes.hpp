// SPDX-License-Identifier: BSD-3-Clause
// Several paths in lockstep, one in each lane: how they are flown and what they cost. Loops over a fixed number of
// lanes, which the compiler turns into wide registers; a path gets the same bits in every lane, among whatever others.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "planner/base/portable_math.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/nearby_obstacles.hpp"
#include "planner/horizon/path_scene.hpp"
#include "planner/optimizer/pareto.hpp"

namespace jink::planner::horizon {

/// One number for each lane.
template <std::size_t kLanes>
struct alignas(kLanes >= 4 ? 32 : 8) Lanes {
  std::array<double, kLanes> at{};  ///< by lane

  /// The number of lane i < kLanes.
  [[gnu::always_inline]] double& operator[](std::size_t i) { return at[i]; }
  /// The number of lane i < kLanes.
  [[gnu::always_inline]] const double& operator[](std::size_t i) const { return at[i]; }
};

/// One point or vector for each lane, ENU.
template <std::size_t kLanes>
struct PointLanes {
  Lanes<kLanes> x,  ///< east
      y,            ///< north
      z;            ///< up

  /// The same point in every lane.
  [[gnu::always_inline]] void set(const Vec3& p) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      x[i] = p.x();
      y[i] = p.y();
      z[i] = p.z();
    }
  }
  /// By lanes: a copy of the whole would be made in other registers than its lanes are read in, which stalls.
  [[gnu::always_inline]] void copy(const PointLanes& p) {
    for (std::size_t i = 0; i < kLanes; ++i) x[i] = p.x[i];
    for (std::size_t i = 0; i < kLanes; ++i) y[i] = p.y[i];
    for (std::size_t i = 0; i < kLanes; ++i) z[i] = p.z[i];
  }
  /// The point of lane i < kLanes.
  [[nodiscard]] Vec3 lane(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// The smallest of all lanes.
template <std::size_t kLanes>
[[gnu::always_inline]] inline double smallest(const Lanes<kLanes>& v) {
  if constexpr (kLanes == 1) {
    return v[0];
  } else {
    constexpr std::size_t kPart = kLanes > 4 ? 4 : kLanes / 2;
    Lanes<kPart> part;
    for (std::size_t i = 0; i < kPart; ++i) part[i] = v[i];
    for (std::size_t j = kPart; j < kLanes; j += kPart) {
      for (std::size_t i = 0; i < kPart; ++i) part[i] = v[j + i] < part[i] ? v[j + i] : part[i];
    }
    return smallest(part);
  }
}

/// The largest of all lanes.
template <std::size_t kLanes>
[[gnu::always_inline]] inline double largest(const Lanes<kLanes>& v) {
  if constexpr (kLanes == 1) {
    return v[0];
  } else {
    constexpr std::size_t kPart = kLanes > 4 ? 4 : kLanes / 2;
    Lanes<kPart> part;
    for (std::size_t i = 0; i < kPart; ++i) part[i] = v[i];
    for (std::size_t j = kPart; j < kLanes; j += kPart) {
      for (std::size_t i = 0; i < kPart; ++i) part[i] = v[j + i] > part[i] ? v[j + i] : part[i];
    }
    return largest(part);
  }
}

/// A box in plain numbers.
struct PlainBox {
  double min_x,  ///< west, m
      min_y,     ///< south
      min_z,     ///< bottom
      max_x,     ///< east
      max_y,     ///< north
      max_z;     ///< top

  /// How far `value` lies outside [low, high]; 0 inside.
  [[gnu::always_inline]] static double outside(double low, double high, double value) {
    const double below = low - value;
    const double above = value - high;
    const double more = below > above ? below : above;
    return more > 0.0 ? more : 0.0;
  }
  /// Of a point to the box; 0 inside.
  [[gnu::always_inline]] [[nodiscard]] double squared_distance(const Vec3& p) const {
    const double x = outside(min_x, max_x, p.x());
    const double y = outside(min_y, max_y, p.y());
    const double z = outside(min_z, max_z, p.z());
    return x * x + y * y + z * z;
  }
  /// False where a number is not one.
  [[gnu::always_inline]] [[nodiscard]] bool inside(const base::Box& box) const {
    return min_x >= box.min.x() && min_y >= box.min.y() && min_z >= box.min.z() && max_x <= box.max.x() &&
           max_y <= box.max.y() && max_z <= box.max.z();
  }
};

/// The flight that decision variables ask for, step by step.
template <std::size_t kLanes>
struct FlightLanes {
  const PathScene& scene;               ///< what all lanes share
  std::array<const double*, kLanes> x;  ///< the variables of each lane
  PointLanes<kLanes> position,          ///< now, m
      velocity;                         ///< now, m/s
  PointLanes<kLanes> begin,             ///< the leg's first offset, m
      drift,                            ///< the offset's change in a second, m/s
      wished;                           ///< the leg's last offset, m

  /// At the start of the horizon. Keeps references to both arguments' data.
  [[gnu::always_inline]] FlightLanes(const PathScene& scene_, const std::array<const double*, kLanes>& x_)
      : scene(scene_), x(x_) {
    position.set(scene.position);
    velocity.set(scene.velocity);
  }

  /// ENU offset from unobstructed flight at the leg's end, moved into the volume where it leads out of it.
  [[gnu::always_inline]] void begin_leg(int leg) {
    begin.copy(wished);
    const auto k = static_cast<std::size_t>(leg);
    const Reach reach = scene.reach[k];
    const Vec3 base = scene.unobstructed[(k + 1) * static_cast<std::size_t>(scene.steps_per_leg)];
    PointLanes<kLanes> asked;
    for (std::size_t i = 0; i < kLanes; ++i) {
      asked.x[i] = x[i][3 * k];
      asked.y[i] = x[i][3 * k + 1];
      asked.z[i] = x[i][3 * k + 2];
    }
    aim(0, asked, reach, base.x(), wished.x);
    aim(1, asked, reach, base.y(), wished.y);
    aim(2, asked, reach, base.z(), wished.z);
    const double per_second = 1.0 / (scene.steps_per_leg * scene.step);
    for (std::size_t i = 0; i < kLanes; ++i) {
      drift.x[i] = (wished.x[i] - begin.x[i]) * per_second;
      drift.y[i] = (wished.y[i] - begin.y[i]) * per_second;
      drift.z[i] = (wished.z[i] - begin.z[i]) * per_second;
    }
  }

  /// ENU coordinate j of the leg's last offset.
  [[gnu::always_inline]] void aim(int j, const PointLanes<kLanes>& asked, const Reach& reach, double base,
                                  Lanes<kLanes>& to) {
    const geometry::PathFrame& frame = scene.frame;
    const double axis = frame.axis[j];
    const double left = frame.left[j] * reach.aside;
    const double up = frame.up[j] * reach.aside;
    const double low = scene.volume.min[j];
    const double high = scene.volume.max[j];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double along = asked.x[i] * (asked.x[i] > 0.0 ? reach.ahead : reach.behind);
      const double wish = base + along * axis + asked.y[i] * left + asked.z[i] * up;
      const double above = wish < low ? low : wish;
      to[i] = (above > high ? high : above) - base;
    }
  }

  /// Flies the leg's step i, which is the horizon's step `n`.
  [[gnu::always_inline]] void fly(int n, int i) {
    constexpr double kPerCatchUp = 1.0 / kCatchUp;
    const Vec3 base = scene.unobstructed[static_cast<std::size_t>(n)];
    const Vec3 forward = scene.speed[static_cast<std::size_t>(n) + 1] * scene.frame.axis;
    const double since = i * scene.step;
    const Follower follower = scene.follower;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double wx =
          forward.x() + drift.x[l] + (base.x() + begin.x[l] + since * drift.x[l] - position.x[l]) * kPerCatchUp;
      const double wy =
          forward.y() + drift.y[l] + (base.y() + begin.y[l] + since * drift.y[l] - position.y[l]) * kPerCatchUp;
      const double wz =
          forward.z() + drift.z[l] + (base.z() + begin.z[l] + since * drift.z[l] - position.z[l]) * kPerCatchUp;
      follower.advance(position.x[l], position.y[l], position.z[l], velocity.x[l], velocity.y[l], velocity.z[l], wx, wy,
                       wz);
    }
  }
};

/// What paths cost, step by step.
template <std::size_t kLanes>
struct CostLanes {
  static constexpr std::size_t kStretch = 10;  ///< steps looked at together for what few paths meet

  const PathScene& scene;                               ///< what all lanes share
  const NearbyObstacles& obstacles;                     ///< what can be met, step by step
  std::size_t count = 0;                                ///< steps in the stretch
  std::array<PointLanes<kLanes>, kStretch + 1> places;  ///< where it begins, and after each of its steps
  std::array<Lanes<kLanes>, kStretch> moved;            ///< in each of its steps
  PointLanes<kLanes> least,                             ///< smallest coordinates of its places, m
      most;                                             ///< largest coordinates of its places, m
  PointLanes<kLanes> corner,                            ///< where the last leg ended
      direction;                                        ///< the last leg's way, m; before the first leg the velocity
  Lanes<kLanes> length,                                 ///< flown, m
      deviation,                                        ///< distance from unobstructed flight, summed over the steps, m
      arrival,                                          ///< end of the last step that did not end near the target, s
      stay,                                             ///< steps for which it has been at the target
      visited,                                          ///< 1 once it has stayed there, where that is enough, else 0
      counts,                                           ///< 0 where it had by the end of the last stretch, else 1
      steering,                                         ///< sum of the angles between legs, Eq. (3), rad
      dip,                                              ///< into the soft distances, as f3 counts it
      violation;                                        ///< of the hard distances and the volume

  /// All paths begin at `start`, at time 0. Keeps references to scene and obstacles.
  [[gnu::always_inline]] CostLanes(const PathScene& scene_, const NearbyObstacles& obstacles_,
                                   const PointLanes<kLanes>& start)
      : scene(scene_), obstacles(obstacles_) {
    places[0].copy(start);
    least.copy(start);
    most.copy(start);
    corner.copy(start);
    direction.set(scene.velocity);
    for (std::size_t i = 0; i < kLanes; ++i) counts[i] = 1.0;
  }

  /// Step n, in which the vehicles fly evenly from where they were to `to`.
  [[gnu::always_inline]] void add(int n, const PointLanes<kLanes>& to) {
    if (count == kStretch) restart();
    const Vec3 base = scene.unobstructed[static_cast<std::size_t>(n) + 1];
    PointLanes<kLanes> from;
    from.copy(places[count]);
    Lanes<kLanes> way;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = to.x[i];
      const double y = to.y[i];
      const double z = to.z[i];
      const double mx = x - from.x[i];
      const double my = y - from.y[i];
      const double mz = z - from.z[i];
      const double step = std::sqrt(mx * mx + my * my + mz * mz);
      const double ux = x - base.x();
      const double uy = y - base.y();
      const double uz = z - base.z();
      deviation[i] += std::sqrt(ux * ux + uy * uy + uz * uz);
      length[i] += counts[i] * step;
      way[i] = step;
      least.x[i] = x < least.x[i] ? x : least.x[i];
      least.y[i] = y < least.y[i] ? y : least.y[i];
      least.z[i] = z < least.z[i] ? z : least.z[i];
      most.x[i] = x > most.x[i] ? x : most.x[i];
      most.y[i] = y > most.y[i] ? y : most.y[i];
      most.z[i] = z > most.z[i] ? z : most.z[i];
    }
    for (std::size_t i = 0; i < kLanes; ++i) moved[count][i] = way[i];
    places[count + 1].copy(to);
    if (++count == kStretch || n + 1 == scene.steps) settle(n);
  }

  /// Ends a stretch of which n is the last step.
  [[gnu::always_inline]] void settle(int n) {
    const PlainBox bounds{smallest(least.x), smallest(least.y), smallest(least.z),
                          largest(most.x),   largest(most.y),   largest(most.z)};
    const int before = n - static_cast<int>(count);
    if (!bounds.inside(scene.volume)) {
      for (std::size_t j = 1; j <= count; ++j) add_outside(places[j]);
    }
    if (bounds.squared_distance(scene.target) > kNear * kNear) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        arrival[i] = visited[i] > 0.0 ? arrival[i] : (n + 1) * scene.step;
        stay[i] = 0.0;
      }
    } else {
      for (std::size_t j = 0; j < count; ++j) add_time(j, (before + static_cast<int>(j) + 2) * scene.step);
      for (std::size_t i = 0; i < kLanes; ++i) counts[i] = 1.0 - visited[i];
    }
    for (std::size_t j = 0; j < count; ++j) {
      const int step = before + static_cast<int>(j) + 1;
      const double weight = scene.step / (0.5 + step * scene.step);  // what is near in time counts more
      for (const NearbyObstacle& obstacle : obstacles.during(step)) {
        if (bounds.squared_distance(obstacle.middle) >= obstacle.near_squared) continue;
        if (may_meet(obstacle, j)) add_obstacle(obstacle, places[j], places[j + 1], weight);
      }
    }
  }

  /// Begins a stretch where the last one ended.
  [[gnu::always_inline]] void restart() {
    places[0].copy(places[count]);
    least.copy(places[0]);
    most.copy(places[0]);
    count = 0;
  }

  /// The stretch's step j, until time `end`, s: it counts for the paths that are then not yet near the target, and its
  /// length does not for those that have visited it.
  [[gnu::always_inline]] void add_time(std::size_t j, double end) {
    const PointLanes<kLanes>& to = places[j + 1];
    const Vec3 target = scene.target;
    const double steps_to_stay = scene.visit ? kVisitSteps : base::kInfinity;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = to.x[i] - target.x();
      const double y = to.y[i] - target.y();
      const double z = to.z[i] - target.z();
      const double squared = x * x + y * y + z * z;
      length[i] -= counts[i] * visited[i] * moved[j][i];
      arrival[i] = squared > kNear * kNear && visited[i] == 0.0 ? end : arrival[i];
      const bool at_target = squared <= kVisit * kVisit && moved[j][i] <= kVisitSpeed * scene.step;
      stay[i] = at_target ? stay[i] + 1.0 : 0.0;
      visited[i] = stay[i] >= steps_to_stay ? 1.0 : visited[i];
    }
  }

  /// Violation for one step that ends at `to`: the distance outside the volume times the step's duration, m s.
  [[gnu::always_inline]] void add_outside(const PointLanes<kLanes>& to) {
    const base::Box& volume = scene.volume;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = PlainBox::outside(volume.min.x(), volume.max.x(), to.x[i]);
      const double y = PlainBox::outside(volume.min.y(), volume.max.y(), to.y[i]);
      const double z = PlainBox::outside(volume.min.z(), volume.max.z(), to.z[i]);
      violation[i] += std::sqrt(x * x + y * y + z * z) * scene.step;
    }
  }

  /// False only where every lane keeps the soft distance in the stretch's step j. Relative motion is straight, so
  /// during the step the distance is not below that of the middles by more than half of both ways.
  [[gnu::always_inline]] [[nodiscard]] bool may_meet(const NearbyObstacle& obstacle, std::size_t j) const {
    const PointLanes<kLanes>& from = places[j];
    const PointLanes<kLanes>& to = places[j + 1];
    const Lanes<kLanes>& way = moved[j];
    const Vec3 middle = obstacle.middle;
    const double near = obstacle.near;
    Lanes<kLanes> sign;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = 0.5 * (from.x[i] + to.x[i]) - middle.x();
      const double y = 0.5 * (from.y[i] + to.y[i]) - middle.y();
      const double z = 0.5 * (from.z[i] + to.z[i]) - middle.z();
      const double limit = near + 0.5 * way[i];
      sign[i] = x * x + y * y + z * z < limit * limit ? -1.0 : 1.0;
    }
    return smallest(sign) < 0.0;
  }

  /// The swept test of geometry.hpp in every lane.
  [[gnu::always_inline]] void add_obstacle(const NearbyObstacle& obstacle, const PointLanes<kLanes>& from,
                                           const PointLanes<kLanes>& to, double weight) {
    const Vec3 c = obstacle.from;
    const Vec3 d = obstacle.to;
    const double hard = obstacle.hard;
    const double soft = obstacle.soft;
    const double extra = soft > hard ? soft - hard : 1.0;
    const double dip_weight = soft > hard ? weight : 0.0;
    for (std::size_t i = 0; i < kLanes; ++i) {
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
      const double distance = std::sqrt(qx * qx + qy * qy + qz * qz);
      const double depth = (soft - distance) / extra;
      const double positive = depth > 0.0 ? depth : 0.0;
      const double bounded = positive < 1.0 ? positive : 1.0;
      dip[i] += dip_weight * (bounded * bounded);
      const double deep = hard - distance;
      violation[i] += weight * (deep > 0.0 ? deep : 0.0);
    }
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
      const bool none = leg.x[i] * leg.x[i] + leg.y[i] * leg.y[i] + leg.z[i] * leg.z[i] < kShortLeg * kShortLeg;
      steering[i] += none ? 0.0 : counted;
      direction.x[i] = none ? dx : leg.x[i];
      direction.y[i] = none ? dy : leg.y[i];
      direction.z[i] = none ? dz : leg.z[i];
      corner.x[i] = none ? corner.x[i] : to.x[i];
      corner.y[i] = none ? corner.y[i] : to.y[i];
      corner.z[i] = none ? corner.z[i] : to.z[i];
    }
  }

  /// After the last step: the way from the end of the horizon to the target, first to a stop, as far as braking takes,
  /// then straight on (or back, where the target was overrun), or over scene.via. Without the first part a path that
  /// comes fast would be the shorter one.
  [[gnu::always_inline]] void finish(const std::array<optimizer::Cost*, kLanes>& costs) {
    const PointLanes<kLanes>& from = places[count - 1];
    const PointLanes<kLanes>& end = places[count];
    const Lanes<kLanes>& way = moved[count - 1];
    PointLanes<kLanes> target;
    target.set(scene.target);
    turn(target);
    const double horizon = scene.steps * scene.step;
    PointLanes<kLanes> stop;
    Lanes<kLanes> rest, total;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double speed = way[i] / scene.step;
      const double stopping = speed * speed * scene.inverse_braking;
      const double further = stopping / (way[i] > 0.0 ? way[i] : 1.0);
      stop.x[i] = end.x[i] + (end.x[i] - from.x[i]) * further;
      stop.y[i] = end.y[i] + (end.y[i] - from.y[i]) * further;
      stop.z[i] = end.z[i] + (end.z[i] - from.z[i]) * further;
      const double rx = target.x[i] - stop.x[i];
      const double ry = target.y[i] - stop.y[i];
      const double rz = target.z[i] - stop.z[i];
      rest[i] = stopping + std::sqrt(rx * rx + ry * ry + rz * rz);
    }
    for (std::size_t i = 0; scene.via && i < kLanes; ++i) {
      const Vec3 place(stop.x[i], stop.y[i], stop.z[i]);
      const Vec3 there = *scene.via - place;
      if (there.dot(scene.frame.axis) > 0.0)
        rest[i] += there.norm() + (scene.target - *scene.via).norm() - (scene.target - place).norm();
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double then = arrival[i] == horizon ? rest[i] / scene.cruise : 0.0;
      const double late = arrival[i] + then - scene.unobstructed_time;
      const double lost = late > 0.0 ? late : 0.0;
      total[i] = length[i] + counts[i] * rest[i] + scene.time_weight * scene.cruise * lost +
                 scene.deviation_weight * deviation[i] / scene.steps;
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (costs[i] == nullptr) continue;
      *costs[i] = optimizer::Cost{};
      costs[i]->f[0] = total[i];
      costs[i]->f[1] = steering[i];
      costs[i]->f[2] = dip[i];
      costs[i]->violation = violation[i];
    }
  }
};

}  // namespace jink::planner::horizon
