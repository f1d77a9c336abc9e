// SPDX-License-Identifier: BSD-3-Clause
// How near the vehicle comes to a solid that moves and turns.
#pragma once

#include <cstdint>

#include "planner/verify/relative_motion.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::verify {

/// From a point to the surface of the body, the point relative to the body's reference point, ENU, m; negative in a
/// prism, minus the way out, and 0 in a hull. Never more than it is by more than rounding. O(vertices) for each of a
/// few steps, no heap. Precondition: a solid.
[[nodiscard]] double solid_distance(const base::Body& body, const Vec3& point);

/// Folds one piece of relative motion, which starts at path time `t0`, when the body is as given, into the result, for
/// a vehicle of that radius. Where it turns or swings so fast that the nearest place is not found in 100 000 steps, the
/// result is not valid.
///
/// Seen from the body, the vehicle's centre goes along a curve q(t). The distance d to a convex body is convex: with
/// its gradient g at an end of an interval, d(q(t)) is nowhere below d + g · (q(t) - q), and that is nowhere below a
/// line less as much as g · q(t) bends, of which its second derivative is at most some a. The two ends' lines, each
/// made steeper by a/2 times the interval's width, bound d from below, and intervals are split until no bound is below
/// what was found by more than 1e-9 m, and rounding (branch and bound with an alpha underestimator, Adjiman et al.,
/// 1998). Along the vertical turning bends nothing, and what is round about it need not be turned: else a hovering
/// vehicle that is as far all the time would not be judged.
void fold_solid(const RelativeMotion& m, const base::Body& body, double t0, double vehicle_radius, std::uint64_t id,
                Verification& result);

}  // namespace jink::planner::verify
