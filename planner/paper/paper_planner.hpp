// SPDX-License-Identifier: BSD-3-Clause
// Paper mode: problem (16) solved for one waypoint after the other, as [Paper] section 3.3 describes.
#pragma once

#include <cstdint>
#include <span>

#include "planner/base/budget.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/types.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/verify/plan.hpp"

namespace jink::planner::paper {

/// What a path in paper mode is planned from.
struct PaperRequest {
  Vec3 start = Vec3::Zero();                                ///< first waypoint, ENU, m
  Vec3 target = Vec3::Zero();                               ///< last waypoint, ENU, m
  base::Box volume;                                         ///< the path stays inside; start and target are
  base::VehicleLimits vehicle;                              ///< size and speeds
  std::span<const base::Track> tracks;                      ///< valid at t = 0
  base::OptimizerSettings optimizer;                        ///< of the PMOMVO that solves each step
  base::PaperSettings settings;                             ///< of the steps
  std::uint64_t seed = 1;                                   ///< of all random numbers
  base::Budget::Time deadline = base::Budget::Time::max();  ///< no step starts after it; the rest is then straight
};

/// The axis that the request is planned along: its own, but the path's where world X does not carry the mission (the
/// extent in x is less than a third of the distance).
base::Axis effective_axis(const PaperRequest& request);

/// Plans the whole path at once. Each step's optimum is chosen from the front by modified TOPSIS with entropy weights
/// among the solutions that violate nothing, or the least. The finished path is verified in continuous time: the status
/// is kReaches only for a free one within the limits of speed and climb, else kBlocked; kInvalid and no path for a
/// request that planner/geometry/validity.hpp refuses. The same bits for any number of threads. Throws
/// std::invalid_argument for settings that Pmomvo refuses or fewer than two waypoints.
verify::Plan plan_paper(const PaperRequest& request, base::WorkerPool& pool);

/// The same with another optimizer, for problems of two variables and two objectives, in place of PMOMVO; of
/// `request.optimizer` only the iterations are used.
verify::Plan plan_paper(const PaperRequest& request, optimizer::Optimizer& optimizer, base::WorkerPool& pool);

}  // namespace jink::planner::paper
