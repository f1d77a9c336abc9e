// SPDX-License-Identifier: BSD-3-Clause
#include "tools/runs/flight.hpp"

#include "tools/log/flight_log.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::runs {
namespace {

std::unique_ptr<log::FlightLog> open_log(const config::Scenario& scenario, const config::Settings& settings,
                                         const FlightOptions& options) {
  if (options.log.empty()) return nullptr;
  log::FlightLogOptions in_virtual_time;
  in_virtual_time.wait = true;
  nlohmann::ordered_json header = scenario_header(scenario, options.seed, settings);
  header["pilot"] = options.pilot;
  return std::make_unique<log::FlightLog>(options.log, std::move(header), in_virtual_time);
}

}  // namespace

FlightRun fly_scenario(const config::Scenario& scenario, const config::Settings& settings,
                       const FlightOptions& options) {
  sim::flight::ClosedLoopOptions loop;
  loop.seed = options.seed;
  loop.threads = options.threads;
  loop.interrupted = options.interrupted;
  loop.flight_observers = options.flight_observers;
  loop.truth_observers = options.truth_observers;
  if (options.pilot != kOwnPilot) {
    loop.planner = [&](const bridge::companion::PlannerTaskSettings& planning, double latency) {
      return options.make_pilot(options.pilot, planning, latency, settings.paper);
    };
  }
  const std::unique_ptr<log::FlightLog> log = open_log(scenario, settings, options);
  if (log) {
    loop.flight_observers.push_back(log.get());
    loop.truth_observers.push_back(log.get());
  }
  FlightRun run;
  run.result = sim::flight::fly_closed_loop(scenario, settings, loop);
  if (log) log->close();
  run.summary = flight_summary("scenario", scenario.name, options.seed, run.result.flight, run.result.min_clearance);
  if (run.result.vehicles.size() > 1) run.summary["vehicles"] = vehicles_json(run.result.vehicles, 1);
  return run;
}

}  // namespace jink::tools::runs
