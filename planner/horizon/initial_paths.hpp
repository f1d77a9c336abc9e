// SPDX-License-Identifier: BSD-3-Clause
// What a pilot would try first: rough paths that the optimizer starts from. Nothing here is checked or promised free.
#pragma once

#include <optional>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::planner::horizon {

/// Paths from the request's state, one point at each waypoint's time, settings.leg() apart:
/// - along the request's way, where it has one, at cruise speed and slower;
/// - through the clearest places across the path where the first obstacle is met (find_gaps()), at the times of
///   passages(), waiting before it until then;
/// - unobstructed flight delayed, slowed and hurried (waiting, and letting pass), and a stop;
/// - lanes beside, above and below it, left again towards the end;
/// - for each of the first obstacles that unobstructed flight meets, the displacements that lead just past it in
///   relative motion, that is out of its velocity obstacle (Fiorini and Shiller 1998): on the near side, on the far
///   side, and between them, taken around the time of the encounter; and a stop short of it.
/// `unobstructed` is flight that regards no obstacle, with points at least to the horizon. What is to be kept from an
/// obstacle's surface is first_clearance(). O(obstacles · points).
std::vector<base::TimedPath> initial_paths(const PathRequest& request, const base::TimedPath& unobstructed,
                                           const base::HorizonSettings& settings);

/// The opening through which the way leads on, where unobstructed flight is met within the horizon: as initial_paths()
/// looks for it, at the horizon's end. Nothing where no place there keeps clear, or nothing is met.
std::optional<Vec3> gap_ahead(const PathRequest& request, const base::TimedPath& unobstructed,
                              const base::HorizonSettings& settings);

}  // namespace jink::planner::horizon
