// SPDX-License-Identifier: BSD-3-Clause
// What the families of known places share: things of a size, and who walks and drives among them. For
// sim/families/*.cpp alone. Places are built along x, with the ground at z = 0, and turned at the end.
#pragma once

#include <vector>

#include "sim/families/builders.hpp"

namespace jink::sim::families {

/// s, for which things keep moving: longer than the longest flight of these families.
inline constexpr double kBusy = 120.0;

/// The box between two corners, at rest.
[[nodiscard]] config::Obstacle block(const Vec3& low, const Vec3& high);
/// An upright cylinder on the ground, at rest.
[[nodiscard]] config::Obstacle post(double x, double y, double radius, double height);

/// A wall from the ground up across x, from `low` to `high` in y, as thick as from x0 to x1.
struct WallAcross {
  double x0 = 0.0, x1 = 0.0;
  double low = 0.0, high = 0.0;
  double height = 0.0;
};
/// An opening in a wall, from the ground up.
struct Opening {
  double middle = 0.0;  ///< in y
  double width = 0.0;
  double height = 0.0;
};
/// Adds to the map what the opening leaves of the wall: to its sides and above it.
void add_wall_with(config::Scenario& scenario, const WallAcross& wall, const Opening& opening);

/// Encloses the world, from which its floor, walls and ceiling follow, in walls and a ceiling of the map.
void add_shell(config::Scenario& scenario);

/// A place on the way of somebody who stays there for a while.
struct Stop {
  Vec3 place;
  double wait = 0.0;  ///< s
};
/// Through the stops at that speed and back again, until kBusy; it sets out at `begin`.
[[nodiscard]] config::WaypointsMotion there_and_back(const std::vector<Stop>& stops, double speed, double begin);

/// Of a door: how long it stays as it is, and how long it takes from the one to the other, s.
struct DoorTimes {
  double shut = 0.0;
  double open = 0.0;
  double moving = 0.0;
  double first = 0.0;  ///< when it first begins to open
};
/// From `shut` to `open` and back, until kBusy.
[[nodiscard]] config::WaypointsMotion opens_and_shuts(const Vec3& shut, const Vec3& open, const DoorTimes& times);

/// Adds somebody 1.6 to 1.9 m tall who walks there and back at 0.8 to 1.8 m/s, or nobody: false where they would come
/// within 0.1 m of what stands or moves in the scenario so far, or stay at the target. Heights of `stops` do not count.
bool add_walker(config::Scenario& scenario, RandomStream& random, const std::vector<Stop>& stops);
/// As many, tried often with stops from `draw()`.
template <typename Draw>
void add_walkers(config::Scenario& scenario, RandomStream& random, int count, const Draw& draw) {
  constexpr int kTries = 40;  // for each
  for (int i = 0, tries = 0; i < count && tries < kTries * count; ++tries) {
    if (add_walker(scenario, random, draw())) ++i;
  }
}

/// Turns it all by a random number of quarter turns about the origin. Of motions it knows the linear and waypoints.
void turn_quarters(config::Scenario& scenario, RandomStream& random);

}  // namespace jink::sim::families
