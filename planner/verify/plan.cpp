// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/plan.hpp"

#include <algorithm>

#include "planner/verify/solid_contact.hpp"

namespace jink::planner::verify {

std::string_view to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::kReaches:
      return "reaches";
    case PlanStatus::kProgresses:
      return "progresses";
    case PlanStatus::kBlocked:
      return "blocked";
    case PlanStatus::kStartBlocked:
      return "start_blocked";
    case PlanStatus::kInvalid:
      return "invalid";
  }
  return "invalid";
}

bool start_blocked(const Vec3& start, double vehicle_radius, std::span<const base::Track> tracks,
                   std::span<const geometry::KnownPath> paths) {
  const auto inside = [&](const Vec3& position, double radius, const base::Body& body) {
    if (!((position - start).norm() < radius + vehicle_radius)) return false;
    return body.solid == nullptr || solid_distance(body, start - position) < vehicle_radius;
  };
  return std::any_of(tracks.begin(), tracks.end(),
                     [&](const base::Track& t) { return inside(t.position, t.radius, t.body); }) ||
         std::any_of(paths.begin(), paths.end(),
                     [&](const geometry::KnownPath& p) { return inside(p.position(0.0), p.radius, p.body); });
}

}  // namespace jink::planner::verify
