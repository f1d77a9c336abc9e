// SPDX-License-Identifier: BSD-3-Clause
// The rival that looks at nothing: what a world does to a vehicle without avoidance.
#pragma once

#include "tools/arena/rival.hpp"

namespace jink::arena {

/// Straight to the target at cruise speed, with the acceleration that plans normally use, braking for the target as
/// undisturbed flight does. The plan's status says what lies in the way; the path does not change for it.
class StraightPilot final : public Rival {
 public:
  explicit StraightPilot(const planner::HorizonSettings& settings) : settings_(settings) {}
  planner::Plan plan(const bridge::PlanJob& job) override;

 private:
  planner::HorizonSettings settings_;
};

}  // namespace jink::arena
