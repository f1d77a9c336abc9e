// SPDX-License-Identifier: BSD-3-Clause
#include "config/scenario.hpp"

#include <algorithm>
#include <array>

#include "config/fault_reader.hpp"
#include "config/map_reader.hpp"
#include "config/obstacle_reader.hpp"
#include "config/solids.hpp"
#include "config/vehicle_reader.hpp"

namespace jink::config {
namespace {

constexpr std::size_t kMostObstacles = 10000;
constexpr std::array<std::string_view, 2> kEstimates = {"px4", "none"};
constexpr std::size_t kMostFurtherVehicles = 9;  // PX4's instances are 0 to 9

Scan read_scan(const Value& value) {
  static constexpr std::array<std::string_view, 2> kScanners = {"camera", "lidar"};
  if (!value.is_map()) return value.choice(kScanners) == 0 ? depth_camera() : lidar();
  const Map map(value,
                {"kind", "horizontal_deg", "vertical_deg", "columns", "rows", "range", "rate", "noise", "unknown"});
  Scan scan = map.at("kind", "camera or lidar").choice(kScanners) == 0 ? depth_camera() : lidar();
  scan.horizontal_deg = map.number_or("horizontal_deg", above(0, 360), scan.horizontal_deg);
  scan.vertical_deg = map.number_or("vertical_deg", above(0, 180), scan.vertical_deg);
  if (const auto count = map.find("columns")) scan.columns = count->integer(closed(1, 2000));
  if (const auto count = map.find("rows")) scan.rows = count->integer(closed(1, 2000));
  scan.range = map.number_or("range", above(0, 25), scan.range);
  scan.rate = map.number_or("rate", above(0, 100), scan.rate);
  scan.noise = map.number_or("noise", closed(0, 10), scan.noise);
  if (const auto unknown = map.find("unknown")) scan.unknown = static_cast<Unknown>(unknown->choice(kUnknown));
  return scan;
}

Sensing read_sensing(const Value& value) {
  const Map map(value,
                {"range", "rate", "delay", "position_noise", "velocity_noise", "dropout", "sensed_from", "scan"});
  Sensing sensing;
  sensing.range = map.number_or("range", above(0, 1e6), sensing.range);
  sensing.rate = map.number_or("rate", above(0, 1000), sensing.rate);
  sensing.delay = map.number_or("delay", closed(0, 10), sensing.delay);
  sensing.position_noise = map.number_or("position_noise", closed(0, 1000), sensing.position_noise);
  sensing.velocity_noise = map.number_or("velocity_noise", closed(0, 1000), sensing.velocity_noise);
  sensing.dropout = map.number_or("dropout", below(0, 1), sensing.dropout);
  if (const auto from = map.find("sensed_from"))
    sensing.sensed_from = static_cast<SensedFrom>(from->choice(kSensedFrom));
  if (const auto scan = map.find("scan")) sensing.scan = read_scan(*scan);
  return sensing;
}

Wind read_wind(const Value& value) {
  const Map map(value, {"mean", "gust", "gust_time"});
  Wind wind;
  wind.mean = map.vec3_or("mean", within(100), wind.mean);
  wind.gust = map.number_or("gust", closed(0, 100), wind.gust);
  wind.gust_time = map.number_or("gust_time", above(0, 1e4), wind.gust_time);
  return wind;
}

EstimateErrors read_estimate(const Value& value) {
  EstimateErrors errors;
  if (!value.is_map()) {
    errors.px4 = value.choice(kEstimates) == 0;
    return errors;
  }
  const Map map(value, {"position_noise", "velocity_noise", "drift", "drift_time"});
  errors.px4 = false;
  errors.position_noise = map.number_or("position_noise", closed(0, 100), errors.position_noise);
  errors.velocity_noise = map.number_or("velocity_noise", closed(0, 100), errors.velocity_noise);
  errors.drift = map.number_or("drift", closed(0, 1000), errors.drift);
  errors.drift_time = map.number_or("drift_time", above(0, 1e6), errors.drift_time);
  return errors;
}

Vec3 read_point_in_world(const Map& map, std::string_view key, const std::optional<planner::base::Box>& world) {
  Vec3 point = map.vec3(key, kCoordinate);
  for (std::size_t i = 0; world && i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Range range = closed(world->min[axis], world->max[axis]);
    if (!range.contains(point[axis]))
      map.at(key, "").list(3, 3)[i].fail("is outside the world; not in " + range.text());
  }
  return point;
}

/// They take off from the ground below their starts, where they must not touch.
void check_clear(const Map& map, const ScenarioVehicle& vehicle, const std::vector<ScenarioVehicle>& others) {
  for (std::size_t k = 0; k < others.size(); ++k) {
    const double apart = (vehicle.start - others[k].start).head<2>().norm();
    const double needed = vehicle.vehicle.radius + others[k].vehicle.radius;
    if (apart > needed) continue;
    map.at("start", "")
        .fail("is " + number_text(apart) + " m from vehicle " + std::to_string(k) +
              " on the ground; expected more than " + number_text(needed) + " m, both radii");
  }
}

std::vector<ScenarioVehicle> read_further(const Value& value, const Scenario& scenario,
                                          const std::filesystem::path& file, const std::filesystem::path& vehicles) {
  std::vector<ScenarioVehicle> all = all_vehicles(scenario);
  for (const Value& item : value.list(0, kMostFurtherVehicles)) {
    const Map map(item, {"start", "target", "vehicle"});
    ScenarioVehicle further = all.front();
    further.start = read_point_in_world(map, "start", scenario.world);
    further.target = read_point_in_world(map, "target", scenario.world);
    if (const auto own = map.find("vehicle")) {
      NamedVehicle named = read_vehicle(*own, file, vehicles);
      further.vehicle_name = std::move(named.name);
      further.vehicle = named.limits;
    }
    check_clear(map, further, all);
    all.push_back(std::move(further));
  }
  all.erase(all.begin());
  return all;
}

// The contract's default: ten times as long as the straight flight, and half a minute to get going.
double default_time_limit(const Scenario& scenario) {
  return 10.0 * (scenario.target - scenario.start).norm() / scenario.vehicle.max_speed + 30.0 + scenario.hold_time;
}

}  // namespace

Scan depth_camera() {
  return {70.0, 50.0, 70, 50, 8.0, 15.0};
}

Scan lidar() {
  return {360.0, 60.0, 360, 40, 12.0, 10.0};
}

std::vector<ScenarioVehicle> all_vehicles(const Scenario& scenario) {
  std::vector<ScenarioVehicle> all{{scenario.start, scenario.target, scenario.vehicle_name, scenario.vehicle}};
  all.insert(all.end(), scenario.vehicles.begin(), scenario.vehicles.end());
  return all;
}

Scenario load_scenario(const std::filesystem::path& file, const std::filesystem::path& vehicles) {
  const Map map(read_document(file),
                {"format", "name", "start", "target", "acceptance_radius", "hold_time", "time_limit", "vehicle",
                 "world", "sensing", "obstacles", "map", "no_fly", "vehicles", "wind", "estimate", "faults"},
                "jink-scenario/1");
  Scenario scenario;
  scenario.name = map.text("name");
  if (const auto world = map.find("world")) scenario.world = read_box(*world, kCoordinate);
  scenario.start = read_point_in_world(map, "start", scenario.world);
  scenario.target = read_point_in_world(map, "target", scenario.world);
  NamedVehicle vehicle = read_vehicle(map.at("vehicle", "the name of a vehicle or a map"), file, vehicles);
  scenario.vehicle_name = std::move(vehicle.name);
  scenario.vehicle = vehicle.limits;
  scenario.acceptance_radius = map.number_or("acceptance_radius", kAcceptance, 0.0);
  scenario.hold_time = map.number_or("hold_time", kHoldTime, 0.0);
  scenario.time_limit = map.number_or("time_limit", above(scenario.hold_time, 1e6), default_time_limit(scenario));
  if (const auto sensing = map.find("sensing")) scenario.sensing = read_sensing(*sensing);
  // Who has a known world may have nothing else in it.
  if (!map.find("map") && !map.find("no_fly")) (void)map.at("obstacles", "a list, [] for none");
  if (const auto obstacles = map.find("obstacles")) {
    for (const Value& item : obstacles->list(0, kMostObstacles)) scenario.obstacles.push_back(read_obstacle(item));
  }
  scenario.map = read_map(map, file);
  double ground = std::min({0.0, scenario.start.z(), scenario.target.z()});
  if (const auto further = map.find("vehicles")) scenario.vehicles = read_further(*further, scenario, file, vehicles);
  for (const ScenarioVehicle& further : scenario.vehicles)
    ground = std::min({ground, further.start.z(), further.target.z()});
  std::erase_if(scenario.map, [&](const Obstacle& solid) {
    return planner::geometry::box_around(track_at_rest(solid)).max.z() <= ground + kRelief;
  });
  if (!scenario.vehicles.empty() && scenario.sensing.scan)
    map.at("sensing", "").fail("has a scan from one vehicle, and here are several; expected none");
  if (!scenario.vehicles.empty() && scenario.sensing.sensed_from == SensedFrom::kVehicle)
    map.at("sensing", "").fail("has tracks sensed from one vehicle, and here are several; expected sensed_from: world");
  if (const auto wind = map.find("wind")) scenario.wind = read_wind(*wind);
  if (const auto estimate = map.find("estimate")) scenario.estimate = read_estimate(*estimate);
  if (const auto faults = map.find("faults"))
    scenario.faults = read_faults(*faults, 1 + static_cast<int>(scenario.vehicles.size()));
  return scenario;
}

}  // namespace jink::config
