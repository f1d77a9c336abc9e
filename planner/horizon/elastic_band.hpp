// SPDX-License-Identifier: BSD-3-Clause
// Pulls a finished path tight: what a search leaves of the way that nothing asks for.
#pragma once

#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// The path as an elastic band (Quinlan and Khatib 1993): its points keep their times and slide to where the band is
/// shortest, each piece in proportion to what it was, so that it goes no faster. Obstacles as the request has them push
/// the band out to the request's margin; what a point is accelerated by is drawn towards `acceleration`, m/s², or what
/// it was, where it is more, and climb to the vehicle's. The ends, and the velocities there, stay.
///
/// Nothing is promised of the result: it is for the verifier to say whether it may be flown. `path` begins in the
/// request's state at time 0, its durations are positive. O(points · obstacles + sweeps · points · near obstacles),
/// allocates.
[[nodiscard]] base::TimedPath elastic_band(const base::TimedPath& path, const PathRequest& request,
                                           double acceleration);

}  // namespace jink::planner::horizon
