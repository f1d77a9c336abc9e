// SPDX-License-Identifier: BSD-3-Clause
// The keys `map` and `no_fly`. OctoMap's files are written by its own library.
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/mission.hpp"
#include "config/octomap.hpp"
#include "config/scenario.hpp"
#include "config/scenario_writer.hpp"
#include "config/solids.hpp"
#include "planner/base/random.hpp"
#include "planner/geometry/static_map.hpp"
#include "tests/config/yaml_case.hpp"

namespace jink::config {
namespace {

const std::string kScenario =
    "format: jink-scenario/1\n"
    "name: yard\n"
    "start: [0, 0, 1.5]\n"
    "target: [20, 0, 1.5]\n"
    "vehicle: ardrone2\n"
    "obstacles: []\n";  // 6 lines

const std::string kSolids =
    "- {box: [8, 0.3, 3], position: [10, 4, 1.5], orientation: [0.5, 0, 0]}\n"
    "- {radius: 1.5, position: [3, 4, 5]}\n"
    "- {cylinder: {radius: 0.2, height: 5}, position: [1, 9, 2.5]}\n"
    "- {capsule: {radius: 0.05, a: [0, -9, 0], b: [0, 9, 0]}, position: [5, 0, 4]}\n"
    "- {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], position: [7, 7, 1]}\n";

const std::string kZone = "no_fly: [{polygon: [[4, 4], [8, 4], [8, 8], [4, 8]], min: 0, max: 10}]\n";

Scenario scenario_with(const Folder& folder, const std::string& more) {
  return load_scenario(folder.write("s.yaml", kScenario + more));
}

TEST(LoadMap, ReadsAListOfSolidsAtRest) {
  const Folder folder;
  (void)folder.write("yard.yaml", kSolids);
  const Scenario scenario = scenario_with(folder, "map: yard.yaml\n");
  ASSERT_EQ(scenario.map.size(), 5U);
  EXPECT_EQ(scenario.map[0].shape, Shape(BoxShape{{8, 0.3, 3}}));
  EXPECT_EQ(scenario.map[0].orientation, Vec3(0.5, 0, 0));
  EXPECT_EQ(scenario.map[0].motion, Motion(LinearMotion{{10, 4, 1.5}}));
  EXPECT_EQ(scenario.map[1].shape, Shape(SphereShape{1.5}));
  EXPECT_TRUE(scenario.obstacles.empty());
  // The same in the file itself, and for a mission.
  EXPECT_EQ(scenario_with(folder, "map:\n" + kSolids).map, scenario.map);
  const Mission mission = load_mission(folder.write("m.yaml",
                                                    "format: jink-mission/1\nname: m\nconnection: udpin://:14540\n"
                                                    "vehicle: px4\nwaypoints: [[1, 2, 3]]\nmap: yard.yaml\n"));
  ASSERT_EQ(mission.map->tracks().size(), 5U);
  EXPECT_EQ(mission.map->tracks()[1].position, Vec3(3, 4, 5));
  EXPECT_EQ(mission.map->tracks()[1].radius, 1.5);
  EXPECT_FALSE(mission.autopilot_fence);
}

TEST(LoadMap, IsAllThatAWorldNeeds) {
  const Folder folder;
  const std::string bare = kScenario.substr(0, kScenario.find("obstacles"));
  EXPECT_EQ(load_scenario(folder.write("s.yaml", bare + kZone)).map.size(), 1U);
  EXPECT_TRUE(load_scenario(folder.write("s.yaml", bare + "map: []\n")).obstacles.empty());
  EXPECT_THROW((void)load_scenario(folder.write("s.yaml", bare)), ConfigError);
}

TEST(LoadMap, IsWrittenAsItIs) {
  const Folder folder;
  const Scenario scenario = scenario_with(folder, "map:\n" + kSolids + kZone);
  EXPECT_EQ(scenario.map.size(), 6U);
  EXPECT_EQ(load_scenario(folder.write("again.yaml", to_yaml(scenario))).map, scenario.map);
}

TEST(LoadMap, WhatIsNoHigherThanTheGroundIsTheGround) {
  const Folder folder;
  EXPECT_TRUE(scenario_with(folder, "map: [{box: [50, 50, 0.2], position: [0, 0, 0]}]\n").map.empty());
  EXPECT_EQ(scenario_with(folder, "map: [{box: [50, 50, 1], position: [0, 0, 0]}]\n").map.size(), 1U);
}

TEST(LoadMap, NamesWhatIsWrongInTheMapsFile) {
  const std::vector<BadCase> cases{
      {"[8, 0.3, 3]", "[8, 0.3]", 1, "[0].box", "", "a list with a number of elements in [3, 3]"},
      {"[8, 0.3, 3]", "[8, .nan, 3]", 1, "[0].box[1]", ".nan", "not a finite number"},
      {"[8, 0.3, 3]", "[8, 0, 3]", 1, "[0].box[1]", "0", "(0, 1000]"},
      {"radius: 1.5, position: [3, 4, 5]", "radius: 1.5", 2, "[1].position", "", "missing"},
      {"position: [3, 4, 5]", "position: [3, 4, 5], velocity: [1, 0, 0]", 2, "[1].velocity", "[1, 0, 0]", "at rest"},
      {"position: [3, 4, 5]", "position: [3, 4, 5], acceleration: [0, 0, 0]", 2, "[1].acceleration", "", "at rest"},
      {"position: [1, 9, 2.5]", "motion: {type: trefoil}", 3, "[2].motion", "", "at rest"},
      {"position: [1, 9, 2.5]", "position: [1, 9, 2.5], yaw_rate: 1", 3, "[2].yaw_rate", "1", "at rest"},
      {"b: [0, 9, 0]", "c: [0, 9, 0]", 4, "[3].capsule.c", "[0, 9, 0]", "unknown key"},
      {"vertices", "vertics", 5, "[4].vertics", "", "did you mean 'vertices'"},
      {"[0, 0, 1]]", "[0, 0, 1e9]]", 5, "[4].vertices[3][2]", "1e9", "[-1000, 1000]"},
  };
  for (const BadCase& bad : cases) {
    expect_refused(kSolids, bad, [](const std::filesystem::path& map) {
      const Folder beside;
      (void)load_scenario(beside.write("s.yaml", kScenario + "map: " + map.string() + "\n"));
    });
  }
}

TEST(LoadMap, NamesWhatIsWrongInTheScenario) {
  const std::vector<BadCase> cases{
      {"[[4, 4], [8, 4], [8, 8], [4, 8]]", "[[4, 4], [8, 4], [4, 8], [8, 8]]", 7, "no_fly[0].polygon", "",
       "crosses or touches itself"},
      {"[[4, 4], [8, 4], [8, 8], [4, 8]]", "[[4, 4], [8, 4]]", 7, "no_fly[0].polygon", "", "[3, 1000]"},
      {"[8, 8]", "[8, .inf]", 7, "no_fly[0].polygon[2][1]", ".inf", "not a finite number"},
      {"[8, 8]", "[8, 8, 8]", 7, "no_fly[0].polygon[2]", "", "[2, 2]"},
      {"max: 10", "max: -1", 7, "no_fly[0].max", "-1", "not above min"},
      {", max: 10", "", 7, "no_fly[0].max", "", "missing"},
      {"min: 0, ", "", 7, "no_fly[0].min", "", "missing"},
      {kZone, "map: nowhere.yaml\n", 7, "map", "nowhere.yaml", "is no file"},
      {kZone, "map: {a: b}\n", 7, "map", "", "expected text"},
      {kZone, "map: 3\n", 7, "map", "3", "is no file"},
  };
  for (const BadCase& bad : cases)
    expect_refused(kScenario + kZone, bad, [](const std::filesystem::path& file) { (void)load_scenario(file); });
}

TEST(LoadMap, ZonesArePrismsOverTheirPolygons) {
  const Folder folder;
  const Scenario square = scenario_with(folder, kZone);
  ASSERT_EQ(square.map.size(), 1U);
  const planner::base::Box box = planner::geometry::box_around(track_at_rest(square.map[0]));
  EXPECT_TRUE(box.min.isApprox(Vec3(4, 4, 0)));
  EXPECT_TRUE(box.max.isApprox(Vec3(8, 8, 10)));
  for (const char* polygon :
       {"[[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]", "[[0, 3], [1, 3], [1, 1], [4, 1], [4, 0], [0, 0]]"}) {
    const Scenario angle = scenario_with(folder, "no_fly: [{polygon: " + std::string(polygon) + ", min: 1, max: 2}]\n");
    EXPECT_EQ(angle.map.size(), 3U);
    for (const Obstacle& piece : angle.map) {
      const planner::base::Box part = planner::geometry::box_around(track_at_rest(piece));
      EXPECT_GE(part.min.minCoeff(), -1e-12);
      EXPECT_FALSE(part.contains({3, 2, 1.5}) && part.min.x() > 1.0) << "not what the angle leaves out";
    }
  }
}

/// What the library says is occupied, cell by cell, and what the boxes hold.
void expect_same(const octomap::OcTree& tree, const std::vector<Obstacle>& boxes, double size) {
  double volume = 0.0;
  for (const Obstacle& box : boxes) volume += std::get<BoxShape>(box.shape).edges.prod();
  double occupied = 0.0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) occupied += std::pow(leaf.getSize(), 3);
  }
  EXPECT_NEAR(volume, occupied, 1e-9 * occupied);
  const double cell = tree.getResolution();
  for (double x = 0.5 * cell - size; x < size; x += cell) {
    for (double y = 0.5 * cell - size; y < size; y += cell) {
      for (double z = 0.5 * cell - size; z < size; z += cell) {
        const octomap::OcTreeNode* node = tree.search(x, y, z);
        const bool full = node != nullptr && tree.isNodeOccupied(node);
        const Vec3 p(x, y, z);
        const bool held = std::any_of(boxes.begin(), boxes.end(), [&](const Obstacle& box) {
          const Vec3 off = (p - std::get<LinearMotion>(box.motion).position).cwiseAbs();
          return (2.0 * off.array() < std::get<BoxShape>(box.shape).edges.array()).all();
        });
        ASSERT_EQ(held, full) << p.transpose();
      }
    }
  }
}

