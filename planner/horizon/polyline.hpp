// SPDX-License-Identifier: BSD-3-Clause
// Ways of straight legs from corner to corner, ENU, m.
#pragma once

#include <span>

#include "planner/base/types.hpp"

namespace jink::planner::horizon {

/// The place of a leg that is nearest to another.
[[nodiscard]] Vec3 nearest_on_line(const Vec3& place, const Vec3& from, const Vec3& to);

/// Of all legs.
[[nodiscard]] double length_of(std::span<const Vec3> way);

/// The place so far along a way; its end where that is farther. Precondition: the way is not empty.
[[nodiscard]] Vec3 place_along(std::span<const Vec3> way, double along);

/// What is left of a way from beside a place, and the way to it. Precondition: the way is not empty.
[[nodiscard]] double left_along(std::span<const Vec3> way, const Vec3& place);

}  // namespace jink::planner::horizon
