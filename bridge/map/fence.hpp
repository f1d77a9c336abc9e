// SPDX-License-Identifier: BSD-3-Clause
// The geofence that an autopilot keeps, as solids that plans keep clear of.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bridge/frames/geodetic.hpp"
#include "bridge/mavlink/messages.hpp"
#include "config/mission.hpp"
#include "config/scenario.hpp"
#include "planner/geometry/polygon.hpp"

namespace jink::bridge::map {

/// Local ENU, m.
struct Fence {
  std::vector<std::vector<planner::geometry::Vec2>> inside;  ///< areas, of which the vehicle is to be in one; none: any
  std::size_t outside = 0;                                   ///< how many areas it is to be out of
  std::vector<config::Obstacle> solids;  ///< walls along the first, prisms and cylinders for the others

  /// Whether it lets a vehicle be there, as far as the areas go that one is to be in; the edge counts as inside.
  [[nodiscard]] bool holds(const Vec3& p) const;
};

/// What MAV_CMD_NAV_FENCE_* items say, about the autopilot's local origin. An area to be in is closed by walls of 1 m
/// just outside its edges, a circle being a polygon of 64 edges within it. Where there are several, PX4 lets a vehicle
/// go from one into another that overlaps it; here each is closed. All solids reach from `low` to `high`.
///
/// Throws std::runtime_error in one line for a polygon that crosses itself or whose corners are not all there, a circle
/// without a radius, what is farther away than 100 km, and items that are no fence's.
[[nodiscard]] Fence fence_of(std::span<const mavlink::MissionItem> items, const frames::Geodetic& origin, double low,
                             double high);

/// The mission with that fence as a part of its map, from under its geofence to above it. Throws as fence_of() does,
/// and where a waypoint is not in the fence.
[[nodiscard]] config::Mission fenced(config::Mission mission, std::span<const mavlink::MissionItem> items,
                                     const frames::Geodetic& origin);

}  // namespace jink::bridge::map
