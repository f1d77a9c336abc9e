// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/contingency.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "planner/horizon/path_check.hpp"

namespace jink::planner::horizon {
namespace {

constexpr std::array kAway = {1.0, 2.0, 4.0};  // m, from where the first stop ends
constexpr int kAround = 8;                     // directions on the level

// Upwards first: most of what moves does so on the level.
std::vector<Vec3> directions() {
  std::vector<Vec3> all{Vec3::UnitZ()};
  for (int k = 0; k < kAround; ++k) {
    const double angle = k * 2.0 * std::numbers::pi / kAround;
    all.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  all.emplace_back(-Vec3::UnitZ());
  return all;
}

}  // namespace

Stop Contingency::choose(const PathRequest& request, std::span<const base::TimedPath> stops,
                         const std::function<bool(const base::TimedPath&)>& allowed) {
  assert(!stops.empty());
  PathRequest evasion = request;
  evasion.target = stops.front().back().position;
  if (!is_valid(evasion)) {
    Stop unjudged{stops.front(), {}, 0};
    unjudged.verification.valid = false;
    return unjudged;
  }
  Stop best;
  int looked_at = 0;
  // True where there is nothing left to look for.
  const auto consider = [&](base::TimedPath path) {
    Stop stop{std::move(path), {}, looked_at++};
    stop.verification = verify_until(stop.path, request, problem_.horizon());
    const bool good = keeps_margins(stop.path, request, problem_.horizon(), stop.verification);
    if (good || best.path.empty() || is_safer(stop.verification, best.verification)) best = std::move(stop);
    return good;
  };
  for (const base::TimedPath& stop : stops) {
    if (consider(stop)) return best;
  }
  for (const double away : kAway) {
    for (const Vec3& direction : directions()) {
      evasion.target = stops.front().back().position + away * direction;
      problem_.prepare(evasion);
      base::TimedPath path = problem_.unobstructed_motion();
      if (allowed && !allowed(path)) continue;
      if (consider(std::move(path))) return best;
    }
  }
  return best;
}

}  // namespace jink::planner::horizon
