// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/tiers.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::arena {
namespace {

constexpr std::array<std::string_view, 2> kTiers{"perfect", "realistic"};

}  // namespace

std::span<const std::string_view> tiers() {
  return kTiers;
}

sim::families::Tier tier_of(std::string_view name) {
  if (name == kTiers[0]) return sim::families::Tier::kPerfect;
  if (name == kTiers[1]) return sim::families::Tier::kRealistic;
  throw std::invalid_argument("there is no tier '" + std::string(name) + "'");
}

}  // namespace jink::tools::lab::arena
