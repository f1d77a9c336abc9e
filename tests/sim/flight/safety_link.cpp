// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/flight/safety_link.hpp"

#include <algorithm>
#include <cmath>

namespace jink::sim::flight::safety {
namespace {

using bridge::vehicle::Command;
using bridge::vehicle::FlightMode;

// Rates of PX4's messages, see sim/mavlink; CURRENT_MODE's is the one that jink asks for.
constexpr double kHeartbeatHz = 1.0;
constexpr double kModeHz = 10.0;
constexpr double kStatusHz = 5.0;
constexpr double kEstimatorHz = 1.0;
constexpr double kAfterTheSecond = 0.05;  // s, that heartbeats come: arming is confirmed nearly a second later
constexpr double kModeMaxAge = 1.2;       // s, of CURRENT_MODE, and of a position: as bridge/mavlink has it
constexpr double kPositionMaxAge = 1.0;

// What must never be sent: as in tests/fuzz/fuzz_supervisor.cpp.
constexpr double kFreshHeartbeat = 1.5;     // s, of one on which a command is given
constexpr double kFreshPosition = 0.2;      // s, of one that a setpoint is held to
constexpr double kVelocityTolerance = 3.0;  // m/s: the way back to a path, and what the estimate is off
constexpr double kBraking = 2.0;            // m/s²
constexpr double kLost = 1.2;               // m, that a vehicle may be off what it is asked for
constexpr double kTolerance = 0.3;          // m, by which what brakes beside a bound may pass it
constexpr double kForgetsSpeed = 0.995;     // of fastest_, in each turn
constexpr std::size_t kMostFaults = 5;      // one is one too many

bool by_hand(FlightMode mode) {
  return mode == FlightMode::kPosition || mode == FlightMode::kAltitude || mode == FlightMode::kManual;
}

}  // namespace

bool Link::due(double rate, double& number) const {
  const double newest = std::floor((news_.heartbeat_stamp - kAfterTheSecond) * rate + 1e-6);
  return std::exchange(number, std::max(number, newest)) < newest;
}

void Link::listen(double now) {
  now_ = now;
  const double before = news_.heartbeat_stamp;
  news_ = link_.state();
  const bool came = news_.heartbeat_stamp > before;
  const bridge::vehicle::VehicleState last = std::exchange(told_, news_);
  told_.armed = last.armed, told_.failsafe = last.failsafe, told_.heartbeat_stamp = last.heartbeat_stamp;
  told_.mode = last.mode, told_.intended_mode = last.intended_mode;
  told_.armable = last.armable, told_.health = last.health, told_.gps_lost = last.gps_lost;
  told_.in_air = last.in_air, told_.battery = last.battery, told_.remote_control = last.remote_control;
  if (!positions) told_.motion = last.motion;
  if (came) hear_modes();
  if (now - mode_at_ > kModeMaxAge) told_.intended_mode = FlightMode::kUnknown;
  if (came && due(kStatusHz, status_)) {
    told_.armable = news_.armable, told_.health = news_.health, told_.gps_lost = news_.gps_lost && tells_gps;
    told_.in_air = news_.in_air, told_.battery = news_.battery, told_.remote_control = news_.remote_control;
  }
  told_.landed_state_known = status_ >= 0.0;
  if (came && due(kEstimatorHz, estimator_)) estimator_ok_ = news_.local_position_ok;
  told_.local_position_ok = estimator_ok_ && estimates && told_.motion.silence(now) <= kPositionMaxAge;
  fastest_ = std::max(kForgetsSpeed * fastest_, told_.motion.value.velocity.norm());
  if (told_.mode != FlightMode::kOffboard) last_sent_ = now;
}

void Link::hear_modes() {
  if (due(kModeHz, mode_) && tells_modes) {
    told_.mode = news_.mode, told_.intended_mode = news_.intended_mode;
    mode_at_ = now_;
    told_of_pilot_ = told_of_pilot_ || told_.mode == pilots_;
  }
  if (!due(kHeartbeatHz, heartbeat_) || !heartbeats) return;
  told_.armed = news_.armed, told_.failsafe = news_.failsafe, told_.heartbeat_stamp = news_.heartbeat_stamp;
  if (now_ - mode_at_ <= kModeMaxAge) return;
  told_.mode = news_.mode;
  told_of_pilot_ = told_of_pilot_ || told_.mode == pilots_;
}

bool Link::send(const bridge::vehicle::Setpoint& setpoint) {
  if (told_of_pilot_) fault("a setpoint after a pilot took over");
  check(setpoint);
  last_sent_ = now_;
  return sends && link_.send(setpoint);
}

void Link::request(Command command) {
  const std::string name(bridge::vehicle::to_string(command));
  requests_.emplace_back(now_, command);
  if (told_of_pilot_) fault(name + " after a pilot took over");
  if (now_ - told_.heartbeat_stamp > kFreshHeartbeat + 1e-9) fault(name + " on an old heartbeat");
  if (command == Command::kArm && (told_.armed || told_.in_air || told_.mode != FlightMode::kOffboard))
    fault("arming where nobody waits for it");
  if (command == Command::kDisarm) fault("disarming");
  // Who is started again asks for OFFBOARD, whoever has the sticks: that is what he was started for.
  if (command != Command::kOffboard && told_.failsafe && by_hand(told_.mode) && told_.remote_control)
    fault(name + " where the failsafe left the vehicle to the pilot");
  link_.request(command);
}

// What is outside, or will be before it can stop, is asked to be no farther outside.
void Link::check(const bridge::vehicle::Setpoint& setpoint) {
  const bool finite = setpoint.position.allFinite() && setpoint.velocity.allFinite() &&
                      setpoint.acceleration.allFinite() && std::isfinite(setpoint.yaw);
  if (!finite) return fault("a setpoint that is not finite");
  const Vec3& p = told_.motion.value.position;
  const planner::base::Box& fence = mission_.geofence;
  const bool held = told_.motion.silence(now_) <= kFreshPosition && steers;
  for (Eigen::Index axis = 0; axis < 3 && held; ++axis) {
    const double beyond =
        std::max(fence.min[axis] - setpoint.position[axis], setpoint.position[axis] - fence.max[axis]);
    const double own = std::max(fence.min[axis] - p[axis], p[axis] - fence.max[axis]);
    const double stops = std::max(0.0, own + fastest_ * fastest_ / (2.0 * kBraking));
    if (beyond > stops + kLost + kTolerance) fault("a setpoint outside of the geofence");
  }
  if (setpoint.position.z() < std::min(0.0, p.z()) - kTolerance) fault("a setpoint under the ground");
  const double most = std::max(mission_.vehicle.max_speed, fastest_) + kVelocityTolerance;
  if (setpoint.velocity.norm() > most) fault("a setpoint beyond the speed");
}

void Link::fault(const std::string& what) {
  if (faults_.size() < kMostFaults) faults_.push_back(what + ", at " + std::to_string(now_) + " s");
}

}  // namespace jink::sim::flight::safety
