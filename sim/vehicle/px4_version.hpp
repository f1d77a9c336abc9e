// SPDX-License-Identifier: BSD-3-Clause
// The releases of PX4 that the simulator plays where they differ to a companion: docs/px4.md.
#pragma once

#include <cstdint>

namespace jink::sim::vehicle {

/// 1.17 is the alpha that was recorded.
enum class Px4Version : std::uint8_t { k1_14, k1_16, k1_17, k1_18 };

}  // namespace jink::sim::vehicle
