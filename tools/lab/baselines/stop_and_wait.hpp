// SPDX-License-Identifier: BSD-3-Clause
// The baseline that never leaves the straight line: it stops and waits.
#pragma once

#include "tools/lab/baselines/baseline.hpp"

namespace jink::tools::lab::baselines {

/// Flies as StraightPilot while that is predicted to keep the margin for `settings.time` seconds, else brakes to rest
/// and waits until it is. It goes on, too, where stopping is predicted to be hit and going on is not, or later: a
/// waiting vehicle does not dodge, but it does not stop in front of what it could still pass.
class WaitingPilot final : public Baseline {
 public:
  explicit WaitingPilot(const planner::base::HorizonSettings& settings) : settings_(settings) {}
  planner::verify::Plan plan(const bridge::companion::PlanJob& job) override;

 private:
  planner::base::HorizonSettings settings_;
};

}  // namespace jink::tools::lab::baselines
