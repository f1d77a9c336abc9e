// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/tiers.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::arena {
namespace {

constexpr std::array<std::string_view, 3> kTiers{"field", "perfect", "realistic"};

}  // namespace

std::span<const std::string_view> tiers() {
  return kTiers;
}

sim::families::Tier tier_of(std::string_view name) {
  for (const auto tier :
       {sim::families::Tier::kField, sim::families::Tier::kPerfect, sim::families::Tier::kRealistic}) {
    if (name == to_string(tier)) return tier;
  }
  throw std::invalid_argument("there is no tier '" + std::string(name) + "'");
}

}  // namespace jink::tools::lab::arena
