// SPDX-License-Identifier: BSD-3-Clause
// The summary objects of contracts: jink-plan/1 and jink-flight/1, and what people read.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "bridge/companion/companion.hpp"
#include "config/scenario.hpp"
#include "sim/flight/simulator_judge.hpp"

namespace jink::tools::runs {

/// `kind` is "scenario" or "mission". `min_clearance` is null where the true motion is not known or there is no
/// obstacle.
nlohmann::ordered_json flight_summary(const std::string& kind, const std::string& name, std::uint64_t seed,
                                      const bridge::companion::FlightSummary& flight,
                                      std::optional<double> min_clearance);

/// What became of each vehicle of a team, by number: [{vehicle, system, outcome, reason, flight_time_s, path_length,
/// min_clearance}, ...]. Vehicle 0 is MAVLink system `first_system`, the next is the next.
nlohmann::ordered_json vehicles_json(std::span<const sim::flight::VehicleReport> reports, int first_system);

/// A few lines for people.
std::string describe_flight(const nlohmann::ordered_json& summary);

/// What a log's header says of a scenario: name, seed, start, target, vehicle, world, parameters, and of obstacles
/// that are no spheres the shapes, of several vehicles all.
nlohmann::ordered_json scenario_header(const config::Scenario& scenario, std::uint64_t seed,
                                       const config::Settings& settings);

/// A number for JSON: null where it is not finite.
nlohmann::ordered_json finite_or_null(double value);

}  // namespace jink::tools::runs