octomap::OcTree room() {
  octomap::OcTree tree(0.25);
  for (double x = -2.875; x < 3; x += 0.25) {
    for (double y = -2.875; y < 3; y += 0.25) {
      for (double z = 0.125; z < 2; z += 0.25) {
        const bool wall = std::max(std::abs(x), std::abs(y)) > 2.75;
        const bool pillar = x > 0 && x < 1 && y > 0 && y < 1;  // prunes to larger leaves
        const bool door = x < 0 && std::abs(y) < 0.5;
        tree.updateNode(x, y, z, (wall && !door) || pillar);
      }
    }
  }
  tree.updateInnerOccupancy();
  return tree;
}

TEST(LoadOctomap, ReadsWhatItsLibraryWrites) {
  const Folder folder;
  octomap::OcTree tree = room();
  ASSERT_TRUE(tree.write((folder.path() / "room.ot").string()));
  const std::vector<Obstacle> full = load_octomap(folder.path() / "room.ot", 1000);
  expect_same(tree, full, 3.5);
  EXPECT_LT(full.size(), 20U) << "walls are merged";
  ASSERT_TRUE(tree.writeBinary((folder.path() / "room.bt").string()));
  const std::vector<Obstacle> binary = load_octomap(folder.path() / "room.bt", 1000);
  expect_same(tree, binary, 3.5);
  EXPECT_EQ(full, binary);
  EXPECT_EQ(scenario_with(folder, "map: room.bt\n").map, binary);
}

