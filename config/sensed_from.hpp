// SPDX-License-Identifier: BSD-3-Clause
// Whose frame tracks are right in: key `sensed_from` of scenarios and missions.
#pragma once

#include <array>
#include <string_view>

namespace jink::config {

/// In which frame tracks are right: an external tracker's in the world's; onboard perception's relative to the vehicle,
/// so that they carry the error of its estimate along.
enum class SensedFrom { kWorld, kVehicle };

inline constexpr std::array<std::string_view, 2> kSensedFrom = {"world", "vehicle"};  ///< SensedFrom's values

}  // namespace jink::config
