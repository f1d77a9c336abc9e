// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/doctor/vehicle_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "bridge/doctor/parameter_checks.hpp"

namespace jink::bridge::doctor {

namespace {

using Level = Check::Level;

constexpr double kSettle_s = 1.5;         // until the rates asked for are there: a heartbeat and a half
constexpr double kParameterTime_s = 3.0;  // at most, for all of them
constexpr double kFenceTime_s = 5.0;
constexpr auto kSlice = std::chrono::milliseconds(50);
constexpr double kRateTolerance = 0.8;  // of the rate expected
constexpr double kLeastPosition_hz = 10.0;
constexpr double kLongestGap = 2.5;    // periods: two lost ones are more than chance
constexpr double kLongestGap_s = 0.2;  // what is short enough at any rate
constexpr double kLongRoundTrip_s = 0.1;
constexpr int kTestedMinor = 17;  // PX4 1.N: what the bridge was measured against; 1.13 brought today's failsafes
constexpr int kOldestMinor = 13;

void wait(const base::Clock& clock, double until, const std::stop_token& stop) {
  while (clock.now() < until && !stop.stop_requested()) std::this_thread::sleep_for(kSlice);
}

Check autopilot_missing(const config::Mission& mission, const LinkFindings& heard) {
  std::string remedy =
      "start `jink sim SCENARIO` or PX4 SITL, or check the mission's connection and the autopilot's port";
  const std::string warning = mavsdk::MavsdkLink::last_warning();
  if (!warning.empty()) remedy += " (MAVSDK: " + warning + ")";
  return {Level::kMissing, "autopilot",
          fmt::format("no heartbeat on {} within {:.1f} s", mission.connection, heard.waited_s), remedy};
}

void inspect_identity(const config::Mission& mission, const LinkFindings& heard, std::vector<Check>& checks) {
  const bool px4 = heard.info.autopilot == vehicle::px4::kAutopilotPx4;
  checks.push_back({px4 ? Level::kOk : Level::kFault, "autopilot",
                    fmt::format("system {} on {}{}", heard.state.system_id, mission.connection,
                                px4 ? "" : fmt::format(", MAV_AUTOPILOT {}", heard.info.autopilot.value_or(0))),
                    px4 ? "" : "jink knows the modes of PX4 alone"});
  if (!heard.info.other_systems.empty()) {
    std::string systems;
    for (const std::uint32_t id : heard.info.other_systems)
      systems += (systems.empty() ? "" : ", ") + std::to_string(id);
    const bool named = mission.system_id != 0;
    checks.push_back(
        {named ? Level::kWarning : Level::kFault, "other autopilots", "system " + systems + " on the same connection",
         named ? "give each vehicle its own port"
               : "jink arms none of several: name one with the mission's system_id, or give each its own port"});
  }
  if (heard.state.reboots > 0) {
    checks.push_back({Level::kFault, "autopilot time", fmt::format("began anew {} times", heard.state.reboots),
                      "the autopilot reboots, or two of them have the same system id"});
  }
  Check version{Level::kWarning, "version", "not told", "check that the autopilot answers REQUEST_MESSAGE"};
  if (heard.info.version) {
    const vehicle::px4::Version& v = *heard.info.version;
    const bool old = v.major < 1 || (v.major == 1 && v.minor < kOldestMinor);
    const std::string name = px4 ? "PX4 " : "";
    version = {old ? Level::kWarning : Level::kOk, "version", name + vehicle::px4::to_string(v),
               old ? fmt::format("update: jink is measured against PX4 1.{}, and failsafes differ before 1.{}",
                                 kTestedMinor, kOldestMinor)
                   : ""};
  }
  checks.push_back(version);
}

Check inspect_rate(const mavsdk::StreamRate& rate, std::size_t index) {
  Check check{Level::kOk, rate.message, "", ""};
  const bool heartbeat = index == 0;
  const bool position = std::string_view(rate.message) == "LOCAL_POSITION_NED";
  if (rate.count == 0) {
    check.level = position || heartbeat ? Level::kFault : Level::kWarning;
    check.finding = fmt::format("none, {:g} Hz expected", rate.expected_hz);
    check.remedy = position ? "wait for a position estimate; check that the link streams LOCAL_POSITION_NED (32)"
                            : "check the streams of this link on the autopilot";
    if (std::string_view(rate.message) == "ODOMETRY") {
      check.remedy = "without it resets of the estimate show only as jumps of more than 1 m: stream ODOMETRY (331)";
    } else if (std::string_view(rate.message) == "CURRENT_MODE") {
      check.remedy = "without it a failsafe is told from a pilot by HEARTBEAT alone: stream CURRENT_MODE (436)";
    }
    return check;
  }
  check.finding = fmt::format("{:.1f} Hz, expected {:g}, largest gap {:.2f} s", rate.measured_hz, rate.expected_hz,
                              rate.largest_gap_s);
  const bool slow = rate.count > 1 && rate.measured_hz < kRateTolerance * rate.expected_hz;
  const bool gap = rate.largest_gap_s > std::max(kLongestGap_s, kLongestGap / rate.expected_hz);
  if (slow || gap) {
    check.level = position && rate.measured_hz < kLeastPosition_hz ? Level::kFault : Level::kWarning;
    check.remedy = "a faster or less busy link: check baud rate, the port's MAV_n_RATE, radio and processor load";
  }
  return check;
}

void inspect_traffic(const config::Mission& mission, const LinkFindings& heard, std::vector<Check>& checks) {
  // With the state over DDS only the heartbeat is needed here.
  const std::size_t needed = mission.state == config::Transport::kDds ? 1 : heard.rates.size();
  for (std::size_t i = 0; i < std::min(needed, heard.rates.size()); ++i) {
    checks.push_back(inspect_rate(heard.rates[i], i));
  }
  if (heard.counts.answers == 0) {
    checks.push_back({Level::kFault, "answers", "none to anything that it is asked",
                      "with MAVLink signing (PX4 1.18: a key on the SD card) it takes signed messages alone, and jink "
                      "cannot sign (docs/security.md); else the way to the autopilot is broken"});
  }
  Check round_trip{Level::kWarning, "round trip", "no answer to PING", "check that messages reach the autopilot"};
  if (heard.info.round_trip_s) {
    const bool slow = *heard.info.round_trip_s > kLongRoundTrip_s;
    round_trip = {slow ? Level::kWarning : Level::kOk, "round trip",
                  fmt::format("{:.1f} ms, the shortest", 1e3 * *heard.info.round_trip_s),
                  slow ? "positions and setpoints are this late: fly slower, or use a quicker link" : ""};
  }
  checks.push_back(round_trip);
  if (heard.counts.malformed + heard.counts.late > 0) {
    checks.push_back({Level::kWarning, "messages",
                      fmt::format("{} unreadable, {} out of order", heard.counts.malformed, heard.counts.late),
                      "the link corrupts or reorders: check the cable, the radio, the network"});
  }
}

// By the severity that StatusTexts puts in front.
Level text_level(const std::string& text) {
  const bool harmless = text.starts_with("info: ") || text.starts_with("notice: ") || text.starts_with("debug: ");
  return harmless ? Level::kOk : Level::kWarning;
}

void inspect_vehicle(const LinkFindings& heard, std::vector<Check>& checks) {
  const vehicle::VehicleState& s = heard.state;
  const bool sound = s.health.empty();
  checks.push_back({sound ? Level::kOk : (s.armable && s.local_position_ok ? Level::kWarning : Level::kFault), "health",
                    sound ? "all checks pass, ready to arm" : "failing: " + s.health,
                    sound ? "" : "see the autopilot's messages in a ground station"});
  if (heard.info.estimator) {
    const std::string complaints = vehicle::px4::estimator_complaints(*heard.info.estimator);
    const bool bad = !complaints.empty();
    checks.push_back({bad ? Level::kFault : Level::kOk, "estimator", bad ? complaints : "position and velocity hold",
                      bad ? "wait for GPS or another position source, away from metal and magnets" : ""});
  }
  if (s.estimate_resets > 0) {
    checks.push_back({Level::kWarning, "estimate resets",
                      fmt::format("{} while listening, {:.2f} m in all", s.estimate_resets, s.estimate_shift.norm()),
                      "wait until the estimate is settled"});
  }
  const std::string percent = heard.info.battery_percent ? fmt::format(", {:.0f} %", *heard.info.battery_percent) : "";
  Check battery{Level::kOk, "battery", std::string(vehicle::to_string(s.battery)) + percent, ""};
  if (s.battery == vehicle::BatteryState::kUnknown) {
    battery.level = Level::kWarning;
    battery.remedy = "jink cannot tell a low battery: set up the power module";
  } else if (s.battery != vehicle::BatteryState::kOk) {
    battery.level = s.battery == vehicle::BatteryState::kCritical ? Level::kFault : Level::kWarning;
    battery.remedy = "charge or change it";
  }
  checks.push_back(battery);
  Check mode{Level::kOk, "mode",
             fmt::format("{}, {}, {}", vehicle::to_string(s.mode), s.armed ? "armed" : "disarmed",
                         s.in_air ? "in the air" : "on the ground"),
             ""};
  if (s.failsafe) {
    mode.level = Level::kFault;
    mode.finding += ", FAILSAFE";
    mode.remedy = "land and clear its cause; see the autopilot's messages in a ground station";
  } else if (s.armed) {
    mode.level = Level::kWarning;
    mode.remedy = s.in_air ? "`jink fly` takes over in flight, without take-off" : "keep away from the propellers";
  }
  checks.push_back(mode);
  for (const mavlink::LinkNotice& notice : heard.notices) {
    if (notice.name == "autopilot_text")
      checks.push_back({text_level(notice.detail), "autopilot says", notice.detail, ""});
  }
}

}  // namespace

LinkFindings listen(mavsdk::MavsdkLink& link, const base::Clock& clock, double seconds, const std::stop_token& stop,
                    bool fence) {
  LinkFindings heard;
  const double begun = clock.now();
  heard.autopilot = link.wait_for_autopilot(seconds, stop);
  heard.waited_s = clock.now() - begun;
  if (!heard.autopilot) return heard;
  wait(clock, clock.now() + kSettle_s, stop);
  link.restart_rates();
  const double since = clock.now();
  const auto values = link.read_parameters(doctor_parameters(), std::min(seconds, kParameterTime_s), stop);
  for (const auto& value : values) {
    if (value) heard.parameters[value->name] = *value;
  }
  if (fence) heard.fence = link.read_fence(kFenceTime_s, stop);
  wait(clock, since + seconds, stop);
  heard.rates = link.rates();
  heard.listened_s = clock.now() - since;
  heard.state = link.state();
  heard.position_age_s = heard.state.motion.age(clock.now());
  heard.info = link.info();
  heard.counts = link.counts();
  while (const auto notice = link.next_notice()) heard.notices.push_back(*notice);
  for (mavlink::AdsbReport report; link.next_adsb(report);) ++heard.aircraft_reports;
  return heard;
}

std::vector<Check> inspect_link(const config::Mission& mission, const LinkFindings& heard) {
  if (!heard.autopilot) return {autopilot_missing(mission, heard)};
  std::vector<Check> checks;
  inspect_identity(mission, heard, checks);
  inspect_traffic(mission, heard, checks);
  inspect_vehicle(heard, checks);
  for (Check& check : inspect_parameters(heard.parameters, mission.endings, heard.state.remote_control))
    checks.push_back(std::move(check));
  return checks;
}

const char* to_string(Check::Level level) {
  switch (level) {
    case Level::kOk:
      return "ok";
    case Level::kWarning:
      return "warning";
    case Level::kFault:
      return "fault";
    case Level::kMissing:
      return "missing";
  }
  return "fault";
}

Check::Level worst(const std::vector<Check>& checks) {
  Level level = Level::kOk;
  for (const Check& check : checks) level = std::max(level, check.level);
  return level;
}

}  // namespace jink::bridge::doctor
