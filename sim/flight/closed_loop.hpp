// SPDX-License-Identifier: BSD-3-Clause
// A scenario flown in virtual time, in one process, without sockets: the companions of `fly` with the world and the
// vehicles of `sim`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "bridge/companion/planner_task.hpp"
#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "sim/flight/simulator_judge.hpp"
#include "sim/world/truth_observer.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::flight {

struct ClosedLoopOptions {
  std::uint64_t seed = 1;
  int threads = 0;  ///< of the planner; 0: one for each core
  std::vector<bridge::companion::FlightObserver*> flight_observers;
  std::vector<world::TruthObserver*> truth_observers;
  /// Makes the planner of the flight, from its settings and the latency in s; empty: jink's own (VirtualPlanner).
  std::function<std::unique_ptr<bridge::companion::PlannerTask>(const bridge::companion::PlannerTaskSettings&, double)>
      planner;
  std::function<bool()> interrupted;  ///< asked at every turn: true ends the flights as Ctrl-C does; may be empty
};

/// What happened, judged by the true motion.
struct ClosedLoopResult {
  /// As the companion saw it; outcome, reason, times and lengths are the truth's. Of a team: the first vehicle's, but
  /// outcome and reason are those of the vehicle that fared worst, so reached only if all reached.
  bridge::companion::FlightSummary flight;
  /// From the vehicle's sphere to any true surface; infinite: no obstacles. Of a team: the least of all, to obstacles
  /// and to each other.
  double min_clearance = planner::base::kInfinity;
  std::vector<VehicleReport> vehicles;  ///< each vehicle's own, by number
};

/// Flies from rest in the air at `start`, t = 0, to the target, until it is reached, something is hit, the world is
/// left or the time limit passes. Further vehicles of the scenario fly too, each with a companion of its own; they tell
/// each other their intents (sim/flight/team_link) and all get the same tracks, as from `jink sim`. Whoever is done
/// hangs where it is; the flight goes on until all are, or one hits something (an obstacle, another vehicle) or leaves
/// the world. The scenario's faults happen on the way, each beginning and end an event `fault`. The flight observers
/// are told what the first vehicle's companion does, the truth observers of all vehicles. Bit-identical for the same
/// arguments at any thread count.
ClosedLoopResult fly_closed_loop(const config::Scenario& scenario, const config::Settings& settings,
                                 const ClosedLoopOptions& options);

/// The mission that stands for a scenario: one waypoint, the flight volume as geofence, arrival in hold. The floor is
/// the volume's, or the lowest of ground, start and target where the scenario has no volume.
config::Mission mission_of(const config::Scenario& scenario);
/// The same for the vehicle of that number: for its own way, with intents where there are several vehicles. Throws
/// std::out_of_range.
config::Mission mission_of(const config::Scenario& scenario, std::size_t vehicle);

}  // namespace jink::sim::flight
