// SPDX-License-Identifier: BSD-3-Clause
// The paper's missions, and the optimization problems that come up in them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/paper/paper_planner.hpp"
#include "planner/paper/waypoint_problem.hpp"
#include "sim/world/known_world.hpp"

namespace jink::tools::lab::bench {

/// A mission of [Paper] Table 2 as `jink plan --mode paper` sets it, with the default settings. The request borrows
/// the tracks, so a mission stays where it is.
class Mission {
 public:
  /// A shipped scenario by name: "table2-5". Throws config::ConfigError.
  explicit Mission(const std::string& name);
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;

  [[nodiscard]] planner::paper::PaperRequest request(std::uint64_t seed) const;
  /// The same mission for horizon mode.
  [[nodiscard]] const planner::horizon::OpenLoopRequest& open_loop() const { return world_.open_loop; }
  /// SLR of a plan of this mission.
  [[nodiscard]] double slr(const planner::verify::Plan& plan) const;

 private:
  config::Scenario scenario_;
  sim::world::KnownWorld world_;
};

/// The problems of all steps of the mission that PMOMVO plans with this seed, in order.
std::vector<planner::paper::WaypointProblem> record_steps(const Mission& mission, std::uint64_t seed,
                                                          planner::base::WorkerPool& pool);

/// The step in the middle of table2-5, planned with seed 1. Made at the first call.
const planner::paper::WaypointProblem& middle_step();

}  // namespace jink::tools::lab::bench
