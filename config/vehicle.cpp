// SPDX-License-Identifier: BSD-3-Clause
#include "config/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "config/settings.hpp"
#include "config/vehicle_reader.hpp"

namespace jink::config {
namespace {

struct Limit {
  std::string_view name;
  double planner::base::VehicleLimits::*member;
  Range range;
  bool required = true;
};

// No aircraft of this kind comes near the upper bounds; a value beyond them is in the wrong unit.
constexpr std::array<Limit, 10> kLimits = {{
    {"radius", &planner::base::VehicleLimits::radius, above(0, 100)},
    {"length", &planner::base::VehicleLimits::length, above(0, 100)},
    {"mass", &planner::base::VehicleLimits::mass, above(0, 10000)},
    {"max_speed", &planner::base::VehicleLimits::max_speed, above(0, 1000)},
    {"cruise_speed", &planner::base::VehicleLimits::cruise_speed, above(0, 1000)},
    {"max_acceleration", &planner::base::VehicleLimits::max_acceleration, above(0, 1000)},
    {"max_jerk", &planner::base::VehicleLimits::max_jerk, above(0, 100000)},
    {"max_climb", &planner::base::VehicleLimits::max_climb, above(0, 1000)},
    {"drag", &planner::base::VehicleLimits::drag, closed(0, 2), false},
    {"damping", &planner::base::VehicleLimits::damping, closed(0, 0.5), false},
}};

planner::base::VehicleLimits read_limits(const Value& value) {
  std::vector<std::string_view> keys;
  keys.reserve(kLimits.size());
  for (const Limit& limit : kLimits) keys.push_back(limit.name);
  const Map map(value, std::move(keys));
  planner::base::VehicleLimits limits;
  for (const Limit& limit : kLimits) {
    double& member = limits.*limit.member;
    member = limit.required ? map.number(limit.name, limit.range) : map.number_or(limit.name, limit.range, member);
  }
  if (limits.cruise_speed > limits.max_speed) {
    map.at("cruise_speed", "").fail("is above max_speed; expected a number in " + above(0, limits.max_speed).text());
  }
  return limits;
}

// A name becomes a part of a path: letters, digits, "_", "-" and single dots inside, so that it stays in its folder.
bool is_file_name(const std::string& name) {
  const auto allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
  };
  return std::all_of(name.begin(), name.end(), allowed) && name.front() != '.' && name.find("..") == std::string::npos;
}

std::set<std::string> names_in(const std::vector<std::filesystem::path>& folders) {
  std::set<std::string> names;
  for (const std::filesystem::path& folder : folders) {
    // A folder that is missing or unreadable holds no vehicles; the caller reports what it found in all of them.
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
      if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
    }
  }
  return names;
}

}  // namespace

planner::base::VehicleLimits load_vehicle(const std::filesystem::path& file) {
  return read_limits(read_document(file));
}

bool is_project_vehicle(const std::string& name, const planner::base::VehicleLimits& limits) {
  if (name.empty() || !is_file_name(name)) return false;
  const std::filesystem::path file = config_folder() / "vehicles" / (name + ".yaml");
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return false;
  const planner::base::VehicleLimits known = load_vehicle(file);
  return std::all_of(kLimits.begin(), kLimits.end(),
                     [&](const Limit& limit) { return known.*limit.member == limits.*limit.member; });
}

NamedVehicle read_vehicle(const Value& value, const std::filesystem::path& file,
                          const std::filesystem::path& vehicles) {
  if (value.is_map()) return {"inline", read_limits(value)};
  const std::string name = value.text();
  if (!is_file_name(name)) value.fail("is not the name of a vehicle: letters, digits, '_', '-' and '.' only");

  std::vector<std::filesystem::path> folders;
  if (vehicles.empty()) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    folders = {folder / ".." / "vehicles", config_folder() / "vehicles"};
  } else {
    folders = {vehicles};
  }
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path candidate = folder / (name + ".yaml");
    std::error_code ignored;
    if (std::filesystem::exists(candidate, ignored)) return {name, load_vehicle(candidate)};
  }

  const std::set<std::string> found = names_in(folders);
  const std::vector<std::string_view> names(found.begin(), found.end());
  if (!names.empty()) {
    const std::string_view near = nearest(name, names);
    value.fail("is not a vehicle; " + (near.empty() ? "" : "did you mean '" + std::string(near) + "'? ") +
               "expected a map or one of " + join(names));
  }
  std::string searched;
  for (const std::filesystem::path& folder : folders) searched += (searched.empty() ? "" : ", ") + folder.string();
  value.fail("is not a vehicle; there are none in " + searched);
}

}  // namespace jink::config
