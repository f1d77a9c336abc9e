// SPDX-License-Identifier: BSD-3-Clause
// The optimization within ORCA: the velocity nearest to a wished one that half-spaces and a largest speed allow.
#pragma once

#include <optional>
#include <span>

#include "planner/base/types.hpp"

namespace jink::tools::lab::baselines {

/// Velocities v with normal · v >= offset (m/s). The normal has length 1.
struct HalfSpace {
  Vec3 normal = Vec3::UnitX();
  double offset = 0.0;
};

/// The velocity nearest to `wished` with |v| <= `speed` that lies in all half-spaces, to kTolerance; none where there
/// is none. Incremental, as Seidel's linear programming (Small-dimensional linear programming and convex hulls made
/// easy, 1991), which van den Berg et al. 2011, section 5.3, use for ORCA: a half-space that the optimum of those
/// before it violates has the new optimum on its plane; the same on planes, and on lines. O(n) for half-spaces in
/// random order, O(n³) at worst.
[[nodiscard]] std::optional<Vec3> nearest_velocity(std::span<const HalfSpace> half_spaces, double speed,
                                                   const Vec3& wished);

/// The same where that may be impossible: `hard` half-spaces hold, and all of `soft` are moved back by the same least
/// distance at which a velocity exists (section 5.3 of the paper: the velocity that penetrates the constraints
/// least). Found by bisection to kTolerance. `relaxed`, where given, gets that distance, m/s. Where not even the hard
/// ones can hold, v = 0.
[[nodiscard]] Vec3 least_violating_velocity(std::span<const HalfSpace> hard, std::span<const HalfSpace> soft,
                                            double speed, const Vec3& wished, double* relaxed = nullptr);

inline constexpr double kTolerance = 1e-9;  ///< m/s

}  // namespace jink::tools::lab::baselines
