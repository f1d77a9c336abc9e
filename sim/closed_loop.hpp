// SPDX-License-Identifier: BSD-3-Clause
// A scenario flown in virtual time, in one process, without sockets: the companion of `fly` with the world and the
// vehicle of `sim`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bridge/companion.hpp"
#include "bridge/planner_task.hpp"
#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "sim/truth.hpp"
#include "sim/world.hpp"

namespace jink::sim {

struct ClosedLoopOptions {
  std::uint64_t seed = 1;
  int threads = 0;  ///< of the planner; 0: one for each core
  std::vector<bridge::FlightObserver*> flight_observers;
  std::vector<TruthObserver*> truth_observers;
  /// Makes the planner of the flight, from its settings and the latency in s; empty: jink's own (VirtualPlanner).
  std::function<std::unique_ptr<bridge::PlannerTask>(const bridge::PlannerTaskSettings&, double)> planner;
};

/// What happened, judged by the true motion.
struct ClosedLoopResult {
  bridge::FlightSummary flight;  ///< as the companion saw it; outcome, reason, times and lengths are the truth's
  double min_clearance = planner::kInfinity;  ///< from the vehicle's sphere to any true surface; infinite: no obstacles
};

/// Flies from rest in the air at `start`, t = 0, to the target, until it is reached, something is hit, the world is
/// left or the time limit passes. The scenario's faults happen on the way, each beginning and end an event `fault` for
/// the flight observers; further vehicles of the scenario are not there. Bit-identical for the same arguments at any
/// thread count.
ClosedLoopResult fly_closed_loop(const config::Scenario& scenario, const config::Settings& settings,
                                 const ClosedLoopOptions& options);

/// The mission that stands for a scenario: one waypoint, the flight volume as geofence, arrival in hold. The floor is
/// the volume's, or the lowest of ground, start and target where the scenario has no volume.
config::Mission mission_of(const config::Scenario& scenario);

}  // namespace jink::sim
