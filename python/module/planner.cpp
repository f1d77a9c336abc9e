// SPDX-License-Identifier: BSD-3-Clause
// Horizon mode and the verifier.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <string>
#include <utility>

#include "config/settings.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/verify/plan.hpp"
#include "planner/verify/verifier.hpp"
#include "python/module/types.hpp"

namespace jink::python {
namespace {

using namespace planner;

/// A planner of the library with threads of its own.
class Planner {
 public:
  Planner(const config::Settings& settings, int threads)
      : planner_(settings.horizon, settings.optimizer), pool_(threads) {}

  struct Work {
    std::uint64_t seed = 1, number = 0;
    base::Budget budget;
  };
  verify::Plan plan(const horizon::PathRequest& request, const base::TimedPath& previous, const Work& work) {
    const AtWork at_work(working_);
    return planner_.plan(request, previous, work.seed, work.number, work.budget, pool_);
  }
  [[nodiscard]] const base::HorizonSettings& settings() const { return planner_.settings(); }

 private:
  horizon::HorizonPlanner planner_;
  base::WorkerPool pool_;
  std::atomic<bool> working_{false};
};

verify::Plan plan(Planner& planner, const Vector& position, const Vector& velocity, const Vector& target,
                  const Tracks* tracks, const base::TimedPath* previous, const base::VehicleLimits& vehicle,
                  const std::optional<Corners>& volume, const Tracks* standing, std::optional<double> margin,
                  std::uint64_t seed, std::uint64_t number, std::optional<int> generations,
                  std::optional<double> deadline_ms) {
  const base::HorizonSettings& settings = planner.settings();
  auto request = horizon::PathRequest::with(settings);
  request.position = vec3(position);
  request.velocity = vec3(velocity);
  request.target = vec3(target);
  request.volume = box(volume);
  request.vehicle = vehicle;
  if (tracks != nullptr) request.tracks = *tracks;
  if (standing != nullptr) request.standing = *standing;
  if (margin) request.margin = *margin;
  const base::TimedPath none;
  return planner.plan(request, previous != nullptr ? *previous : none,
                      {seed, number, budget_of(generations.value_or(settings.generations), deadline_ms)});
}

verify::Verification verify_path(const base::TimedPath& path, const Tracks* tracks, const base::VehicleLimits& vehicle,
                                 const std::optional<Corners>& volume, const std::optional<Vector>& velocity,
                                 const Tracks* standing, double tracks_time, double until, double acceleration_trust,
                                 bool rests) {
  verify::VerifierInput input;
  input.path = path;
  if (tracks != nullptr) input.tracks = *tracks;
  if (standing != nullptr) input.standing = *standing;
  input.tracks_time = tracks_time;
  input.vehicle_radius = vehicle.radius;
  input.volume = box(volume);
  input.acceleration_trust = acceleration_trust;
  input.until = until;
  if (velocity)
    input.limits = {vec3(*velocity), vehicle.max_speed, vehicle.max_climb, vehicle.max_acceleration, 0.0, rests};
  return verify::verify(input);
}

void add_verification(nb::module_& module) {
  using verify::Verification;
  nb::class_<Verification>(module, "Verification", "What a path does among predicted obstacles, in continuous time.")
      .def_ro("min_clearance", &Verification::min_clearance,
              "from the vehicle's sphere to the nearest surface, m; inf: nothing there")
      .def_ro("t_min_clearance", &Verification::t_min_clearance, "when, s of the path")
      .def_ro("nearest_id", &Verification::nearest_id, "to which track")
      .def_ro("first_contact", &Verification::first_contact, "when a clearance first falls below 0, s; None: never")
      .def_ro("contact_speed", &Verification::contact_speed, "relative speed then, m/s")
      .def_ro("inside_volume", &Verification::inside_volume)
      .def_ro("valid", &Verification::valid, "the input could be judged")
      .def_prop_ro(
          "speed", [](const Verification& v) { return v.limits.speed; },
          "largest, relative to the limit; 0: not judged")
      .def_prop_ro(
          "climb", [](const Verification& v) { return v.limits.climb; }, "likewise")
      .def_prop_ro(
          "acceleration", [](const Verification& v) { return v.limits.acceleration; }, "likewise")
      .def_prop_ro("free", &Verification::free, "valid, without contact, inside the volume")
      .def_prop_ro("flyable", &Verification::flyable, "free, and nowhere beyond the limits, where they were looked at");
}

void add_plan(nb::module_& module) {
  using verify::Plan;
  nb::class_<Plan>(module, "Plan", "A path, what the verifier says of it, and how it was found.")
      .def_prop_ro(
          "status", [](const Plan& p) { return std::string(verify::to_string(p.status)); },
          "reaches, progresses, blocked, start_blocked or invalid")
      .def_ro("path", &Plan::path, "empty where the status is invalid")
      .def_ro("verification", &Plan::verification)
      .def_ro("horizon", &Plan::horizon, "how far it was looked ahead, s")
      .def_ro("evaluations", &Plan::evaluations, "solutions evaluated")
      .def_ro("generations", &Plan::generations, "done in the search that gave the path")
      .def_ro("deadline_reached", &Plan::deadline_reached)
      .def_ro("kept_previous", &Plan::kept_previous)
      .def_ro("emergency", &Plan::emergency, "more acceleration is used than plans normally may")
      .def_prop_ro(
          "front",
          [](Plan& p) -> Table<const double> {
            return {p.front.empty() ? nullptr : p.front.data()->data(), {p.front.size(), std::size_t{2}}};
          },
          "n x 2: the first two objectives of the first front");
}

}  // namespace

void add_planner(nb::module_& module) {
  add_verification(module);
  add_plan(module);
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  nb::class_<Planner>(module, "HorizonPlanner", "Plans the remaining path from the present state, again and again.")
      .def(nb::init<const config::Settings&, int>(), nb::arg("settings"), nb::arg("threads") = 1)
      .def("plan", &plan, nb::arg("position"), nb::arg("velocity"), nb::arg("target"),
           nb::arg("tracks").none() = nb::none(), nb::kw_only(), nb::arg("previous").none() = nb::none(),
           nb::arg("vehicle") = base::VehicleLimits(), nb::arg("volume").none() = nb::none(),
           nb::arg("standing").none() = nb::none(), nb::arg("margin").none() = nb::none(), nb::arg("seed") = 1,
           nb::arg("number") = 0, nb::arg("generations").none() = nb::none(),
           nb::arg("deadline_ms").none() = nb::none(), released,
           "Plans from position (m) and velocity (m/s) on, ENU, among tracks that are valid now and `standing` ones "
           "that\n"
           "do not move. `previous` is the plan now flown, its times counted from now (Path.after()). `volume` is\n"
           "(smallest, largest) coordinates. `number` counts the plans of a flight. The same bits for the same "
           "arguments,\n"
           "unless a deadline ends the search.");
  module.def(
      "verify", &verify_path, nb::arg("path"), nb::arg("tracks").none() = nb::none(),
      nb::arg("vehicle") = base::VehicleLimits(), nb::kw_only(), nb::arg("volume").none() = nb::none(),
      nb::arg("velocity").none() = nb::none(), nb::arg("standing").none() = nb::none(), nb::arg("tracks_time") = 0.0,
      nb::arg("until") = base::kInfinity, nb::arg("acceleration_trust") = base::kInfinity, nb::arg("rests") = true,
      released,
      "Checks a path, flown at constant velocity between its points, in continuous time. The tracks are valid at\n"
      "`tracks_time` of the path; obstacles and `volume` count up to `until`. With `velocity`, the vehicle's at the\n"
      "first point, the vehicle's limits are looked at too; `rests`: the path ends at rest.");
}

}  // namespace jink::python
