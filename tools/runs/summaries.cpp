// SPDX-License-Identifier: BSD-3-Clause
#include "tools/runs/summaries.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "config/solids.hpp"
#include "planner/optimizer/indicators.hpp"
#include "sim/world/shapes.hpp"
#include "sim/world/world.hpp"
#include "tools/log/flight_log.hpp"

namespace jink::tools::runs {
namespace {

using Json = nlohmann::ordered_json;

Json percentiles_json(const std::vector<double>& values) {
  const auto p = bridge::companion::percentiles(values);
  if (!p) return {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}};
  return {{"p50", p->p50}, {"p99", p->p99}, {"max", p->max}};
}

std::string number(const Json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.2f} {}", value.get<double>(), unit) : std::string("unknown");
}

/// The true shapes that are no spheres, about the centre that the log's `obstacles` records give.
Json shapes_json(const config::Scenario& scenario) {
  Json shapes = Json::array();
  for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {
    const config::Obstacle& obstacle = scenario.obstacles[i];
    const config::Shape& shape = obstacle.shape;
    // What turns does so about its reference point.
    const Vec3 center = obstacle.yaw_rate == 0.0 ? sim::world::bounding_sphere(shape).center : Vec3(Vec3::Zero());
    Json entry{{"id", sim::world::World::id(static_cast<int>(i))}};
    if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
      entry["box"] = log::vector_json(box->edges);
    } else if (const auto* cylinder = std::get_if<config::CylinderShape>(&shape)) {
      entry["cylinder"] = {{"radius", cylinder->radius}, {"height", cylinder->height}};
    } else if (const auto* capsule = std::get_if<config::CapsuleShape>(&shape)) {
      entry["capsule"] = {{"radius", capsule->radius},
                          {"a", log::vector_json(capsule->a - center)},
                          {"b", log::vector_json(capsule->b - center)}};
    } else if (const auto* hull = std::get_if<config::VertexShape>(&shape)) {
      entry["vertices"] = Json::array();
      for (const Vec3& vertex : hull->vertices) entry["vertices"].push_back(log::vector_json(vertex - center));
    } else {
      continue;
    }
    if (!obstacle.orientation.isZero(0.0)) entry["orientation"] = log::vector_json(obstacle.orientation);
    if (obstacle.yaw_rate != 0.0) entry["yaw_rate"] = obstacle.yaw_rate;
    shapes.push_back(std::move(entry));
  }
  return shapes;
}

}  // namespace

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json flight_summary(const std::string& kind, const std::string& name, std::uint64_t seed,
                    const bridge::companion::FlightSummary& flight, std::optional<double> min_clearance) {
  Json summary{{"format", "jink-flight/1"}};
  summary[kind] = name;
  summary["seed"] = seed;
  summary["outcome"] = bridge::supervisor::to_string(flight.outcome);
  summary["reason"] = flight.reason;
  summary["flight_time_s"] = flight.flight_time;
  summary["path_length"] = flight.path_length;
  summary["straight_length"] = flight.straight_length;
  summary["slr"] = finite_or_null(planner::optimizer::straight_line_rate(flight.path_length, flight.straight_length));
  summary["min_clearance"] = min_clearance ? finite_or_null(*min_clearance) : Json(nullptr);
  summary["max_speed"] = flight.max_speed;
  summary["plans"] = flight.plans;
  summary["deadline_misses"] = flight.deadline_misses;
  summary["plan_ms"] = percentiles_json(flight.plan_ms);
  summary["track_to_setpoint_ms"] = percentiles_json(flight.track_to_setpoint_ms);
  summary["blocked_plans"] = flight.blocked_plans;
  summary["dropped_tracks"] = flight.dropped_tracks;
  summary["max_tracking_error"] = flight.largest_tracking_error;
  summary["max_margin"] = flight.largest_margin;
  summary["estimate_resets"] = flight.estimate_resets;
  summary["end_estimate"] = flight.end_estimate ? log::vector_json(*flight.end_estimate) : Json(nullptr);
  summary["hazards"] = Json::array();
  for (const bridge::companion::HazardRecord& hazard : flight.hazards)
    summary["hazards"].push_back({{"what", hazard.what}, {"t", hazard.t}, {"duration_s", hazard.duration}});
  return summary;
}

