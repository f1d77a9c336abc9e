// SPDX-License-Identifier: BSD-3-Clause
// jink plan and jink replay.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "bridge/companion/companion.hpp"
#include "config/scenario.hpp"
#include "planner/geometry/static_map.hpp"
#include "python/module/types.hpp"
#include "sim/world/known_world.hpp"
#include "sim/world/truth_observer.hpp"
#include "tools/base/exit_code.hpp"
#include "tools/base/files.hpp"
#include "tools/base/option_ranges.hpp"
#include "tools/report/html_report.hpp"
#include "tools/runs/flight.hpp"
#include "tools/runs/plan.hpp"
#include "tools/runs/recording.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::python {
namespace {

using tools::base::UsageError;
namespace runs = tools::runs;

std::uint64_t whole(const std::string& option, const std::string& text) {
  namespace ranges = tools::base;
  static constexpr std::pair<std::string_view, ranges::WholeRange> kOptions[] = {
      {"--seed", ranges::kSeed},          {"--threads", ranges::kThreads},       {"--slaves", ranges::kSlaves},
      {"--sharing", ranges::kSharing},    {"--population", ranges::kPopulation}, {"--iterations", ranges::kIterations},
      {"--waypoints", ranges::kWaypoints}};
  for (const auto& [name, range] : kOptions) {
    if (name != option) continue;
    std::uint64_t value = 0;
    if (const std::string wrong = ranges::read_whole(text, range, value); !wrong.empty())
      throw UsageError(option + ": " + wrong);
    return value;
  }
  throw UsageError(option + ": is no option that takes a whole number");
}

double deadline_ms(const std::string& text) {
  double value = 0.0;
  if (const std::string wrong = tools::base::read_number(text, tools::base::kDeadline_ms, value); !wrong.empty())
    throw UsageError("--deadline-ms: " + wrong);
  return value;
}

/// What is shown of a scenario: the world as `jink plan` knows it.
class Scenario {
 public:
  explicit Scenario(std::string file_)
      : file(std::move(file_)), scenario(config::load_scenario(file)), known(scenario) {
    if (known.map) standing.assign(known.map->tracks().begin(), known.map->tracks().end());
  }
  std::string file;
  config::Scenario scenario;
  sim::world::KnownWorld known;
  Tracks standing;
};

runs::PlanRun plan(const Scenario& scenario, const config::Settings& settings, runs::PlanOptions options) {
  options.scenario = scenario.file;
  if (options.mode != "paper" && options.mode != "horizon")
    throw UsageError("--mode: " + options.mode + " not in {paper,horizon}");
  if (options.algorithm != runs::kOwnAlgorithm)
    throw UsageError("--algorithm: " + options.algorithm +
                     " is the laboratory's, which Python does not have; `jink-lab plan` has it");
  return runs::plan_scenario(options, scenario.scenario, settings);
}

/// The true motion of a flight's vehicles, and its events, as they come.
class Recorder final : public sim::world::TruthObserver, public bridge::companion::FlightObserver {
 public:
  struct State {
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
  };
  void on_truth(double t, std::span<const sim::world::VehicleTruth> vehicles, const sim::world::World&) override {
    times.push_back(t);
    count = vehicles.size();
    for (const sim::world::VehicleTruth& vehicle : vehicles) states.push_back({vehicle.position, vehicle.velocity});
  }
  void on_event(double t, std::string_view name, const std::string& detail) override {
    events.emplace_back(t, name, detail);
  }

  std::vector<double> times;
  std::vector<State> states;  // of all vehicles at each time
  std::size_t count = 1;      // vehicles
  std::vector<std::tuple<double, std::string, std::string>> events;

  /// vehicles x n x 3.
  nb::ndarray<nb::numpy, const double, nb::ndim<3>> view(Vec3 State::*member) const {
    constexpr std::int64_t kState = sizeof(State) / sizeof(double);
    return {states.empty() ? nullptr : (states.data()->*member).data(),
            {count, times.size(), std::size_t{3}},
            {},
            {kState, static_cast<std::int64_t>(count) * kState, std::int64_t{1}}};
  }
};

struct Flight {
  std::string summary, text;
  bool reached = false;
  Recorder recorder;
};

/// Whether Ctrl-C was pressed, asked of the interpreter a few times a second; it then throws.
class Interruption {
 public:
  bool operator()() {
    constexpr std::chrono::milliseconds kPeriod{100};
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < kPeriod) return false;
    asked_ = now;
    const nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    return false;
  }

 private:
  std::chrono::steady_clock::time_point asked_{};
};

std::unique_ptr<Flight> fly(const Scenario& scenario, const config::Settings& settings, std::uint64_t seed, int threads,
                            const std::string& log, const std::string& report, const std::string& pilot) {
  if (!report.empty() && log.empty()) throw UsageError(runs::kReportNeedsLog);
  if (pilot != runs::kOwnPilot)
    throw UsageError("--pilot: " + pilot +
                     " is the laboratory's, which Python does not have; `jink-lab replay` has it");
  for (const auto& [option, file] : {std::pair("--log: ", log), std::pair("--report: ", report)}) {
    if (file.empty()) continue;
    if (const std::string why = tools::base::why_unwritable(file); !why.empty()) throw UsageError(option + why);
  }
  tools::base::refuse_same_file({{"SCENARIO|FLIGHT.jsonl", scenario.file}}, {{"--log", log}, {"--report", report}});
  auto flight = std::make_unique<Flight>();
  runs::FlightOptions options;
  options.seed = seed;
  options.threads = threads;
  options.log = log;
  options.flight_observers = {&flight->recorder};
  options.truth_observers = {&flight->recorder};
  options.interrupted = Interruption();
  const runs::FlightRun run = runs::fly_scenario(scenario.scenario, settings, options);
  if (!report.empty()) {
    const nlohmann::json plain = run.summary;
    tools::report::write_report(log, report, &plain);
  }
  flight->summary = run.summary.dump();
  flight->text = runs::describe_flight(run.summary);
  flight->reached = run.reached();
  return flight;
}

