// SPDX-License-Identifier: BSD-3-Clause
// What is kept of one flight and of one world: a line each of the results file.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "planner/base/types.hpp"
#include "tools/lab/arena/settings.hpp"
#include "tools/lab/statistics/samples.hpp"

namespace jink::tools::lab::arena {

using jink::tools::lab::statistics::DurationHistogram;
using jink::tools::lab::statistics::Proportion;
using jink::tools::lab::statistics::quantile;
using jink::tools::lab::statistics::wilson;

/// Wall-clock figures: another run, machine or thread count gives others.
struct Measured {
  double wall_s = 0.0;          ///< of the whole flight
  std::int64_t late_plans = 0;  ///< that took longer than horizon.deadline_ms
  DurationHistogram plan_ms;    ///< of each plan, around the planner
};

/// One flight. All but `measured` follows from the campaign's settings, bit by bit.
struct FlightRecord {
  std::size_t job = 0;
  std::string family;
  std::uint64_t seed = 0;
  std::string tier, pilot;
  std::string outcome;  ///< as in the flight summary of contracts
  std::string reason;
  double flight_time = 0.0;
  double path_length = 0.0;
  double straight_length = 0.0;
  double min_clearance = planner::base::kInfinity;  ///< by the true motion; infinite: no obstacles
  double max_speed = 0.0;                           ///< flown
  double cruise_speed = 0.0;                        ///< of the vehicle
  double speed_limit = 0.0;                         ///< likewise
  double tracking_error = 0.0;                      ///< the largest
  std::int64_t plans = 0;
  std::int64_t blocked_plans = 0;
  std::int64_t deadline_misses = 0;  ///< in virtual time: with the configured latency
  Measured measured;

  [[nodiscard]] bool reached() const { return outcome == "reached"; }
};

/// Whether a flight through a world exists.
enum class Verdict {
  kFlown,       ///< a pilot of this campaign reached the target
  kSolvable,    ///< the oracle has a flight
  kImpossible,  ///< the oracle shows that there is none
  kUnknown      ///< neither was shown
};
[[nodiscard]] std::string_view to_string(Verdict verdict);

struct WorldRecord {
  std::size_t world = 0;  ///< World::number
  std::string family;
  std::uint64_t seed = 0;
  Verdict verdict = Verdict::kUnknown;
};

/// One line without its end. Numbers read back to the same bits.
[[nodiscard]] nlohmann::ordered_json to_json(const FlightRecord& record);
[[nodiscard]] nlohmann::ordered_json to_json(const WorldRecord& record);

/// The inverse. Throw std::runtime_error for anything else.
[[nodiscard]] FlightRecord flight_from(const nlohmann::ordered_json& line);
[[nodiscard]] WorldRecord world_from(const nlohmann::ordered_json& line);

/// The same in all but what was measured.
[[nodiscard]] bool same_result(const FlightRecord& a, const FlightRecord& b);

}  // namespace jink::tools::lab::arena