Json vehicles_json(std::span<const sim::flight::VehicleReport> reports, int first_system) {
  Json vehicles = Json::array();
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const sim::flight::VehicleReport& report = reports[k];
    vehicles.push_back({{"vehicle", k},
                        {"system", first_system + static_cast<int>(k)},
                        {"outcome", bridge::supervisor::to_string(report.flight.outcome)},
                        {"reason", report.flight.reason},
                        {"flight_time_s", report.flight.flight_time},
                        {"path_length", report.flight.path_length},
                        {"min_clearance", finite_or_null(report.min_clearance)}});
  }
  return vehicles;
}

std::string describe_flight(const Json& s) {
  const std::string name = s.contains("scenario") ? "scenario " + s["scenario"].get<std::string>()
                                                  : "mission " + s["mission"].get<std::string>();
  std::string text =
      fmt::format("{}: {} ({})\n", name, s["outcome"].get<std::string>(), s["reason"].get<std::string>());
  text +=
      fmt::format("  flown {} in {}, straight {}; fastest {}\n", number(s["path_length"], "m"),
                  number(s["flight_time_s"], "s"), number(s["straight_length"], "m"), number(s["max_speed"], "m/s"));
  if (!s["min_clearance"].is_null()) text += fmt::format("  smallest clearance {}\n", number(s["min_clearance"], "m"));
  text += fmt::format("  {} plans, {} blocked, {} late; plan time p50 {}, p99 {}; track to setpoint p50 {}, p99 {}",
                      s["plans"].get<std::uint64_t>(), s["blocked_plans"].get<std::uint64_t>(),
                      s["deadline_misses"].get<std::uint64_t>(), number(s["plan_ms"]["p50"], "ms"),
                      number(s["plan_ms"]["p99"], "ms"), number(s["track_to_setpoint_ms"]["p50"], "ms"),
                      number(s["track_to_setpoint_ms"]["p99"], "ms"));
  if (s["end_estimate"].is_array())
    text += fmt::format(
        "\n  in the end at ({:.1f}, {:.1f}, {:.1f}) m by the autopilot's estimate; z is no height above ground",
        s["end_estimate"][0].get<double>(), s["end_estimate"][1].get<double>(), s["end_estimate"][2].get<double>());
  if (s.contains("vehicles")) {
    for (const Json& vehicle : s["vehicles"])
      text += fmt::format("\n  vehicle {}: {} after {}, smallest clearance {}", vehicle["vehicle"].get<int>(),
                          vehicle["outcome"].get<std::string>(), number(vehicle["flight_time_s"], "s"),
                          number(vehicle["min_clearance"], "m"));
  }
  for (const Json& hazard : s["hazards"])
    text += fmt::format("\n  braked for {} at {}: {}", number(hazard["duration_s"], "s"), number(hazard["t"], "s"),
                        hazard["what"].get<std::string>());
  return text;
}

Json scenario_header(const config::Scenario& scenario, std::uint64_t seed, const config::Settings& settings) {
  Json header{{"scenario", scenario.name},
              {"seed", seed},
              {"start", log::vector_json(scenario.start)},
              {"target", log::vector_json(scenario.target)},
              {"time_limit", scenario.time_limit},
              {"vehicle",
               {{"name", scenario.vehicle_name},
                {"radius", scenario.vehicle.radius},
                {"max_speed", scenario.vehicle.max_speed}}},
              {"world", nullptr}};
  if (scenario.world)
    header["world"] = {{"min", log::vector_json(scenario.world->min)}, {"max", log::vector_json(scenario.world->max)}};
  if (Json shapes = shapes_json(scenario); !shapes.empty()) header["shapes"] = std::move(shapes);
  // What is scanned is not known: plans see of it what the log's `seen` records say.
  if (!scenario.map.empty())
    header[scenario.sensing.scan ? "stands" : "map"] = log::map_json(*config::make_map(scenario.map));
  if (!scenario.vehicles.empty()) {
    header["vehicles"] = Json::array();
    for (const config::ScenarioVehicle& vehicle : config::all_vehicles(scenario)) {
      header["vehicles"].push_back({{"name", vehicle.vehicle_name},
                                    {"radius", vehicle.vehicle.radius},
                                    {"start", log::vector_json(vehicle.start)},
                                    {"target", log::vector_json(vehicle.target)}});
    }
  }
  header["parameters"] = log::parameters_of(settings);
  return header;
}

}  // namespace jink::tools::runs
