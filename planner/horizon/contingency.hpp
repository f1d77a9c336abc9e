// SPDX-License-Identifier: BSD-3-Clause
// How a vehicle comes to rest that is not to fly on: verified, without a search.
#pragma once

#include <functional>
#include <span>

#include "planner/base/settings.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::horizon {

/// A path to rest, and what the verifier says of it.
struct Stop {
  base::TimedPath path;               ///< ENU, from time 0 on; at its end the vehicle rests
  verify::Verification verification;  ///< up to the horizon, of the rest too
  int choice = 0;                     ///< 0: it is the first of those that were looked at
};

/// Chooses a stop. Not thread-safe; a pure function of its arguments.
class Contingency {
 public:
  /// Of `settings` it uses the horizon and the acceleration for emergencies. Throws as PathProblem does.
  explicit Contingency(const base::HorizonSettings& settings) : problem_(settings.for_emergencies()) {}

  /// The first stop that is free up to the horizon and keeps request.margin: of `stops`, which begin in the request's
  /// state at time 0, in their order; then of stops above, beside and below the end of the first, the nearest first.
  /// Where none keeps the margin: the one that does the least harm. The request's target is not looked at. For a
  /// request that is_valid() in path_check.hpp refuses: the first, not valid. Precondition: `stops` holds a path, none
  /// of them is empty. O(stops · (points + tracks)), allocates.
  /// Of its own stops, those above, beside and below, it leaves out what is not `allowed`, where that is asked.
  Stop choose(const PathRequest& request, std::span<const base::TimedPath> stops,
              const std::function<bool(const base::TimedPath&)>& allowed = {});

 private:
  PathProblem problem_;
};

}  // namespace jink::planner::horizon
