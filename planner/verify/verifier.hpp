// SPDX-License-Identifier: BSD-3-Clause
// The exact check of a finished path in continuous time. It shares no collision routine with the optimizer, so that a
// mistake there cannot pass here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"
#include "planner/verify/flight_limits.hpp"

namespace jink::planner::verify {

/// What a path does among predicted obstacles. Times are the path's own.
struct Verification {
  double min_clearance = base::kInfinity;  ///< smallest distance from the vehicle's sphere to an obstacle's surface
  double t_min_clearance = 0.0;            ///< when
  std::uint64_t nearest_id = 0;            ///< to which track or known path
  std::optional<double> first_contact;     ///< first time at which a clearance falls below zero
  double contact_speed = 0.0;              ///< relative speed at the first contact
  bool inside_volume = true;               ///< the path lies in the volume, up to VerifierInput::until
  bool valid = true;                       ///< the input could be judged, see verify()
  LimitsUse limits;                        ///< of all of the path, where limits were given

  /// What could not be judged is not free.
  [[nodiscard]] bool free() const { return valid && !first_contact && inside_volume; }
  /// Free, and nowhere beyond the limits that were given.
  [[nodiscard]] bool flyable() const { return free() && limits.within(); }
};

/// What is checked, and against what. ENU, m, s.
struct VerifierInput {
  std::span<const base::TimedPoint> path;        ///< vehicle; constant velocity between points
  std::span<const base::Track> tracks;           ///< valid at the path time `tracks_time`
  double tracks_time = 0.0;                      ///< not after the path's first time
  double vehicle_radius = 0.0;                   ///< of the sphere around the vehicle
  base::Box volume;                              ///< that the path must not leave
  double acceleration_trust = base::kInfinity;   ///< as in predict_position, from the measurement on
  double until = base::kInfinity;                ///< path time up to which obstacles and the volume count
  std::span<const geometry::KnownPath> known{};  ///< offsets and `until` count from `tracks_time`; margins do not count
  std::optional<FlightLimits> limits{};          ///< that the path must keep; none: not looked at
  std::span<const base::Track> standing{};       ///< further tracks, of what neither moves nor turns
};

/// m: what a clearance is off by at most, where it is judged at all. Within 10 km of the origin, 600 s and at up to 1
/// km/s it is off by at most kUsualAccuracy. Most of it is how finely instants are told (1e-13 s), times the speed.
inline constexpr double kAccuracy = 1e-7;
inline constexpr double kUsualAccuracy = 1e-9;  ///< m, see kAccuracy

/// Minimum over all instants, not samples: between two points and the instants at which a prediction changes or a known
/// path turns, the squared distance to a sphere's centre is a polynomial of degree four whose stationary points are all
/// found, and the distance to a solid is bounded from below until no interval can hold a smaller one
/// (solid_contact.hpp). In a hull of vertices the distance counts as 0, however deep. What is certain to be farther
/// away than a clearance already seen, and free, is skipped. O(points + tracks), and points for each track that comes
/// near; at worst O(points · tracks).
///
/// Not valid, and so not free, is what planner/geometry/validity.hpp refuses (no path, times that do not increase,
/// numbers that are none, negative radii, what is larger than its bounds), and tracks that get farther than kFarthest
/// or faster than kFastest while they count: their distances could not be told to kAccuracy.
Verification verify(const VerifierInput& input);

}  // namespace jink::planner::verify
