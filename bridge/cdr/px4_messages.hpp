// SPDX-License-Identifier: BSD-3-Clause
// PX4's VehicleLocalPosition: the bytes, what they say, and what that means for the vehicle's state. No transport.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::cdr::px4 {

/// What of a VehicleLocalPosition is used here, in PX4's frame (NED) and units (m, m/s, rad).
struct LocalPosition {
  std::uint64_t timestamp_us = 0;  ///< of the agent's clock where it synchronises (UXRCE_DDS_SYNCT), else since boot
  bool xy_valid = false;
  bool z_valid = false;
  bool v_xy_valid = false;
  bool v_z_valid = false;
  Vec3 position_ned = Vec3::Zero();
  Vec3 velocity_ned = Vec3::Zero();
  Vec3 shift_ned = Vec3::Zero();  ///< of the newest reset of each counter: delta_xy, delta_z
  std::uint8_t xy_resets = 0;     ///< counters that wrap
  std::uint8_t z_resets = 0;
  double heading = 0.0;              ///< clockwise from north; NaN: not known
  double horizontal_accuracy = 0.0;  ///< eph: as in vehicle::px4::position_sigma
  double vertical_accuracy = 0.0;    ///< epv; likewise
  bool dead_reckoning = false;
  bool global = false;  ///< xy_global and z_global: the local frame's origin is known
  frames::Geodetic origin;
};

/// Decodes a payload (encapsulation and CDR) of any layout known, which its length tells, without the 4 bytes of
/// encapsulation: 192 bytes before PX4 1.15 (no heading_var, no tilt_var, other terrain fields), 212 in version 0 as of
/// 1.15 and 1.16 (vehicle_local_position), 216 in version 1 (vehicle_local_position_v1; hagl_max in two). Nothing where
/// it is none of these. Values are taken as they are. Pure.
[[nodiscard]] std::optional<LocalPosition> decode_local_position(std::span<const std::uint8_t> payload);

/// Follows the messages of one autopilot. Not thread-safe.
class LocalPositionFilter {
 public:
  /// How old, in s, a position may be and still stand for "the estimator holds a local position".
  static constexpr double kMaxAge_s = 1.0;

  /// Takes one message in, true at `stamp` and received at `now`. False, and nothing is taken, where a value that is
  /// marked as valid is not finite or absurd (position beyond 1e5 m, speed beyond 1e3 m/s). heading_good_for_control
  /// says nothing of that: PX4 holds it false until the yaw was aligned in flight, above 1.5 m, and arms and flies
  /// OFFBOARD without it.
  ///
  /// The position's stamp advances only with position and velocity all valid. A reset counter that advances by one
  /// tells of a jump of the message's own delta; one that advances by more (messages were lost, the autopilot was
  /// started anew) of what the position moved beyond its velocity, on the axes of that counter. Resets of velocity and
  /// heading move nothing.
  [[nodiscard]] bool update(const LocalPosition& message, double stamp, double now);

  /// Puts position, velocity, yaw, their stamp, estimate_resets, estimate_shift, local_position_ok and, once known,
  /// origin and position_sigma into `state`, in ENU. What is missing is added to `state.health`: "local position",
  /// "heading", "dead reckoning".
  void apply(vehicle::VehicleState& state, double now) const;

 private:
  void count_resets(const LocalPosition& message, double stamp);

  std::optional<LocalPosition> newest_;  // the newest taken in, valid or not
  std::optional<LocalPosition> valid_;   // the newest with all valid
  double valid_stamp_ = base::kNever;
  double valid_at_ = base::kNever;  // received
  std::uint32_t resets_ = 0;
  Vec3 shift_ned_ = Vec3::Zero();
  std::optional<frames::Geodetic> origin_;
};

}  // namespace jink::bridge::cdr::px4
