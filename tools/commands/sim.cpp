// SPDX-License-Identifier: BSD-3-Clause
// jink sim: the headless simulator. A PX4-style autopilot on UDP, and the obstacles' tracks on DDS, in real time.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/dds/clouds.hpp"
#include "bridge/dds/tracks.hpp"
#include "config/mission.hpp"
#include "config/scenario.hpp"
#include "sim/dds/vehicle_topics.hpp"
#include "sim/flight/virtual_clouds.hpp"
#include "sim/simulator/simulator.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/progress_line.hpp"
#include "tools/log/flight_log.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::commands {
namespace {

constexpr int kLastInstance = 9;  // PX4's
constexpr int kTurnSteps = 5;     // of 4 ms: in lockstep a setpoint is waited for every 20 ms
constexpr std::chrono::seconds kLongestWait{1};
constexpr std::chrono::microseconds kPollPause{50};
constexpr double kPlainPeriod = 5.0;  // s, between lines where there is no terminal

struct SimOptions {
  cli::CommonOptions common;
  std::string scenario;
  std::string log;
  std::string clock = "start";
  std::string px4 = "1.17";
  double speed = 1.0;
  std::optional<double> boot_clock;
  double duration = 0.0;  // of simulated time; 0: until Ctrl-C
  std::string tracks_namespace;
  std::string dds_security;
  int domain = 0;
  int instance = 0;
  bool no_vehicle = false;
  bool dds_vehicle = false;
  bool no_tracks = false;
  bool lockstep = false;
};

double unix_now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

sim::vehicle::Px4Version px4_version(const std::string& name) {
  if (name == "1.14") return sim::vehicle::Px4Version::k1_14;
  if (name == "1.16") return sim::vehicle::Px4Version::k1_16;
  return name == "1.18" ? sim::vehicle::Px4Version::k1_18 : sim::vehicle::Px4Version::k1_17;
}

/// Events to the terminal and the log, the truth to the log.
class LogSink final : public sim::simulator::SimulatorObserver {
 public:
  explicit LogSink(cli::BackgroundPrinter& printer) : printer_(printer) {}
  /// From here on, what was told before included. None: there is no log.
  void write_to(log::FlightLog* log) {
    log_ = log;
    for (const Event& event : std::exchange(early_, {}))
      if (log_ != nullptr) log_->on_event(event.t, event.name, event.detail);
    begun_ = true;
  }
  void on_event(double t, std::string_view name, const std::string& detail) override {
    printer_.line(detail);
    if (!begun_) early_.push_back({t, std::string(name), detail});
    if (log_ != nullptr) log_->on_event(t, name, detail);
  }
  void on_truth(double t, std::span<const sim::world::VehicleTruth> vehicles, const sim::world::World& world) override {
    if (log_ != nullptr) log_->on_truth(t, vehicles, world);
  }

