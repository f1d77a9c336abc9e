// SPDX-License-Identifier: BSD-3-Clause
// Quality of a front of two minimised objectives: hypervolume, maximum spread, hole relative size; and of a path: SLR.
#pragma once

#include <array>
#include <span>

namespace jink::planner::optimizer {

/// Values of two minimised objectives.
using Point2 = std::array<double, 2>;

/// Bounds to normalise fronts that are compared: the ideal and the nadir of their union.
struct FrontBounds {
  Point2 ideal{};  ///< the smallest value of each objective
  Point2 nadir{};  ///< the largest value of each objective among the non-dominated points
};
/// Bounds of the union of `points`, of which the nadir is taken over the non-dominated ones. Precondition: not empty.
FrontBounds front_bounds(std::span<const Point2> points);

/// The point in units of the bounds' extent, 0 at the ideal and 1 at the nadir; 0 along an objective without extent.
Point2 normalise(const Point2& point, const FrontBounds& bounds);

/// HV: area dominated by the points and bounded by `reference`. Points that do not dominate the reference add nothing.
/// Exact, O(n log n). With normalised points the reference is (1.1, 1.1).
double hypervolume(std::span<const Point2> points, const Point2& reference);

/// MS: sqrt of the mean over objectives of (extent of the front / extent of the reference front)². 0 for one point; an
/// objective in which the reference has no extent counts 1. Preconditions: both not empty.
double maximum_spread(std::span<const Point2> front, std::span<const Point2> reference);

/// HRS (Collette and Siarry): the largest gap between neighbours along the front over the mean gap; 1 for fewer than
/// three points or a front without extent.
double hole_relative_size(std::span<const Point2> front);

/// SLR: path length over straight distance; 1 where the straight distance is 0 and nothing was flown.
double straight_line_rate(double path_length, double straight_length);

}  // namespace jink::planner::optimizer
