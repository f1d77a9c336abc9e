// SPDX-License-Identifier: BSD-3-Clause
// jink replay: a scenario flown closed loop in virtual time, in one process; or a recorded flight planned again.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "bridge/base/clock.hpp"
#include "config/scenario.hpp"
#include "planner/base/version.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tools/cli/progress_line.hpp"
#include "tools/cli/summaries.hpp"
#include "tools/commands/commands.hpp"
#include "tools/log/flight_log.hpp"
#include "tools/log/flight_replay.hpp"
#include "tools/report/html_report.hpp"

namespace jink::tools::commands {
namespace {

constexpr std::size_t kMostShown = 20;     // differences that are listed
constexpr std::size_t kLivePlans = 25;     // between progress lines
constexpr std::size_t kNamedMissing = 10;  // parameters that are named

constexpr const char* kOwnPilot = "jink";

struct ReplayOptions {
  cli::CommonOptions common;
  std::string scenario;
  std::string log;
  std::string report;
  std::string pilot = kOwnPilot;
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
  if (!options.report.empty() && options.log.empty())
    throw cli::UsageError("--report: needs --log FILE.jsonl, from which it is made");
  const config::Scenario scenario = config::load_scenario(options.scenario);
  if (!scenario.map.empty()) printer.line(fmt::format("map: {} solids", scenario.map.size()));
  sim::flight::ClosedLoopOptions loop;
  loop.seed = options.common.seed;
  loop.threads = options.common.thread_count();
  cli::catch_signals();
  loop.interrupted = cli::interrupted;
  std::optional<cli::BackgroundPrinter> background(printer);
  FaultPrinter faults(*background);
  const config::Mission mission = sim::flight::mission_of(scenario);
  const bridge::base::SteadyClock pace;  // of the progress line alone: the flight's time is virtual
  cli::FlightProgress live(mission, settings.companion.stale_state, *background, &pace);
  loop.flight_observers = {&faults, &live};
  if (options.pilot != kOwnPilot) {
    loop.planner = [&](const bridge::companion::PlannerTaskSettings& planning, double latency) {
      return options.others->pilot(options.pilot, planning, latency, settings.paper);
    };
  }
  std::unique_ptr<log::FlightLog> log;
  if (!options.log.empty()) {
    log::FlightLogOptions in_virtual_time;
    in_virtual_time.wait = true;
    nlohmann::ordered_json header = cli::scenario_header(scenario, options.common.seed, settings);
    header["pilot"] = options.pilot;
    log = std::make_unique<log::FlightLog>(options.log, std::move(header), in_virtual_time);
    loop.flight_observers.push_back(log.get());
    loop.truth_observers.push_back(log.get());
  }
  const sim::flight::ClosedLoopResult result = sim::flight::fly_closed_loop(scenario, settings, loop);
  if (log) log->close();
  background.reset();

