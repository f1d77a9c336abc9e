// SPDX-License-Identifier: BSD-3-Clause
// jink fly: the bridge on a companion computer.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>
#include <thread>

#include "bridge/adsb_tracks.hpp"
#include "bridge/clock.hpp"
#include "bridge/companion.hpp"
#include "bridge/dds_autoware.hpp"
#include "bridge/dds_intents.hpp"
#include "bridge/dds_px4.hpp"
#include "bridge/dds_tracks.hpp"
#include "bridge/mavsdk_link.hpp"
#include "bridge/track_sources.hpp"
#include "config/mission.hpp"
#include "tools/command_line.hpp"
#include "tools/flight_log.hpp"
#include "tools/live_line.hpp"
#include "tools/report/report.hpp"
#include "tools/summaries.hpp"

namespace jink::tools {
namespace {

struct FlyOptions {
  CommonOptions common;
  std::string mission;
  std::string log;
  std::string report;
};

/// Events as lines.
class Teller final : public bridge::FlightObserver {
 public:
  explicit Teller(BackgroundPrinter& printer) : printer_(printer) {}

  void on_event(double t, std::string_view name, const std::string& detail) override {
    printer_.line(fmt::format("[{:6.1f} s] {}{}{}", t, name, detail.empty() ? "" : ": ", detail));
  }

 private:
  BackgroundPrinter& printer_;
};

nlohmann::ordered_json mission_header(const config::Mission& mission, const FlyOptions& options,
                                      const config::Settings& settings) {
  const bool bounded = mission.geofence.min.allFinite() && mission.geofence.max.allFinite();
  return {
      {"mission", mission.name},
      {"seed", options.common.seed},
      {"target", vector_json(mission.waypoints.back())},
      {"vehicle",
       {{"name", mission.vehicle_name}, {"radius", mission.vehicle.radius}, {"max_speed", mission.vehicle.max_speed}}},
      {"world", bounded ? nlohmann::ordered_json{{"min", vector_json(mission.geofence.min)},
                                                 {"max", vector_json(mission.geofence.max)}}
                        : nullptr},
      {"parameters", parameters_of(settings)}};
}

/// Turns the loop at the setpoints' rate, and sooner when a track message or a plan has come, until the flight is over;
/// Ctrl-C brakes and hands over to HOLD.
void run_loop(bridge::Companion& companion, bridge::MavsdkLink& link, const bridge::Clock& clock, double rate_hz,
              bridge::Wake& wake, const std::vector<bridge::FlightObserver*>& observers) {
  constexpr double kFailing_s = 10.0;  // of turns that throw, after which HOLD has been asked for often enough
  const auto period =
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(1.0 / rate_hz));
  auto next = std::chrono::steady_clock::now() + period;
  double last_good = clock.now();
  while (true) {
    const double begun = clock.now();
    bool failed = false;
    try {
      if (!companion.step(begun)) return;
      last_good = begun;
    } catch (const std::exception& failure) {
      failed = true;
      companion.end(begun, bridge::Outcome::kAborted, std::string("jink failed: ") + failure.what());
      link.request(bridge::Command::kHold);
    }
    if (failed && begun - last_good > kFailing_s) return;
    if (interrupted()) companion.interrupt(clock.now());
    while (const auto notice = link.next_notice()) {
      for (bridge::FlightObserver* observer : observers) observer->on_event(clock.now(), notice->name, notice->detail);
    }
    wake.wait_until(failed ? std::max(next, std::chrono::steady_clock::now() + std::chrono::milliseconds(500)) : next);
    // A turn that came late is not made up for: setpoints in a burst say nothing.
    const auto now = std::chrono::steady_clock::now();
    if (next <= now) next = std::max(next + period, now);
  }
}

/// All that a mission's flight talks to but the autopilot's MAVLink.
struct Transports {
  Transports(const config::Mission& mission, bridge::MavsdkLink& mavlink, const bridge::Clock& clock)
      : node(mission.dds_domain), vehicle(&mavlink) {
    const config::TrackSources& sources = mission.tracks.sources;
    if (sources.jink) tracks.add(jink.emplace(node, clock));
    if (sources.autoware) tracks.add(autoware.emplace(node, clock));
    if (sources.adsb) {
      const auto reports = [&mavlink](bridge::AdsbReport& report) { return mavlink.next_adsb(report); };
      const auto origin = [&mavlink] { return mavlink.state().origin; };
      tracks.add(adsb.emplace(reports, origin, clock));
    }
    const bool state = mission.state == config::Transport::kDds;
    const bool setpoints = mission.setpoints == config::Transport::kDds;
    if (state || setpoints) {
      const bridge::DdsVehicleOptions options{state, setpoints, mission.dds_namespace};
      vehicle = &dds_vehicle.emplace(mavlink, node, clock, options);
    }
    if (mission.intents) intents.emplace(node, clock);
  }
  Transports(const Transports&) = delete;
  Transports& operator=(const Transports&) = delete;

