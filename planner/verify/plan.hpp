// SPDX-License-Identifier: BSD-3-Clause
// What planning gives back.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::verify {

/// What is known of a plan's path.
enum class PlanStatus {
  kReaches,       ///< free and within the vehicle's limits, verified, to the target
  kProgresses,    ///< free, verified, for the time looked ahead; beyond that nothing is claimed
  kBlocked,       ///< no free plan was found: the path is the least bad manoeuvre
  kStartBlocked,  ///< the vehicle is inside an obstacle at the start
  kInvalid        ///< the request holds a number that is none or absurd; there is no path
};
/// The status as the flight log has it: reaches, progresses, blocked, start_blocked or invalid.
std::string_view to_string(PlanStatus status);

/// Whether a vehicle of this radius stands inside an obstacle at time 0.
[[nodiscard]] bool start_blocked(const Vec3& start, double vehicle_radius, std::span<const base::Track> tracks,
                                 std::span<const geometry::KnownPath> paths = {});

/// How far a search went: the generations that were scheduled, and of these the ones done. 0, 0: it was not made.
struct SearchExtent {
  int schedule = 0;     ///< generations scheduled
  int generations = 0;  ///< generations done

  /// Equal in both numbers.
  bool operator==(const SearchExtent&) const = default;
};

/// A path, what the verifier says of it, and how it was found.
struct Plan {
  PlanStatus status = PlanStatus::kInvalid;  ///< what is known of the path
  base::TimedPath path;                      ///< ENU, from time 0 on; empty where the status is kInvalid
  Verification verification;                 ///< of the path, in continuous time
  double horizon = 0.0;                      ///< horizon mode: how far it was looked ahead, s
  std::int64_t evaluations = 0;              ///< solutions evaluated in all searches
  int schedule = 0;                          ///< generations that were scheduled in the search that gave the path
  int generations = 0;                       ///< generations that were done in it

  /// Horizon mode: the search with the acceleration that plans normally use, and the one with more. With these, the
  /// arguments and the seed the plan can be repeated.
  std::array<SearchExtent, 2> searches{};
  bool deadline_reached = false;             ///< a deadline ended the search
  bool kept_previous = false;                ///< the plan before was kept
  bool emergency = false;                    ///< more acceleration is used than plans normally may
  std::vector<std::array<double, 2>> front;  ///< the first two objectives of the (first) front
};

}  // namespace jink::planner::verify
