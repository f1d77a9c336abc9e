// SPDX-License-Identifier: BSD-3-Clause
// An independent judge of worlds and of paths: whether a free flight exists, and how near a path comes to the true
// obstacles. It knows the whole future. Nothing in it is planner code; of sim it takes the true positions (World) and
// the distance to what stands and to a hull of vertices, no more. Most worlds cost it hundredths of a second, those
// with a map about one second (jink_oracle_table measures it); one that stays unknown, some seconds.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"

namespace jink::tools::lab::oracle {

/// Where the vehicle's centre is at a time: ENU, m, scenario time in s. Between two of them it goes at constant
/// velocity.
struct TimedPoint {
  double t = 0.0;
  Vec3 position = Vec3::Zero();
};

struct OracleOptions {
  double margin = 0.4;              ///< m, that a flight must keep from every surface
  double least_margin = 0.15;       ///< m, the same where there is no such flight, as through a door of 1.3 m
  double acceleration_share = 0.5;  ///< of the vehicle's limit that a flight may use
  double acceptance = 0.5;          ///< m, from the target, within which a world without a flight must not let it come
};

enum class Verdict {
  kSolvable,    ///< here is a flight
  kImpossible,  ///< no vehicle of this size and speed gets there in time, however well it accelerates
  kUnknown      ///< neither was shown
};
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// A flight from rest at the start, t = 0, to rest at the target. Its points lie so close that the constant
/// accelerations in between leave the straight pieces by less than 2 mm.
struct Flight {
  std::vector<TimedPoint> path;
  double arrival_time = planner::base::kInfinity;   ///< of this flight; an earlier one may exist
  double min_clearance = planner::base::kInfinity;  ///< true_clearance() of the path
};

struct OracleResult {
  Verdict verdict = Verdict::kUnknown;
  Flight flight;               ///< of the scenario's own vehicle; empty unless solvable
  std::vector<Flight> others;  ///< of the further vehicles, by number from 1; empty unless solvable
};

/// The answers in one: a narrow search, then the proof that there is no flight, then a wide search, then
/// find_tight_flight(). All are deterministic. Thread safe. A team (Scenario::vehicles) is solvable if find_flights()
/// finds a flight for each, and impossible if one of them could not even get there alone. Unknown where something
/// chases (config::ChaseMotion): what it does is no function of time. The functions below take it for standing.
[[nodiscard]] OracleResult judge(const config::Scenario& scenario, const OracleOptions& options = {});

/// How hard a search tries. A fine one is as wide as a wide one, in steps half as large.
enum class Effort { kNarrow, kWide, kFine };

/// A flight that keeps to the vehicle's speed, climb and share of acceleration, to the world (or, without one, 8 m
/// around the mission and above the lowest of ground, start and target) and to the margin, and arrives within the time
/// limit and four straight flights at full speed and half a minute; or nothing, which proves nothing. It is a chain of
/// half seconds at constant acceleration between whole metres per second on each axis (a fine search: half metres per
/// second), found by a beam search over time with wide beams, and the last decimetres to the target. Beams are led
/// round what stands by the shortest ways on a grid of a quarter of a metre. Shapes count as they are. What it returns
/// is checked by true_clearance(), not by the search, so it is right whatever the search does. Further vehicles are not
/// there.
[[nodiscard]] std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options,
                                                Effort effort);
/// The same, narrow first and then wide, then find_tight_flight().
[[nodiscard]] std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options = {});
/// A flight that keeps the least margin, searched for narrow and then fine; nothing where that is not the smaller one.
[[nodiscard]] std::optional<Flight> find_tight_flight(const config::Scenario& scenario, const OracleOptions& options);

/// A flight for each vehicle of the scenario, by number, that keeps the margin from the obstacles and from the flights
/// of those before it, or nothing, which proves nothing.
[[nodiscard]] std::vector<Flight> find_flights(const config::Scenario& scenario, const OracleOptions& options = {});

/// The scenario with that vehicle for its own and no others. Throws std::out_of_range.
[[nodiscard]] config::Scenario alone(const config::Scenario& scenario, std::size_t vehicle);

/// Whether no motion at all gets within `options.acceptance` of the target by the time limit that keeps to max_speed
/// and max_climb and touches nothing. An over-approximation of what can be reached is followed in steps of 50 ms: all
/// cells of a grid next to a reached one, less those that lie wholly where the vehicle overlaps an obstacle or the map
/// at that instant. A cell is as long as the vehicle flies in a step, so it cannot pass more than one. Where the
/// scenario has no world, the vehicle may come in from everywhere, 8 m around the mission. Further vehicles are not
/// there.
[[nodiscard]] bool certainly_impossible(const config::Scenario& scenario, const OracleOptions& options = {});

/// The smallest distance, in continuous time, from the vehicle's sphere to the true surface of any obstacle or solid of
/// the map while it flies `path`, to 0.1 mm (never below the truth); infinite without any of them or without points.
/// Negative: they overlap, or minus the vehicle's radius for a centre in a hull of vertices. Times must not decrease.
/// Bisection with a bound on the speed of the approach: no contact is missed.
[[nodiscard]] double true_clearance(const config::Scenario& scenario, std::span<const TimedPoint> path);

/// The largest speed and vertical speed on the pieces of `path`, m/s; infinite where it jumps.
[[nodiscard]] double top_speed(std::span<const TimedPoint> path);
[[nodiscard]] double top_climb(std::span<const TimedPoint> path);

}  // namespace jink::tools::lab::oracle
