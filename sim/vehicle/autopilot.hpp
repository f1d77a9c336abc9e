// SPDX-License-Identifier: BSD-3-Clause
// The simulator's autopilot: modes, arming, take-off, landing and failsafes as PX4's SITL shows them. Pure logic in
// virtual time and local ENU: no socket, no clock, no message. It owns and flies the vehicle.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/vehicle/estimator.hpp"
#include "sim/vehicle/mission.hpp"
#include "sim/vehicle/parameters.hpp"
#include "sim/vehicle/px4_event.hpp"
#include "sim/vehicle/px4_version.hpp"
#include "sim/vehicle/vehicle_model.hpp"
#include "sim/vehicle/wind.hpp"

namespace jink::sim::vehicle {

/// PX4's modes; the value is HEARTBEAT.custom_mode: main mode in bits 16 to 23, sub-mode of AUTO in bits 24 to 31.
enum class FlightMode : std::uint32_t {
  kManual = 0x00010000,
  kAltitude = 0x00020000,
  kPosition = 0x00030000,
  kTakeoff = 0x02040000,
  kHold = 0x03040000,
  kMission = 0x04040000,
  kReturn = 0x05040000,
  kLand = 0x06040000,
  kAcro = 0x00050000,
  kOffboard = 0x00060000,
  kStabilized = 0x00070000,
};

/// Flown by hand: it needs a remote control.
[[nodiscard]] bool is_manual(FlightMode mode);

/// MAV_RESULT's values.
enum class Result : std::uint8_t {
  kAccepted = 0,
  kTemporarilyRejected = 1,
  kDenied = 2,
  kUnsupported = 3,
  kFailed = 4,
};

/// MAV_LANDED_STATE's values.
enum class LandedState : std::uint8_t { kOnGround = 1, kInAir = 2, kTakeoff = 3, kLanding = 4 };

/// MAV_BATTERY_CHARGE_STATE's values that are in use.
enum class BatteryLevel : std::uint8_t { kUnknown = 0, kOk = 1, kLow = 2, kCritical = 3, kEmergency = 4 };

/// What HEARTBEAT carries, in MAVLink's values.
struct Heartbeat {
  std::uint8_t base_mode = 0;
  std::uint32_t custom_mode = 0;
  std::uint8_t system_status = 0;
};

/// MAV_SEVERITY's values that are in use.
enum class Severity : std::uint8_t { kCritical = 2, kWarning = 4, kInfo = 6 };

struct StatusText {
  Severity severity = Severity::kInfo;
  std::string text;
};

struct AutopilotOptions {
  planner::base::VehicleLimits limits{};
  Vec3 position = Vec3::Zero();  ///< where it starts
  double yaw = 90.0 * kDegree;   ///< counter-clockwise from east: PX4's SITL starts heading north
  bool airborne = false;         ///< true: armed in HOLD at `position`; false: on the ground below it
  double ground_height = 0.0;
  double ready_delay = 4.3;  ///< from start until it may be armed, PX4's SITL; 0 and less: at once
  int system_id = 1;
  Px4Version version = Px4Version::k1_17;
  Cascade cascade{};
  Wind wind{};                  ///< none: exactly as without a wind
  EstimateErrors estimate{};    ///< none: what it believes is the truth, bit by bit
  std::uint64_t seed = 1;       ///< of gusts and errors
  bool remote_control = false;  ///< a pilot's, sticks centred, from the start; else from pilot_mode() on
};

/// Not thread-safe: one thread steps and commands it. Commands act at once, setpoints with the next step.
class Autopilot {
 public:
  /// Throws std::invalid_argument for unusable limits, a position or height that is not finite, or a wind or errors
  /// that are negative or not finite.
  explicit Autopilot(const AutopilotOptions& options);

  /// Advances by VehicleModel::kStep.
  void step();
  /// Seconds since the simulation began: no reboot sets it back.
  [[nodiscard]] double time() const { return static_cast<double>(steps_) * VehicleModel::kStep; }
  /// Seconds since it last booted: what its messages tell.
  [[nodiscard]] double boot_time() const { return static_cast<double>(steps_ - boot_step_) * VehicleModel::kStep; }
  /// How often it was rebooted.
  [[nodiscard]] int reboots() const { return reboots_; }

  // Commands: MAV_RESULT as PX4 answers it.
  Result arm(bool force = false);
  /// In the air refused unless forced: then the motors stop and it falls.
  Result disarm(bool force = false);
  /// PX4's DO_SET_MODE. An unknown main mode is accepted and ignored, as there.
  Result set_mode(unsigned main_mode, unsigned sub_mode = 0);
  /// Climbs to `height` (ENU z; none: MIS_TAKEOFF_ALT above the present one), then holds. Accepted disarmed: then it
  /// takes off when armed.
  Result takeoff(std::optional<double> height = std::nullopt);
  Result land();
  Result hold();
  Result return_home();
  /// HOLD, and in the air at that point (a part that is not finite stays as it is), with that yaw and at most that
  /// speed on the way there when they are finite and, the speed, positive.
  Result reposition(const Vec3& position, double yaw = std::numeric_limits<double>::quiet_NaN(),
                    double speed = std::numeric_limits<double>::quiet_NaN());
  /// MISSION: flies the mission from the item where it is, then holds. Refused when armed without a mission.
  Result fly_mission();
  /// PX4's MISSION_START: MISSION from `item` (-1: where it is), armed.
  Result start_mission(int item);
  /// As Mission::replace and Mission::set_current.
  void set_mission(std::vector<MissionItem> items, std::optional<std::size_t> current = std::nullopt);
  bool set_mission_current(std::size_t item) { return mission_.set_current(item); }
  [[nodiscard]] const Mission& mission() const { return mission_; }
  Result set_home(const Vec3& position);
  /// A setpoint for OFFBOARD: keeps the stream alive whatever the mode. Refused, and no sign of life, unless each
  /// axis has a position, a velocity or an acceleration and nothing is infinite.
  Result offboard_setpoint(const Setpoint& setpoint);
  /// A text to the ground stations, for what the edge above refuses.
  void report(Severity severity, std::string text);
  /// The true world says that it hit something: motors off for good, it falls.
  void crash();

  // Faults and the pilot, as they befall the vehicle.
  /// Cuts satellite navigation, or gives it back. After EKF2_NOAID_TOUT without it no position is valid.
  void set_gps(bool available);
  /// The estimate moves by `by` (m, finite) at once and counts a reset; the vehicle stays, then moves as its controller
  /// follows the estimate. Its own setpoints move along, an OFFBOARD position does not.
  void jump_estimate(const Vec3& by);
  /// 0 to 1, clamped; NaN: not known. Full at the start, and nothing but this drains it.
  void set_battery(double remaining);
  /// The wind's mean from now on; gusts stay. Throws std::invalid_argument where it is not finite.
  void set_wind(const Vec3& mean) { wind_.set_mean(mean); }
  /// The motors stop, in the air it falls. It boots anew with its parameters, and where it is its local frame begins.
  void reboot();
  /// A pilot with a remote control, sticks centred from now on, switches the mode: manual ones are possible then.
  Result pilot_mode(FlightMode mode);
  /// As a failed check before take-off does: the health bit says it, and arming is refused even by force.
  void refuse_arming(bool on) { refuses_arming_ = on; }
  /// As an OFFBOARD that cannot run does. One that flies goes on, but does not come back after a failsafe.
  void refuse_offboard(bool on) { refuses_offboard_ = on; }

  /// In the simulation's frame.
  [[nodiscard]] const Motion& true_motion() const { return model_.motion(); }
  /// What the vehicle believes and reports, in its local frame.
  [[nodiscard]] const Motion& estimated_motion() const { return estimator_.motion(); }
  /// Origin of the local frame, reset counter, validity.
  [[nodiscard]] const Estimator& estimator() const { return estimator_; }
  [[nodiscard]] bool position_valid() const { return estimator_.position_valid(); }
  /// 0 to 1; NaN: not known.
  [[nodiscard]] double battery() const { return battery_; }
  [[nodiscard]] BatteryLevel battery_level() const;
  /// PX4 before 1.15 says CRITICAL in its heartbeat also for what it only warns of.
  [[nodiscard]] bool warning_is_critical() const;
  [[nodiscard]] const VehicleModel& model() const { return model_; }
  [[nodiscard]] Parameters& parameters() { return parameters_; }
  [[nodiscard]] const Parameters& parameters() const { return parameters_; }
  [[nodiscard]] const AutopilotOptions& options() const { return options_; }

  /// The mode that flies now, a failsafe's included.
  [[nodiscard]] FlightMode mode() const { return failsafe_ ? *failsafe_ : intended_mode_; }
  /// The mode last asked for.
  [[nodiscard]] FlightMode intended_mode() const { return intended_mode_; }
  /// Whether there is one, healthy.
  [[nodiscard]] bool remote_control() const { return remote_control_; }
  [[nodiscard]] bool armed() const { return armed_; }
  [[nodiscard]] bool landed() const { return landed_; }
  [[nodiscard]] bool crashed() const { return crashed_; }
  [[nodiscard]] bool in_failsafe() const { return failsafe_.has_value(); }
  [[nodiscard]] bool offboard_active() const { return armed_ && mode() == FlightMode::kOffboard; }
  /// A valid setpoint came within the last COM_OF_LOSS_T.
  [[nodiscard]] bool stream_live() const;
  [[nodiscard]] bool ready() const { return boot_time() >= options_.ready_delay; }
  /// The ground's z in the local frame.
  [[nodiscard]] double local_ground() const { return options_.ground_height - estimator_.origin().z(); }
  /// Of the truth above the ground: the rangefinder's.
  [[nodiscard]] double height_above_ground() const { return true_motion().position.z() - options_.ground_height; }
  /// The health bit of SYS_STATUS: it could be armed, or go on flying, in this mode.
  [[nodiscard]] bool prearm_ok() const;
  [[nodiscard]] LandedState landed_state() const;
  [[nodiscard]] Heartbeat heartbeat() const;
  [[nodiscard]] const Vec3& home() const { return home_; }
  /// What the vehicle follows now; nothing while the motors are off or idle.
  [[nodiscard]] std::optional<Setpoint> active_setpoint() const;
  /// The texts since the last call, oldest first (at most the last 64).
  [[nodiscard]] std::vector<StatusText> take_status_texts();
  /// The events since the last call, likewise.
  [[nodiscard]] std::vector<FlightEvent> take_events();

