// SPDX-License-Identifier: BSD-3-Clause
// The paper's own planner in flight: jink's paper mode, from the present state, again and again.
#pragma once

#include "planner/pmomvo.hpp"
#include "planner/worker_pool.hpp"
#include "tools/arena/rival.hpp"

namespace jink::arena {

/// Problem (16) of [Paper] with PMOMVO, waypoint after waypoint from where the vehicle is to the target, for the
/// obstacles as their tracks are now; Eq. (2) to (17), see planner/paper_planner.hpp. Every plan is made anew, as
/// the paper has it: none is kept, and none knows the one before. The margin is the flight's where that is more than
/// the paper mode's own.
///
/// differs: the paper's vehicle is on its path without delay. This one follows the waypoints' timed polyline with its
/// limits of speed and acceleration, and it is that motion which is judged.
class PaperPilot final : public Rival {
 public:
  PaperPilot(const bridge::PlannerTaskSettings& settings, const planner::PaperSettings& paper);
  planner::Plan plan(const bridge::PlanJob& job) override;

 private:
  bridge::PlannerTaskSettings settings_;
  planner::PaperSettings paper_;
  planner::Pmomvo optimizer_;
  planner::WorkerPool pool_;
};

}  // namespace jink::arena
