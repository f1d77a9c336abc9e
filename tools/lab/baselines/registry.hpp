// SPDX-License-Identifier: BSD-3-Clause
// Who flies in the arena: jink, the paper's planners, and baselines. All get the same tracks and state in and give a
// timed path out (bridge::PlannerTask); setpoints, supervisor, sensing and vehicle are the same for all.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "bridge/companion/planner_task.hpp"

namespace jink::tools::lab::baselines {

/// The names that make_pilot() knows, in this order: jink (the horizon planner), paper (jink's paper mode, replanned
/// from the present state), momvo (the horizon problem with MOMVO alone: one slave, no sharing), straight (looks at
/// nothing), stop_and_wait (stays on the straight line), orca (reactive velocity obstacles), rrt_star (RRT* of OMPL).
[[nodiscard]] std::span<const std::string_view> pilots();

/// The planner of that pilot for one flight in virtual time; a plan is there `latency` seconds after its beginning.
/// `paper` is for the pilot of that name. All are deterministic: the same jobs, settings and seed give the same bits at
/// any number of threads, also where other flights go on beside. Throws std::invalid_argument for an unknown name, and
/// what the planner throws for settings that it refuses.
[[nodiscard]] std::unique_ptr<bridge::companion::PlannerTask> make_pilot(
    std::string_view name, const bridge::companion::PlannerTaskSettings& settings, double latency,
    const planner::base::PaperSettings& paper = {});

}  // namespace jink::tools::lab::baselines