 private:
  cli::BackgroundPrinter& printer_;
  log::FlightLog* log_ = nullptr;
  struct Event {
    double t;
    std::string name, detail;
  };
  std::vector<Event> early_;  // told while the simulator was made
  bool begun_ = false;
};

std::string mode_text(const sim::vehicle::Autopilot& autopilot) {
  switch (autopilot.mode()) {
    case sim::vehicle::FlightMode::kOffboard:
      return autopilot.armed() ? "OFFBOARD" : "OFFBOARD (disarmed)";
    case sim::vehicle::FlightMode::kHold:
      return autopilot.armed() ? "HOLD" : "disarmed";
    case sim::vehicle::FlightMode::kLand:
      return "LAND";
    case sim::vehicle::FlightMode::kTakeoff:
      return "TAKEOFF";
    case sim::vehicle::FlightMode::kMission:
      return autopilot.armed() ? "MISSION" : "MISSION (disarmed)";
    case sim::vehicle::FlightMode::kReturn:
      return "RETURN";
    default:
      return autopilot.armed() ? "other mode" : "disarmed";
  }
}

std::string status(const sim::simulator::Simulator& simulator, const bridge::dds::DdsTrackWriter* writer) {
  const int readers = writer != nullptr ? writer->readers() : -1;  // -1: no tracks are told
  std::string text;
  for (std::size_t k = 0; k < simulator.vehicle_count(); ++k) {
    const auto& motion = simulator.autopilot(k).true_motion();
    const config::ScenarioVehicle& vehicle = simulator.vehicle(k);
    const double whole = (vehicle.target - vehicle.start).norm();
    cli::ProgressStatus live;
    live.t = simulator.scenario_time();
    live.mode = mode_text(simulator.autopilot(k));
    if (k == 0 && readers == 0) live.stale.emplace_back("no track reader");
    live.to_go = (motion.position - vehicle.target).norm();
    live.progress = whole > 0.0 ? std::clamp(1.0 - *live.to_go / whole, 0.0, 1.0) : 1.0;
    live.nearest = simulator.world().clearance(motion.position, live.t, vehicle.vehicle.radius);
    live.speed = motion.velocity.norm();
    live.height = motion.position.z();
    text += (k == 0 ? "" : fmt::format("  [{}] ", k)) + cli::progress_text(live);
  }
  if (simulator.vehicle_count() > 0) return text;
  cli::ProgressStatus live;
  live.t = simulator.now();
  if (readers == 0) live.stale.emplace_back("no track reader");
  return cli::progress_text(live);
}

/// Until every companion in OFFBOARD has sent a setpoint in this turn, or for a second. A turn in which none is waited
/// for takes as long as in real time, since whoever connects then can follow no faster clock; `turn` is its beginning,
/// and becomes the next one's.
void wait_for_companions(sim::simulator::Simulator& simulator, double speed, bool awaited,
                         std::chrono::steady_clock::time_point& turn) {
  const auto begun = std::chrono::steady_clock::now();
  const std::chrono::duration<double> whole(kTurnSteps * sim::vehicle::VehicleModel::kStep / speed);
  if (!awaited) std::this_thread::sleep_until(turn + std::chrono::duration_cast<std::chrono::nanoseconds>(whole));
  while (!simulator.answered() && !cli::interrupted()) {
    if (std::chrono::steady_clock::now() - begun > kLongestWait) {
      simulator.give_up();
      break;
    }
    std::this_thread::sleep_for(kPollPause);
    simulator.poll();
  }
  simulator.begin_turn();
  turn = std::chrono::steady_clock::now();
}

/// Steps in real time (or `speed` times it; a late step is caught up) or in lockstep, until the end.
void run_until_the_end(sim::simulator::Simulator& simulator, const SimOptions& options, cli::BackgroundPrinter& printer,
                       const bridge::dds::DdsTrackWriter* writer) {
  const auto begun = std::chrono::steady_clock::now();
  auto turn = begun;
  bool awaited = false;  // in lockstep: a companion is, in this turn
  cli::ProgressLine live(printer, kPlainPeriod);
  const bridge::base::SteadyClock pace;  // simulated time may run a thousand times as fast
  for (int step = 0; !cli::interrupted(); ++step) {
    simulator.step();
    if (options.duration > 0.0 && simulator.now() >= options.duration) break;
    if (live.due(pace.now())) live.show(status(simulator, writer));
    if (options.lockstep) {
      if (step % kTurnSteps == kTurnSteps - 1) {
        wait_for_companions(simulator, options.speed, awaited, turn);
        awaited = !simulator.answered();
      }
      continue;
    }
    std::this_thread::sleep_until(
        begun + std::chrono::duration_cast<std::chrono::nanoseconds>(
                    std::chrono::duration<double>((step + 1) * sim::vehicle::VehicleModel::kStep / options.speed)));
  }
}

/// What PX4's uXRCE-DDS agents would publish and take, one for each vehicle; the first without a namespace, as PX4's.
class DdsSides {
 public:
  DdsSides(const SimOptions& options, std::size_t vehicles)
      : node_(options.domain, "jink sim", options.dds_security), jumps_(vehicles) {
    for (std::size_t k = 0; k < vehicles; ++k) {
      const std::size_t instance = static_cast<std::size_t>(options.instance) + k;
      sides_.push_back(std::make_unique<sim::dds::VehicleTopics>(
          node_, instance == 0 ? "" : fmt::format("px4_{}", instance), px4_version(options.px4)));
    }
  }

