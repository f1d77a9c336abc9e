// SPDX-License-Identifier: BSD-3-Clause
// A request's path before the verifier, and which of two does less harm.
#pragma once

#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::horizon {

/// Whether all numbers are ones to plan with (planner/geometry/validity.hpp), margins, track_acceleration and
/// sudden_change not below 0, and what stands does. O(tracks + points of the paths).
[[nodiscard]] bool is_valid(const PathRequest& request);

/// Whether a path can be the plan before, of which the request is the continuation: it is at the request's position at
/// time 0, within 1e-6 m, and does in the `step` s from there what a vehicle at the request's velocity can: it strays
/// from even motion by no more than twice what the vehicle's acceleration gives, and 0.06 m. (A path's velocity is told
/// by its positions. A plan's last step may be off by the distance at which it counts as there.)
[[nodiscard]] bool continues(const base::TimedPath& path, const PathRequest& request, double step);

/// Checks a path among the request's obstacles up to a path time, s; a path that ends before waits at its end.
[[nodiscard]] verify::Verification verify_until(const base::TimedPath& path, const PathRequest& request, double until);

/// Whether a path, which verify_until() found to be so, is free and keeps both margins up to then.
[[nodiscard]] bool keeps_margins(const base::TimedPath& path, const PathRequest& request, double until,
                                 const verify::Verification& found);

/// Whether a path ends at the request's target.
[[nodiscard]] bool arrives(const base::TimedPath& path, const PathRequest& request);

/// What a path that is planned for the request in steps of `step`, s, uses of the vehicle's limits. One that ends at
/// the target ends at rest.
[[nodiscard]] verify::LimitsUse use_of_limits(const base::TimedPath& path, const PathRequest& request, double step);

/// Whether `a` does less harm than `b`: free before not free, then more clearance; else free for longer (by more than
/// the verifier's accuracy), then the softer contact.
[[nodiscard]] bool is_safer(const verify::Verification& a, const verify::Verification& b);

}  // namespace jink::planner::horizon
