// SPDX-License-Identifier: BSD-3-Clause
// jink fly: the bridge on a companion computer.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/companion/companion.hpp"
#include "bridge/companion/pilot_texts.hpp"
#include "bridge/dds/clouds.hpp"
#include "bridge/dds/intents.hpp"
#include "bridge/dds/px4_link.hpp"
#include "bridge/dds/tracks.hpp"
#include "bridge/map/fence.hpp"
#include "bridge/mavlink/adsb_tracks.hpp"
#include "bridge/mavsdk/link.hpp"
#include "bridge/tracking/track_sources.hpp"
#include "config/mission.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/progress_line.hpp"
#include "tools/log/flight_log.hpp"
#include "tools/report/html_report.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::commands {
namespace {

struct FlyOptions {
  cli::CommonOptions common;
  std::string mission;
  std::string log;
  std::string report;
};

/// Events as lines.
class EventPrinter final : public bridge::companion::FlightObserver {
 public:
  explicit EventPrinter(cli::BackgroundPrinter& printer) : printer_(printer) {}

  void on_event(double t, std::string_view name, const std::string& detail) override {
    printer_.line(fmt::format("[{:6.1f} s] {}{}{}", t, name, detail.empty() ? "" : ": ", detail));
  }

 private:
  cli::BackgroundPrinter& printer_;
};

nlohmann::ordered_json mission_header(const config::Mission& mission, const FlyOptions& options,
                                      const config::Settings& settings) {
  const bool bounded = mission.geofence.min.allFinite() && mission.geofence.max.allFinite();
  nlohmann::ordered_json header{
      {"mission", mission.name},
      {"seed", options.common.seed},
      {"target", log::vector_json(mission.waypoints.back())},
      {"vehicle",
       {{"name", mission.vehicle_name}, {"radius", mission.vehicle.radius}, {"max_speed", mission.vehicle.max_speed}}},
      {"world", bounded ? nlohmann::ordered_json{{"min", log::vector_json(mission.geofence.min)},
                                                 {"max", log::vector_json(mission.geofence.max)}}
                        : nullptr},
      {"parameters", log::parameters_of(settings)}};
  if (!mission.map->tracks().empty()) header["map"] = log::map_json(*mission.map);
  return header;
}

/// Turns the loop at the setpoints' rate, and sooner when a track message or a plan has come, until the flight is over;
/// Ctrl-C brakes and hands over to HOLD.
void run_loop(bridge::companion::Companion& companion, bridge::mavsdk::MavsdkLink& link,
              const bridge::base::Clock& clock, double rate_hz, bridge::base::Notifier& notifier,
              const std::vector<bridge::companion::FlightObserver*>& observers,
              bridge::companion::PilotTexts& pilot_texts) {
  constexpr double kFailing_s = 10.0;  // of turns that throw, after which HOLD has been asked for often enough
  const auto period =
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(1.0 / rate_hz));
  auto next = std::chrono::steady_clock::now() + period;
  double last_good = clock.now();  // NOLINT(clang-analyzer-deadcode.DeadStores): read where the first turn throws
  while (true) {
    const double begun = clock.now();
    bool failed = false;
    try {
      if (!companion.step(begun)) return;
      last_good = begun;
    } catch (const std::exception& failure) {
      failed = true;
      companion.end(begun, bridge::supervisor::Outcome::kAborted, std::string("jink failed: ") + failure.what());
      link.request(bridge::vehicle::Command::kHold);
    }
    if (failed && begun - last_good > kFailing_s) return;
    const bool heard = link.autopilot_system_id() != 0;  // until then texts wait
    for (auto text = heard ? pilot_texts.next(begun) : std::nullopt; text; text = pilot_texts.next(begun))
      (void)link.tell(*text);
    if (cli::interrupted()) companion.interrupt(clock.now());
    while (const auto notice = link.next_notice()) {
      for (bridge::companion::FlightObserver* observer : observers)
        observer->on_event(clock.now(), notice->name, notice->detail);
    }
    notifier.wait_until(failed ? std::max(next, std::chrono::steady_clock::now() + std::chrono::milliseconds(500))
                               : next);
    // A turn that came late is not made up for: setpoints in a burst say nothing.
    const auto now = std::chrono::steady_clock::now();
    if (next <= now) next = std::max(next + period, now);
  }
}

bridge::dds::TrackReaderOptions track_options(const config::Mission& mission, bridge::mavsdk::MavsdkLink& mavlink,
                                              config::TrackTopic topic) {
  const config::TrackPolicy& tracks = mission.tracks;
  bridge::dds::TrackReaderOptions options;
  options.format = static_cast<bridge::dds::TrackFormat>(topic);
  options.name_space = tracks.name_space;
  for (std::size_t i = 0; i < tracks.writers.size(); ++i) {
    if (tracks.writers[i].topic == topic) options.writers[tracks.writers[i].participant] = i + 1;
  }
  if (const auto& origin = tracks.origins.at(static_cast<std::size_t>(topic)))
    options.origin = {origin->latitude_deg, origin->longitude_deg, origin->altitude_m};
  options.local_origin = [&mavlink] { return mavlink.state().origin; };
  return options;
}