  bridge::CompanionParts parts(bridge::PlannerTask& planner, const std::vector<bridge::FlightObserver*>& observers,
                               const bridge::Clock& clock) {
    return {*vehicle, tracks, planner, observers, &clock, intents ? &*intents : nullptr};
  }

  bridge::DdsNode node;
  std::optional<bridge::DdsTrackReader> jink;
  std::optional<bridge::DdsAutowareReader> autoware;
  std::optional<bridge::AdsbTracks> adsb;
  bridge::TrackSources tracks;
  bridge::VehicleLink* vehicle;
  std::optional<bridge::DdsVehicleLink> dds_vehicle;
  std::optional<bridge::DdsIntents> intents;
};

int exit_code(const bridge::FlightSummary& flight) {
  if (flight.missing_peer != bridge::MissingPeer::kNone) return kExitMissingPeer;
  return flight.outcome == bridge::Outcome::kReached ? kExitReached : kExitFailed;
}

int run(const FlyOptions& options) {
  const Printer printer(options.common.json == "-");
  refuse_same_file({{"MISSION", options.mission}},
                   {{"--log", options.log}, {"--json", options.common.json}, {"--report", options.report}});
  if (!options.report.empty() && options.log.empty())
    throw UsageError("--report: needs --log FILE.jsonl, from which it is made");
  const config::Settings settings = options.common.settings();
  const config::Mission mission = config::load_mission(options.mission);
  catch_signals();
  const bridge::SteadyClock clock;
  bridge::Wake wake;
  std::optional<BackgroundPrinter> background(printer);
  Teller teller(*background);
  LiveFlight live(mission, settings.companion.stale_state, *background);
  std::vector<bridge::FlightObserver*> observers{&teller, &live};
  std::unique_ptr<FlightLog> log;
  std::unique_ptr<bridge::MavsdkLink> link;
  try {
    link = std::make_unique<bridge::MavsdkLink>(mission.connection, clock);
  } catch (const std::runtime_error& error) {
    throw UsageError(options.mission + ": key 'connection': " + error.what());
  }
  if (!options.log.empty()) {  // an earlier flight's log outlives a mistyped connection
    log = std::make_unique<FlightLog>(options.log, mission_header(mission, options, settings));
    observers.push_back(log.get());
  }
  const std::jthread discovery([&link](const std::stop_token& stop) {
    while (!stop.stop_requested() && !link->wait_for_autopilot(1.0, stop)) {
    }
  });
  Transports transports(mission, *link, clock);
  bridge::ThreadedPlanner planner(
      {settings.horizon, settings.optimizer, options.common.seed, options.common.thread_count()}, clock, &wake);
  transports.tracks.notify(wake);
  bridge::Companion companion(mission, settings, transports.parts(planner, observers, clock));
  background->line(fmt::format("mission {}: {} waypoint{}, autopilot on {}, tracks on DDS domain {}, seed {}",
                               mission.name, mission.waypoints.size(), mission.waypoints.size() == 1 ? "" : "s",
                               mission.connection, mission.dds_domain, options.common.seed));
  if (const std::string trouble = bridge::discovery_trouble(mission.dds_domain); !trouble.empty())
    background->line("warning: " + trouble);
  run_loop(companion, *link, clock, settings.companion.setpoint_rate_hz, wake, observers);

  background.reset();
  const bridge::FlightSummary flight = companion.summary();
  const auto summary = flight_summary("mission", mission.name, options.common.seed, flight, std::nullopt);
  write_json(options.common.json, summary);
  if (flight.missing_peer != bridge::MissingPeer::kNone) {
    std::fprintf(stderr, "jink: %s; %s\n", flight.reason.c_str(),
                 flight.missing_peer == bridge::MissingPeer::kAutopilot
                     ? "start `jink sim SCENARIO`, PX4 SITL, or check the mission's connection"
                     : "start `jink sim SCENARIO` or your track writer, or check the mission's dds.domain");
  } else {
    printer.line(describe_flight(summary));
  }
  if (log) log->close();
  if (!options.report.empty()) {
    const nlohmann::json plain = summary;
    write_report(options.log, options.report, &plain);
    printer.line("report: " + std::filesystem::absolute(options.report).string());
  }
  return exit_code(flight);
}

}  // namespace

Subcommand add_fly(CLI::App& jink) {
  CLI::App* app = jink.add_subcommand("fly", "fly a mission against the simulator, PX4 SITL or a vehicle");
  const auto options = std::make_shared<FlyOptions>();
  app->add_option("MISSION", options->mission, "mission file")->required();
  app->add_option("--log", options->log, "write a flight log (JSON Lines)")->check(writable_file());
  app->add_option("--report", options->report, "write an HTML flight report at the end; needs --log")
      ->check(writable_file());
  options->common.add_to(*app);
  app->get_option("--json")->check(writable_file());
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools
