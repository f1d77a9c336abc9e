// SPDX-License-Identifier: BSD-3-Clause
// What plans are made from and of: vehicle, path, tracks, solids, parameters.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "planner/base/solid.hpp"
#include "python/module/types.hpp"
#include "tools/base/exit_code.hpp"

namespace jink::python {
namespace {

namespace base = planner::base;
using namespace planner::base;

void add_vehicle(nb::module_& module) {
  nb::class_<VehicleLimits>(module, "Vehicle",
                            "What a vehicle is and can do: m, s, kg. Unless told a Parrot AR.Drone 2.0.")
      .def(nb::init<>())
      .def_rw("radius", &VehicleLimits::radius, "of the sphere that encloses it, m")
      .def_rw("length", &VehicleLimits::length, "m")
      .def_rw("mass", &VehicleLimits::mass, "kg")
      .def_rw("max_speed", &VehicleLimits::max_speed, "m/s")
      .def_rw("cruise_speed", &VehicleLimits::cruise_speed, "m/s")
      .def_rw("max_acceleration", &VehicleLimits::max_acceleration, "m/s²")
      .def_rw("max_jerk", &VehicleLimits::max_jerk, "m/s³")
      .def_rw("max_climb", &VehicleLimits::max_climb, "m/s, up and down")
      .def_rw("drag", &VehicleLimits::drag, "1/s, deceleration per speed")
      .def_rw("damping", &VehicleLimits::damping, "of a commanded acceleration, that the autopilot takes off again");
}

/// The path from time t on, whose times count from there.
TimedPath after(const TimedPath& path, double t) {
  if (path.empty()) throw std::invalid_argument("the path has no points");
  return later(path, t);
}

void add_path(nb::module_& module) {
  nb::class_<TimedPath>(module, "Path", "n points in time order, ENU, m, s. The arrays are views of its memory.")
      .def(nb::init<std::size_t>(), nb::arg("count"))
      .def("__len__", [](const TimedPath& path) { return path.size(); })
      .def_prop_ro(
          "t", [](TimedPath& path) { return column(path, &TimedPoint::t); }, "n, s")
      .def_prop_ro(
          "position", [](TimedPath& path) { return table(path, &TimedPoint::position); }, "n x 3, m")
      .def_prop_ro(
          "velocity", [](TimedPath& path) { return table(path, &TimedPoint::velocity); }, "n x 3, m/s")
      .def_prop_ro(
          "acceleration", [](TimedPath& path) { return table(path, &TimedPoint::acceleration); }, "n x 3, m/s²")
      .def_prop_ro("length", &path_length, "of its segments together, m")
      .def("after", &after, nb::arg("t"),
           "The path from time t on, whose times count from there. Raises Error where it is empty.");
}

std::vector<Vec3> vertices(const std::vector<Vector>& points) {
  std::vector<Vec3> result;
  for (const Vector& point : points) result.push_back(vec3(point));
  return result;
}

Solid::Pose pose(const Vector& center) {
  return {vec3(center), Eigen::Matrix3d::Identity()};
}

void add_solid(nb::module_& module) {
  const Vector origin{};
  nb::class_<Solid>(module, "Solid",
                    "What a track is where it is no ball: a convex solid about the track's position, m.")
      .def_static(
          "box", [](const Vector& edges, const Vector& center) { return Solid::box(vec3(edges), pose(center)); },
          nb::arg("edges"), nb::arg("center") = origin)
      .def_static(
          "cylinder",
          [](double radius, double height, const Vector& center) {
            return Solid::cylinder(radius, height, pose(center));
          },
          nb::arg("radius"), nb::arg("height"), nb::arg("center") = origin)
      .def_static(
          "capsule",
          [](double radius, const Vector& a, const Vector& b) { return Solid::capsule(radius, vec3(a), vec3(b)); },
          nb::arg("radius"), nb::arg("a"), nb::arg("b"))
      .def_static(
          "hull", [](const std::vector<Vector>& points) { return Solid::hull(vertices(points)); }, nb::arg("points"))
      .def_prop_ro("reach", &Solid::reach, "how far its farthest point is from the track's position, m");
}

void set_solid(Tracks& tracks, std::size_t i, const std::shared_ptr<const Solid>& solid, double yaw, double yaw_rate) {
  if (i >= tracks.size()) throw nb::index_error("there is no such track");
  tracks[i].body = {solid, yaw, yaw_rate};
  if (solid) tracks[i].radius = solid->reach();
}

void add_tracks(nb::module_& module) {
  nb::class_<Tracks>(module, "Tracks",
                     "n obstacles in motion at one instant, ENU, m, s. The arrays are views of its memory.")
      .def(nb::init<std::size_t>(), nb::arg("count"))
      .def("__len__", [](const Tracks& tracks) { return tracks.size(); })
      .def_prop_ro(
          "id", [](Tracks& tracks) { return column(tracks, &Track::id); }, "n")
      .def_prop_ro(
          "position", [](Tracks& tracks) { return table(tracks, &Track::position); }, "n x 3, m")
      .def_prop_ro(
          "velocity", [](Tracks& tracks) { return table(tracks, &Track::velocity); }, "n x 3, m/s")
      .def_prop_ro(
          "acceleration", [](Tracks& tracks) { return table(tracks, &Track::acceleration); }, "n x 3, m/s²")
      .def_prop_ro(
          "radius", [](Tracks& tracks) { return column(tracks, &Track::radius); }, "n, m")
      .def_prop_ro(
          "position_sigma", [](Tracks& tracks) { return column(tracks, &Track::position_sigma); }, "n, m")
      .def_prop_ro(
          "velocity_sigma", [](Tracks& tracks) { return column(tracks, &Track::velocity_sigma); }, "n, m/s")
      .def_prop_ro(
          "age", [](Tracks& tracks) { return column(tracks, &Track::age); }, "n, s since it was measured")
      .def_prop_ro(
          "sudden_change", [](Tracks& tracks) { return column(tracks, &Track::sudden_change); },
          "n, m/s, by which the velocity has been seen to be another at once")
      .def("set_solid", &set_solid, nb::arg("i"), nb::arg("solid").none(), nb::arg("yaw") = 0.0,
           nb::arg("yaw_rate") = 0.0,
           "Makes track i this solid, turned by yaw (rad); its radius becomes the solid's reach.");
}

config::Settings settings_of(const std::optional<std::string>& file, const std::vector<std::string>& overrides) {
  if (file && file->empty()) throw tools::base::UsageError("--config: is empty; expected a name");
  return config::load_settings(file.value_or(""), overrides);
}

nb::dict items(const config::Settings& settings) {
  nb::dict result;
  for (const config::SettingText& setting : config::list_settings(settings))
    result[setting.key.c_str()] = setting.value;
  return result;
}

}  // namespace

base::Budget budget_of(int generations, std::optional<double> deadline_ms) {
  constexpr double kMost_ms = 1e9;
  base::Budget budget;
  budget.generations = generations;
  if (generations < 1)
    throw std::invalid_argument("generations: " + std::to_string(generations) + " is not at least 1");
  if (!deadline_ms) return budget;
  if (!(*deadline_ms > 0.0 && *deadline_ms <= kMost_ms))
    throw std::invalid_argument("deadline_ms: " + std::to_string(*deadline_ms) + " is not above 0 and at most 1e9");
  budget.deadline = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                           std::chrono::duration<double, std::milli>(*deadline_ms));
  return budget;
}

void add_values(nb::module_& module) {
  add_vehicle(module);
  add_path(module);
  add_solid(module);
  add_tracks(module);
  nb::class_<config::Settings>(module, "Settings", "The planner's parameters: a file as planner.yaml, then changes.")
      .def(
          "__init__",
          [](config::Settings* self, const std::optional<std::string>& file,
             const std::vector<std::string>& overrides) { new (self) config::Settings(settings_of(file, overrides)); },
          nb::arg("config").none() = nb::none(), nb::arg("overrides") = std::vector<std::string>())
      .def("items", &items, nb::sig("def items(self) -> dict[str, str]"), "Every parameter by its key, as text.");
}

}  // namespace jink::python
