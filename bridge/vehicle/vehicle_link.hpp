// SPDX-License-Identifier: BSD-3-Clause
// The companion's view of an autopilot. Two implementations: mavsdk_link (MAVLink through MAVSDK) and the virtual-time
// link of sim/flight/closed_loop. Frame: local ENU from the autopilot's local origin; yaw counter-clockwise from east.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/base/stamped.hpp"
#include "bridge/frames/geodetic.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::vehicle {

enum class FlightMode {
  kUnknown,
  kManual,
  kAltitude,
  kPosition,
  kHold,
  kTakeoff,
  kLand,
  kReturn,
  kMission,
  kOffboard,
  kOther
};
/// "hold", "offboard", ...: for people and logs.
std::string_view to_string(FlightMode mode);

enum class BatteryState { kUnknown, kOk, kLow, kCritical };
/// "ok", "low", ...: for people and logs.
std::string_view to_string(BatteryState state);

/// The autopilot's parameters that decide how a flight may end without jink; none: not told.
struct FailsafeParameters {
  std::optional<double> offboard_loss;  ///< COM_OBL_RC_ACT: what it does without setpoints
  std::optional<double> fence_breach;   ///< GF_ACTION: what it does out of its own fence
  std::optional<double> return_height;  ///< RTL_RETURN_ALT, m above home: to which RETURN climbs
};

/// The newest of everything the autopilot has told. Stamps are in the companion's clock.
struct VehicleState {
  double heartbeat_stamp = base::kNever;  ///< newest heartbeat, which carries armed and mode
  bool armed = false;
  FlightMode mode = FlightMode::kUnknown;
  /// What was asked for last, by whomever; a failsafe leaves it as it was. kUnknown: not told lately.
  FlightMode intended_mode = FlightMode::kUnknown;
  bool remote_control = false;                                  ///< a pilot's, healthy
  base::Stamped<base::Kinematics, base::Frame::kLocal> motion;  ///< newest local position with velocity
  /// m, standard deviation of `motion`'s position, the greater of what the autopilot states per horizontal axis and for
  /// the height (ESTIMATOR_STATUS, VehicleLocalPosition); 0: it states none.
  double position_sigma = 0.0;
  double yaw = 0.0;
  /// Body (x ahead, y left, z up) to ENU, with that yaw; level where only a yaw is told.
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  double attitude_stamp = base::kNever;  ///< when it was so
  bool armable = false;                  ///< the autopilot's own pre-arm checks pass
  bool local_position_ok = false;        ///< its estimator holds a local position
  bool gps_lost = false;           ///< it has a GPS that it counts on, and that has no fix: the position will drift
  bool in_air = false;             ///< landed state says so (or taking off, landing)
  bool landed_state_known = true;  ///< false: the autopilot has not told yet
  std::string health;              ///< what is missing, in the autopilot's terms; empty when nothing is
  bool failsafe = false;           ///< the autopilot's own failsafe flies: HEARTBEAT.system_status CRITICAL or worse
  /// Jumps of the position estimate since the first position: how many, and the sum of them. The vehicle did not move.
  std::uint32_t estimate_resets = 0;
  Vec3 estimate_shift = Vec3::Zero();
  BatteryState battery = BatteryState::kUnknown;
  std::optional<frames::Geodetic> origin;  ///< of the local frame; none: not told yet
  std::optional<double> home_height;  ///< z of home, which the autopilot takes from where it is armed; none: not told
  std::uint32_t system_id = 0;        ///< MAVLink system of the autopilot; 0: not found yet
  std::uint32_t other_system_id = 0;  ///< of another autopilot on the connection; 0: there is none
  /// s, that a setpoint is on its way to the autopilot, as far as the link can tell; `motion`'s stamp has the way back
  /// taken off.
  double link_delay = 0.0;
  FailsafeParameters failsafe_parameters;
  std::uint32_t reboots = 0;  ///< times that the autopilot began anew; its local frame may be another since
};

/// What the vehicle is asked to follow: position with velocity and acceleration feed-forward, and a heading.
struct Setpoint {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 acceleration = Vec3::Zero();
  double yaw = 0.0;
};

enum class Command { kArm, kDisarm, kOffboard, kHold, kLand, kReturn };
std::string_view to_string(Command command);

/// The autopilot's answer to a command. `accepted` is its acknowledgement and no proof: PX4 accepts DO_SET_MODE twice,
/// and only the second answer is true. The proof is VehicleState.
struct CommandReport {
  Command command = Command::kHold;
  bool accepted = false;
  std::string detail;  ///< the result in words where it was refused or never answered
};

class VehicleLink {
 public:
  virtual ~VehicleLink() = default;
  /// Never blocks.
  [[nodiscard]] virtual VehicleState state() = 0;
  /// Sends one setpoint now; false when it could not be handed to the transport. Nothing is ever sent again by the
  /// link itself: when the companion stops calling this, the stream stops and the autopilot notices.
  [[nodiscard]] virtual bool send(const Setpoint& setpoint) = 0;
  /// Starts a command and returns at once; its answer comes by next_report().
  virtual void request(Command command) = 0;
  [[nodiscard]] virtual std::optional<CommandReport> next_report() = 0;
};

}  // namespace jink::bridge::vehicle
