// SPDX-License-Identifier: BSD-3-Clause
// The simulated autopilot's DDS side: what PX4's uXRCE-DDS agent would publish and take.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bridge/dds/participant.hpp"
#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::dds {

/// Jumps of the autopilot's position estimate, as VehicleLocalPosition tells of them.
struct EstimateJumps {
  std::uint8_t horizontal = 0;  ///< how many so far; wraps
  std::uint8_t vertical = 0;    ///< likewise
  Vec3 newest = Vec3::Zero();   ///< the shift of the newest of each, ENU
};

/// Tells the jumps from an estimator's reset counter, which says when, and its motion, which says how far. Not
/// thread-safe.
class EstimateJumpDetector {
 public:
  /// `counter` goes up by one, and around, with each jump; `estimated` is the motion `dt` s after the one before. What
  /// the position moved beyond its velocity is the jump.
  const EstimateJumps& update(std::uint8_t counter, const vehicle::Motion& estimated, double dt);

 private:
  EstimateJumps jumps_;
  std::optional<Vec3> position_;  // the one before
};

/// When VehicleLocalPosition.heading_good_for_control holds: PX4's EKF2 aligns the yaw anew in each flight, once it is
/// clear of what disturbs the compass on the ground. Not thread-safe.
class YawAlignment {
 public:
  static constexpr double kHeight = 1.5;      ///< m above the ground, PX4's mag_anomalies_max_hagl
  static constexpr double kSettling_s = 1.0;  ///< after the alignment, as there

  /// `height` above the ground at `now`; true where the yaw is aligned, also on the ground afterwards.
  bool update(double now, bool landed, double height);

 private:
  bool landed_ = true;
  std::optional<double> climbed_at_;
};

/// Publishes VehicleLocalPosition (best effort, transient local; version 1 as vehicle_local_position_v1, or for
/// PX4 1.16 version 0 and for 1.14 the layout without a version, both as vehicle_local_position) and takes
/// TrajectorySetpoint and OffboardControlMode (best effort, volatile). The mode is what keeps offboard alive: each one
/// renews the newest setpoint, and setpoints without a mode in the last kModeTimeout_s are left alone. Of the modes
/// that ask for position, velocity or acceleration, the first that is set counts; others are refused with a status
/// text. Not thread-safe.
class VehicleTopics {
 public:
  static constexpr double kPositionRate_hz = 100.0;
  static constexpr double kModeTimeout_s = 0.5;  ///< PX4 asks for more than 2 Hz

  /// `name_space` as of the agent: "px4_1". `node` must outlive it. @throws std::runtime_error, one line.
  VehicleTopics(bridge::dds::DdsParticipant& node, const std::string& name_space = {},
                vehicle::Px4Version version = vehicle::Px4Version::k1_17);
  ~VehicleTopics();
  VehicleTopics(const VehicleTopics&) = delete;
  VehicleTopics& operator=(const VehicleTopics&) = delete;

  /// Hands what has come to the autopilot, and publishes when it is time. `now`: simulated seconds, not decreasing.
  void step(double now, vehicle::Autopilot& autopilot, const EstimateJumps& jumps = {});

  /// Readers of the position, matched now.
  [[nodiscard]] int readers() const;
  /// Setpoints handed to the autopilot.
  [[nodiscard]] std::uint64_t setpoints() const;
  /// Payloads that were none.
  [[nodiscard]] std::uint64_t malformed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::sim::dds