TEST(LoadOctomap, ReadsRandomTrees) {
  const Folder folder;
  planner::base::RandomStream random(4);
  for (int n = 0; n < 20; ++n) {
    octomap::OcTree tree(0.5);
    for (int i = 0; i < 300; ++i) {
      const auto at = [&] { return random.uniform(-4, 4); };
      const double x = at();
      const double y = at();
      tree.updateNode(x, y, at(), random.uniform(0, 1) < 0.7);
    }
    ASSERT_TRUE(tree.writeBinary((folder.path() / "t.bt").string()));
    expect_same(tree, load_octomap(folder.path() / "t.bt", 1000), 4.5);
  }
}

TEST(LoadOctomap, ReadsColouredAndEmptyOnes) {
  const Folder folder;
  octomap::ColorOcTree coloured(1.0);
  coloured.updateNode(0.5, 0.5, 0.5, true);
  coloured.setNodeColor(coloured.coordToKey(0.5, 0.5, 0.5), 1, 2, 3);
  coloured.updateInnerOccupancy();
  ASSERT_TRUE(coloured.write((folder.path() / "c.ot").string()));
  const std::vector<Obstacle> one = load_octomap(folder.path() / "c.ot", 10);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].shape, Shape(BoxShape{{1, 1, 1}}));
  EXPECT_EQ(one[0].motion, Motion(LinearMotion{{0.5, 0.5, 0.5}}));
  ASSERT_TRUE(octomap::OcTree(0.5).write((folder.path() / "e.ot").string()));
  EXPECT_TRUE(load_octomap(folder.path() / "e.ot", 10).empty());
}

