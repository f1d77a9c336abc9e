// SPDX-License-Identifier: BSD-3-Clause
// The paper's own planner in flight: jink's paper mode, from the present state, again and again.
#pragma once

#include "planner/base/worker_pool.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "tools/lab/baselines/baseline.hpp"

namespace jink::tools::lab::baselines {

/// Problem (16) of [Paper] with PMOMVO, waypoint after waypoint from where the vehicle is to the target, for the
/// obstacles as their tracks are now; Eq. (2) to (17), see planner/paper/paper_planner.hpp. The margin is the flight's
/// where that is more than the paper mode's own.
///
/// differs: the paper's vehicle is at cruise speed and on its path without delay; flown as they are, its paths hit what
/// they pass. So the time that the run-up costs is regarded (the obstacles are planned with as they are that much
/// later, and the waypoints' times follow), and the vehicle follows the timed polyline with its limits. That motion is
/// judged: it is kept while it keeps the margin, else all is planned anew; where the new one does not keep it either,
/// it is flown with more acceleration or the old one is, whichever does the least harm.
class PaperPilot final : public Baseline {
 public:
  PaperPilot(const bridge::companion::PlannerTaskSettings& settings, const planner::base::PaperSettings& paper);
  planner::verify::Plan plan(const bridge::companion::PlanJob& job) override;

 private:
  /// The paper's path among the obstacles as they are `lag` seconds later.
  planner::verify::Plan ask(const bridge::companion::PlanJob& job, double lag);

  bridge::companion::PlannerTaskSettings settings_;
  planner::base::PaperSettings paper_;
  planner::optimizer::Pmomvo optimizer_;
  planner::base::WorkerPool pool_;
};

}  // namespace jink::tools::lab::baselines