std::tuple<std::string, std::string, bool> replay_log(const std::string& log, std::optional<std::uint64_t> seed,
                                                      int threads, const std::optional<std::string>& config,
                                                      const std::vector<std::string>& overrides,
                                                      const std::string& log_out, const std::string& report,
                                                      const std::string& pilot) {
  if (config && config->empty()) throw UsageError("--config: is empty; expected a name");
  runs::refuse_for_recording(pilot, log_out, report);
  runs::RecordingOptions options;
  options.log = log;
  options.seed = seed;
  options.threads = threads;
  options.config = config.value_or("");
  options.overrides = overrides;
  std::string notes;
  options.note = [&](const std::string& line) { notes += line + '\n'; };
  options.progress = [interruption = Interruption()](std::size_t) mutable { interruption(); };
  const runs::RecordingRun run = runs::replay_recording(options);
  return {run.summary.dump(), notes + run.text, run.same};
}

void add_scenario(nb::module_& module) {
  nb::class_<Scenario>(module, "Scenario", "A scenario file, and the world as it is known at t = 0.")
      .def(nb::init<std::string>(), nb::arg("file"), nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("file", [](const Scenario& s) { return s.file; })
      .def_prop_ro("name", [](const Scenario& s) { return s.scenario.name; })
      .def_prop_ro(
          "start", [](const Scenario& s) { return vector(s.scenario.start); }, "ENU, m")
      .def_prop_ro(
          "target", [](const Scenario& s) { return vector(s.scenario.target); }, "ENU, m")
      .def_prop_ro(
          "time_limit", [](const Scenario& s) { return s.scenario.time_limit; }, "s")
      .def_prop_ro(
          "vehicle", [](const Scenario& s) { return s.scenario.vehicle; }, "a copy")
      .def_prop_ro(
          "volume",
          [](const Scenario& s) {
            return Corners{vector(s.known.volume.min), vector(s.known.volume.max)};
          },
          "smallest and largest coordinates of the flight, m")
      .def_prop_ro(
          "tracks", [](Scenario& s) -> Tracks& { return s.known.tracks; }, "the obstacles at t = 0")
      .def_prop_ro(
          "standing", [](Scenario& s) -> Tracks& { return s.standing; }, "what the map has");
}

}  // namespace

void add_runs(nb::module_& module) {
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  add_scenario(module);
  module.def("whole", &whole, nb::arg("option"), nb::arg("text"));
  module.def("deadline_ms", &deadline_ms, nb::arg("text"));
  nb::class_<runs::PlanOptions>(module, "PlanOptions")
      .def(nb::init<>())
      .def_rw("seed", &runs::PlanOptions::seed)
      .def_rw("threads", &runs::PlanOptions::threads)
      .def_rw("mode", &runs::PlanOptions::mode)
      .def_rw("algorithm", &runs::PlanOptions::algorithm)
      .def_rw("slaves", &runs::PlanOptions::slaves)
      .def_rw("sharing", &runs::PlanOptions::sharing)
      .def_rw("population", &runs::PlanOptions::population)
      .def_rw("iterations", &runs::PlanOptions::iterations)
      .def_rw("waypoints", &runs::PlanOptions::waypoints)
      .def_rw("deadline_ms", &runs::PlanOptions::deadline_ms);
  nb::class_<runs::PlanRun>(module, "PlanRun")
      .def_prop_ro("summary", [](const runs::PlanRun& r) { return r.summary.dump(); })
      .def_ro("text", &runs::PlanRun::text)
      .def_ro("plan", &runs::PlanRun::plan)
      .def_prop_ro("reached", &runs::PlanRun::reached);
  module.def("plan", &plan, nb::arg("scenario"), nb::arg("settings"), nb::arg("options"), released);
  nb::class_<Flight>(module, "Flight")
      .def_ro("summary", &Flight::summary)
      .def_ro("text", &Flight::text)
      .def_ro("reached", &Flight::reached)
      .def_prop_ro("t",
                   [](const Flight& f) -> Column<const double> {
                     return {f.recorder.times.data(), {f.recorder.times.size()}};
                   })
      .def_prop_ro("position", [](const Flight& f) { return f.recorder.view(&Recorder::State::position); })
      .def_prop_ro("velocity", [](const Flight& f) { return f.recorder.view(&Recorder::State::velocity); })
      .def_prop_ro("events", [](const Flight& f) { return f.recorder.events; });
  module.def("fly", &fly, nb::arg("scenario"), nb::arg("settings"), nb::arg("seed"), nb::arg("threads"), nb::arg("log"),
             nb::arg("report"), nb::arg("pilot"), released);
  module.def("replay_log", &replay_log, nb::arg("log"), nb::arg("seed").none(), nb::arg("threads"),
             nb::arg("config").none(), nb::arg("overrides"), nb::arg("log_out"), nb::arg("report"), nb::arg("pilot"),
             released);
}

}  // namespace jink::python