TEST(LoadOctomap, RefusesWhatIsNoneInOneLine) {
  const Folder folder;
  std::ostringstream out;
  octomap::OcTree tree = room();
  ASSERT_TRUE(tree.writeBinary(out));
  const std::string good = out.str();
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::vector<std::pair<std::string, std::string>> bad{
      {"", "is empty"},
      {"hello", "is no OctoMap"},
      {good.substr(0, good.size() - 1), "is cut off within its tree"},
      {good.substr(0, 40), "is cut off"},
      {good + "x", "goes on behind its tree"},
      {replaced("res 0.25", "res nan"), "key 'res'"},
      {replaced("res 0.25", "res 0"), "(0, 1000]"},
      {replaced("id OcTree", "id Voxels"), "Voxels"},
      {replaced("res 0.25", "colour 3"), "unknown key 'colour'"},
      {"# Octomap OcTree binary file\nid OcTree\nsize 9\nres 1\ndata\n" + std::string(99, '\xff'), "nested deeper"},
  };
  for (const auto& [text, expected] : bad) {
    const std::filesystem::path file = folder.write("bad.bt", text);
    const std::string error = error_of([&] { (void)load_octomap(file, 1000); });
    EXPECT_TRUE(error.starts_with(file.string() + ":")) << error;
    expect_contains(error, expected);
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  octomap::OcTree far(100.0);
  far.updateNode(200'000.0, 0.0, 0.0, true);
  ASSERT_TRUE(far.writeBinary((folder.path() / "far.bt").string()));
  expect_contains(error_of([&] { (void)load_octomap(folder.path() / "far.bt", 9); }), "beyond [-100000, 100000]");
  const std::filesystem::path file = folder.write("many.bt", good);
  expect_contains(error_of([&] { (void)load_octomap(file, 3); }), "at most 3");
}

TEST(LoadMission, MapAndFence) {
  const std::string valid =
      "format: jink-mission/1\nname: m\nconnection: udpin://:14540\nvehicle: px4\nwaypoints: [[1, 2, 3]]\n"
      "fence: autopilot\n" +
      kZone;
  const Folder folder;
  const Mission mission = load_mission(folder.write("m.yaml", valid));
  EXPECT_TRUE(mission.autopilot_fence);
  EXPECT_EQ(mission.map->tracks().size(), 1U);
  EXPECT_EQ(in_local_frame(mission, 3.0, 0.0).map_up, 3.0) << "as waypoints, above the ground";
  expect_refused(valid, {"fence: autopilot", "fence: qgc", 6, "fence", "qgc", "one of autopilot"},
                 [](const std::filesystem::path& file) { (void)load_mission(file); });
}

}  // namespace
}  // namespace jink::config
