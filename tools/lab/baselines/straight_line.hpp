// SPDX-License-Identifier: BSD-3-Clause
// The baseline that looks at nothing: what a world does to a vehicle without avoidance.
#pragma once

#include "tools/lab/baselines/baseline.hpp"

namespace jink::tools::lab::baselines {

/// Straight to the target at cruise speed, with the acceleration that plans normally use, braking for the target as
/// unobstructed flight does. The plan's status says what lies in the way; the path does not change for it.
class StraightPilot final : public Baseline {
 public:
  explicit StraightPilot(const planner::base::HorizonSettings& settings) : settings_(settings) {}
  planner::verify::Plan plan(const bridge::companion::PlanJob& job) override;

 private:
  planner::base::HorizonSettings settings_;
};

}  // namespace jink::tools::lab::baselines
