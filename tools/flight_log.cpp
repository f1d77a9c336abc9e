// SPDX-License-Identifier: BSD-3-Clause
#include "tools/flight_log.hpp"

#include <stdexcept>

#include "tools/command_line.hpp"

namespace jink::tools {

using Json = nlohmann::ordered_json;

Json vector_json(const planner::Vec3& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

FlightLog::FlightLog(const std::filesystem::path& file, Json header) : file_(file), out_(file) {
  if (!out_) throw UsageError("--log: '" + file.string() + "' cannot be written");
  Json first{{"type", "header"}, {"format", "jink-log/1"}, {"version", JINK_VERSION}};
  first.update(header);
  write(first);
}

void FlightLog::on_state(double t, const bridge::VehicleState& state) {
  write({{"type", "state"},
         {"t", t},
         {"p", vector_json(state.position)},
         {"v", vector_json(state.velocity)},
         {"armed", state.armed},
         {"mode", bridge::to_string(state.mode)}});
}

void FlightLog::on_tracks(double t, const std::vector<planner::Track>& tracks) {
  Json list = Json::array();
  for (const planner::Track& track : tracks) {
    list.push_back({{"id", track.id},
                    {"p", vector_json(track.position)},
                    {"v", vector_json(track.velocity)},
                    {"a", vector_json(track.acceleration)},
                    {"radius", track.radius},
                    {"position_sigma", track.position_sigma},
                    {"velocity_sigma", track.velocity_sigma},
                    {"age", track.age}});
  }
  write({{"type", "tracks"}, {"t", t}, {"tracks", std::move(list)}});
}

void FlightLog::on_plan(double t, const bridge::PlanResult& result) {
  Json path = Json::array();
  for (const planner::TimedPoint& point : result.plan.path) {
    path.push_back({result.job.start + point.t, point.position.x(), point.position.y(), point.position.z()});
  }
  write({{"type", "plan"},
         {"t", t},
         {"path", std::move(path)},
         {"ms", result.ms},
         {"status", planner::to_string(result.plan.status)},
         {"kept", result.plan.kept_previous},
         {"number", result.job.number},
         {"generations", result.plan.generations},
         {"missed", result.missed}});
}

void FlightLog::on_setpoint(double t, const bridge::Setpoint& setpoint) {
  write({{"type", "setpoint"},
         {"t", t},
         {"p", vector_json(setpoint.position)},
         {"v", vector_json(setpoint.velocity)},
         {"a", vector_json(setpoint.acceleration)},
         {"yaw", setpoint.yaw}});
}

void FlightLog::on_event(double t, std::string_view name, const std::string& detail) {
  write({{"type", "event"}, {"t", t}, {"name", name}, {"detail", detail}});
}

void FlightLog::on_truth(double t, std::span<const sim::VehicleTruth> vehicles, const sim::World& world) {
  for (std::size_t k = 0; k < vehicles.size(); ++k) {
    Json record{{"type", "truth"}, {"t", t}};
    if (vehicles.size() > 1) record["vehicle"] = k;
    record["p"] = vector_json(vehicles[k].position);
    record["v"] = vector_json(vehicles[k].velocity);
    write(record);
  }
  for (int i = 0; i < world.obstacle_count(); ++i) {
    const planner::Sphere sphere = world.sphere(i, t);
    write({{"type", "obstacles"},
           {"t", t},
           {"id", sim::World::id(i)},
           {"p", vector_json(sphere.center)},
           {"radius", sphere.radius}});
  }
}

void FlightLog::close() {
  out_.flush();
  if (!out_) throw std::runtime_error(file_.string() + ": the flight log could not be written to its end");
}

Json parameters_of(const config::Settings& settings) {
  Json parameters = Json::object();
  for (const config::SettingText& setting : config::list_settings(settings)) parameters[setting.key] = setting.value;
  return parameters;
}

}  // namespace jink::tools
