// SPDX-License-Identifier: BSD-3-Clause
// Polygons on the level: whether one bounds an area, and the convex ones that it is made of.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace jink::planner::geometry {

/// A point on the level: east and north, m.
using Vec2 = Eigen::Vector2d;

/// Whether the corners, in either turn, bound one area: three or more, all finite, and no two edges meet but
/// neighbours at the corner that they share. O(n²).
[[nodiscard]] bool is_simple(std::span<const Vec2> corners);

/// The same corners, counter-clockwise.
[[nodiscard]] std::vector<Vec2> counter_clockwise(std::vector<Vec2> corners);

/// Convex polygons, counter-clockwise, that together are the polygon: itself where it is convex, else triangles (ear
/// clipping, Meisters 1975). Where rounding leaves no ear, the last piece is all corners that are left, whose hull
/// holds the rest. Precondition: is_simple(). O(n³), in practice O(n²).
[[nodiscard]] std::vector<std::vector<Vec2>> convex_pieces(std::span<const Vec2> corners);

}  // namespace jink::planner::geometry
