// SPDX-License-Identifier: BSD-3-Clause
// How the vehicle moves, seen from an obstacle, while neither changes its acceleration.
#pragma once

#include "planner/base/types.hpp"

namespace jink::planner::verify {

/// p0 + p1 t + p2 t² on [0, duration], from the obstacle's centre to the vehicle's; ENU, m, s.
struct RelativeMotion {
  Vec3 p0,                ///< m
      p1,                 ///< m/s
      p2;                 ///< m/s²
  double duration = 0.0;  ///< s

  /// Where the vehicle is.
  [[nodiscard]] Vec3 at(double t) const { return p0 + t * (p1 + t * p2); }
  /// How fast it is.
  [[nodiscard]] Vec3 velocity(double t) const { return p1 + 2.0 * t * p2; }
};

}  // namespace jink::planner::verify
