// SPDX-License-Identifier: BSD-3-Clause
// Seeded families of worlds to judge planners on. In every world the straight line is blocked: a vehicle that flies it
// and looks at nothing hits an obstacle. Whether a free flight exists is not promised; most have one.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "config/scenario.hpp"

namespace jink::sim {

/// How a vehicle that ignores all obstacles flies from start to target: from rest, then at cruise speed (less where
/// max_climb asks for it), then to rest.
inline constexpr double kStraightAcceleration = 3.0;  ///< m/s²
inline constexpr double kStraightBraking = 2.0;       ///< m/s²

/// Every obstacle keeps this distance in metres from the vehicle's sphere at the start, at t = 0, surface to surface.
inline constexpr double kStartClearance = 1.5;

/// On the straight flight the vehicle's sphere overlaps an obstacle by at least this much, in metres.
inline constexpr double kStraightOverlap = 0.1;

/// The names that make_world() knows, in a fixed order.
///
/// Constant velocity: crossing (movers timed to meet the vehicle), head_on, overtaking (slower ones ahead and faster
/// ones from behind), falling (from above through the line), gates (pairs of spheres with a gap too small for the
/// vehicle, standing on the line or moving across it), darts (4 to 9 m/s, up to nearly twice as fast as the vehicle),
/// vertical (a steep mission, movers across), backward (the target at smaller or equal x).
///
/// Other motion: walls (one to three, closed across a corridor, with a hole that wanders), target_occupied (by an
/// obstacle that leaves late), crowd (80 bouncing in a low corridor), turning (sines), cloud (60 bouncing in a hall).
[[nodiscard]] std::span<const std::string_view> world_families();

/// Whether every obstacle of the family's worlds keeps a constant velocity for ever, so that a track of t = 0 tells all
/// of its future. False for an unknown family.
[[nodiscard]] bool is_linear(std::string_view family);

/// A world of that family: the same for the same arguments. ENU, m, s; named "family-seed", for the AR.Drone, 15 to
/// 40 m from start to target, with the default time limit. World and obstacles pass the checks of
/// config::load_scenario; kStartClearance and kStraightOverlap hold. Throws std::invalid_argument for an unknown
/// family. Deterministic; the C library's sine and cosine have a say in the last bit.
[[nodiscard]] config::Scenario make_world(std::string_view family, std::uint64_t seed);

}  // namespace jink::sim
