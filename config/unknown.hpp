// SPDX-License-Identifier: BSD-3-Clause
// What counts where nothing was seen: key `unknown` of a mission's cloud and of a scenario's scan.
#pragma once

#include <array>
#include <string_view>

namespace jink::config {

/// Free: it is flown there, and what stands is found on the way. Occupied: it is flown where it was seen to be free.
enum class Unknown { kFree, kOccupied };

inline constexpr std::array<std::string_view, 2> kUnknown = {"free", "occupied"};  ///< Unknown's values

}  // namespace jink::config