  void step(std::size_t k, double now, sim::vehicle::Autopilot& autopilot) {
    const sim::dds::EstimateJumps& jumps = jumps_[k].update(
        autopilot.estimator().reset_counter(), autopilot.estimated_motion(), sim::vehicle::VehicleModel::kStep);
    sides_[k]->step(now, autopilot, jumps);
  }

 private:
  bridge::dds::DdsParticipant node_;
  std::vector<std::unique_ptr<sim::dds::VehicleTopics>> sides_;
  std::vector<sim::dds::EstimateJumpDetector> jumps_;
};

/// The summary of vehicle 0's flight; its outcome and reason are those of the vehicle that fared worst.
nlohmann::ordered_json summary_of(const sim::simulator::Simulator& simulator, const SimOptions& options) {
  const std::vector<sim::flight::VehicleReport> reports = simulator.reports();
  const std::string& name = simulator.world().scenario().name;
  auto summary = runs::flight_summary("scenario", name, options.common.seed, reports.front().flight,
                                      reports.front().min_clearance);
  if (reports.size() == 1) return summary;
  const bridge::supervisor::Outcome outcome = sim::flight::worst(reports);
  summary["outcome"] = bridge::supervisor::to_string(outcome);
  std::string reason;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const sim::flight::VehicleReport& report = reports[k];
    if (report.flight.outcome == outcome)
      reason += fmt::format("{}vehicle {}: {}", reason.empty() ? "" : "; ", k, report.flight.reason);
  }
  summary["reason"] = reason;
  summary["vehicles"] = runs::vehicles_json(reports, simulator.autopilot(0).options().system_id);
  return summary;
}

/// What the vehicle's depth camera or lidar sees, as a ROS 2 driver would publish it.
class CloudSide {
 public:
  CloudSide(const SimOptions& options, const sim::simulator::Simulator& simulator)
      : speed_(options.speed),
        simulator_(simulator),
        node_(options.domain, "jink sim camera", options.dds_security),
        writer_(node_, options.tracks_namespace),
        pipeline_(simulator.world(), options.common.seed, 0) {}

  void step(double now, const sim::vehicle::Autopilot& autopilot) {
    const double clock_start = simulator_.clock_runs() ? now - simulator_.scenario_time() : planner::base::kInfinity;
    pipeline_.step(now, sim::flight::body_of(autopilot), clock_start);
    sim::world::ScanMessage seen;
    while (pipeline_.poll(now, seen)) (void)writer_.publish(seen.points, unix_now() - (now - seen.stamp) / speed_);
  }

 private:
  double speed_;
  const sim::simulator::Simulator& simulator_;
  bridge::dds::DdsParticipant node_;
  bridge::dds::DdsCloudWriter writer_;
  sim::world::ScanPipeline pipeline_;
};

void introduce(const config::Scenario& scenario, const SimOptions& options, cli::BackgroundPrinter& printer) {
  printer.line(
      fmt::format("scenario {}: {} obstacles{}{}, seed {}", scenario.name, scenario.obstacles.size(),
                  scenario.map.empty() ? std::string() : fmt::format(", a map of {} solids", scenario.map.size()),
                  options.no_tracks
                      ? ", not published"
                      : fmt::format(" as {} on DDS domain {}",
                                    bridge::dds::track_topic(bridge::dds::TrackFormat::kJink, options.tracks_namespace),
                                    options.domain),
                  options.common.seed));
  const int vehicles = options.no_vehicle ? 0 : 1 + static_cast<int>(scenario.vehicles.size());
  for (int i = options.instance; i < options.instance + vehicles; ++i) {
    printer.line(
        fmt::format("autopilot: MAVLink from UDP {} to 127.0.0.1:{} (companion) and :14550 (ground station), system {}",
                    14580 + i, 14540 + i, i + 1));
  }
  const bool on_dds = !options.no_tracks || options.dds_vehicle;
  if (const std::string trouble = bridge::dds::discovery_trouble(options.domain); on_dds && !trouble.empty())
    printer.line("warning: " + trouble);
  if (options.no_vehicle && !options.common.json.empty())
    printer.line("warning: --json: nothing is written, without a vehicle there is no flight to sum up");
  printer.line("press Ctrl-C to stop");
}

