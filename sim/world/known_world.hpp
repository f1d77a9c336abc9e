// SPDX-License-Identifier: BSD-3-Clause
// A scenario as `jink plan` knows it: the world at t = 0, each obstacle a track that is extrapolated from then on.
#pragma once

#include <memory>
#include <vector>

#include "config/scenario.hpp"
#include "planner/geometry/static_map.hpp"
#include "planner/horizon/open_loop.hpp"

namespace jink::sim::world {

struct KnownWorld {
  explicit KnownWorld(const config::Scenario& scenario);
  KnownWorld(const KnownWorld&) = delete;
  KnownWorld& operator=(const KnownWorld&) = delete;

  std::vector<planner::base::Track> tracks;   ///< exact at t = 0, in the order of the scenario's obstacles
  std::vector<planner::base::Track> spheres;  ///< the same, each the sphere that encloses it: what the paper knows
  std::shared_ptr<const planner::geometry::StaticMap> map;  ///< the scenario's; the paper knows none
  planner::base::Box volume;  ///< the scenario's world, or all above the lowest of ground, start and target
  planner::horizon::OpenLoopRequest open_loop;  ///< from rest at the start; borrows `tracks` and `map`
};

}  // namespace jink::sim::world
