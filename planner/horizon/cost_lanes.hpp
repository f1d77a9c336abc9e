// SPDX-License-Identifier: BSD-3-Clause
// What several paths cost that are flown in lockstep, one in each lane: the measures put together, and what comes after
// the last step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "planner/base/types.hpp"
#include "planner/horizon/lanes.hpp"
#include "planner/horizon/measure_lanes.hpp"
#include "planner/horizon/nearby_obstacles.hpp"
#include "planner/horizon/path_scene.hpp"
#include "planner/horizon/stretch_lanes.hpp"
#include "planner/optimizer/pareto.hpp"

namespace jink::planner::horizon {

/// What paths cost, step by step.
template <std::size_t kLanes>
struct CostLanes {
  const PathScene& scene;            ///< what all lanes share
  const NearbyObstacles& obstacles;  ///< what can be met, step by step
  StretchLanes<kLanes> stretch;      ///< the last steps
  TravelLanes<kLanes> travel;        ///< what f1 counts
  SteeringLanes<kLanes> steering;    ///< what f2 counts
  ClearanceLanes<kLanes> clearance;  ///< what f3 and the violation count

  /// All paths begin at `start`, at time 0. Keeps references to scene and obstacles.
  [[gnu::always_inline]] CostLanes(const PathScene& scene_, const NearbyObstacles& obstacles_,
                                   const PointLanes<kLanes>& start)
      : scene(scene_), obstacles(obstacles_), stretch(start), steering(start, scene_) {}

  /// Step n, in which the vehicles fly evenly from where they were to `to`.
  [[gnu::always_inline]] void add(int n, const PointLanes<kLanes>& to) {
    if (stretch.full()) stretch.restart();
    stretch.add(to);
    travel.add(to, stretch.moved[stretch.count - 1], scene.unobstructed[static_cast<std::size_t>(n) + 1]);
    if (stretch.full() || n + 1 == scene.steps) settle(n);
  }

  /// A leg ends at `to`.
  [[gnu::always_inline]] void turn(const PointLanes<kLanes>& to) { steering.turn(to); }

  /// Ends a stretch of which n is the last step.
  [[gnu::always_inline]] void settle(int n) {
    const PlainBox bounds = stretch.bounds();
    const int before = n - static_cast<int>(stretch.count);
    if (!bounds.inside(scene.volume)) {
      for (std::size_t j = 1; j <= stretch.count; ++j) clearance.add_outside(scene, stretch.places[j]);
    }
    if (bounds.squared_distance(scene.target.x(), scene.target.y(), scene.target.z()) >
        scene.near_target * scene.near_target) {
      travel.pass((n + 1) * scene.step);
    } else {
      for (std::size_t j = 0; j < stretch.count; ++j) {
        const double end = (before + static_cast<int>(j) + 2) * scene.step;
        travel.add_time(scene, stretch.places[j + 1], stretch.moved[j], end);
      }
      travel.settle();
    }
    const bool near_bounds = !bounds.inside(scene.inner_volume);
    // What stands is looked for once.
    constexpr std::size_t kMostStanding = 256;
    std::array<std::uint32_t, kMostStanding> standing;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    const std::span<const base::Box> boxes = obstacles.standing_boxes();
    std::size_t found = 0, looked = 0;
    for (; looked < boxes.size() && found < kMostStanding; ++looked) {
      if (bounds.meets(boxes[looked])) standing[found++] = static_cast<std::uint32_t>(looked);
    }
    for (std::size_t j = 0; j < stretch.count; ++j) {
      const int step = before + static_cast<int>(j) + 1;
      const double weight = scene.step / (0.5 + step * scene.step);  // what is near in time counts more
      if (near_bounds) clearance.add_near_bounds(scene, stretch.places[j + 1], weight);
      const PlainBox here = stretch.bounds_of(j);
      keep_away_from_moving(step, here, j, weight);
      for (std::size_t k = 0; k < found + boxes.size() - looked; ++k) {
        const std::size_t i = k < found ? standing[k] : looked + k - found;
        if (here.meets(boxes[i])) keep_away(obstacles.standing(i), j, weight);
      }
    }
  }

