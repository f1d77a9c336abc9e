// SPDX-License-Identifier: BSD-3-Clause
// What `jink doctor` looks at on the MAVLink side: listening to the vehicle, and what follows from what was heard. It
// commands nothing but messages and their rates.
#pragma once

#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bridge/doctor/check.hpp"
#include "bridge/mavsdk/link.hpp"
#include "config/mission.hpp"

namespace jink::bridge::doctor {

/// What was heard of the vehicle. Values only, so that the judgement needs no vehicle.
struct LinkFindings {
  bool autopilot = false;       ///< one was found
  double waited_s = 0.0;        ///< for it
  double listened_s = 0.0;      ///< to it
  vehicle::VehicleState state;  ///< at the end
  double position_age_s = 0.0;
  mavlink::LinkInfo info;
  mavlink::LinkCounts counts;
  std::vector<mavsdk::StreamRate> rates;
  std::map<std::string, vehicle::px4::Parameter> parameters;  ///< those of the doctor that were answered
  std::vector<mavlink::LinkNotice> notices;
  std::uint64_t aircraft_reports = 0;  ///< ADSB_VEHICLE
  std::optional<std::vector<mavlink::MissionItem>>
      fence;  ///< the autopilot's, where the mission is by it; none: not read
};

/// Waits for an autopilot for `seconds`, then asks and listens for about `seconds`; to read its fence, where that is
/// asked for, takes some more. Returns early when `stop` says so.
[[nodiscard]] LinkFindings listen(mavsdk::MavsdkLink& link, const base::Clock& clock, double seconds,
                                  const std::stop_token& stop, bool fence = false);

/// Link, version, rates, health, mode, parameters, in this order; without an autopilot one finding, kMissing.
[[nodiscard]] std::vector<Check> inspect_link(const config::Mission& mission, const LinkFindings& heard);

/// Local frame and origin, and the mission in it: heights, geofence, distances. Nothing without an autopilot.
[[nodiscard]] std::vector<Check> inspect_mission(const config::Mission& mission, const LinkFindings& heard);

/// "ok", "warning", "fault", "missing".
[[nodiscard]] const char* to_string(Check::Level level);
/// The worst level, in the order of the enum; kOk for none.
[[nodiscard]] Check::Level worst(const std::vector<Check>& checks);

}  // namespace jink::bridge::doctor
