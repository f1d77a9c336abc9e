// SPDX-License-Identifier: BSD-3-Clause
// The paper's missions, and the optimization problems that come up in them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "planner/paper_planner.hpp"
#include "planner/waypoint_problem.hpp"
#include "planner/worker_pool.hpp"
#include "sim/known_world.hpp"

namespace jink::bench {

/// A mission of [Paper] Table 2 as `jink plan --mode paper` sets it, with the default settings. The request borrows
/// the tracks, so a mission stays where it is.
class Mission {
 public:
  /// A shipped scenario by name: "table2-5". Throws config::ConfigError.
  explicit Mission(const std::string& name);
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;

  [[nodiscard]] planner::PaperRequest request(std::uint64_t seed) const;
  /// The same mission for horizon mode.
  [[nodiscard]] const planner::OpenLoopRequest& open_loop() const { return world_.open_loop; }
  /// SLR of a plan of this mission.
  [[nodiscard]] double slr(const planner::Plan& plan) const;

 private:
  config::Scenario scenario_;
  sim::KnownWorld world_;
};

/// The problems of all steps of the mission that PMOMVO plans with this seed, in order.
std::vector<planner::WaypointProblem> record_steps(const Mission& mission, std::uint64_t seed,
                                                   planner::WorkerPool& pool);

/// The step in the middle of table2-5, planned with seed 1. Made at the first call.
const planner::WaypointProblem& middle_step();

}  // namespace jink::bench
