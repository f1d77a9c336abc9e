// SPDX-License-Identifier: BSD-3-Clause
// From a flight in memory to what the page shows: measures at the log's full rate, then thins and rounds.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "tools/report/flight_data.hpp"

namespace jink::tools::report {

/// Distance between the vehicle's surface (its centre, where the log tells no radius) and the nearest obstacle's
/// surface.
struct ClearanceSample {
  double t = 0.0;
  double distance = 0.0;
};

/// The indices to keep of samples at times `t`, which never fall: the first, the last, and between them those that
/// are `interval` or more after the last one kept.
std::vector<std::size_t> thin(std::span<const double> t, double interval);

/// From true positions of vehicle and obstacles at equal times, to the obstacles' true shapes and to other vehicles;
/// empty where the log has none. `vehicle` 0 is the log's own, k the k-th of FlightData::others. Within a hull of
/// vertices the distance to its surface counts as 0.
std::vector<ClearanceSample> true_clearance(const FlightData& flight, std::size_t vehicle = 0);

/// From the vehicle's estimate and the tracks, each track moved by its velocity to the time of the newest estimate;
/// empty where the log lacks one of the two.
std::vector<ClearanceSample> tracked_clearance(const FlightData& flight);

/// The page's data. `summary` may be null. Keys: see the viewer's data.js.
nlohmann::json report_data(const FlightData& flight, const nlohmann::json* summary);

}  // namespace jink::tools::report