void check_dds(const SimOptions& options) {
  if (!options.tracks_namespace.empty() && !config::is_namespace(options.tracks_namespace)) {
    throw cli::UsageError("--tracks-namespace " + options.tracks_namespace +
                          ": expected names of letters, digits and _, parted by /");
  }
  if (options.dds_security.empty()) return;
  if (const std::string_view missing = config::missing_security_file(options.dds_security); !missing.empty())
    throw cli::UsageError("--dds-security " + options.dds_security + ": holds no file " + std::string(missing));
}

void check_instances(const config::Scenario& scenario, const SimOptions& options) {
  const int last = options.instance + static_cast<int>(scenario.vehicles.size());
  if (options.no_vehicle || last <= kLastInstance) return;
  throw cli::UsageError(
      fmt::format("--instance {}: the scenario's {} vehicles need instances {} to {}; expected 0 to {}",
                  options.instance, scenario.vehicles.size() + 1, options.instance, last,
                  kLastInstance - static_cast<int>(scenario.vehicles.size())));
}

std::unique_ptr<sim::simulator::Simulator> make_simulator(const config::Scenario& scenario,
                                                          const sim::simulator::SimulatorOptions& options,
                                                          sim::simulator::SimulatorParts parts) {
  try {
    return std::make_unique<sim::simulator::Simulator>(scenario, options, std::move(parts));
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(fmt::format("--instance {}: {}", options.instance, error.what()));
  }
}

int run(const SimOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  cli::refuse_same_file({{"SCENARIO", options.scenario}}, {{"--log", options.log}, {"--json", options.common.json}});
  const config::Settings settings = options.common.settings();
  const config::Scenario scenario = config::load_scenario(options.scenario);
  check_instances(scenario, options);
  check_dds(options);
  cli::catch_signals();
  std::unique_ptr<log::FlightLog> log;
  std::optional<cli::BackgroundPrinter> background(printer);
  LogSink log_sink(*background);
  std::unique_ptr<bridge::dds::DdsTrackWriter> writer;  // none: somebody else tells of the obstacles
  if (!options.no_tracks)
    writer =
        std::make_unique<bridge::dds::DdsTrackWriter>(options.domain, options.tracks_namespace, options.dds_security);
  const auto publish = [&](const sim::world::TrackMessage& message, double now) {
    const double age = (now - message.stamp) / options.speed;
    return !writer || writer->publish(message.tracks, unix_now() - age + message.clock_offset);
  };
  sim::simulator::SimulatorOptions choices;
  choices.seed = options.common.seed;
  choices.instance = options.instance;
  choices.vehicles = !options.no_vehicle;
  choices.px4 = px4_version(options.px4);
  choices.immediate_clock = options.clock == "immediate";
  // In lockstep there is no wall clock that it could lag behind.
  choices.clock_rate = options.boot_clock.value_or(options.lockstep ? 1.0 : sim::mavlink::kSitlClockRate);
  std::optional<DdsSides> dds;
  if (options.dds_vehicle) dds.emplace(options, 1 + scenario.vehicles.size());
  std::optional<CloudSide> clouds;
  const auto on_step = [&dds, &clouds](std::size_t k, double now, sim::vehicle::Autopilot& autopilot) {
    if (dds) dds->step(k, now, autopilot);
    if (clouds) clouds->step(now, autopilot);
  };
  const std::unique_ptr<sim::simulator::Simulator> simulator =
      make_simulator(scenario, choices, {publish, {&log_sink}, on_step});
  if (scenario.sensing.scan && !options.no_vehicle) clouds.emplace(options, *simulator);
  if (!options.log.empty())  // what another simulator writes is left alone where that has the port
    log = std::make_unique<log::FlightLog>(options.log, runs::scenario_header(scenario, options.common.seed, settings));
  log_sink.write_to(log.get());
  introduce(scenario, options, *background);
  run_until_the_end(*simulator, options, *background, writer.get());
  background.reset();  // nothing is said by the simulator from here on
  if (log) log->close();
  if (options.no_vehicle) return base::kExitReached;
  const auto summary = summary_of(*simulator, options);
  cli::write_json(options.common.json, summary);
  const auto& clearance = summary["min_clearance"];
  printer.line(fmt::format("scenario {}: {} ({}), smallest clearance {}", scenario.name,
                           summary["outcome"].get<std::string>(), summary["reason"].get<std::string>(),
                           clearance.is_number() ? fmt::format("{:.2f} m", clearance.get<double>()) : "unlimited"));
  return simulator->failed() ? base::kExitFailed : base::kExitReached;
}

}  // namespace

