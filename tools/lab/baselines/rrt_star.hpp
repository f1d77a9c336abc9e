// SPDX-License-Identifier: BSD-3-Clause
// The sampling-based baseline: RRT* from OMPL, replanned again and again; the paper names it as future work.
#pragma once

#include <vector>

#include "tools/lab/baselines/baseline.hpp"
#include "tools/lab/baselines/space_time_search.hpp"

namespace jink::tools::lab::baselines {

/// Flies unobstructed where that keeps the margin. Else searches space and time with RRT* (space_time_search.hpp) at
/// cruise speed towards the target, or towards the point of the straight line that lies three quarters of the time
/// looked ahead away; obstacles move as their tracks predict. The way found is then flown with bounded speed and
/// acceleration, and that motion is checked: on to the target, and with a stop at the way's end. The previous plan
/// seeds the search, and is kept while it is free and the new one is not clearly better, as jink does it. Where nothing
/// keeps the margin, it flies what does the least harm among the new way, the old one and a hard stop.
///
/// The budget is a number of iterations: the wall clock has no say.
class RrtPilot final : public Baseline {
 public:
  explicit RrtPilot(const bridge::companion::PlannerTaskSettings& settings, const SpaceTimeSettings& search = {})
      : settings_(settings), search_(search) {}
  planner::verify::Plan plan(const bridge::companion::PlanJob& job) override;

 private:
  [[nodiscard]] std::vector<SpaceTime> search(const bridge::companion::PlanJob& job) const;
  [[nodiscard]] SpaceTimeProblem problem(const planner::horizon::PathRequest& request,
                                         std::vector<planner::base::Track>& spheres) const;

  bridge::companion::PlannerTaskSettings settings_;
  SpaceTimeSettings search_;
};

}  // namespace jink::tools::lab::baselines
