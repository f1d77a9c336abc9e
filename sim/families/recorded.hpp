// SPDX-License-Identifier: BSD-3-Clause
// Worlds in which movers do what real ones were recorded to do.
#pragma once

#include <cstdint>
#include <string_view>

#include "config/scenario.hpp"
#include "sim/recorded/recording.hpp"

namespace jink::sim::families {

/// The name of the family of these worlds.
inline constexpr std::string_view kRecorded = "recorded";

/// A world out of a recording: the same for the same arguments. A mission of 15 to 40 m in any direction, level, begun
/// so that the straight flight meets one of the movers at one of the moments at which it was recorded, both drawn. The
/// obstacles are that mover and all others that come within 100 m of the middle of the mission within the time limit.
/// Before the first and after the last of its places a mover goes on at the velocity that it had there: nobody was
/// looking. Where all are cylinders, as people are, the world ends at z = 0 and 1.2 m above the highest head.
///
/// ENU, m, s, relative to the meeting on the level and to the recording's zero upwards, t = 0 when the flight begins;
/// named "recorded-seed", with perfect sensing. kStartClearance and kStraightOverlap (families.hpp) hold. Throws
/// std::runtime_error where no draw of 1000 gives such a world.
[[nodiscard]] config::Scenario make_recorded_world(const recorded::Recording& recording, std::uint64_t seed);

}  // namespace jink::sim::families