 private:
  /// kLanded: rotors idle; kRamp: thrust comes up slowly after the take-off was asked for; kFlying.
  enum class Phase { kLanded, kRamp, kFlying };

  Result change_mode(FlightMode mode);
  void enter_active_mode();
  void disarm_now();

  // autopilot_events.cpp
  void emit_event(EventKind kind, std::uint8_t detail = 0);
  void emit_armed_event(EventKind kind, ArmingReason reason);
  void emit_failsafe_event(FlightMode mode);
  void watch_checks();

  // autopilot_failsafe.cpp
  void update_failsafe();
  void update_battery();
  [[nodiscard]] bool offboard_runs() const;
  [[nodiscard]] std::optional<FlightMode> mode_fallback() const;
  [[nodiscard]] std::optional<FlightMode> battery_failsafe() const;

  void update_home();
  void update_takeoff();
  void update_landed();
  void update_auto_disarm();
  void finish_takeoff();
  void touch_down();
  [[nodiscard]] bool takeoff_wanted() const;
  [[nodiscard]] bool descent_wanted() const;
  [[nodiscard]] SpeedBounds bounds() const;

  [[nodiscard]] Setpoint guide();
  [[nodiscard]] Setpoint guide_hold() const;
  [[nodiscard]] Setpoint guide_descent(double speed) const;
  [[nodiscard]] Setpoint guide_manual() const;
  [[nodiscard]] Setpoint guide_return();
  [[nodiscard]] Setpoint guide_mission();
  [[nodiscard]] MissionView mission_view() const;
  [[nodiscard]] double landing_speed() const;

  AutopilotOptions options_;
  Parameters parameters_;
  VehicleModel model_;
  WindModel wind_;
  Estimator estimator_;
  std::int64_t steps_ = 0;
  std::int64_t boot_step_ = 0;
  int reboots_ = 0;

  Setpoint offboard_;
  std::optional<double> last_offboard_;
  Setpoint active_setpoint_;
  Vec3 home_ = Vec3::Zero();
  Vec3 hold_position_ = Vec3::Zero();
  double hold_yaw_ = std::numeric_limits<double>::quiet_NaN();
  double cruise_speed_ = planner::base::kInfinity;  ///< asked for; else MPC_XY_CRUISE
  Mission mission_;
  MissionOrder mission_order_;
  double takeoff_height_ = 0.0;
  double armed_at_ = 0.0;
  double ramp_started_ = 0.0;
  double landed_at_ = 0.0;
  std::optional<double> settled_since_;  ///< on the ground and told to descend
  double battery_ = 1.0;
  double battery_acts_at_ = planner::base::kInfinity;  ///< from when on its failsafe's own mode flies; HOLD before
  BatteryLevel reported_battery_ = BatteryLevel::kOk;  ///< the worst in this flight
  BatteryLevel armed_battery_ = BatteryLevel::kOk;     ///< known when it was armed: not acted upon
  std::vector<StatusText> texts_;
  std::vector<FlightEvent> events_;

  FlightMode intended_mode_ = FlightMode::kHold;
  FlightMode mode_after_disarm_ = FlightMode::kHold;  ///< the last one that does not forbid arming
  FlightMode guided_mode_ = FlightMode::kHold;        ///< the one that hold_position_ and return_... belong to
  std::optional<FlightMode> failsafe_;
  Phase phase_ = Phase::kLanded;
  bool armed_ = false;
  bool crashed_ = false;
  bool landed_ = true;
  bool has_flown_ = false;  ///< since it was armed
  bool return_climbed_ = false;
  bool return_arrived_ = false;
  bool ready_reported_ = false;
  bool stream_reported_ = false;     ///< by the last report of the arming checks
  bool mission_reported_ = false;    ///< likewise
  bool home_was_set_ = false;        ///< by command, since it was last disarmed
  bool battery_taken_over_ = false;  ///< by a change of mode during its failsafe
  bool remote_control_ = false;
  bool refuses_arming_ = false;
  bool refuses_offboard_ = false;
};

}  // namespace jink::sim::vehicle
