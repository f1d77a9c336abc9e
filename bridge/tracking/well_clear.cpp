// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/well_clear.hpp"

#include <cmath>

namespace jink::bridge::tracking {

std::optional<double> less_than_well_clear_in(const Aircraft& aircraft, double now, const Vec3& vehicle) {
  constexpr double kStep = 0.5;  // s: an aircraft of 250 m/s is 125 m farther, the volume 1200 m wide
  const double age = now - aircraft.stamp;
  if (age > WellClear::kRemembered) return std::nullopt;
  for (double t = 0.0; t <= WellClear::kHorizon; t += kStep) {
    const Vec3 apart = aircraft.position + (age + t) * aircraft.velocity - vehicle;
    const double beside =
        WellClear::kBeside + WellClear::kSigmas * aircraft.horizontal_sigma + aircraft.speed_sigma * (age + t);
    const double vertical =
        WellClear::kVertical + WellClear::kSigmas * aircraft.vertical_sigma + aircraft.climb_sigma * (age + t);
    if (apart.head<2>().norm() < beside && std::abs(apart.z()) < vertical) return t;
  }
  return std::nullopt;
}

}  // namespace jink::bridge::tracking
