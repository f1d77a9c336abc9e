// SPDX-License-Identifier: BSD-3-Clause
// How near the vehicle comes to a sphere.
#pragma once

#include <cstdint>

#include "planner/verify/relative_motion.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner::verify {

/// Folds one piece of relative motion, which starts at path time `t0`, into the result: the squared distance is a
/// polynomial of degree four, whose stationary points are all found. `radius` is the sum of both.
void fold_sphere(const RelativeMotion& m, double t0, double radius, std::uint64_t id, Verification& result);

}  // namespace jink::planner::verify