/// All that a mission's flight talks to but the autopilot's MAVLink.
struct Transports {
  Transports(const config::Mission& mission, bridge::mavsdk::MavsdkLink& mavlink, const bridge::base::Clock& clock)
      : node(mission.dds_domain, "jink", mission.dds_security), vehicle(&mavlink) {
    const config::TrackSources& sources = mission.tracks.sources;
    for (const config::TrackTopic topic : config::kTrackTopics) {
      if (sources.has(topic)) tracks.add(readers.emplace_back(node, clock, track_options(mission, mavlink, topic)));
    }
    if (sources.adsb) {
      const auto reports = [&mavlink](bridge::mavlink::AdsbReport& report) { return mavlink.next_adsb(report); };
      const auto origin = [&mavlink] { return mavlink.state().origin; };
      tracks.add(adsb.emplace(reports, origin, clock, mission.icao_address));
    }
    const bool state = mission.state == config::Transport::kDds;
    const bool setpoints = mission.setpoints == config::Transport::kDds;
    if (state || setpoints) {
      const bridge::dds::DdsVehicleOptions options{state, setpoints, mission.dds_namespace};
      vehicle = &dds_vehicle.emplace(mavlink, node, clock, options);
    }
    if (mission.intents) intents.emplace(node, clock);
    if (mission.cloud)
      clouds.emplace(node, clock, bridge::dds::CloudReaderOptions{mission.tracks.name_space, mission.cloud->frame});
  }
  Transports(const Transports&) = delete;
  Transports& operator=(const Transports&) = delete;

  bridge::companion::CompanionParts parts(bridge::companion::PlannerTask& planner,
                                          const std::vector<bridge::companion::FlightObserver*>& observers,
                                          const bridge::base::Clock& clock) {
    return {*vehicle, tracks, planner, observers, &clock, intents ? &*intents : nullptr, clouds ? &*clouds : nullptr};
  }

  bridge::dds::DdsParticipant node;
  std::list<bridge::dds::DdsTrackReader> readers;
  std::optional<bridge::mavlink::AdsbTracks> adsb;
  bridge::tracking::TrackSources tracks;
  bridge::vehicle::VehicleLink* vehicle;
  std::optional<bridge::dds::DdsVehicleLink> dds_vehicle;
  std::optional<bridge::dds::DdsIntents> intents;
  std::optional<bridge::dds::DdsCloudReader> clouds;
};

