// SPDX-License-Identifier: BSD-3-Clause
// What all solutions of one horizon plan share, laid out as flying and measuring them reads it.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/geometry/geometry.hpp"
#include "planner/horizon/nearby_obstacles.hpp"

namespace jink::planner::horizon {

/// How the vehicle follows a wished velocity: speed, climb and acceleration bounded, the acceleration constant in each
/// step.
struct Follower {
  double step = 0.0;            ///< s
  double inverse_speed = 0.0;   ///< 1 / largest speed
  double inverse_climb = 0.0;   ///< 1 / largest vertical speed
  double inverse_change = 0.0;  ///< 1 / largest change of velocity in a step

  /// One step of one vehicle: position p, velocity v, wished velocity w. Without a branch, for loops over vehicles.
  [[gnu::always_inline]] void advance(double& px, double& py, double& pz, double& vx, double& vy, double& vz, double wx,
                                      double wy, double wz) const {
    const double fast = std::sqrt(wx * wx + wy * wy + wz * wz) * inverse_speed;
    const double steep = std::abs(wz) * inverse_climb;
    const double more = steep > fast ? steep : fast;
    const double share = 1.0 / (more > 1.0 ? more : 1.0);
    const double dx = wx * share - vx;
    const double dy = wy * share - vy;
    const double dz = wz * share - vz;
    const double hard = std::sqrt(dx * dx + dy * dy + dz * dz) * inverse_change;
    const double part = 1.0 / (hard > 1.0 ? hard : 1.0);
    const double cx = part * dx;
    const double cy = part * dy;
    const double cz = part * dz;
    px += (vx + 0.5 * cx) * step;
    py += (vy + 0.5 * cy) * step;
    pz += (vz + 0.5 * cz) * step;
    vx += cx;
    vy += cy;
    vz += cz;
  }
};

/// How far a variable of ±1 moves a waypoint, m.
struct Reach {
  double ahead = 0.0,  ///< along the axis, of a variable above 0
      behind = 0.0,    ///< along the axis, of a variable below 0
      aside = 0.0;     ///< to the left, and upwards
};

/// The request and the settings of one plan, and what follows from them for every solution. ENU, m, s.
struct PathScene {
  int waypoints = 0;               ///< K, legs of the horizon
  int steps_per_leg = 0;           ///< between two waypoints
  int steps = 0;                   ///< in the horizon
  double step = 0.0;               ///< s
  Vec3 position = Vec3::Zero();    ///< of the vehicle at time 0
  Vec3 velocity = Vec3::Zero();    ///< of the vehicle at time 0
  Vec3 target = Vec3::Zero();      ///< where the path ends
  std::optional<Vec3> via;         ///< over which the way on leads from where the horizon ends short of it
  base::Box volume;                ///< that the path must not leave
  base::Box inner_volume;          ///< whose outside counts as a dip
  double per_clearance = 0.0;      ///< 1 / PathRequest::volume_clearance, 1/m
  geometry::PathFrame frame;       ///< from the vehicle to the target
  Follower follower;               ///< how the vehicle follows
  std::vector<Reach> reach;        ///< of each waypoint
  std::vector<Vec3> unobstructed;  ///< position after each step, the start first
  std::vector<double> speed;       ///< along the axis, likewise
  std::vector<double> mean_speed;  ///< along the axis in each leg
  std::vector<double> uneven;      ///< of each step: wished on top, in shares of the offset's mean drift along the axis
  double cruise = 0.0;             ///< along the axis, the climb limit considered
  double unobstructed_time = 0.0;  ///< to the target
  double inverse_braking = 0.0;    ///< 1 / (2 · planned acceleration): times speed² the way to a stop
  double per_catch_up = 0.0;       ///< 1 / HorizonSettings::catch_up
  double shortest_leg = 0.0;       ///< as HorizonSettings has it, and so the next four
  double near_target = 0.0;        ///< m
  double visit_range = 0.0;        ///< m
  double visit_speed = 0.0;        ///< m/s
  double visit_steps = 0.0;        ///< HorizonSettings::visit_time in steps; infinite where a visit is not enough
  double time_weight = 0.0;        ///< HorizonSettings::time_weight, times its `hurry` where there is a `via`
  double deviation_weight = 0.0;   ///< HorizonSettings::deviation_weight
};

}  // namespace jink::planner::horizon
