// SPDX-License-Identifier: BSD-3-Clause
// What the doctor concludes from what was heard: a healthy vehicle, and one thing wrong at a time.
#include "bridge/doctor/vehicle_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "bridge/doctor/parameter_checks.hpp"

namespace jink::bridge::doctor {
namespace {

using config::Mission;
using vehicle::BatteryState;
using vehicle::FlightMode;
using Level = Check::Level;
namespace px4 = vehicle::px4;

Mission mission() {
  Mission m;
  m.connection = "udpin://127.0.0.1:14540";
  m.waypoints = {{20.0, 0.0, 1.5}};
  m.geofence = {{-50.0, -50.0, 0.0}, {50.0, 50.0, 20.0}};
  return m;
}

LinkFindings healthy() {
  LinkFindings h;
  h.autopilot = true;
  h.state.armable = h.state.local_position_ok = true;
  h.state.motion.stamp = h.state.motion.received = 1.0;
  h.state.mode = FlightMode::kHold;
  h.state.battery = BatteryState::kOk;
  h.state.origin = {47.4, 8.5, 488.0};
  h.state.system_id = 1;
  h.info.autopilot = vehicle::px4::kAutopilotPx4;
  h.info.version = vehicle::px4::version(0x01110040);
  h.info.estimator = 895;
  h.info.round_trip_s = 0.001;
  h.counts.answers = 3;
  h.rates = {{"HEARTBEAT", 1.0, 1.0, 1.01, 5},
             {"LOCAL_POSITION_NED", 50.0, 49.8, 0.03, 250},
             {"ATTITUDE", 50.0, 50.0, 0.03, 250},
             {"ODOMETRY", 30.0, 30.0, 0.04, 150},
             {"CURRENT_MODE", 2.0, 2.0, 0.51, 10}};
  for (const auto& [name, value] :
       {std::pair{"COM_OBL_RC_ACT", 5.0}, {"COM_OF_LOSS_T", 1.0}, {"COM_RCL_EXCEPT", 4.0}, {"NAV_DLL_ACT", 0.0}}) {
    h.parameters[name] = {name, true, value};
  }
  return h;
}

Check find(const std::vector<Check>& checks, const std::string& name) {
  const auto found = std::find_if(checks.begin(), checks.end(), [&](const Check& c) { return c.name == name; });
  if (found != checks.end()) return *found;
  ADD_FAILURE() << "no check " << name;
  return {};
}

std::string bad_ones(const std::vector<Check>& checks) {
  std::string names;
  for (const Check& c : checks) {
    if (c.level != Level::kOk) names += c.name + ": " + c.finding + "\n";
    EXPECT_EQ(c.remedy.empty(), c.level == Level::kOk || c.name == "autopilot says") << c.name;
    EXPECT_FALSE(c.finding.empty()) << c.name;
    EXPECT_EQ((c.finding + c.remedy).find('\n'), std::string::npos) << c.name;
  }
  return names;
}

TEST(Doctor, FindsNothingWrongWithAHealthyVehicle) {
  EXPECT_EQ(bad_ones(inspect_link(mission(), healthy())), "");
  EXPECT_EQ(bad_ones(inspect_mission(mission(), healthy())), "");
}

TEST(Doctor, WithoutAnAutopilotThatIsAllItSays) {
  const auto checks = inspect_link(mission(), LinkFindings{});
  ASSERT_EQ(checks.size(), 1U);
  EXPECT_EQ(checks[0].level, Level::kMissing);
  EXPECT_NE(checks[0].finding.find("udpin://127.0.0.1:14540"), std::string::npos);
  EXPECT_TRUE(inspect_mission(mission(), LinkFindings{}).empty());
  EXPECT_EQ(worst(checks), Level::kMissing);
}

struct Case {
  std::string name;
  Level level;
  std::string finding;  // a part of it
  std::function<void(LinkFindings&)> change;
};

TEST(Doctor, NamesTheOneThingThatIsWrongWithTheVehicle) {
  const std::vector<Case> cases{
      {"autopilot", Level::kFault, "MAV_AUTOPILOT 3", [](LinkFindings& h) { h.info.autopilot = 3; }},
      {"other autopilots", Level::kFault, "system 2, 9",
       [](LinkFindings& h) {
         h.info.other_systems = {2, 9};
       }},
      {"autopilot time", Level::kFault, "2 times", [](LinkFindings& h) { h.state.reboots = 2; }},
      {"version", Level::kWarning, "not told", [](LinkFindings& h) { h.info.version.reset(); }},
      {"version", Level::kWarning, "PX4 1.12.3",
       [](LinkFindings& h) { h.info.version = vehicle::px4::version(0x010C03FF); }},
      {"HEARTBEAT", Level::kWarning, "gap 4.00 s", [](LinkFindings& h) { h.rates[0].largest_gap_s = 4.0; }},
      {"LOCAL_POSITION_NED", Level::kFault, "none", [](LinkFindings& h) { h.rates[1].count = 0; }},
      {"LOCAL_POSITION_NED", Level::kWarning, "30.0 Hz", [](LinkFindings& h) { h.rates[1].measured_hz = 30.0; }},
      {"LOCAL_POSITION_NED", Level::kFault, "4.0 Hz", [](LinkFindings& h) { h.rates[1].measured_hz = 4.0; }},
      {"ATTITUDE", Level::kWarning, "gap 0.70 s", [](LinkFindings& h) { h.rates[2].largest_gap_s = 0.7; }},
      {"ODOMETRY", Level::kWarning, "none", [](LinkFindings& h) { h.rates[3].count = 0; }},
      {"CURRENT_MODE", Level::kWarning, "none", [](LinkFindings& h) { h.rates[4].count = 0; }},
      {"round trip", Level::kWarning, "400.0 ms", [](LinkFindings& h) { h.info.round_trip_s = 0.4; }},
      {"round trip", Level::kWarning, "no answer", [](LinkFindings& h) { h.info.round_trip_s.reset(); }},
      {"messages", Level::kWarning, "3 unreadable, 4 out",
       [](LinkFindings& h) {
         h.counts.malformed = 3;
         h.counts.late = 4;
       }},
      {"health", Level::kFault, "failing: GPS",
       [](LinkFindings& h) {
         h.state.health = "GPS, pre-arm check";
         h.state.armable = false;
       }},
      {"health", Level::kWarning, "failing: logging", [](LinkFindings& h) { h.state.health = "logging"; }},
      {"estimator", Level::kFault, "no height", [](LinkFindings& h) { h.info.estimator = 895 & ~32U; }},
      {"estimate resets", Level::kWarning, "1 while", [](LinkFindings& h) { h.state.estimate_resets = 1; }},
      {"battery", Level::kWarning, "low", [](LinkFindings& h) { h.state.battery = BatteryState::kLow; }},
      {"battery", Level::kFault, "critical", [](LinkFindings& h) { h.state.battery = BatteryState::kCritical; }},
      {"battery", Level::kWarning, "unknown", [](LinkFindings& h) { h.state.battery = BatteryState::kUnknown; }},
      {"mode", Level::kFault, "FAILSAFE", [](LinkFindings& h) { h.state.failsafe = true; }},
      {"mode", Level::kWarning, "hold, armed, on the ground", [](LinkFindings& h) { h.state.armed = true; }},
      {"autopilot says", Level::kWarning, "critical: x",
       [](LinkFindings& h) {
         h.notices = {{"autopilot_text", "critical: x"}};
       }},
      {"COM_OBL_RC_ACT", Level::kWarning, "not told", [](LinkFindings& h) { h.parameters.erase("COM_OBL_RC_ACT"); }},
  };
  for (const Case& c : cases) {
    LinkFindings h = healthy();
    c.change(h);
    const auto checks = inspect_link(mission(), h);
    const Check check = find(checks, c.name);
    EXPECT_EQ(check.level, c.level) << c.name << ": " << check.finding;
    EXPECT_NE(check.finding.find(c.finding), std::string::npos) << c.name << ": " << check.finding;
    const std::string bad = bad_ones(checks);
    EXPECT_EQ(std::count(bad.begin(), bad.end(), '\n'), 1) << bad;
  }
}

TEST(Doctor, RepeatsWhatTheAutopilotSays) {
  LinkFindings h = healthy();
  h.notices = {{"autopilot_text", "info: Ready for takeoff!"}, {"second_autopilot", "said elsewhere"}};
  const auto checks = inspect_link(mission(), h);
  EXPECT_EQ(bad_ones(checks), "");
  EXPECT_EQ(find(checks, "autopilot says").finding, "info: Ready for takeoff!");
}

TEST(Doctor, WithTheStateOverDdsTheLinkNeedsNoPositions) {
  Mission m = mission();
  m.state = config::Transport::kDds;
  LinkFindings h = healthy();
  for (std::size_t i = 1; i < h.rates.size(); ++i) h.rates[i].count = 0;
  EXPECT_EQ(bad_ones(inspect_link(m, h)), "");
  h.state.motion.stamp = h.state.motion.received = base::kNever;
  EXPECT_EQ(find(inspect_mission(m, h), "local position").level, Level::kWarning);
}

TEST(Doctor, KnowsWhatTheParametersDo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::tuple<std::string, double, Level>> cases{
      {"COM_OBL_RC_ACT", 0.0, Level::kWarning},
      {"COM_OBL_RC_ACT", 3.0, Level::kWarning},
      {"COM_OBL_RC_ACT", 4.0, Level::kWarning},
      {"COM_OBL_RC_ACT", 5.0, Level::kOk},
      {"COM_OBL_RC_ACT", 6.0, Level::kFault},
      {"COM_OBL_RC_ACT", 7.0, Level::kFault},
      {"COM_OBL_RC_ACT", 99.0, Level::kWarning},
      {"COM_OBL_RC_ACT", nan, Level::kWarning},
      {"COM_OF_LOSS_T", 0.5, Level::kOk},
      {"COM_OF_LOSS_T", 5.0, Level::kWarning},
      {"COM_OF_LOSS_T", 0.05, Level::kWarning},
      {"COM_OF_LOSS_T", nan, Level::kWarning},
      {"COM_RCL_EXCEPT", 0.0, Level::kWarning},
      {"COM_RCL_EXCEPT", 3.0, Level::kWarning},
      {"COM_RCL_EXCEPT", 7.0, Level::kOk},
      {"COM_RCL_EXCEPT", nan, Level::kWarning},
      {"NAV_DLL_ACT", 0.0, Level::kOk},
      {"NAV_DLL_ACT", 2.0, Level::kWarning},
      {"COM_LOW_BAT_ACT", 0.0, Level::kWarning},
      {"COM_LOW_BAT_ACT", 3.0, Level::kWarning},
      {"COM_LOW_BAT_ACT", 2.0, Level::kOk},
      {"GF_ACTION", 1.0, Level::kOk},
      {"GF_ACTION", 2.0, Level::kOk},
      {"GF_ACTION", 4.0, Level::kFault},
      {"GF_ACTION", 5.0, Level::kWarning},
  };
  for (const auto& [name, value, level] : cases) {
    const auto checks = inspect_parameters({{name, {name, true, value}}}, {}, false);
    EXPECT_EQ(find(checks, name).level, level) << name << " = " << value << ": " << find(checks, name).finding;
    EXPECT_EQ(find(checks, name).remedy.empty(), level == Level::kOk) << name << " = " << value;
  }
  // As of PX4 1.18: out of modes flown by hand it goes to hold, and does nothing else.
  EXPECT_EQ(find(inspect_parameters(
                     {{"COM_RCL_EXCEPT", {"COM_RCL_EXCEPT", true, 0.0}}, {"NAV_RCL_ACT", {"NAV_RCL_ACT", true, 7.0}}},
                     {}, false),
                 "COM_RCL_EXCEPT")
                .level,
            Level::kOk);
  // With a remote control at hand its loss is no surprise.
  EXPECT_EQ(
      find(inspect_parameters({{"COM_RCL_EXCEPT", {"COM_RCL_EXCEPT", true, 0.0}}}, {}, true), "COM_RCL_EXCEPT").level,
      Level::kOk);
}

TEST(Doctor, WarnsWhereTheAutopilotsFailsafeIsNotTheMissionsEnding) {
  config::Endings endings;
  endings.link = endings.breach = config::EndsIn::kLand;
  endings.battery = config::EndsIn::kReturn;
  const std::map<std::string, vehicle::px4::Parameter> parameters{{"COM_OBL_RC_ACT", {"COM_OBL_RC_ACT", true, 4.0}},
                                                                  {"COM_LOW_BAT_ACT", {"COM_LOW_BAT_ACT", true, 3.0}},
                                                                  {"GF_ACTION", {"GF_ACTION", true, 5.0}}};
  for (const char* name : {"COM_OBL_RC_ACT", "COM_LOW_BAT_ACT", "GF_ACTION"}) {
    EXPECT_EQ(find(inspect_parameters(parameters, endings, false), name).level, Level::kOk) << name;
    EXPECT_EQ(find(inspect_parameters(parameters, {}, false), name).level, Level::kWarning) << name;
  }
  EXPECT_EQ(find(inspect_parameters(parameters, {}, false), "COM_OBL_RC_ACT").finding,
            "4: land when setpoints stop; the mission has endings.link: hold");
}

TEST(Doctor, SaysWhatFlyWillRefuse) {
  Mission m = mission();
  LinkFindings h = healthy();
  h.state.failsafe_parameters.offboard_loss = 7.0;
  EXPECT_EQ(find(inspect_mission(m, h), "endings").level, Level::kFault);
  m.endings.motors_cut = true;
  EXPECT_EQ(bad_ones(inspect_mission(m, h)), "");
}

TEST(Doctor, LooksAtTheMissionWhereTheVehicleIs) {
  const std::vector<Case> of_vehicle{
      {"local position", Level::kFault, "never heard",
       [](LinkFindings& h) { h.state.motion.stamp = h.state.motion.received = base::kNever; }},
      {"local position", Level::kFault, "not valid", [](LinkFindings& h) { h.state.local_position_ok = false; }},
      {"local position", Level::kOk, "5.0 m above", [](LinkFindings& h) { h.state.motion.value.position.z() = 5.0; }},
      {"origin", Level::kWarning, "not told", [](LinkFindings& h) { h.state.origin.reset(); }},
      {"origin", Level::kWarning, "0.000000",
       [](LinkFindings& h) {
         h.state.origin = {0.0, 0.0, 0.0};
       }},
      {"geofence", Level::kFault, "does not contain the vehicle",
       [](LinkFindings& h) { h.state.motion.value.position.x() = -60.0; }},
      {"geofence", Level::kOk, "39.0) contains vehicle",  // it counts from the ground
       [](LinkFindings& h) { h.state.motion.value.position.z() = 19.0; }},
  };
  for (const Case& c : of_vehicle) {
    LinkFindings h = healthy();
    c.change(h);
    const Check check = find(inspect_mission(mission(), h), c.name);
    EXPECT_EQ(check.level, c.level) << c.name << ": " << check.finding;
    EXPECT_NE(check.finding.find(c.finding), std::string::npos) << c.name << ": " << check.finding;
  }
  LinkFindings raised = healthy();
  raised.state.motion.value.position.z() = 19.0;
  Mission from_origin = mission();
  from_origin.heights = config::Heights::kOrigin;
  EXPECT_EQ(find(inspect_mission(from_origin, raised), "local position").level, Level::kWarning);
  const Check fence = find(inspect_mission(from_origin, raised), "geofence");
  EXPECT_EQ(fence.level, Level::kFault);
  EXPECT_NE(fence.finding.find("take-off leads to 20.5"), std::string::npos) << fence.finding;
  const auto of_mission = [](const std::string& name, const std::function<void(Mission&)>& change) {
    Mission m = mission();
    change(m);
    return find(inspect_mission(m, healthy()), name);
  };
  EXPECT_EQ(of_mission("geofence", [](Mission& m) { m.geofence = {}; }).level, Level::kWarning);
  EXPECT_EQ(of_mission("geofence", [](Mission& m) { m.waypoints = {{60.0, 0.0, 2.0}}; }).level, Level::kFault);
  EXPECT_EQ(of_mission("min_height", [](Mission& m) { m.waypoints[0].z() = 0.0; }).finding,
            "1 waypoint below 1 m will be raised to it");
  EXPECT_EQ(of_mission("heights",
                       [](Mission& m) {
                         m.heights = config::Heights::kSea;
                         m.geofence = {};
                       })
                .finding,
            "a waypoint is 486.5 m under the ground");
  EXPECT_EQ(of_mission("ADS-B", [](Mission&) {}).level, Level::kOk);
  EXPECT_EQ(of_mission("waypoints", [](Mission& m) { m.time_limit = 5.0; }).level, Level::kFault);
  EXPECT_EQ(of_mission("waypoints",
                       [](Mission& m) {
                         m.geofence = {};
                         m.waypoints = {{700.0, 0.0, 2.0}};
                       })
                .level,
            Level::kWarning);
}

}  // namespace
}  // namespace jink::bridge::doctor
