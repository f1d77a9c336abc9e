// SPDX-License-Identifier: BSD-3-Clause
// Whether a crewed aircraft will come too near: by volumes and times of aviation, not by those of the planner, whose
// 6 s and decimetres are nothing to it. Pure logic.
#pragma once

#include <cstdint>
#include <optional>

#include "planner/base/types.hpp"

namespace jink::bridge::tracking {

/// An aircraft with people on board, as its transponder tells of it, in local ENU.
struct Aircraft {
  std::uint32_t icao_address = 0;
  double stamp = 0.0;  ///< when it was measured, companion's clock
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  // Standard deviations: m, and m/s.
  double horizontal_sigma = 0.0;
  double vertical_sigma = 0.0;
  double speed_sigma = 0.0;
  double climb_sigma = 0.0;
};

/// A small uncrewed aircraft is well clear of a crewed one where it is 2000 ft beside it, or 250 ft above or below it:
/// ASTM F3442/F3442M; Weinert, Campbell, Vela, Schuldt, Kurucar, "Well-Clear Recommendation for Small Unmanned Aircraft
/// Systems Based on Unmitigated Collision Risk", J. Air Transportation 26(3), 2018.
struct WellClear {
  static constexpr double kBeside = 609.6;    ///< m
  static constexpr double kVertical = 76.2;   ///< m
  static constexpr double kSigmas = 2.0;      ///< of the position, that are added
  static constexpr double kHorizon = 60.0;    ///< s: a landing from 40 m at 0.7 m/s
  static constexpr double kRemembered = 6.0;  ///< s, after which a measurement says nothing any more
};

/// Seconds until a vehicle at `vehicle` may be less than well clear of the aircraft, at the earliest: 0: now. The
/// aircraft flies straight on, give or take its sigmas. None: not within kHorizon, or the aircraft is forgotten.
[[nodiscard]] std::optional<double> less_than_well_clear_in(const Aircraft& aircraft, double now, const Vec3& vehicle);

}  // namespace jink::bridge::tracking
