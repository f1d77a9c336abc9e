// SPDX-License-Identifier: BSD-3-Clause
// Problem (16) at fixed steps of a world, so that all algorithms solve the same problem objects, and how good a front
// can be there.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/problem.hpp"
#include "planner/paper/waypoint_problem.hpp"
#include "tools/lab/study/worlds.hpp"

namespace jink::tools::lab::study {

/// The non-dominated front of a problem of two variables and two objectives, by search of the whole box.
struct ReferenceFront {
  std::vector<planner::optimizer::Point2> points;  ///< by the first objective, at most a few hundred
  planner::optimizer::FrontBounds bounds;          ///< its ideal and nadir
  double hypervolume = 0.0;                        ///< of all that was found, in units of the bounds, to (1.1, 1.1)
};

/// A grid of 257 x 257 over the box, then three times a finer one about each point that is non-dominated or nearly so.
/// Stands in for the union of all fronts that are compared, which later runs would change. Deterministic.
[[nodiscard]] ReferenceFront search_reference(const planner::optimizer::Problem& problem);

/// What is said of a front, in units of the reference's bounds.
struct Indicators {
  double hv = 0.0;   ///< to (1.1, 1.1)
  double ms = 0.0;   ///< against the reference's extent
  double hrs = 0.0;  ///< largest gap over mean gap
};
/// Of a front that is not empty.
[[nodiscard]] Indicators indicators(const std::vector<planner::optimizer::Point2>& front,
                                    const ReferenceFront& reference);

/// One step: which waypoint is looked for, and the problem of it.
struct FrontStep {
  int station = 0;   ///< of the path's waypoints, from 0, the start
  bool hit = false;  ///< whether the shortest way to the station is blocked
  planner::paper::WaypointProblem problem;
  ReferenceFront reference;
};

inline constexpr std::size_t kFrontSteps = 4;

/// Four steps of a flight that left the straight line before: the vehicle is 0.8 m beside and 0.4 m above it, in turn
/// to the left and to the right, and has been flying away from the target's direction by 35 degrees (|φ| < φ_max), so
/// that the shortest way and the straightest differ; at the start of a path they are one, and the front a point.
/// Obstacles are where they are when the straight flight passes there. In a world of the paper the stations are one
/// fifth to four fifths of the waypoints. In a blocked one they are those at which the shortest way violates the
/// constraints most (of some seeds, where they are too few, it is free at the last of them). Everywhere some waypoint
/// in the box holds the constraints, and the front is no point. Throws std::invalid_argument where the settings have
/// fewer than 7 waypoints or the world has fewer than kFrontSteps such steps.
[[nodiscard]] std::vector<FrontStep> front_steps(const World& world, const planner::base::PaperSettings& settings,
                                                 bool blocked);

}  // namespace jink::tools::lab::study
