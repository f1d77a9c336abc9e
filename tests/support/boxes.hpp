// SPDX-License-Identifier: BSD-3-Clause
// Boxes as tracks, and walls of them.
#pragma once

#include <cstddef>
#include <vector>

#include "planner/base/solid.hpp"
#include "planner/base/types.hpp"

namespace jink::support {

/// At rest, its edges along the axes.
inline planner::base::Track box(const Vec3& center, const Vec3& edges) {
  planner::base::Track track;
  track.position = center;
  track.body.solid = planner::base::Solid::box(edges, {});
  track.radius = track.body.solid->reach();
  return track;
}

/// With ids from 1 on.
inline std::vector<planner::base::Track> numbered(std::vector<planner::base::Track> tracks) {
  for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].id = i + 1;
  return tracks;
}

/// Three pieces of a wall across at x, 10 m high, that leave two doors of 1.3 m: about y = 0 and about `second`.
inline std::vector<planner::base::Track> wall_with_two_doors(double x, double second) {
  constexpr double kHalf = 0.65, kSide = 20.0;
  const auto piece = [x](double low, double high) { return box({x, 0.5 * (low + high), 4}, {0.2, high - low, 12}); };
  return numbered({piece(-kSide, -kHalf), piece(kHalf, second - kHalf), piece(second + kHalf, kSide)});
}

}  // namespace jink::support
