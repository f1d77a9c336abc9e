// SPDX-License-Identifier: BSD-3-Clause
// Horizon mode for a world that is taken as known: the whole path at once, for `jink plan`.
#pragma once

#include <cstdint>

#include "planner/base/budget.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/geometry/static_map.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/verify/plan.hpp"

namespace jink::planner::horizon {

/// What an open-loop plan starts from.
struct OpenLoopRequest {
  PathRequest path;                          ///< from rest at the start; tracks valid at t = 0
  double time_limit = 0.0;                   ///< the path is cut here; not below 0
  double commit = 0.5;                       ///< how much of each plan is kept before planning on: whole steps; above 0
  const geometry::StaticMap* map = nullptr;  ///< what stands still besides; borrowed, none: nothing does
};

/// One plan after the other along the path itself, the obstacles extrapolated from t = 0. What arrives is pulled tight
/// (elastic_band()), with as much time as it needs to bend. So is the way that would be flown if there were nothing.
/// Of the two the better one is returned: the one that arrives, then the one that is free, then the one that comes
/// nearer, then the shorter one, 0.05 m of length for a second. `budget` is that of each plan, its deadline that of
/// all.
///
/// The finished path is verified: kReaches only where all of it is free and within the vehicle's limits and it ends at
/// the target within the time limit, kInvalid and no path for a request that holds what is none. `make` and what is
/// thrown: as for HorizonPlanner.
verify::Plan plan_open_loop(const base::HorizonSettings& settings, const base::OptimizerSettings& optimizer,
                            const OpenLoopRequest& request, std::uint64_t seed, const base::Budget& budget,
                            base::WorkerPool& pool, const optimizer::MakeOptimizer& make = {});

}  // namespace jink::planner::horizon
