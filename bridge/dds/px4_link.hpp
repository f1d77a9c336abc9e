// SPDX-License-Identifier: BSD-3-Clause
// The vehicle's state and setpoints over DDS, as PX4's uXRCE-DDS agent publishes and takes them. Arming, modes, health
// and commands stay with the link underneath.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/participant.hpp"
#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::dds {

inline constexpr const char* kLocalPositionType = "px4_msgs::msg::dds_::VehicleLocalPosition_";
inline constexpr const char* kTrajectorySetpointType = "px4_msgs::msg::dds_::TrajectorySetpoint_";
inline constexpr const char* kOffboardControlModeType = "px4_msgs::msg::dds_::OffboardControlMode_";
inline constexpr const char* kLocalPositionTopic = "out/vehicle_local_position";       ///< up to PX4 1.16
inline constexpr const char* kLocalPositionTopicV1 = "out/vehicle_local_position_v1";  ///< after it
inline constexpr const char* kTrajectorySetpointTopic = "in/trajectory_setpoint";
inline constexpr const char* kOffboardControlModeTopic = "in/offboard_control_mode";

/// A topic of PX4's agent: "rt/fmu/" and `name`, with the agent's namespace before "fmu" where it has one
/// (uxrce_dds_client start -n px4_1, or UXRCE_DDS_NS_IDX 1); slashes around it do not matter.
[[nodiscard]] std::string px4_topic(const std::string& name_space, const std::string& name);

/// What goes over DDS; the rest is the link's underneath.
struct DdsVehicleOptions {
  bool state = true;  ///< position, velocity, yaw, resets and origin
  bool setpoints = true;
  std::string name_space;  ///< config::Mission::dds_namespace
};

/// Since the start.
struct DdsVehicleCounts {
  int position_writers = 0;         ///< matched now, on both topics
  int setpoint_readers = 0;         ///< matched now: those of the topic that has fewer
  std::uint64_t positions = 0;      ///< taken in
  std::uint64_t malformed = 0;      ///< of no layout known
  std::uint64_t late = 0;           ///< more than vehicle::StampDelay::kLongest on their way
  std::uint64_t dropped = 0;        ///< marked as valid, but not finite or absurd
  std::uint64_t other_writers = 0;  ///< messages of a second writer while the first one is alive
  std::uint64_t setpoints_sent = 0;
};

/// A vehicle link that takes its position and sends its setpoints by DDS. All functions are safe from any thread and
/// never block.
///
/// State: both topics of vehicle_local_position are read, best effort and volatile, which matches PX4's best effort,
/// transient local writers and any other; the payload's length tells its version (bridge/cdr/px4_messages). Stamps are
/// `clock` at reception, less the delay that the message's own stamp tells (vehicle::StampDelay). Where
/// several writers publish, the first one heard is followed until it has been silent for kWriterSilence_s: two
/// autopilots are never mixed. When DDS falls silent the stamp stays and ages.
class DdsVehicleLink final : public vehicle::VehicleLink {
 public:
  static constexpr double kWriterSilence_s = 0.5;

  /// `under`, `node` and `clock` must outlive it. @throws std::runtime_error, one line, when Fast DDS cannot make a
  /// reader or writer.
  DdsVehicleLink(vehicle::VehicleLink& under, DdsParticipant& node, const base::Clock& clock,
                 const DdsVehicleOptions& options);
  ~DdsVehicleLink() override;
  DdsVehicleLink(const DdsVehicleLink&) = delete;
  DdsVehicleLink& operator=(const DdsVehicleLink&) = delete;

  [[nodiscard]] vehicle::VehicleState state() override;
  /// On DDS: an OffboardControlMode that asks for position control, then a TrajectorySetpoint in NED with position,
  /// velocity, acceleration and yaw (jerk and yaw speed NaN), both stamped with system time in microseconds as the
  /// agent's clock synchronisation expects. False for values that are not finite or beyond 1e6, when Fast DDS does not
  /// take it, and while nobody reads it: then it would go nowhere.
  [[nodiscard]] bool send(const vehicle::Setpoint& setpoint) override;
  void request(vehicle::Command command) override;
  [[nodiscard]] std::optional<vehicle::CommandReport> next_report() override;

  [[nodiscard]] DdsVehicleCounts counts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
