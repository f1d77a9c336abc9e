// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/tiers.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::arena {
namespace {

using sim::families::Tier;

constexpr std::array kTiers{Tier::kCamera, Tier::kField, Tier::kLidar, Tier::kPerfect, Tier::kRealistic};

}  // namespace

std::span<const std::string_view> tiers() {
  static const auto kNames = [] {
    std::array<std::string_view, kTiers.size()> names;
    std::transform(kTiers.begin(), kTiers.end(), names.begin(), sim::families::to_string);
    return names;
  }();
  return kNames;
}

Tier tier_of(std::string_view name) {
  for (const Tier tier : kTiers) {
    if (name == to_string(tier)) return tier;
  }
  throw std::invalid_argument("there is no tier '" + std::string(name) + "'");
}

}  // namespace jink::tools::lab::arena
