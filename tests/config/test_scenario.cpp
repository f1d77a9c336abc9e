// SPDX-License-Identifier: BSD-3-Clause
#include "config/scenario.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/config/yaml_case.hpp"

namespace jink::config {
namespace {

const std::string kVehicle =
    "{radius: 0.3, length: 0.5, mass: 0.4, max_speed: 5, cruise_speed: 3, max_acceleration: 6, max_jerk: 30, "
    "max_climb: 2}";

const std::string kValidScenario =
    "format: jink-scenario/1\n"  // line 1
    "name: example\n"            // 2
    "start: [0, 0, 1.5]\n"       // 3
    "target: [20, 0, 1.5]\n"     // 4
    "time_limit: 60\n"           // 5
    "vehicle: " +
    kVehicle +
    "\n"                                                                                                    // 6
    "world: {min: [-5, -10, 0], max: [25, 10, 8]}\n"                                                        // 7
    "sensing: {range: 21, rate: 25, delay: 0.1, position_noise: 0.2, velocity_noise: 0.3, dropout: 0.4}\n"  // 8
    "obstacles:\n"                                                                                          // 9
    "- {radius: 0.5, position: [5, 5, 2], velocity: [4, -2, 1], acceleration: [0, 0, 7]}\n"                 // 10
    "- {box: [0.8, 0.9, 1.0], motion: {type: trefoil, center: [10, 0, 1], scale: [1, 2, 3], slower: 1.1, offset: "
    "0.3}}\n"
    "- {radius: 0.4, motion: {type: sine, center: [5, 0, 1], amplitude: [0, 2, 0], frequency_hz: [0, 0.2, 0], phase: "
    "[0, 0, 0.6]}}\n"  // 12
    "- {radius: 0.45, motion: {type: bounce, position: [1, 1, 1], velocity: [1, 2, 0], min: [0, -5, 1], max: [19, 5, "
    "1]}}\n"  // 13
    "- {vertices: [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], motion: {type: waypoints, times: [0, 5, 9], points: "
    "[[3,3,1],[6,0,1],[9,3,2]]}}\n";  // 14

void try_scenario(const std::filesystem::path& file) {
  static_cast<void>(load_scenario(file));
}

Scenario loaded(const std::string& text) {
  const Folder folder;
  return load_scenario(folder.write("s.yaml", text));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(LoadScenario, TheTargetIsReachedAtItUnlessNearIsEnough) {
  EXPECT_EQ(loaded(kValidScenario).acceptance_radius, 0.0);
  EXPECT_EQ(loaded(replaced(kValidScenario, "time_limit: 60", "acceptance_radius: 0.8")).acceptance_radius, 0.8);
}

TEST(LoadScenario, AHoldAtTheTargetIsWithinTheTimeLimit) {
  const double usual = loaded(replaced(kValidScenario, "time_limit: 60", "")).time_limit;
  const Scenario holds = loaded(replaced(kValidScenario, "time_limit: 60", "hold_time: 40"));
  EXPECT_EQ(holds.hold_time, 40.0);
  EXPECT_EQ(holds.time_limit, usual + 40.0);
  EXPECT_EQ(loaded(kValidScenario).hold_time, 0.0);
}

TEST(LoadScenario, ReadsEveryKey) {
  const Scenario s = loaded(kValidScenario);
  EXPECT_EQ(s.name, "example");
  EXPECT_EQ(s.start, Vec3(0, 0, 1.5));
  EXPECT_EQ(s.target, Vec3(20, 0, 1.5));
  EXPECT_EQ(s.time_limit, 60.0);
  EXPECT_EQ(s.vehicle_name, "inline");
  EXPECT_EQ(s.vehicle.max_speed, 5.0);
  ASSERT_TRUE(s.world.has_value());
  EXPECT_EQ(s.world->min, Vec3(-5, -10, 0));
  EXPECT_EQ(s.world->max, Vec3(25, 10, 8));
  EXPECT_EQ(s.sensing.range, 21.0);
  EXPECT_EQ(s.sensing.rate, 25.0);
  EXPECT_EQ(s.sensing.delay, 0.1);
  EXPECT_EQ(s.sensing.position_noise, 0.2);
  EXPECT_EQ(s.sensing.velocity_noise, 0.3);
  EXPECT_EQ(s.sensing.dropout, 0.4);
  EXPECT_EQ(s.obstacles.size(), 5U);
}

TEST(LoadScenario, ReadsEveryShapeAndMotion) {
  const Scenario s = loaded(kValidScenario);
  ASSERT_EQ(s.obstacles.size(), 5U);
  EXPECT_EQ(std::get<SphereShape>(s.obstacles[0].shape).radius, 0.5);
  const auto linear = std::get<LinearMotion>(s.obstacles[0].motion);
  EXPECT_EQ(linear.position, Vec3(5, 5, 2));
  EXPECT_EQ(linear.velocity, Vec3(4, -2, 1));
  EXPECT_EQ(linear.acceleration, Vec3(0, 0, 7));
  EXPECT_EQ(std::get<BoxShape>(s.obstacles[1].shape).edges, Vec3(0.8, 0.9, 1.0));
  const auto trefoil = std::get<TrefoilMotion>(s.obstacles[1].motion);
  EXPECT_EQ(trefoil.center, Vec3(10, 0, 1));
  EXPECT_EQ(trefoil.scale, Vec3(1, 2, 3));
  EXPECT_EQ(trefoil.slower, 1.1);
  EXPECT_EQ(trefoil.offset, 0.3);
  const auto sine = std::get<SineMotion>(s.obstacles[2].motion);
  EXPECT_EQ(sine.center, Vec3(5, 0, 1));
  EXPECT_EQ(sine.amplitude, Vec3(0, 2, 0));
  EXPECT_EQ(sine.frequency_hz, Vec3(0, 0.2, 0));
  EXPECT_EQ(sine.phase, Vec3(0, 0, 0.6));
  const auto bounce = std::get<BounceMotion>(s.obstacles[3].motion);
  EXPECT_EQ(bounce.position, Vec3(1, 1, 1));
  EXPECT_EQ(bounce.velocity, Vec3(1, 2, 0));
  EXPECT_EQ(bounce.min, Vec3(0, -5, 1));
  EXPECT_EQ(bounce.max, Vec3(19, 5, 1));
  const auto vertices = std::get<VertexShape>(s.obstacles[4].shape).vertices;
  ASSERT_EQ(vertices.size(), 4U);
  EXPECT_EQ(vertices[3], Vec3(0, 0, 1));
  EXPECT_EQ(s.obstacles[1].orientation, Vec3::Zero());
  EXPECT_EQ(s.obstacles[1].yaw_rate, 0.0);
  const Scenario turned = loaded(
      replaced(replaced(kValidScenario, "box: [0.8, 0.9, 1.0]",
                        "cylinder: {radius: 0.3, height: 8}, orientation: [0.1, 0.2, 0.3], yaw_rate: -0.4"),
               "vertices: [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]", "capsule: {radius: 0.02, a: [0, -4, 0], b: [0, 4, 1]}"));
  EXPECT_EQ(turned.obstacles[1].shape, Shape(CylinderShape{0.3, 8}));
  EXPECT_EQ(turned.obstacles[1].orientation, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(turned.obstacles[1].yaw_rate, -0.4);
  EXPECT_EQ(turned.obstacles[4].shape, Shape(CapsuleShape{0.02, {0, -4, 0}, {0, 4, 1}}));
  const auto waypoints = std::get<WaypointsMotion>(s.obstacles[4].motion);
  EXPECT_EQ(waypoints.times, (std::vector<double>{0, 5, 9}));
  ASSERT_EQ(waypoints.points.size(), 3U);
  EXPECT_EQ(waypoints.points[2], Vec3(9, 3, 2));
}

TEST(LoadScenario, FillsInWhatIsOptional) {
  const Scenario s =
      loaded("format: jink-scenario/1\nname: short\nstart: [0, 0, 0]\ntarget: [3, 4, 0]\nvehicle: " + kVehicle +
             "\nsensing: {delay: 0.2}\nobstacles:\n- {radius: 1, position: [9, 9, 9]}\n");
  EXPECT_EQ(s.time_limit, 10.0 * 5.0 / 5.0 + 30.0);
  EXPECT_FALSE(s.world.has_value());
  EXPECT_EQ(s.sensing.range, planner::base::kInfinity);
  EXPECT_EQ(s.sensing.rate, 20.0);
  EXPECT_EQ(s.sensing.delay, 0.2);
  EXPECT_EQ(s.sensing.dropout, 0.0);
  const auto linear = std::get<LinearMotion>(s.obstacles.at(0).motion);
  EXPECT_EQ(linear.velocity, Vec3(0, 0, 0));
  EXPECT_EQ(linear.acceleration, Vec3(0, 0, 0));
}

TEST(LoadScenario, AcceptsNoObstaclesAndStartAtTarget) {
  const Scenario s =
      loaded("format: jink-scenario/1\nname: idle\nstart: [1, 2, 3]\ntarget: [1, 2, 3]\nvehicle: " + kVehicle +
             "\nobstacles: []\n");
  EXPECT_TRUE(s.obstacles.empty());
  EXPECT_EQ(s.time_limit, 30.0);
}

TEST(LoadScenario, RefusesBadTopLevelKeys) {
  const std::vector<BadCase> cases = {
      {"jink-scenario/1", "jink-scenario/2", 1, "format", "jink-scenario/2", "is not 'jink-scenario/1'"},
      {"format: jink-scenario/1\n", "", 1, "format", "", "missing; expected 'jink-scenario/1'"},
      {"name: example", "name: ''", 2, "name", "", "is empty; expected text"},
      {"name: example", "name: [a]", 2, "name", "[a]", "is a list of 1; expected text"},
      {"name: example\n", "", 1, "name", "", "missing; expected text"},
      {"start: [0, 0, 1.5]", "start: [0, 0]", 3, "start", "[0, 0]", "is a list of 2; expected [x, y, z]"},
      {"start: [0, 0, 1.5]", "start: 7", 3, "start", "7", "is a number; expected [x, y, z]"},
      {"start: [0, 0, 1.5]", "start: [0, x, 1.5]", 3, "start[1]", "x", "is a string; expected a number"},
      {"start: [0, 0, 1.5]", "start: [0, .inf, 1.5]", 3, "start[1]", ".inf", "not a finite number"},
      {"start: [0, 0, 1.5]", "start: [0, 0, -0.1]", 3, "start[2]", "-0.1", "outside the world; not in [0, 8]"},
      {"target: [20, 0, 1.5]", "target: [26, 0, 1.5]", 4, "target[0]", "26", "outside the world; not in [-5, 25]"},
      {"target: [20, 0, 1.5]", "target: [1e6, 0, 1]", 4, "target[0]", "1e6", "is not in [-100000, 100000]"},
      {"target:", "tagret:", 4, "tagret", "[20, 0, 1.5]", "did you mean 'target'?"},
      {"time_limit: 60", "acceptance_radius: 101", 5, "acceptance_radius", "101", "is not in (0, 100]"},
      {"time_limit: 60", "hold_time: 0", 5, "hold_time", "0", "is not in (0, 86400]"},
      {"time_limit: 60", "hold_time: 70\ntime_limit: 60", 6, "time_limit", "60", "is not in (70, 1000000]"},
      {"time_limit: 60", "time_limit: 0", 5, "time_limit", "0", "is not in (0, 1000000]"},
      {"world: {min: [-5, -10, 0], max: [25, 10, 8]}", "world: {min: [-5, -10, 0], max: [25, -10, 8]}", 7,
       "world.max[1]", "-10", "is not above min, -10; expected a number in (-10, 100000]"},
      {"world: {min: [-5, -10, 0], ", "world: {", 7, "world.min", "", "missing; expected [x, y, z]"},
      {"world: {min: [-5, -10, 0], max: [25, 10, 8]}", "world: 8", 7, "world", "8", "a map with the keys min, max"},
      {"mass: 0.4", "mass: -1", 6, "vehicle.mass", "-1", "is not in (0, 10000]"},
      {"mass: 0.4, ", "", 6, "vehicle.mass", "", "missing; expected a number in (0, 10000]"},
      {"obstacles:\n", "obstacels:\n", 9, "obstacels", "", "did you mean 'obstacles'?"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidScenario, bad, try_scenario);
}

TEST(LoadScenario, RefusesBadSensing) {
  const std::vector<BadCase> cases = {
      {"range: 21", "range: 0", 8, "sensing.range", "0", "is not in (0, 1000000]"},
      {"rate: 25", "rate: -3", 8, "sensing.rate", "-3", "is not in (0, 1000]"},
      {"rate: 25", "rate: 1001", 8, "sensing.rate", "1001", "is not in (0, 1000]"},
      {"delay: 0.1", "delay: 10.1", 8, "sensing.delay", "10.1", "is not in [0, 10]"},
      {"position_noise: 0.2", "position_noise: -1", 8, "sensing.position_noise", "-1", "is not in [0, 1000]"},
      {"velocity_noise: 0.3", "velocity_noise: yes", 8, "sensing.velocity_noise", "yes", "is a boolean"},
      {"dropout: 0.4", "dropout: 1", 8, "sensing.dropout", "1", "is not in [0, 1)"},
      {"rate: 25", "rat: 25", 8, "sensing.rat", "25", "did you mean 'rate'?"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidScenario, bad, try_scenario);
}

TEST(LoadScenario, RefusesBadShapes) {
  const std::vector<BadCase> cases = {
      {"radius: 0.5", "radius: -0.5", 10, "obstacles[0].radius", "-0.5", "is not in (0, 1000]"},
      {"radius: 0.5, ", "", 10, "obstacles[0]", "",
       "has no shape; expected exactly one of radius, box, cylinder, capsule, vertices"},
      {"radius: 0.5, ", "radius: 0.5, box: [1, 1, 1], ", 10, "obstacles[0]", "", "has the shapes radius, box"},
      {"box: [0.8, 0.9, 1.0]", "box: [0.8, 0, 1.0]", 11, "obstacles[1].box[1]", "0", "is not in (0, 1000]"},
      {"box: [0.8, 0.9, 1.0]", "box: 0.8", 11, "obstacles[1].box", "0.8", "is a number; expected a list"},
      {"[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]", "[]", 14, "obstacles[4].vertices", "[]", "in [1, 10000]"},
      {"[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]", "[[0,0,0],[1,0]]", 14, "obstacles[4].vertices[1]", "[1, 0]", "[x, y, z]"},
      {"[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]", "[[1,2,3],[1,2,3]]", 14, "obstacles[4].vertices", "[[1, 2, 3], [1, 2, 3]]",
       "has an enclosing sphere of radius 0; expected one in (0, 1000]"},
      {"[0,1,0]", "[0,.nan,0]", 14, "obstacles[4].vertices[2][1]", ".nan", "not a finite number"},
      {"radius: 0.5", "cylinder: {radius: 0.5}", 10, "obstacles[0].cylinder.height", "", "missing; expected a number"},
      {"radius: 0.5", "cylinder: {radius: 0.5, height: -2}", 10, "obstacles[0].cylinder.height", "-2", "(0, 1000]"},
      {"radius: 0.5", "capsule: {radius: 0, a: [0, 0, 0], b: [1, 0, 0]}", 10, "obstacles[0].capsule.radius", "0",
       "is not in (0, 1000]"},
      {"radius: 0.5", "capsule: {radius: 1, a: [0, 0, 0], c: [1, 0, 0]}", 10, "obstacles[0].capsule.c", "[1, 0, 0]",
       "unknown key"},
      {"radius: 0.5, ", "radius: 0.5, yaw_rate: 1, ", 10, "obstacles[0].yaw_rate", "1", "a sphere is the same"},
      {"box: [0.8, 0.9, 1.0]", "box: [0.8, 0.9, 1.0], orientation: [1, 2]", 11, "obstacles[1].orientation", "[1, 2]",
       "[x, y, z]"},
      {"box: [0.8, 0.9, 1.0]", "box: [0.8, 0.9, 1.0], yaw_rate: 200", 11, "obstacles[1].yaw_rate", "200",
       "is not in [-100, 100]"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidScenario, bad, try_scenario);
}

TEST(LoadScenario, RefusesBadMotions) {
  const std::vector<BadCase> cases = {
      {"position: [5, 5, 2], ", "", 10, "obstacles[0].position", "", "missing; expected [x, y, z], or motion"},
      {"velocity: [4, -2, 1]", "velocity: [4, -2000, 1]", 10, "obstacles[0].velocity[1]", "-2000", "[-1000, 1000]"},
      {"acceleration: [0, 0, 7]", "motion: {type: sine}", 10, "obstacles[0].position", "[5, 5, 2]", "beside motion"},
      {"type: trefoil", "type: trefoyl", 11, "obstacles[1].motion.type", "trefoyl", "did you mean 'trefoil'?"},
      {"type: trefoil", "type: linear", 11, "obstacles[1].motion.type", "linear", "trefoil, sine, bounce, waypoints"},
      {"type: trefoil, ", "", 11, "obstacles[1].motion.type", "", "missing; expected one of trefoil"},
      {"slower: 1.1", "slower: 0", 11, "obstacles[1].motion.slower", "0", "is not in [0.001, 1000000]"},
      {"slower: 1.1, ", "", 11, "obstacles[1].motion.slower", "", "missing; expected a number"},
      {"slower: 1.1", "slowr: 1.1", 11, "obstacles[1].motion.slowr", "1.1", "did you mean 'slower'?"},
      {"offset: 0.3", "offset: 0.3, phase: [0, 0, 0]", 11, "obstacles[1].motion.phase", "[0, 0, 0]", "unknown key"},
      {"frequency_hz: [0, 0.2, 0]", "frequency_hz: [0, -0.2, 0]", 12, "obstacles[2].motion.frequency_hz[1]", "-0.2",
       "is not in [0, 1000]"},
      {"position: [1, 1, 1]", "position: [1, 6, 1]", 13, "obstacles[3].motion.position[1]", "6",
       "is not between min and max, in [-5, 5]"},
      {"max: [19, 5, 1]", "max: [-1, 5, 1]", 13, "obstacles[3].motion.max[0]", "-1",
       "expected a number in (0, 100000]"},
      {"velocity: [1, 2, 0]", "velocity: [1, 2, 3]", 13, "obstacles[3].motion.max[2]", "1", "is not above min"},
      {"times: [0, 5, 9]", "times: [0, 5, 5]", 14, "obstacles[4].motion.times[2]", "5",
       "expected a number in (5, 1000000]"},
      {"times: [0, 5, 9]", "times: [-1, 5, 9]", 14, "obstacles[4].motion.times[0]", "-1", "is not in [0, 1000000]"},
      {"times: [0, 5, 9]", "times: [0, 5]", 14, "obstacles[4].motion.points", "", "is a list of 3; expected a list"},
      {"times: [0, 5, 9]", "times: []", 14, "obstacles[4].motion.times", "[]", "is a list of 0"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidScenario, bad, try_scenario);
}

const std::string kTeam = kValidScenario +
                          "vehicles:\n"                                                         // 15
                          "- {start: [0, 2, 1.5], target: [20, 2, 1.5]}\n"                      // 16
                          "- {start: [0, 4, 1.6], target: [20, 4, 1.7], vehicle: ardrone2}\n";  // 17

TEST(LoadScenario, ReadsFurtherVehicles) {
  EXPECT_TRUE(loaded(kValidScenario).vehicles.empty());
  EXPECT_EQ(all_vehicles(loaded(kValidScenario)).size(), 1U);
  const Scenario s = loaded(kTeam);
  ASSERT_EQ(s.vehicles.size(), 2U);
  EXPECT_EQ(s.vehicles[0].start, Vec3(0, 2, 1.5));
  EXPECT_EQ(s.vehicles[0].target, Vec3(20, 2, 1.5));
  EXPECT_EQ(s.vehicles[0].vehicle_name, "inline");
  EXPECT_EQ(s.vehicles[0].vehicle.mass, 0.4);
  EXPECT_EQ(s.vehicles[1].vehicle_name, "ardrone2");
  EXPECT_EQ(s.vehicles[1].vehicle.mass, 0.42);
  const std::vector<ScenarioVehicle> all = all_vehicles(s);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].start, s.start);
  EXPECT_EQ(all[0].target, s.target);
  EXPECT_EQ(all[2].target, Vec3(20, 4, 1.7));
}

TEST(LoadScenario, RefusesBadFurtherVehicles) {
  const std::vector<BadCase> cases = {
      {"start: [0, 2, 1.5], ", "", 16, "vehicles[0].start", "", "missing"},
      {", target: [20, 2, 1.5]", "", 16, "vehicles[0].target", "", "missing"},
      {"target: [20, 2, 1.5]", "targt: [20, 2, 1.5]", 16, "vehicles[0].targt", "[20, 2, 1.5]",
       "did you mean 'target'?"},
      {"start: [0, 2, 1.5]", "start: [0, 12, 1.5]", 16, "vehicles[0].start[1]", "12", "not in [-10, 10]"},
      // The two spheres of 0.3 m would overlap on the ground, however far apart the starts are in height.
      {"start: [0, 2, 1.5]", "start: [0, 0.5, 7]", 16, "vehicles[0].start", "[0, 0.5, 7]",
       "is 0.5 m from vehicle 0 on the ground; expected more than 0.6 m"},
      {"start: [0, 4, 1.6]", "start: [0, 2, 1.5]", 17, "vehicles[1].start", "[0, 2, 1.5]", "is 0 m from vehicle 1"},
      {"vehicle: ardrone2", "vehicle: ardrone3", 17, "vehicles[1].vehicle", "ardrone3", "did you mean 'ardrone2'?"},
      {"vehicles:\n- {start: [0, 2, 1.5], target: [20, 2, 1.5]}\n- {start: [0, 4, 1.6], target: [20, 4, 1.7], "
       "vehicle: ardrone2}\n",
       "vehicles: [1,2,3,4,5,6,7,8,9,10]\n", 15, "vehicles", "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]", "in [0, 9]"},
  };
  for (const BadCase& bad : cases) expect_refused(kTeam, bad, try_scenario);
}

const std::string kFaulty = kTeam +
                            "wind: {mean: [1, 2, -0.5], gust: 0.7, gust_time: 3}\n"                               // 18
                            "estimate: {position_noise: 0.1, velocity_noise: 0.2, drift: 0.3, drift_time: 40}\n"  // 19
                            "faults:\n"                                                                           // 20
                            "- {at: 12, kind: link_loss, for: 3, direction: up, vehicle: 1}\n"                    // 21
                            "- {at: 0, kind: packet_loss, rate: 0.25}\n"                                          // 22
                            "- {at: 1, kind: delay, seconds: 0.2, direction: down}\n"                             // 23
                            "- {at: 2, kind: reorder, rate: 0.125}\n"                                             // 24
                            "- {at: 3, kind: gps_loss}\n"                                                         // 25
                            "- {at: 4, kind: estimate_jump, by: [3, 0, -1]}\n"                                    // 26
                            "- {at: 5, kind: tracks_stop}\n"                                                      // 27
                            "- {at: 6, kind: tracks_freeze}\n"                                                    // 28
                            "- {at: 7, kind: track_noise, position: 0.6, velocity: 0.8}\n"                        // 29
                            "- {at: 8, kind: id_swap}\n"                                                          // 30
                            "- {at: 9, kind: tracks_garbage}\n"                                                   // 31
                            "- {at: 10, kind: tracks_flood, count: 20000}\n"                                      // 32
                            "- {at: 11, kind: tracks_self, vehicle: 2}\n"                                         // 33
                            "- {at: 13, kind: tracks_clock, offset: -3600}\n"                                     // 34
                            "- {at: 14, kind: reboot, vehicle: 0}\n"                                              // 35
                            "- {at: 15, kind: pilot_mode, mode: altitude}\n"                                      // 36
                            "- {at: 16, kind: low_battery, remaining: 0.05}\n"                                    // 37
                            "- {at: 17, kind: refuse_arming}\n"                                                   // 38
                            "- {at: 18, kind: refuse_offboard}\n";                                                // 39

TEST(LoadScenario, ReadsWindAndEstimate) {
  const Scenario plain = loaded(kValidScenario);
  EXPECT_EQ(plain.wind.mean, Vec3::Zero());
  EXPECT_EQ(plain.wind.gust, 0.0);
  EXPECT_TRUE(plain.estimate.px4);
  EXPECT_EQ(plain.estimate.drift, 0.0);
  EXPECT_TRUE(plain.faults.empty());
  const Scenario s = loaded(kFaulty);
  EXPECT_EQ(s.wind.mean, Vec3(1, 2, -0.5));
  EXPECT_EQ(s.wind.gust, 0.7);
  EXPECT_EQ(s.wind.gust_time, 3.0);
  EXPECT_FALSE(s.estimate.px4);
  EXPECT_EQ(s.estimate.position_noise, 0.1);
  EXPECT_EQ(s.estimate.velocity_noise, 0.2);
  EXPECT_EQ(s.estimate.drift, 0.3);
  EXPECT_EQ(s.estimate.drift_time, 40.0);
}

TEST(LoadScenario, KnowsWhoseEstimateItIsAndWhereItSenses) {
  EXPECT_TRUE(loaded(kValidScenario + "estimate: px4\n").estimate.px4);
  EXPECT_EQ(loaded(kValidScenario + "estimate: none\n").estimate, (EstimateErrors{.px4 = false}));
  expect_refused(kValidScenario + "estimate: none\n",
                 {"estimate: none", "estimate: some", 15, "estimate", "some", "px4"}, try_scenario);
  EXPECT_EQ(loaded(kValidScenario).sensing.sensed_from, SensedFrom::kWorld);
  EXPECT_EQ(loaded(replaced(kValidScenario, "dropout: 0.4", "sensed_from: vehicle")).sensing.sensed_from,
            SensedFrom::kVehicle);
  expect_refused(kTeam, {"dropout: 0.4", "sensed_from: vehicle", 8, "sensing", "", "several"}, try_scenario);
}

TEST(LoadScenario, ReadsEveryFault) {
  const std::vector<Fault> faults = loaded(kFaulty).faults;
  ASSERT_EQ(faults.size(), 19U);
  for (std::size_t i = 0; i < faults.size(); ++i) EXPECT_EQ(faults[i].kind, static_cast<FaultKind>(i));
  EXPECT_EQ(faults[0].at, 12.0);
  EXPECT_EQ(faults[0].duration, 3.0);
  EXPECT_EQ(faults[0].direction, LinkDirection::kUp);
  EXPECT_EQ(faults[0].vehicle, 1);
  EXPECT_TRUE(faults[0].befalls(1));
  EXPECT_FALSE(faults[0].befalls(0));
  EXPECT_EQ(faults[1].rate, 0.25);
  EXPECT_EQ(faults[1].duration, std::nullopt);
  EXPECT_EQ(faults[1].direction, LinkDirection::kBoth);
  EXPECT_TRUE(faults[1].befalls(2));
  EXPECT_EQ(faults[2].seconds, 0.2);
  EXPECT_EQ(faults[2].direction, LinkDirection::kDown);
  EXPECT_EQ(faults[3].rate, 0.125);
  EXPECT_EQ(faults[5].by, Vec3(3, 0, -1));
  EXPECT_EQ(faults[8].position, 0.6);
  EXPECT_EQ(faults[8].velocity, 0.8);
  EXPECT_EQ(faults[11].count, 20000);
  EXPECT_EQ(faults[13].offset, -3600.0);
  EXPECT_EQ(faults[15].mode, PilotMode::kAltitude);
  EXPECT_EQ(faults[16].remaining, 0.05);
  EXPECT_EQ(faults[0].text(), "link_loss, up, for 3 s, vehicle 1");
  EXPECT_EQ(faults[5].text(), "estimate_jump, by [3, 0, -1]");
  EXPECT_EQ(faults[15].text(), "pilot_mode, altitude");
}

TEST(LoadScenario, RefusesBadFaults) {
  const std::vector<BadCase> cases = {
      {"kind: link_loss", "kind: linkloss", 21, "faults[0].kind", "linkloss", "did you mean 'link_loss'?"},
      {"kind: link_loss, ", "", 21, "faults[0].kind", "", "missing; expected one of link_loss, packet_loss"},
      {"at: 12, ", "", 21, "faults[0].at", "", "missing; expected a number in [0, 1000000]"},
      {"at: 12", "at: -1", 21, "faults[0].at", "-1", "is not in [0, 1000000]"},
      {"for: 3", "for: 0", 21, "faults[0].for", "0", "is not in (0, 1000000]"},
      {"for: 3", "fro: 3", 21, "faults[0].fro", "3", "did you mean 'for'?"},
      {"direction: up", "direction: upp", 21, "faults[0].direction", "upp", "did you mean 'up'?"},
      {"vehicle: 1}", "vehicle: 3}", 21, "faults[0].vehicle", "3", "is not in [0, 2]"},
      {"vehicle: 1}", "vehicle: 0.5}", 21, "faults[0].vehicle", "0.5", "is not an integer"},
      {"direction: up", "rate: 0.5", 21, "faults[0].rate", "0.5", "allowed: at, kind, for, vehicle, direction"},
      {"rate: 0.25", "rate: 1.25", 22, "faults[1].rate", "1.25", "is not in [0, 1]"},
      {", rate: 0.25", "", 22, "faults[1].rate", "", "missing"},
      {"seconds: 0.2", "seconds: 61", 23, "faults[2].seconds", "61", "is not in [0, 60]"},
      {"rate: 0.125", "rate: .nan", 24, "faults[3].rate", ".nan", "not a finite number"},
      {"kind: gps_loss", "kind: gps_loss, direction: up", 25, "faults[4].direction", "up", "unknown key"},
      {"by: [3, 0, -1]", "by: [3, 0]", 26, "faults[5].by", "[3, 0]", "[x, y, z]"},
      {"by: [3, 0, -1]", "by: [3, 0, 1e9]", 26, "faults[5].by[2]", "1e9", "is not in [-10000, 10000]"},
      {"by: [3, 0, -1]", "by: [3, 0, -1], for: 2", 26, "faults[5].for", "2", "happens at once; expected no 'for'"},
      {"kind: tracks_stop", "kind: tracks_stop, vehicle: 0", 27, "faults[6].vehicle", "0", "unknown key"},
      {"position: 0.6, velocity: 0.8", "for: 1", 29, "faults[8]", "", "has no noise; expected position"},
      {"velocity: 0.8", "velocity: -0.8", 29, "faults[8].velocity", "-0.8", "is not in [0, 1000]"},
      {"count: 20000", "count: 20001", 32, "faults[11].count", "20001", "is not in [1, 20000]"},
      {"count: 20000", "count: 1.5", 32, "faults[11].count", "1.5", "is not an integer"},
      {", offset: -3600", "", 34, "faults[13].offset", "", "missing"},
      {"mode: altitude", "mode: offboard", 36, "faults[15].mode", "offboard",
       "hold, position, altitude, land, return, manual"},
      {"remaining: 0.05", "remaining: 5", 37, "faults[16].remaining", "5", "is not in [0, 1]"},
      {"gust: 0.7", "gust: -0.7", 18, "wind.gust", "-0.7", "is not in [0, 100]"},
      {"gust_time: 3", "gust_time: 0", 18, "wind.gust_time", "0", "is not in (0, 10000]"},
      {"mean: [1, 2, -0.5]", "mean: [1, 200, 0]", 18, "wind.mean[1]", "200", "is not in [-100, 100]"},
      {"drift: 0.3", "drft: 0.3", 19, "estimate.drft", "0.3", "did you mean 'drift'?"},
      {"drift_time: 40", "drift_time: 0", 19, "estimate.drift_time", "0", "is not in (0, 1000000]"},
  };
  for (const BadCase& bad : cases) expect_refused(kFaulty, bad, try_scenario);
  expect_contains(error_of([] { loaded(kValidScenario + "faults: 3\n"); }), ":15: key 'faults': value '3' is a number");
  expect_contains(error_of([] { loaded(kValidScenario + "faults:\n- {at: 0, kind: reboot, vehicle: 1}\n"); }),
                  "is not in [0, 0]");
}

TEST(LoadScenario, NamesTheLineOfAValueInALongList) {
  const std::string text = replaced(kValidScenario, "start: [0, 0, 1.5]", "start:\n- 0\n- zero\n- 1.5");
  const Folder folder;
  const auto file = folder.write("s.yaml", text);
  expect_contains(error_of([&] { try_scenario(file); }), ":5: key 'start[1]': value 'zero'");
}

TEST(LoadScenario, FindsAVehicleBesideTheScenariosFolderFirst) {
  const Folder folder;
  const std::string text = replaced(kValidScenario, kVehicle, "ardrone2");
  const auto file = folder.write("scenarios/s.yaml", text);
  // The project's own, as there is none beside the scenario yet.
  const Scenario own = load_scenario(file);
  EXPECT_EQ(own.vehicle_name, "ardrone2");
  EXPECT_EQ(own.vehicle.mass, 0.42);
  folder.write("vehicles/ardrone2.yaml",
               "radius: 1\nlength: 2\nmass: 3\nmax_speed: 4\ncruise_speed: 4\n"
               "max_acceleration: 6\nmax_jerk: 7\nmax_climb: 8\n");
  EXPECT_EQ(load_scenario(file).vehicle.mass, 3.0);
  // A folder that is given is the only one.
  EXPECT_EQ(load_scenario(file, folder.path() / "vehicles").vehicle.mass, 3.0);
  expect_contains(
      error_of([&] { static_cast<void>(load_scenario(file, folder.path() / "none")); }),
      ":6: key 'vehicle': value 'ardrone2' is not a vehicle; there are none in " + (folder.path() / "none").string());
}

TEST(LoadScenario, LetsTheEnvironmentNameTheProjectsFolder) {
  const Folder folder;
  folder.write("elsewhere/vehicles/kite.yaml",
               "radius: 1\nlength: 2\nmass: 3\nmax_speed: 4\ncruise_speed: 4\n"
               "max_acceleration: 6\nmax_jerk: 7\nmax_climb: 8\n");
  const auto file = folder.write("s.yaml", replaced(kValidScenario, kVehicle, "kite"));
  // No test of this program starts a thread.
  ASSERT_EQ(setenv("JINK_CONFIG_DIR", (folder.path() / "elsewhere").c_str(), 1), 0);  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(load_scenario(file).vehicle.max_jerk, 7.0);
  ASSERT_EQ(unsetenv("JINK_CONFIG_DIR"), 0);  // NOLINT(concurrency-mt-unsafe)
  expect_contains(error_of([&] { try_scenario(file); }), "is not a vehicle");
}

TEST(LoadScenario, NamesTheVehiclesThatExist) {
  const std::vector<BadCase> cases = {
      {kVehicle, "ardrone3", 6, "vehicle", "ardrone3",
       "did you mean 'ardrone2'? expected a map or one of ardrone2, px4"},
      {kVehicle, "zeppelin", 6, "vehicle", "zeppelin", "expected a map or one of ardrone2, px4"},
      {kVehicle, "../ardrone2", 6, "vehicle", "../ardrone2", "is not the name of a vehicle"},
      {kVehicle, "/etc/passwd", 6, "vehicle", "/etc/passwd", "is not the name of a vehicle"},
      {kVehicle, "..", 6, "vehicle", "..", "is not the name of a vehicle"},
      {kVehicle, "[1]", 6, "vehicle", "[1]", "is a list of 1; expected text"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidScenario, bad, try_scenario);
}

TEST(LoadScenario, BlamesTheVehicleFileForItsOwnFaults) {
  const Folder folder;
  const auto vehicle = folder.write("broken.yaml", "radius: 1\nlength: -2\n");
  const auto file = folder.write("s.yaml", replaced(kValidScenario, kVehicle, "broken"));
  expect_contains(error_of([&] { static_cast<void>(load_scenario(file, folder.path())); }), vehicle.string() + ":");
}

TEST(LoadScenario, AScanIsACameraOrALidarOrGivenInFull) {
  const Folder folder;
  const auto scan = [&](const std::string& text) {
    return load_scenario(folder.write("s.yaml",
                                      "format: jink-scenario/1\nname: s\nstart: [0, 0, 1]\ntarget: [9, 0, 1]\n"
                                      "vehicle: ardrone2\nobstacles: []\nsensing: {scan: " +
                                          text + "}\n"))
        .sensing.scan;
  };
  EXPECT_EQ(scan("camera"), depth_camera());
  EXPECT_EQ(scan("lidar"), lidar());
  EXPECT_EQ(scan("{kind: lidar, horizontal_deg: 180, vertical_deg: 40, columns: 90, rows: 16, range: 20, rate: 5, "
                 "noise: 0.02, unknown: occupied}"),
            (Scan{180, 40, 90, 16, 20, 5, 0.02, Unknown::kOccupied}));
  for (const char* bad :
       {"sonar", "{rate: 5}", "{kind: camera, range: 26}", "{kind: camera, columns: 0}", "{kind: camera, fov: 3}",
        "{kind: camera, rate: 0}", "{kind: camera, noise: -1}", "{kind: camera, unknown: solid}"})
    expect_contains(error_of([&] { static_cast<void>(scan(bad)); }), "sensing.scan");
}

}  // namespace
}  // namespace jink::config
