// SPDX-License-Identifier: BSD-3-Clause
// The vehicle loader; and, as it is the smallest, what all loaders share: files, syntax, numbers, keys.
#include "config/vehicle.hpp"

#include <gtest/gtest.h>

#include "tests/config/yaml_case.hpp"

namespace jink::config {
namespace {

const std::string kValidVehicle =
    "radius: 0.25\n"           // line 1
    "length: 0.5\n"            // 2
    "mass: 1.5\n"              // 3
    "max_speed: 12\n"          // 4
    "cruise_speed: 5\n"        // 5
    "max_acceleration: 4e0\n"  // 6
    "max_jerk: +30.\n"         // 7
    "max_climb: .75\n";        // 8

void try_vehicle(const std::filesystem::path& file) {
  static_cast<void>(load_vehicle(file));
}

std::string error_for(const std::string& text) {
  const Folder folder;
  const auto file = folder.write("v.yaml", text);
  std::string error = error_of([&] { try_vehicle(file); });
  EXPECT_TRUE(error.starts_with(file.string() + ":")) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error.substr(std::min(error.size(), file.string().size()));
}

TEST(LoadVehicle, ReadsEveryKey) {
  const Folder folder;
  const planner::base::VehicleLimits v = load_vehicle(folder.write("v.yaml", kValidVehicle));
  EXPECT_EQ(v.radius, 0.25);
  EXPECT_EQ(v.length, 0.5);
  EXPECT_EQ(v.mass, 1.5);
  EXPECT_EQ(v.max_speed, 12.0);
  EXPECT_EQ(v.cruise_speed, 5.0);
  EXPECT_EQ(v.max_acceleration, 4.0);
  EXPECT_EQ(v.max_jerk, 30.0);
  EXPECT_EQ(v.max_climb, 0.75);
}

TEST(LoadVehicle, RefusesBadValuesWithPlaceAndRange) {
  const std::vector<BadCase> cases = {
      {"0.25", "0", 1, "radius", "0", "is not in (0, 100]"},
      {"0.25", "-0.25", 1, "radius", "-0.25", "is not in (0, 100]"},
      {"0.25", "100.5", 1, "radius", "100.5", "is not in (0, 100]"},
      {"0.25", ".nan", 1, "radius", ".nan", "not a finite number; expected a number in (0, 100]"},
      {"0.25", ".inf", 1, "radius", ".inf", "not a finite number"},
      {"0.25", "-.INF", 1, "radius", "-.INF", "not a finite number"},
      {"0.25", "nan", 1, "radius", "nan", "not a finite number"},
      {"0.25", "1e999", 1, "radius", "1e999", "not a finite number"},
      {"0.25", "true", 1, "radius", "true", "is a boolean; expected a number in (0, 100]"},
      {"0.25", "wide", 1, "radius", "wide", "is a string; expected a number"},
      {"0.25", "'0.25'", 1, "radius", "0.25", "is a string; expected a number"},
      {"0.25", "\"0.25\"", 1, "radius", "0.25", "is a string; expected a number"},
      {"0.25", "0.25 m", 1, "radius", "0.25 m", "is a string"},
      {"0.25", "0,25", 1, "radius", "0,25", "is a string"},
      {"0.25", "0x10", 1, "radius", "0x10", "is a string"},
      {"0.25", "[0.25]", 1, "radius", "[0.25]", "is a list of 1"},
      {"0.25", "{m: 0.25}", 1, "radius", "{m: 0.25}", "is a map"},
      {"0.25", "", 1, "radius", "null", "is empty"},
      {"0.25", "~", 1, "radius", "null", "is empty"},
      {"mass: 1.5", "mass: 0", 3, "mass", "0", "(0, 10000]"},
      {"max_speed: 12", "max_speed: 4", 5, "cruise_speed", "5", "above max_speed; expected a number in (0, 4]"},
      {"max_climb: .75", "max_climb: -1", 8, "max_climb", "-1", "(0, 1000]"},
      {"max_climb: .75", "max_climb: .75\ndrag: 3", 9, "drag", "3", "[0, 2]"},
      {"max_climb: .75", "max_climb: .75\ndamping: -0.1", 9, "damping", "-0.1", "[0, 0.5]"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidVehicle, bad, try_vehicle);
}

TEST(LoadVehicle, TakesWhatTheFeedForwardBeginsWith) {
  const Folder folder;
  const planner::base::VehicleLimits none = load_vehicle(folder.write("none.yaml", kValidVehicle));
  EXPECT_EQ(none.drag, 0.0);
  EXPECT_EQ(none.damping, 0.0);
  const planner::base::VehicleLimits known =
      load_vehicle(folder.write("known.yaml", std::string(kValidVehicle) + "drag: 0.7\ndamping: 0.15\n"));
  EXPECT_EQ(known.drag, 0.7);
  EXPECT_EQ(known.damping, 0.15);
}

TEST(LoadVehicle, RefusesKeysThatAreUnknownMissingOrRepeated) {
  const std::vector<BadCase> cases = {
      {"mass: 1.5\n", "", 1, "mass", "", "missing; expected a number in (0, 10000]"},
      {"radius:", "raduis:", 1, "raduis", "0.25", "unknown key with value '0.25'; did you mean 'radius'?"},
      {"max_jerk:", "max_jrk:", 7, "max_jrk", "+30.", "did you mean 'max_jerk'?"},
      {"max_jerk:", "Max_Jerk:", 7, "Max_Jerk", "+30.", "did you mean 'max_jerk'?"},
      {"mass: 1.5\n", "mass: 1.5\ncolour: blue\n", 4, "colour", "blue", "allowed: radius, length, mass"},
      {"mass: 1.5\n", "mass: 1.5\nradius: 0.3\n", 4, "radius", "0.3", "given again with value '0.3', first in line 1"},
      {"mass: 1.5\n", "mass: 1.5\n[a]: 2\n", 4, "[a]", "", "the key is a list of 1; expected a name"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidVehicle, bad, try_vehicle);
}

TEST(LoadVehicle, SuggestsNothingForAKeyThatResemblesNone) {
  EXPECT_EQ(error_for("colour: blue\n").find("did you mean"), std::string::npos);
}

TEST(LoadVehicle, RefusesWhatIsNotOneMap) {
  expect_contains(error_for(""), ":1: is empty");
  expect_contains(error_for("# a comment alone\n"), ":1: is empty");
  expect_contains(error_for("---\n...\n"), ":1: is empty");
  expect_contains(error_for("- 1\n- 2\n"), ":1: the file holds a list of 2; expected a map with the keys radius");
  expect_contains(error_for("hello\n"), ":1: the file holds a string");
  expect_contains(error_for(kValidVehicle + "---\n" + kValidVehicle), ":9: holds a second document");
}

TEST(LoadVehicle, ReportsSyntaxErrorsWithTheirLine) {
  expect_contains(error_for("radius: 0.3\nlength: [1, 2\nmass: 1\n"), ": not valid YAML: ");
  expect_contains(error_for("radius: 0.3\n\tlength: 1\n"), ":2: not valid YAML: ");
  expect_contains(error_for("radius: *nothing\n"), ":1: not valid YAML: ");
  expect_contains(error_for("radius: 0.3\nlength: 1: 2\n"), ":2: not valid YAML: ");
}

TEST(LoadVehicle, SurvivesDeepNestingAndAliasBombs) {
  expect_contains(error_for("radius: " + std::string(100000, '[') + "\n"), ":1: is nested deeper than 32");
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    const std::string name = "a" + std::to_string(i);
    bomb += name;
    bomb += ": &" + name;
    bomb += " [" + before;
    for (int j = 0; j < 9; ++j) bomb += ", " + before;
    bomb += "]\n";
  }
  expect_contains(error_for(bomb), ":6: holds more than a million values");
  expect_contains(error_for("radius: &r [*r]\n"), ":1: an alias contains itself");
}

TEST(LoadVehicle, AcceptsAnAliasInItsPlace) {
  const Folder folder;
  std::string text = kValidVehicle;
  text.replace(text.find("0.25"), 4, "&half 0.5");
  text.replace(text.find("length: 0.5"), 11, "length: *half");
  const planner::base::VehicleLimits v = load_vehicle(folder.write("v.yaml", text));
  EXPECT_EQ(v.radius, 0.5);
  EXPECT_EQ(v.length, 0.5);
}

TEST(LoadVehicle, CutsLongValuesAndKeepsToOneLine) {
  EXPECT_LT(error_for("radius: \"" + std::string(5000, 'x') + "\"\n").size(), 200U);
  EXPECT_LT(error_for(std::string(500, 'x') + ": 1\n").size(), 300U);
  expect_contains(error_for("radius: \"a\\nb\\tc\"\n"), "value 'a?b?c' is a string");
}

TEST(LoadVehicle, RefusesFilesThatCannotBeRead) {
  const Folder folder;
  const auto missing = folder.path() / "none.yaml";
  EXPECT_EQ(error_of([&] { try_vehicle(missing); }), missing.string() + ": cannot read: No such file or directory");
  expect_contains(error_of([&] { try_vehicle(folder.path()); }), folder.path().string() + ": is a directory");
  const auto large = folder.write("large.yaml", std::string((std::size_t{16} << 20) + 1, '#'));
  EXPECT_EQ(error_of([&] { try_vehicle(large); }), large.string() + ": is larger than 16 MiB");
}

TEST(LoadVehicle, AcceptsBothEndsOfLines) {
  std::string text;
  for (const char c : kValidVehicle) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const Folder folder;
  EXPECT_EQ(load_vehicle(folder.write("v.yaml", text)).max_climb, 0.75);
}

}  // namespace
}  // namespace jink::config
