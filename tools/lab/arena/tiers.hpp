// SPDX-License-Identifier: BSD-3-Clause
// The tiers by name.
#pragma once

#include <span>
#include <string_view>

#include "sim/families/families.hpp"

namespace jink::tools::lab::arena {

/// camera, field, lidar, perfect, realistic: in this order.
[[nodiscard]] std::span<const std::string_view> tiers();

/// Throws std::invalid_argument for an unknown name.
[[nodiscard]] sim::families::Tier tier_of(std::string_view name);

}  // namespace jink::tools::lab::arena
