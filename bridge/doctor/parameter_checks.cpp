// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/doctor/parameter_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace jink::bridge::doctor {

namespace {

using Level = Check::Level;
using Parameters = std::map<std::string, vehicle::px4::Parameter>;

constexpr int kOffboardExcepted = 4;          // bit 2 of COM_RCL_EXCEPT
constexpr double kHoldWithoutFailsafe = 7.0;  // NAV_RCL_ACT of PX4 1.18: out of modes flown by hand, and nothing else
constexpr double kLongestLoss_s = 1.0;        // PX4's default of COM_OF_LOSS_T
constexpr double kShortestLoss_s = 0.2;       // ten setpoints: less, and a hiccup of the link is a failsafe

const std::array<std::string, 7> kNames{"COM_OBL_RC_ACT", "COM_OF_LOSS_T",   "COM_RCL_EXCEPT", "NAV_RCL_ACT",
                                        "NAV_DLL_ACT",    "COM_LOW_BAT_ACT", "GF_ACTION"};

std::optional<double> value_of(const Parameters& parameters, const std::string& name) {
  const auto found = parameters.find(name);
  if (found == parameters.end()) return std::nullopt;
  return found->second.value;
}

Check untold(const std::string& name) {
  return {Level::kWarning, name, "not told", "look it up with a ground station: this decides what a loss does"};
}

const char* name_of(config::EndsIn ending) {
  constexpr std::array<const char*, 3> kNamesOfEndings{"hold", "land", "return"};
  return kNamesOfEndings.at(static_cast<std::size_t>(ending));
}

// What the autopilot does by itself, beside what jink does for the same cause.
void compare(Check& check, const std::string& does, const char* cause, config::EndsIn ending) {
  if (does == name_of(ending)) return;
  check.level = std::max(check.level, Level::kWarning);
  check.finding += fmt::format("; the mission has endings.{}: {}", cause, name_of(ending));
  if (check.remedy.empty()) check.remedy = "let both say the same";
}

// The setpoints stop: the companion died or its link did.
Check offboard_loss(double value, const config::Endings& endings) {
  constexpr std::array<const char*, 8> kMeanings{"position mode", "altitude mode", "stabilized mode", "return",
                                                 "land",          "hold",          "terminate",       "disarm"};
  Check check{Level::kWarning, "COM_OBL_RC_ACT", "", "set 5 (hold) or 4 (land), as endings.link"};
  const bool known = value >= 0.0 && value < static_cast<double>(kMeanings.size());
  if (!known) {
    check.finding = fmt::format("{:g}: not known here", value);
    return check;
  }
  const auto action = static_cast<std::size_t>(value);
  check.finding = fmt::format("{}: {} when setpoints stop", action, kMeanings[action]);
  if (action <= 2) check.finding += "; without RC the vehicle sinks and lands where it is";
  if (action == 3) check.finding += ", which climbs and flies where nothing was planned";
  if (action >= 6) {
    check.level = endings.motors_cut ? Level::kWarning : Level::kFault;
    check.finding += ": the vehicle falls";
  }
  if (action == 4 || action == 5) {
    check.level = Level::kOk;
    check.remedy.clear();
    compare(check, kMeanings[action], "link", endings.link);
  }
  return check;
}

Check loss_time(double value) {
  Check check{Level::kOk, "COM_OF_LOSS_T", fmt::format("{:g} s without setpoints until the autopilot acts", value), ""};
  if (!(value <= kLongestLoss_s)) {
    check.level = Level::kWarning;
    check.finding += ", in which it flies on";
    check.remedy = "set 1.0 or less";
  } else if (value < kShortestLoss_s) {
    check.level = Level::kWarning;
    check.finding += ": a hiccup of the link is enough";
    check.remedy = "set 0.5 to 1.0";
  }
  return check;
}

Check manual_loss(double value, std::optional<double> action, bool rc_receiver) {
  const bool excepted = std::isfinite(value) && (static_cast<int>(value) & kOffboardExcepted) != 0;
  if (excepted) {
    return {Level::kOk, "COM_RCL_EXCEPT", fmt::format("{:g}: offboard goes on without manual control", value), ""};
  }
  if (action == kHoldWithoutFailsafe) {
    return {Level::kOk, "COM_RCL_EXCEPT",
            fmt::format("{:g}, with NAV_RCL_ACT 7: offboard goes on without manual control", value), ""};
  }
  const std::string then = action ? fmt::format("NAV_RCL_ACT ({:g})", *action) : std::string("NAV_RCL_ACT");
  Check check{Level::kOk, "COM_RCL_EXCEPT",
              fmt::format("{:g}: losing manual control ends offboard, by {}", value, then), ""};
  if (!rc_receiver) {
    check.level = Level::kWarning;
    check.finding += "; none is there now";
    check.remedy = "to fly without RC set bit 2: 4";
  }
  return check;
}

Check ground_station_loss(double value) {
  if (value == 0.0) return {Level::kOk, "NAV_DLL_ACT", "0: losing a ground station changes nothing", ""};
  return {Level::kWarning, "NAV_DLL_ACT",
          fmt::format("{:g}: losing the ground station ends offboard; without one the vehicle may not arm", value),
          "keep a ground station connected, or set 0"};
}

Check low_battery(double value, const config::Endings& endings) {
  if (value == 0.0)
    return {Level::kWarning, "COM_LOW_BAT_ACT", "0: a low battery is only told of", "set 2 (land) or 3 (return, land)"};
  const std::string does = value == 2.0 ? "land" : "return";
  Check check{Level::kOk, "COM_LOW_BAT_ACT", fmt::format("{:g}: {} when the battery is critical", value, does), ""};
  compare(check, does, "battery", endings.battery);
  return check;
}

// Out of the autopilot's own geofence, where it has one.
Check fence_breach(double value, const config::Endings& endings) {
  constexpr std::array<const char*, 6> kMeanings{"nothing", "a warning", "hold", "return", "terminate", "land"};
  Check check{Level::kOk, "GF_ACTION", fmt::format("{:g}: not known here", value), ""};
  if (!(value >= 0.0 && value < static_cast<double>(kMeanings.size()))) return check;
  const auto action = static_cast<std::size_t>(value);
  check.finding = fmt::format("{}: {} out of the autopilot's own geofence", action, kMeanings[action]);
  if (action == 4) {
    check.level = endings.motors_cut ? Level::kWarning : Level::kFault;
    check.finding += ": the vehicle falls";
    check.remedy = "set 2 (hold)";
  } else if (action >= 2) {
    compare(check, kMeanings[action], "breach", endings.breach);
  }
  return check;
}

}  // namespace

std::span<const std::string> doctor_parameters() {
  return kNames;
}

std::vector<Check> inspect_parameters(const Parameters& parameters, const config::Endings& endings, bool rc_receiver) {
  std::vector<Check> checks;
  const auto judge = [&](const std::string& name, auto&& meaning, bool expected) {
    const std::optional<double> value = value_of(parameters, name);
    if (value) {
      checks.push_back(meaning(*value));
    } else if (expected) {
      checks.push_back(untold(name));
    }
  };
  judge(
      "COM_OBL_RC_ACT", [&](double value) { return offboard_loss(value, endings); }, true);
  judge("COM_OF_LOSS_T", loss_time, true);
  judge(
      "COM_RCL_EXCEPT",
      [&](double value) { return manual_loss(value, value_of(parameters, "NAV_RCL_ACT"), rc_receiver); }, true);
  judge("NAV_DLL_ACT", ground_station_loss, true);
  judge(
      "COM_LOW_BAT_ACT", [&](double value) { return low_battery(value, endings); }, false);
  judge(
      "GF_ACTION", [&](double value) { return fence_breach(value, endings); }, false);
  return checks;
}

}  // namespace jink::bridge::doctor
