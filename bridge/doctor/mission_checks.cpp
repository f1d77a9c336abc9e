// SPDX-License-Identifier: BSD-3-Clause
// The doctor on frames and on the mission in them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "bridge/doctor/vehicle_checks.hpp"
#include "bridge/map/fence.hpp"
#include "bridge/supervisor/dangers.hpp"

namespace jink::bridge::doctor {

namespace {

using Level = Check::Level;
using planner::base::Box;

constexpr double kGroundHeight = 2.0;   // m; local z of a vehicle on the ground: more is another ground
constexpr double kFarWaypoint = 500.0;  // m; more is rather another place than a plan
constexpr double kHighest = 9000.0;     // m above the sea, and kLowest: any ground there is
constexpr double kLowest = -500.0;

std::string point(const Vec3& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

Check inspect_position(const config::Mission& mission, const LinkFindings& heard) {
  const vehicle::VehicleState& s = heard.state;
  if (!s.motion.heard() && mission.state == config::Transport::kDds) {
    return {Level::kWarning, "local position", "not on MAVLink, so the mission is not checked against it",
            "stream LOCAL_POSITION_NED (32) on this link too"};
  }
  if (!s.motion.heard()) {
    return {Level::kFault, "local position", "never heard", "wait for GPS or another position source"};
  }
  const std::string where = point(s.motion.value.position) + " m east, north, up";
  if (!s.local_position_ok) {
    return {Level::kFault, "local position",
            where + fmt::format(", but not valid ({:.1f} s old)", heard.position_age_s),
            "wait for GPS or another position source"};
  }
  if (!s.in_air && std::abs(s.motion.value.position.z()) > kGroundHeight) {
    const bool counts = mission.heights == config::Heights::kOrigin;
    return {counts ? Level::kWarning : Level::kOk, "local position",
            where + fmt::format(": on the ground at {:.1f} m above the local origin", s.motion.value.position.z()),
            counts ? "the mission's heights count from the origin: heights: ground counts from here" : ""};
  }
  return {Level::kOk, "local position", where, ""};
}

Check inspect_origin(const config::Mission& mission, const LinkFindings& heard) {
  if (!heard.state.origin) {
    const bool aircraft = mission.tracks.sources.adsb;
    return {Level::kWarning, "origin", std::string("not told") + (aircraft ? ": ADS-B aircraft cannot be placed" : ""),
            "wait for a GPS fix, or set it (SET_GPS_GLOBAL_ORIGIN)"};
  }
  const frames::Geodetic& o = *heard.state.origin;
  const bool sane =
      o.altitude_m > kLowest && o.altitude_m < kHighest && (o.latitude_deg != 0.0 || o.longitude_deg != 0.0);
  return {sane ? Level::kOk : Level::kWarning, "origin",
          fmt::format("{:.6f}, {:.6f}, {:.1f} m above the sea", o.latitude_deg, o.longitude_deg, o.altitude_m),
          sane ? "" : "no place on the ground: check GPS and the origin that was set"};
}

// Where the flight begins: above the present place, or here when it is in the air already.
Vec3 beginning(const config::Mission& mission, const vehicle::VehicleState& s) {
  Vec3 start = s.motion.value.position;
  if (!s.in_air) start.z() = s.motion.value.position.z() + mission.takeoff_height;
  start.z() = std::max(start.z(), mission.min_height);
  return start;
}

Check inspect_fence(const config::Mission& mission, const vehicle::VehicleState& s) {
  const Box& fence = mission.geofence;
  if (!fence.min.allFinite() || !fence.max.allFinite()) {
    return {Level::kWarning, "geofence", "none", "set geofence in the mission: nothing else keeps a detour near"};
  }
  const std::string box = point(fence.min) + " to " + point(fence.max);
  const Vec3 start = beginning(mission, s);
  // On the ground only the sides matter: it climbs into the volume.
  Vec3 here = s.motion.value.position;
  if (!s.in_air) here.z() = std::clamp(here.z(), fence.min.z(), fence.max.z());
  if (!fence.contains(here)) {
    return {Level::kFault, "geofence", box + " does not contain the vehicle at " + point(s.motion.value.position),
            "move the vehicle or the geofence: it counts from the autopilot's local origin"};
  }
  if (!fence.contains(start)) {
    return {Level::kFault, "geofence", fmt::format("take-off leads to {:.1f} m, out of {}", start.z(), box),
            "lower takeoff_height or raise the geofence"};
  }
  for (std::size_t i = 0; i < mission.waypoints.size(); ++i) {
    Vec3 raised = mission.waypoints[i];
    raised.z() = std::max(raised.z(), mission.min_height);
    if (!fence.contains(raised)) {
      return {Level::kFault, "geofence", fmt::format("waypoint {} at {} is outside of {}", i + 1, point(raised), box),
              "move the waypoint or the geofence"};
    }
  }
  return {Level::kOk, "geofence", box + " contains vehicle and waypoints", ""};
}

void inspect_map(const config::Mission& mission, const LinkFindings& heard, std::vector<Check>& checks) {
  if (const std::size_t solids = mission.map->tracks().size(); solids > 0)
    checks.push_back({Level::kOk, "map", fmt::format("{} solid{}", solids, solids == 1 ? "" : "s"), ""});
  if (!mission.autopilot_fence) return;
  Check check{Level::kFault, "autopilot's fence", "not read: the autopilot did not tell it",
              "`jink fly` refuses to fly"};
  if (heard.fence && heard.fence->empty()) {
    check = {Level::kWarning, check.name, "empty",
             "upload one by a ground station, or take `fence` out of the mission"};
  } else if (heard.fence && !heard.state.origin) {
    check.finding = fmt::format("{} items, which cannot be placed without an origin", heard.fence->size());
  } else if (heard.fence) {
    try {
      const config::Mission fenced = map::fenced(mission, *heard.fence, *heard.state.origin);
      check = {Level::kOk, check.name,
               fmt::format("{} items, {} solids", heard.fence->size(),
                           fenced.map->tracks().size() - mission.map->tracks().size()),
               ""};
    } catch (const std::runtime_error& error) {
      check.finding = error.what();
    }
  }
  checks.push_back(std::move(check));
}

void inspect_waypoints(const config::Mission& mission, const vehicle::VehicleState& s, std::vector<Check>& checks) {
  Vec3 from = beginning(mission, s);
  const double first = (mission.waypoints.front() - from).norm();
  double length = 0.0;
  int raised = 0;
  for (Vec3 waypoint : mission.waypoints) {
    raised += waypoint.z() < mission.min_height ? 1 : 0;
    waypoint.z() = std::max(waypoint.z(), mission.min_height);
    length += (waypoint - from).norm();
    from = waypoint;
  }
  const double seconds = length / mission.vehicle.cruise_speed;
  Check check{Level::kOk, "waypoints",
              fmt::format("{}: the first {:.1f} m away, {:.1f} m in all, {:.0f} s at cruise speed",
                          mission.waypoints.size(), first, length, seconds),
              ""};
  if (seconds > mission.time_limit) {
    check.level = Level::kFault;
    check.finding += fmt::format(", time_limit {:g} s", mission.time_limit);
    check.remedy = "raise time_limit";
  } else if (first > kFarWaypoint) {
    check.level = Level::kWarning;
    check.remedy = "check that the waypoints count from this autopilot's local origin";
  }
  checks.push_back(check);
  if (raised > 0) {
    checks.push_back({Level::kWarning, "min_height",
                      fmt::format("{} waypoint{} below {:g} m will be raised to it", raised, raised == 1 ? "" : "s",
                                  mission.min_height - mission.ground),
                      "raise them in the mission, or lower min_height"});
  }
  if (mission.heights == config::Heights::kGround) return;
  for (const Vec3& waypoint : mission.waypoints) {
    if (waypoint.z() >= mission.ground) continue;
    checks.push_back({Level::kFault, "heights",
                      fmt::format("a waypoint is {:.1f} m under the ground", mission.ground - waypoint.z()),
                      "check what the mission's heights are above: ground, origin or amsl"});
    return;
  }
}

}  // namespace

std::vector<Check> inspect_mission(const config::Mission& mission, const LinkFindings& heard) {
  if (!heard.autopilot) return {};
  std::vector<Check> checks{inspect_position(mission, heard), inspect_origin(mission, heard)};
  inspect_map(mission, heard, checks);
  if (mission.tracks.sources.adsb) {
    checks.push_back({Level::kOk, "ADS-B",
                      heard.aircraft_reports > 0 ? fmt::format("{} reports of aircraft", heard.aircraft_reports)
                                                 : std::string("no aircraft: an empty sky, or no receiver"),
                      ""});
  }
  const vehicle::VehicleState& state = heard.state;
  if (!state.motion.heard()) return checks;
  if (mission.heights == config::Heights::kSea && !state.origin) {
    checks.push_back({Level::kFault, "heights", "above the sea, and the local origin's is not told",
                      "wait for a GPS fix, or let the mission's heights count from the ground"});
    return checks;
  }
  const double ground = state.in_air ? state.home_height.value_or(0.0) : state.motion.value.position.z();
  const config::Mission placed = config::in_local_frame(mission, ground, state.origin ? state.origin->altitude_m : 0.0);
  checks.push_back(inspect_fence(placed, state));
  if (const std::string why = supervisor::danger(placed, state.failsafe_parameters); !why.empty())
    checks.push_back({Level::kFault, "endings", why, "`jink fly` refuses this mission as it is"});
  inspect_waypoints(placed, state, checks);
  return checks;
}

}  // namespace jink::bridge::doctor
