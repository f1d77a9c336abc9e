// SPDX-License-Identifier: BSD-3-Clause
// What a scenario asks of its autopilots: wind, an estimate that errs, and the faults that befall them.
#pragma once

#include <cstdint>

#include "config/scenario.hpp"
#include "sim/faults/fault_timeline.hpp"
#include "sim/vehicle/autopilot.hpp"
#include "sim/world/sensing.hpp"

namespace jink::sim::faults {

/// Estimate less truth, now.
[[nodiscard]] world::EstimateError estimate_error(const vehicle::Autopilot& autopilot);

/// Wind and estimate of the scenario. The seed is that of the run and the vehicle's number, so that each vehicle's
/// gusts and errors are its own.
void set_conditions(const config::Scenario& scenario, std::uint64_t seed, int vehicle,
                    vehicle::AutopilotOptions& options);

/// Does to vehicle `vehicle` what a change of the timeline says, if it befalls it; the timeline has advanced to it.
/// Faults of links and tracks are not its business. A battery that was low is full again when the fault ends.
void apply(const FaultTimeline& timeline, const FaultChange& change, int vehicle, vehicle::Autopilot& autopilot);

}  // namespace jink::sim::faults
