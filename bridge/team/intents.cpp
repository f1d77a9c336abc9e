// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/team/intents.hpp"

#include <cmath>

namespace jink::bridge::team {

// Each comparison is false for NaN.
const char* refusal(const Intent& intent) {
  using L = IntentLimits;
  if (intent.path.empty()) return "the path is empty";
  if (intent.path.size() > L::kPoints) return "the path has too many points";
  if (!(intent.radius > 0.0 && intent.radius <= L::kRadius)) return "the radius is not finite or out of range";
  if (!(intent.margin >= 0.0 && intent.margin <= L::kMargin)) return "the margin is not finite or out of range";
  double before = -planner::base::kInfinity;
  for (const planner::base::TimedPoint& point : intent.path) {
    if (!(std::abs(point.t) <= L::kTime)) return "a time is not finite or out of range";
    if (!(point.t - before >= L::kStep)) return "the times do not rise";
    if (!(point.position.norm() <= L::kPosition)) return "a position is not finite or out of range";
    before = point.t;
  }
  if (!intent.origin) return nullptr;
  const frames::Geodetic& o = *intent.origin;
  if (!(std::abs(o.latitude_deg) <= 90.0 && std::abs(o.longitude_deg) <= 180.0 &&
        std::abs(o.altitude_m) <= L::kPosition))
    return "the origin is out of range";
  return nullptr;
}

std::uint64_t vehicle_id(std::uint32_t system_id, std::uint64_t writer) {
  constexpr std::uint64_t kLowerHalf = 0xffffffffU;
  return (static_cast<std::uint64_t>(system_id) << 32U) | ((writer ^ (writer >> 32U)) & kLowerHalf);
}

std::uint32_t system_of(std::uint64_t vehicle) {
  return static_cast<std::uint32_t>(vehicle >> 32U);
}

}  // namespace jink::bridge::team