  auto summary =
      cli::flight_summary("scenario", scenario.name, options.common.seed, result.flight, result.min_clearance);
  if (result.vehicles.size() > 1) summary["vehicles"] = cli::vehicles_json(result.vehicles, 1);
  cli::write_json(options.common.json, summary);
  printer.line(cli::describe_flight(summary));
  if (!options.report.empty()) {
    const nlohmann::json plain = summary;
    report::write_report(options.log, options.report, &plain);
    printer.line("report: " + std::filesystem::absolute(options.report).string());
  }
  return result.flight.outcome == bridge::supervisor::Outcome::kReached ? base::kExitReached : base::kExitFailed;
}

/// The log's parameters, unless told otherwise; what is not the log's own is said.
log::ReplaySettings replay_settings(const ReplayOptions& options, const log::FlightRecording& flight,
                                    const cli::Printer& printer) {
  std::vector<std::string> missing, ignored;
  log::ReplaySettings result;
  result.recorded = config::recorded_settings(flight.source(), flight.parameters(), {}, missing);
  result.settings = options.common.config.empty() ? config::recorded_settings(flight.source(), flight.parameters(),
                                                                              options.common.overrides, ignored)
                                                  : options.common.settings();
  result.seed = options.own_seed ? options.common.seed : flight.seed();
  result.threads = options.common.thread_count();
  if (flight.version() != JINK_VERSION)
    printer.line(fmt::format("the log is of jink {}, this is jink {}: differences may come from that", flight.version(),
                             JINK_VERSION));
  if (!missing.empty()) {
    const std::size_t named = std::min(missing.size(), kNamedMissing);
    printer.line(fmt::format("the log does not tell {} parameter{}, which {} today's default: {}{}", missing.size(),
                             missing.size() == 1 ? "" : "s", missing.size() == 1 ? "has" : "have",
                             fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                             named < missing.size() ? ", ..." : ""));
  }
  if (options.own_seed || !options.common.config.empty() || !options.common.overrides.empty())
    printer.line("other parameters than the log's: differences are what they lead to");
  return result;
}

nlohmann::ordered_json comparison_json(const log::FlightRecording& flight, const log::FlightComparison& comparison) {
  nlohmann::ordered_json differences = nlohmann::ordered_json::array();
  for (const log::PlanDifference& d : comparison.differences) {
    differences.push_back({{"t", d.t},
                           {"number", d.number},
                           {"line", d.line},
                           {"recorded", planner::verify::to_string(d.recorded)},
                           {"now", planner::verify::to_string(d.now)},
                           {"max_distance", d.max_distance ? cli::finite_or_null(*d.max_distance) : nullptr}});
  }
  return {{"format", "jink-flight-replay/1"},
          {"flight", flight.name()},
          {"seed", flight.seed()},
          {"version", flight.version()},
          {"plans", comparison.plans},
          {"differ", comparison.differences.size()},
          {"differences", std::move(differences)},
          {"ignored_records", flight.unknown() + flight.without_inputs() + (flight.cut_off() ? 1U : 0U)}};
}

void describe(const log::FlightRecording& flight, const log::FlightComparison& comparison,
              const cli::Printer& printer) {
  for (std::size_t i = 0; i < std::min(kMostShown, comparison.differences.size()); ++i) {
    const log::PlanDifference& d = comparison.differences[i];
    printer.line(
        fmt::format("  t {:.2f} s, plan {}: recorded {}, now {}, paths {} apart", d.t, d.number,
                    planner::verify::to_string(d.recorded), planner::verify::to_string(d.now),
                    d.max_distance ? fmt::format("{:.3g} m", *d.max_distance) : "not comparable, one is empty"));
  }
  if (comparison.differences.size() > kMostShown)
    printer.line(fmt::format("  ... and {} more", comparison.differences.size() - kMostShown));
  if (flight.cut_off())
    printer.line("the log's last line is cut off: its writer was killed; the lines before it count");
  if (flight.without_inputs() > 0)
    printer.line(
        fmt::format("{} plans have no record of what they were made from and were left out", flight.without_inputs()));
  printer.line(fmt::format("{}: {} plans, {} differ", flight.name(), comparison.plans, comparison.differences.size()));
}

int replay_flight(const ReplayOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  if (options.pilot != kOwnPilot)
    throw cli::UsageError("--pilot: a replayed log has plans of jink; only a scenario is flown by others");
  if (!options.log.empty() || !options.report.empty())
    throw cli::UsageError(std::string(options.log.empty() ? "--report" : "--log") +
                          ": a replayed log writes none; `jink report FLIGHT.jsonl` makes a report of it");
  cli::end_on_signals();
  std::optional<log::FlightRecording> flight;
  log::FlightComparison comparison;
  try {
    flight.emplace(options.scenario);
    if (flight->pilot() != kOwnPilot)
      throw cli::UsageError(
          fmt::format("{}: its plans are of '{}'; only jink's can be made again", options.scenario, flight->pilot()));
    const log::ReplaySettings settings = replay_settings(options, *flight, printer);
    comparison = log::compare_plans(*flight, settings, [&](std::size_t plans) {
      if (plans % kLivePlans == 0) printer.live(fmt::format("{} plans recomputed", plans));
    });
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(error.what());
  }
  if (comparison.plans == 0) {
    throw cli::UsageError(options.scenario +
                          (flight->without_inputs() > 0
                               ? ": its " + std::to_string(flight->without_inputs()) +
                                     " plans have no record of what they were made from (written by an older jink)"
                               : std::string(": holds no plans; logs of `jink replay` and `jink fly` do")));
  }
  cli::catch_signals();  // what is written now is not cut off
  cli::write_json(options.common.json, comparison_json(*flight, comparison));
  describe(*flight, comparison, printer);
  return comparison.differences.empty() ? base::kExitReached : base::kExitFailed;
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
            if (others == nullptr && options->pilot != kOwnPilot) throw NeedsLaboratory();
            options->own_seed = app.count("--seed") > 0;
            return run(*options);
          }};
}

}  // namespace jink::tools::commands
