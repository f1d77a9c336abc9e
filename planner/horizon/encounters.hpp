// SPDX-License-Identifier: BSD-3-Clause
// What unobstructed flight meets, and how far a plan has to look for it.
#pragma once

#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::planner::horizon {

/// Where unobstructed flight comes too close to an obstacle.
struct Encounter {
  double t = 0.0;                 ///< of the closest approach to a sphere; when it first comes too close to a solid, s
  double until = 0.0;             ///< the same for a sphere; when it last is too close to a solid, s
  Vec3 apart = Vec3::Zero();      ///< from the obstacle's centre to the vehicle, at time t, m
  Vec3 from_face = Vec3::Zero();  ///< from where a solid is nearest to the vehicle, then, m; `apart` of a sphere
  Vec3 closing = Vec3::Zero();    ///< velocity of the vehicle relative to the obstacle, then, m/s
  double wanted = 0.0;            ///< distance from a sphere's centre, or from a solid's surface, m
  PlacedSolid solid;              ///< at time t

  /// How far from the obstacle's centre the vehicle is to be in a direction, unit vector, ENU, m.
  [[nodiscard]] double extent(const Vec3& direction) const {
    return solid.is_none() ? wanted : solid.extent(direction) + wanted;
  }
};

/// What is kept from an obstacle's surface by what a search begins with, m: the vehicle cuts corners.
inline double first_clearance(const PathRequest& request, const base::HorizonSettings& settings) {
  return request.margin + settings.seed_clearance;
}

/// The first settings.encounters encounters within `until`, in order of time. `unobstructed` is flight that regards no
/// obstacle. O(obstacles · points).
std::vector<Encounter> encounters(const PathRequest& request, const base::TimedPath& unobstructed, double until,
                                  const base::HorizonSettings& settings);

/// How far a plan looks ahead and aside.
enum class Extent {
  kBrief,  ///< HorizonSettings::for_brief()
  kUsual,  ///< as the settings are
  kFar     ///< HorizonSettings::for_far()
};

/// How far the way on asks to be looked at: the shortest horizon in which it leads on. kBrief: where it is met first, a
/// place keeps clear so near by that the vehicle can be there within settings.brief_time, at one of the next waypoints'
/// times; not where it is at the target by then, since it is to stay there, nor where it is stuck. Along
/// PathRequest::way only what moves is met: the way leads past what stands, and on. kUsual: one within
/// settings.lateral_range does. kFar: one within settings.far_range does. Closed all the way it is kUsual.
/// `unobstructed` as for encounters(), up to the usual horizon. O(obstacles · (points + places)), allocates.
Extent extent_of(const PathRequest& request, const base::TimedPath& unobstructed,
                 const base::HorizonSettings& settings);

}  // namespace jink::planner::horizon