  /// From what moves in step j of the stretch, `step` of the horizon, in which all lanes are `here`.
  [[gnu::always_inline]] void keep_away_from_moving(int step, const PlainBox& here, std::size_t j, double weight) {
    constexpr std::size_t kAtOnce = NearbyObstacles::kAtOnce;
    const std::span<const NearbyObstacle> met = obstacles.during(step);
    const NearbyMiddles middles = obstacles.middles(step);
    for (std::size_t first = 0; first < met.size(); first += kAtOnce) {
      Lanes<kAtOnce> sign;
      for (std::size_t i = 0; i < kAtOnce; ++i) {
        const std::size_t k = first + i;
        const double squared = here.squared_distance(middles.x[k], middles.y[k], middles.z[k]);
        sign[i] = squared < middles.near_squared[k] ? -1.0 : 1.0;
      }
      if (smallest(sign) > 0.0) continue;
      for (std::size_t i = 0; i < std::min(kAtOnce, met.size() - first); ++i) {
        const NearbyObstacle& obstacle = met[first + i];
        if (sign[i] > 0.0) continue;
        if (obstacle.solid < 0 || here.meets(obstacles.solid(obstacle).keep_out)) keep_away(obstacle, j, weight);
      }
    }
  }

  /// From an obstacle in step j of the stretch.
  [[gnu::always_inline]] void keep_away(const NearbyObstacle& obstacle, std::size_t j, double weight) {
    Lanes<kLanes> near;
    stretch.find_near(obstacle, j, near);
    if (smallest(near) > 0.0) return;
    if (obstacle.solid >= 0) {
      clearance.add_solid(obstacle, obstacles.solid(obstacle), stretch.places[j], stretch.places[j + 1],
                          stretch.moved[j], weight);
    } else {
      clearance.add_sphere(obstacle, stretch.places[j], stretch.places[j + 1], near, weight);
    }
  }

  /// The way from the end of the horizon to the target, m: first to a stop, as far as braking takes, then straight on
  /// (or back, where the target was overrun), or over scene.via. Without the first part a path that comes fast would be
  /// the shorter one.
  [[gnu::always_inline]] void measure_rest(Lanes<kLanes>& rest) const {
    const PointLanes<kLanes>& from = stretch.places[stretch.count - 1];
    const PointLanes<kLanes>& end = stretch.places[stretch.count];
    const Lanes<kLanes>& way = stretch.moved[stretch.count - 1];
    const Vec3 target = scene.target;
    PointLanes<kLanes> stop;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double speed = way[i] / scene.step;
      const double stopping = speed * speed * scene.inverse_braking;
      const double further = stopping / (way[i] > 0.0 ? way[i] : 1.0);
      stop.x[i] = end.x[i] + (end.x[i] - from.x[i]) * further;
      stop.y[i] = end.y[i] + (end.y[i] - from.y[i]) * further;
      stop.z[i] = end.z[i] + (end.z[i] - from.z[i]) * further;
      const double rx = target.x() - stop.x[i];
      const double ry = target.y() - stop.y[i];
      const double rz = target.z() - stop.z[i];
      rest[i] = stopping + std::sqrt(rx * rx + ry * ry + rz * rz);
    }
    for (std::size_t i = 0; scene.via && i < kLanes; ++i) {
      const Vec3 place = stop.lane(i);
      const Vec3 there = *scene.via - place;
      if (there.dot(scene.frame.axis) > 0.0)
        rest[i] += there.norm() + (scene.target - *scene.via).norm() - (scene.target - place).norm();
    }
  }

  /// After the last step. f1 = s + c·r + w_t·v·lost + w_d·d/n, m: the length s flown in the horizon and the rest r on
  /// to the target, unless it was visited (c = 0), as [Paper] Eq. (2) over the whole path; differs: plus the time lost
  /// against unobstructed flight, as length at cruise speed v, and the mean distance d/n from it, weighted.
  /// f2: the angles of Eq. (3), summed, the last leg being the straight rest. f3: the dip.
  [[gnu::always_inline]] void finish(const std::array<optimizer::Cost*, kLanes>& costs) {
    PointLanes<kLanes> target;
    target.set(scene.target);
    turn(target);
    const double horizon = scene.steps * scene.step;
    Lanes<kLanes> rest, f1;
    measure_rest(rest);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double then = travel.arrival[i] == horizon ? rest[i] / scene.cruise : 0.0;
      const double late = travel.arrival[i] + then - scene.unobstructed_time;
      const double lost = late > 0.0 ? late : 0.0;
      f1[i] = travel.length[i] + travel.counts[i] * rest[i] + scene.time_weight * scene.cruise * lost +
              scene.deviation_weight * travel.deviation[i] / scene.steps;
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (costs[i] != nullptr) *costs[i] = {{f1[i], steering.steering[i], clearance.dip[i]}, clearance.violation[i]};
    }
  }
};

}  // namespace jink::planner::horizon