/// Makes the fence that the autopilot keeps a part of the mission's map. Gives back how the flight ends before it
/// began, where that cannot be done.
std::optional<bridge::companion::FlightSummary> take_fence(bridge::mavsdk::MavsdkLink& link, config::Mission& mission,
                                                           cli::BackgroundPrinter& printer) {
  constexpr double kAutopilotTimeout_s = 30.0;
  constexpr double kOriginTimeout_s = 60.0;  // a GPS fix takes its time
  constexpr double kFenceTimeout_s = 5.0;
  std::stop_source stop;
  const std::jthread interrupts([&stop](const std::stop_token& end) {
    while (!end.stop_requested() && !cli::interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop.request_stop();
  });
  bridge::companion::FlightSummary refused;
  refused.outcome = bridge::supervisor::Outcome::kAborted;
  refused.reason = "interrupted";
  if (!link.wait_for_autopilot(kAutopilotTimeout_s, stop.get_token())) {
    if (stop.stop_requested()) return refused;
    refused.reason = "waited in vain for an autopilot's heartbeat on " + mission.connection;
    refused.missing_peer = bridge::supervisor::MissingPeer::kAutopilot;
    return refused;
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(kOriginTimeout_s);
  const auto placed = [&link] { return link.state().origin && link.state().motion.heard(); };
  while (!placed() && !stop.stop_requested() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const auto items = placed() ? link.read_fence(kFenceTimeout_s, stop.get_token()) : std::nullopt;
  if (stop.stop_requested()) return refused;
  if (!items) {
    refused.reason = placed() ? "the autopilot's fence could not be read within 5 s"
                              : "waited in vain for the local origin, which the autopilot's fence is placed by";
    return refused;
  }
  if (items->empty()) std::fprintf(stderr, "jink: the autopilot's fence is empty: it bounds nothing\n");
  try {
    const bridge::vehicle::VehicleState state = link.state();
    mission = bridge::map::fenced(mission, *items, *state.origin);
    if (!bridge::map::fence_of(*items, *state.origin, 0.0, 1.0).holds(state.motion.value.position)) {
      refused.reason = "the vehicle is outside the autopilot's fence";
      return refused;
    }
  } catch (const std::runtime_error& error) {
    refused.reason = error.what();
    return refused;
  }
  printer.line(fmt::format("fence: {} items of the autopilot", items->size()));
  return std::nullopt;
}

/// Tells how it ended.
void finish(const FlyOptions& options, const config::Mission& mission, const bridge::companion::FlightSummary& flight,
            const cli::Printer& printer, const std::unique_ptr<log::FlightLog>& log) {
  const auto summary = runs::flight_summary("mission", mission.name, options.common.seed, flight, std::nullopt);
  cli::write_json(options.common.json, summary);
  if (flight.missing_peer != bridge::supervisor::MissingPeer::kNone) {
    std::fprintf(stderr, "jink: %s; %s\n", flight.reason.c_str(),
                 flight.missing_peer == bridge::supervisor::MissingPeer::kAutopilot
                     ? "start `jink sim SCENARIO`, PX4 SITL, or check the mission's connection"
                     : "start `jink sim SCENARIO` or your track writer, or check the mission's dds.domain");
  } else {
    printer.line(runs::describe_flight(summary));
  }
  if (!log) return;
  log->close();
  if (options.report.empty()) return;
  const nlohmann::json plain = summary;
  report::write_report(options.log, options.report, &plain);
  printer.line("report: " + std::filesystem::absolute(options.report).string());
}

int exit_code(const bridge::companion::FlightSummary& flight) {
  if (flight.missing_peer != bridge::supervisor::MissingPeer::kNone) return base::kExitMissingPeer;
  return flight.outcome == bridge::supervisor::Outcome::kReached ? base::kExitReached : base::kExitFailed;
}

int run(const FlyOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  cli::refuse_same_file({{"MISSION", options.mission}},
                        {{"--log", options.log}, {"--json", options.common.json}, {"--report", options.report}});
  if (!options.report.empty() && options.log.empty())
    throw cli::UsageError("--report: needs --log FILE.jsonl, from which it is made");
  const config::Settings settings = options.common.settings();
  config::Mission mission = config::load_mission(options.mission);
  cli::catch_signals();
  const bridge::base::SteadyClock clock;
  bridge::base::Notifier notifier;
  std::optional<cli::BackgroundPrinter> background(printer);
  EventPrinter event_printer(*background);
  cli::FlightProgress live(mission, settings.companion.stale_state, *background);
  bridge::companion::PilotTexts pilot_texts;
  std::vector<bridge::companion::FlightObserver*> observers{&event_printer, &live, &pilot_texts};
  std::unique_ptr<log::FlightLog> log;
  std::unique_ptr<bridge::mavsdk::MavsdkLink> link;
  try {
    link = std::make_unique<bridge::mavsdk::MavsdkLink>(mission.connection, clock,
                                                        static_cast<std::uint32_t>(mission.system_id));
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(options.mission + ": key 'connection': " + error.what());
  }
  if (mission.autopilot_fence) {
    if (const auto refused = take_fence(*link, mission, *background)) {
      background.reset();
      finish(options, mission, *refused, printer, log);
      return exit_code(*refused);
    }
  }
  if (!options.log.empty()) {  // an earlier flight's log outlives a mistyped connection
    log = std::make_unique<log::FlightLog>(options.log, mission_header(mission, options, settings));
    observers.push_back(log.get());
  }
  const std::jthread discovery([&link](const std::stop_token& stop) {
    while (!stop.stop_requested() && !link->wait_for_autopilot(1.0, stop)) {
    }
  });
  Transports transports(mission, *link, clock);
  bridge::companion::ThreadedPlanner planner(
      {settings.horizon, settings.optimizer, options.common.seed, options.common.thread_count()}, clock, &notifier);
  transports.tracks.notify(notifier);
  bridge::companion::Companion companion(mission, settings, transports.parts(planner, observers, clock));
  background->line(fmt::format("mission {}: {} waypoint{}, autopilot on {}, tracks on DDS domain {}, seed {}",
                               mission.name, mission.waypoints.size(), mission.waypoints.size() == 1 ? "" : "s",
                               mission.connection, mission.dds_domain, options.common.seed));
  if (!mission.map->tracks().empty()) background->line(fmt::format("map: {} solids", mission.map->tracks().size()));
  if (const std::string trouble = bridge::dds::discovery_trouble(mission.dds_domain); !trouble.empty())
    background->line("warning: " + trouble);
  run_loop(companion, *link, clock, settings.companion.setpoint_rate_hz, notifier, observers, pilot_texts);
  while (const auto text = pilot_texts.last()) (void)link->tell(*text);

  background.reset();
  const bridge::companion::FlightSummary flight = companion.summary();
  finish(options, mission, flight, printer, log);
  return exit_code(flight);
}

}  // namespace

cli::Subcommand add_fly(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand("fly", "fly a mission against the simulator, PX4 SITL or a vehicle");
  const auto options = std::make_shared<FlyOptions>();
  app.add_option("MISSION", options->mission, "mission file").required();
  app.add_option("--log", options->log, "write a flight log (JSON Lines)").check(cli::writable_file());
  app.add_option("--report", options->report, "write an HTML flight report at the end; needs --log")
      .check(cli::writable_file());
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