cli::Subcommand add_sim(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand(
      "sim", "simulate a PX4-style vehicle on UDP and the scenario's obstacles on DDS, without a screen");
  const auto options = std::make_shared<SimOptions>();
  app.add_option("SCENARIO", options->scenario, "scenario file").required();
  cli::Option speed = app.add_option("--speed", options->speed, "simulated seconds in a second, 0.5 to 20")
                          .check(cli::number_in({0.5, 20.0}))
                          .show_default();
  app.add_flag("--lockstep", options->lockstep,
               "as fast as possible; but while a vehicle is armed in OFFBOARD, after every 20 ms of simulated time "
               "wait until its companion has sent a setpoint in them. A companion that does not within 1 s is "
               "reported and not waited for until it sends again. For companions that answer telemetry (ATTITUDE "
               "comes at 99 Hz); one that keeps wall-clock time at 50 Hz makes it real time")
      .excludes(speed);
  app.add_option("--clock", options->clock,
                 "start: obstacles stand until the vehicle is at the start in OFFBOARD; immediate")
      .one_of({"start", "immediate"})
      .show_default();
  app.add_flag("--no-vehicle", options->no_vehicle,
               "obstacles alone, for use beside PX4 SITL or a real vehicle; their clock runs at once");
  app.add_flag("--dds-vehicle", options->dds_vehicle,
               "the vehicles on PX4's DDS topics too, as its uXRCE-DDS agent has them: fmu/out/"
               "vehicle_local_position_v1 (or of the release's version), fmu/in/trajectory_setpoint; instance N > 0 in "
               "namespace px4_N");
  app.add_option("--px4", options->px4,
                 "the release of PX4 that the vehicles play where releases differ: version, parameters, heartbeat, "
                 "layout of the position on DDS")
      .one_of({"1.14", "1.16", "1.17", "1.18"})
      .show_default();
  app.add_flag("--no-tracks", options->no_tracks, "vehicle alone: another writer publishes the obstacles");
  app.add_option("--domain", options->domain, "DDS domain, 0 to 232")
      .transform(cli::whole_number({0, 232}))
      .show_default();
  app.add_option("--tracks-namespace", options->tracks_namespace,
                 "before the topic of the obstacles: uav_1 means rt/uav_1/jink/obstacle_tracks");
  app.add_option("--dds-security", options->dds_security,
                 "folder with the keys of a DDS enclave, as SROS 2 lays them out");
  app.add_option("--instance", options->instance,
                 "N: ports 14580+N to 14540+N, MAVLink system N+1; 0 to 9; further vehicles take N+1 and so on")
      .transform(cli::whole_number({0, 9}))
      .show_default();
  app.add_option("--duration", options->duration, "end after so many simulated seconds (default: at Ctrl-C)")
      .check(cli::number_in({0.1, 1e6}));
  app.add_option("--boot-clock", options->boot_clock,
                 "seconds of the autopilot's clock, by which its messages are stamped, in a simulated one, 0.9 to 1.1 "
                 "(default: 0.987, PX4 SITL's against the wall; 1 with --lockstep)")
      .check(cli::number_in({0.9, 1.1}));
  app.add_option("--log", options->log, "write a flight log of the truth (JSON Lines)").check(cli::writable_file());
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
