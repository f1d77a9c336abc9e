// SPDX-License-Identifier: BSD-3-Clause
// MISSION: what the mission wants becomes setpoints; it ends in HOLD, on the ground or in RETURN.
#include <cmath>
#include <utility>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {

void Autopilot::set_mission(std::vector<MissionItem> items, std::optional<std::size_t> current) {
  mission_.replace(std::move(items), current);
}

Result Autopilot::fly_mission() {
  if (armed_ && !mission_.available()) {
    report(Severity::kCritical, "Switching to mode 'Mission' is currently not possible");
    return Result::kTemporarilyRejected;
  }
  return change_mode(FlightMode::kMission);
}

Result Autopilot::start_mission(int item) {
  if (!mission_.available()) {
    report(Severity::kCritical, "Mission start denied! No valid mission");
    return Result::kDenied;
  }
  if (item < -1 || item >= static_cast<int>(mission_.size())) return Result::kDenied;
  if (item >= 0) mission_.set_current(static_cast<std::size_t>(item));
  const Result result = change_mode(FlightMode::kMission);
  return result == Result::kAccepted ? arm() : result;
}

MissionView Autopilot::mission_view() const {
  return {.time = time(),
          .position = estimated_motion().position,
          .yaw = estimated_motion().yaw,
          .home = home_,
          .origin = estimator_.origin(),
          .landed = landed_,
          .acceptance_radius = parameters_.real("NAV_ACC_RAD"),
          .altitude_radius = parameters_.real("NAV_MC_ALT_RAD"),
          .yaw_error = parameters_.real("MIS_YAW_ERR") * kDegree};
}

Setpoint Autopilot::guide_mission() {
  const bool ended = mission_.finished();
  mission_order_ = mission_.update(mission_view());
  cruise_speed_ = mission_order_.speed;
  switch (mission_order_.kind) {
    case MissionOrder::Kind::kFly:
      hold_position_ = mission_order_.position;
      hold_yaw_ = mission_order_.yaw;
      return guide_hold();
    case MissionOrder::Kind::kLand:
      hold_position_.head<2>() = mission_order_.position.head<2>();
      return guide_descent(landing_speed());
    case MissionOrder::Kind::kReturn:
      return_home();
      return guide_return();
    case MissionOrder::Kind::kEnd:
      break;
  }
  if (landed_) {  // the automatic disarming is what follows
    if (!ended && mission_.available()) report(Severity::kInfo, "Mission finished, landed");
    return guide_hold();
  }
  report(Severity::kInfo,
         mission_.available() ? "Mission finished, loitering" : "No valid mission available, loitering");
  const Vec3 place = hold_position_;
  hold();
  hold_position_ = place;
  return guide_hold();
}

}  // namespace jink::sim::vehicle
