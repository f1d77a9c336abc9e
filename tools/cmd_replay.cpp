// SPDX-License-Identifier: BSD-3-Clause
// jink replay: a scenario flown closed loop in virtual time, in one process.
#include <fmt/format.h>

#include <memory>

#include "config/scenario.hpp"
#include "sim/closed_loop.hpp"
#include "tools/command_line.hpp"
#include "tools/flight_log.hpp"
#include "tools/report/report.hpp"
#include "tools/summaries.hpp"

namespace jink::tools {
namespace {

struct ReplayOptions {
  CommonOptions common;
  std::string scenario;
  std::string log;
  std::string report;
};

/// The faults to the terminal as they begin and end.
class FaultPrinter final : public bridge::FlightObserver {
 public:
  explicit FaultPrinter(const Printer& printer) : printer_(printer) {}
  void on_event(double t, std::string_view name, const std::string& detail) override {
    if (name == "fault") printer_.line(fmt::format("t {:6.2f} s  fault: {}", t, detail));
  }

 private:
  const Printer& printer_;
};

int run(const ReplayOptions& options) {
  const Printer printer(options.common.json == "-");
  const config::Settings settings = options.common.settings();
  if (std::filesystem::path(options.scenario).extension() == ".jsonl") {
    throw UsageError(options.scenario + ": replaying a flight log is not built yet; give a scenario file (.yaml)");
  }
  if (!options.report.empty() && options.log.empty())
    throw UsageError("--report: needs --log FILE.jsonl, from which it is made");
  const config::Scenario scenario = config::load_scenario(options.scenario);
  if (!scenario.vehicles.empty()) {
    throw UsageError(options.scenario +
                     ": key 'vehicles': replay flies one vehicle; fly several with jink sim and one " +
                     "jink fly for each");
  }

  sim::ClosedLoopOptions loop;
  loop.seed = options.common.seed;
  loop.threads = options.common.thread_count();
  FaultPrinter faults(printer);
  loop.flight_observers.push_back(&faults);
  std::unique_ptr<FlightLog> log;
  if (!options.log.empty()) {
    log = std::make_unique<FlightLog>(options.log, scenario_header(scenario, options.common.seed, settings));
    loop.flight_observers.push_back(log.get());
    loop.truth_observers.push_back(log.get());
  }
  const sim::ClosedLoopResult result = sim::fly_closed_loop(scenario, settings, loop);
  if (log) log->close();

  const auto summary =
      flight_summary("scenario", scenario.name, options.common.seed, result.flight, result.min_clearance);
  write_json(options.common.json, summary);
  printer.line(describe_flight(summary));
  if (!options.report.empty()) {
    const nlohmann::json plain = summary;
    write_report(options.log, options.report, &plain);
    printer.line("report: " + std::filesystem::absolute(options.report).string());
  }
  return result.flight.outcome == bridge::Outcome::kReached ? kExitReached : kExitFailed;
}

}  // namespace

Subcommand add_replay(CLI::App& jink) {
  CLI::App* app = jink.add_subcommand(
      "replay", "fly a scenario closed loop in virtual time: bit-identical for the same seed, at any thread count");
  const auto options = std::make_shared<ReplayOptions>();
  app->add_option("SCENARIO", options->scenario, "scenario file")->required();
  app->add_option("--log", options->log, "write a flight log (JSON Lines)");
  app->add_option("--report", options->report, "write an HTML flight report; needs --log");
  options->common.add_to(*app);
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools
