// SPDX-License-Identifier: BSD-3-Clause
// jink replay: a scenario flown closed loop in virtual time, in one process; or a recorded flight planned again.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "bridge/base/clock.hpp"
#include "config/scenario.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tools/cli/progress_line.hpp"
#include "tools/commands/commands.hpp"
#include "tools/report/html_report.hpp"
#include "tools/runs/flight.hpp"
#include "tools/runs/recording.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::commands {
namespace {

constexpr std::size_t kLivePlans = 25;  // between progress lines

struct ReplayOptions {
  cli::CommonOptions common;
  std::string scenario;
  std::string log;
  std::string report;
  std::string pilot = runs::kOwnPilot;
  bool own_seed = false;  ///< --seed was given
  const OtherPlanners* others = nullptr;
};

/// The faults as lines as they begin and end.
class FaultPrinter final : public bridge::companion::FlightObserver {
 public:
  explicit FaultPrinter(cli::BackgroundPrinter& printer) : printer_(printer) {}
  void on_event(double t, std::string_view name, const std::string& detail) override {
    if (name == "fault") printer_.line(fmt::format("t {:6.2f} s  fault: {}", t, detail));
  }

 private:
  cli::BackgroundPrinter& printer_;
};

int replay_scenario(const ReplayOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  const config::Settings settings = options.common.settings();
  if (!options.report.empty() && options.log.empty()) throw cli::UsageError(runs::kReportNeedsLog);
  const config::Scenario scenario = config::load_scenario(options.scenario);
  if (!scenario.map.empty()) printer.line(fmt::format("map: {} solids", scenario.map.size()));
  cli::catch_signals();
  std::optional<cli::BackgroundPrinter> background(printer);
  FaultPrinter faults(*background);
  const config::Mission mission = sim::flight::mission_of(scenario);
  const bridge::base::SteadyClock pace;  // of the progress line alone: the flight's time is virtual
  cli::FlightProgress live(mission, settings.companion.stale_state, *background, &pace);
  runs::FlightOptions flight;
  flight.seed = options.common.seed;
  flight.threads = options.common.thread_count();
  flight.log = options.log;
  flight.pilot = options.pilot;
  if (options.others != nullptr) flight.make_pilot = options.others->pilot;
  flight.flight_observers = {&faults, &live};
  flight.interrupted = cli::interrupted;
  const runs::FlightRun run = runs::fly_scenario(scenario, settings, flight);
  background.reset();

  cli::write_json(options.common.json, run.summary);
  printer.line(runs::describe_flight(run.summary));
  if (!options.report.empty()) {
    const nlohmann::json plain = run.summary;
    report::write_report(options.log, options.report, &plain);
    printer.line("report: " + std::filesystem::absolute(options.report).string());
  }
  return run.reached() ? base::kExitReached : base::kExitFailed;
}

int replay_flight(const ReplayOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  runs::refuse_for_recording(options.pilot, options.log, options.report);
  cli::end_on_signals();
  runs::RecordingOptions recording;
  recording.log = options.scenario;
  if (options.own_seed) recording.seed = options.common.seed;
  recording.threads = options.common.thread_count();
  recording.config = options.common.config;
  recording.overrides = options.common.overrides;
  recording.note = [&](const std::string& line) { printer.line(line); };
  recording.progress = [&](std::size_t plans) {
    if (plans % kLivePlans == 0) printer.live(fmt::format("{} plans recomputed", plans));
  };
  const runs::RecordingRun run = runs::replay_recording(recording);
  cli::catch_signals();  // what is written now is not cut off
  cli::write_json(options.common.json, run.summary);
  printer.line(run.text);
  return run.same ? base::kExitReached : base::kExitFailed;
}

int run(const ReplayOptions& options) {
  cli::refuse_same_file({{"SCENARIO|FLIGHT.jsonl", options.scenario}},
                        {{"--log", options.log}, {"--json", options.common.json}, {"--report", options.report}});
  return std::filesystem::path(options.scenario).extension() == ".jsonl" ? replay_flight(options)
                                                                         : replay_scenario(options);
}

}  // namespace

cli::Subcommand add_replay(const cli::Parser& jink, const OtherPlanners* others) {
  const cli::Parser app =
      jink.add_subcommand("replay",
                          "fly a scenario closed loop in virtual time, all of its vehicles: bit-identical for the same "
                          "seed, at any thread\n"
                          "count; or, given a "
                          "flight log, make its plans again from what they were made from and say which differ");
  const auto options = std::make_shared<ReplayOptions>();
  app.add_option("SCENARIO|FLIGHT.jsonl", options->scenario, "scenario file, or flight log of `replay` or `fly`")
      .required();
  app.add_option("--log", options->log, "write a flight log (JSON Lines)").check(cli::writable_file());
  app.add_option("--report", options->report, "write an HTML flight report; needs --log").check(cli::writable_file());
  options->others = others;
  cli::Option pilot = app.add_option("--pilot", options->pilot,
                                     std::string("planner: jink, or a baseline of `jink arena`") +
                                         (others == nullptr ? "; `jink-lab replay --help` names them" : ""))
                          .show_default();
  if (others != nullptr) pilot.one_of(others->pilots);
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options, app, others] {
            if (others == nullptr && options->pilot != runs::kOwnPilot) throw NeedsLaboratory();
            options->own_seed = app.count("--seed") > 0;
            return run(*options);
          }};
}

}  // namespace jink::tools::commands
