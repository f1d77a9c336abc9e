// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/dangers.hpp"

#include <algorithm>

#include "bridge/base/text.hpp"

namespace jink::bridge::supervisor {
namespace {

bool returns(const config::Endings& e) {
  const auto choices = {e.tracks, e.link, e.battery, e.breach, e.traffic, e.planner};
  return std::find(choices.begin(), choices.end(), config::EndsIn::kReturn) != choices.end();
}

}  // namespace

// GF_ACTION is not waited for: not every autopilot has it.
bool told(const config::Mission& mission, const vehicle::FailsafeParameters& parameters) {
  return parameters.offboard_loss && (parameters.return_height || !returns(mission.endings));
}

std::string danger(const config::Mission& mission, const vehicle::FailsafeParameters& parameters) {
  const config::Endings& endings = mission.endings;
  if (!endings.motors_cut) {
    const double loss = parameters.offboard_loss.value_or(0.0);
    if (loss == 6.0 || loss == 7.0) {
      return "the autopilot cuts its motors when setpoints stop (COM_OBL_RC_ACT " +
             std::string(loss == 6.0 ? "6" : "7") + "): set 5 (hold), or let the mission's endings accept motors_cut";
    }
    if (parameters.fence_breach == 4.0)
      return "the autopilot cuts its motors out of its geofence (GF_ACTION 4): set 2 (hold), or let the mission's "
             "endings accept motors_cut";
  }
  const double ceiling = mission.geofence.max.z() - mission.ground;
  if (returns(endings) && !endings.return_above_fence && parameters.return_height &&
      *parameters.return_height > ceiling) {
    return "RETURN climbs to " + base::metres(*parameters.return_height) + " (RTL_RETURN_ALT), the geofence ends at " +
           base::metres(ceiling) + ": lower it, or let the mission's endings accept return_above_fence";
  }
  return {};
}

}  // namespace jink::bridge::supervisor
