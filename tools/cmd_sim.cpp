// SPDX-License-Identifier: BSD-3-Clause
// jink sim: the headless simulator. A PX4-style autopilot on UDP, and the obstacles' tracks on DDS, in real time.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>

#include "bridge/dds_tracks.hpp"
#include "config/scenario.hpp"
#include "sim/autopilot.hpp"
#include "sim/mavlink_endpoint.hpp"
#include "sim/sensing.hpp"
#include "sim/world.hpp"
#include "tools/command_line.hpp"
#include "tools/flight_log.hpp"
#include "tools/summaries.hpp"

namespace jink::tools {
namespace {

constexpr double kAtStart = 0.5;      // m from the start, in OFFBOARD, at which the scenario's clock starts
constexpr double kAtTarget = 0.5;     // m
constexpr int kTruthSteps = 5;        // of 4 ms, between truth records: 50 Hz
constexpr int kLiveSteps = 50;        // of 4 ms, between live lines
constexpr double kPlainPeriod = 5.0;  // s, between lines where there is no terminal

struct SimOptions {
  CommonOptions common;
  std::string scenario;
  std::string log;
  std::string clock = "start";
  double speed = 1.0;
  double duration = 0.0;  // of simulated time; 0: until Ctrl-C
  int domain = 0;
  int instance = 0;
  bool no_vehicle = false;
  bool no_tracks = false;
};

double unix_now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// The simulator as one thing to step: world, sensing, and, unless it is left out, the vehicle with its endpoint.
class Simulator {
 public:
  Simulator(const SimOptions& options, const config::Scenario& scenario, const Printer& printer, FlightLog* log)
      : options_(options),
        printer_(printer),
        log_(log),
        world_(scenario),
        sensing_(scenario.sensing, options.common.seed),
        last_(scenario.start) {
    if (!options.no_tracks) writer_ = std::make_unique<bridge::DdsTrackWriter>(options.domain);
    if (!options.no_vehicle) {
      sim::AutopilotOptions vehicle;
      vehicle.limits = scenario.vehicle;
      vehicle.ground_height = std::min(0.0, scenario.start.z());
      vehicle.position = {scenario.start.x(), scenario.start.y(), vehicle.ground_height};
      vehicle.cascade.max_descent = scenario.vehicle.max_climb;
      vehicle.system_id = options.instance + 1;
      autopilot_.emplace(vehicle);
      sim::EndpointOptions endpoint;
      endpoint.instance = options.instance;
      endpoint_ = std::make_unique<sim::MavlinkEndpoint>(*autopilot_, endpoint);
      last_ = vehicle.position;
    }
    if (options.no_vehicle || options.clock == "immediate") start_clock(0.0);
  }

  void step(int step) {
    const double now = step * sim::VehicleModel::kStep;
    const Vec3 position = autopilot_ ? autopilot_->true_motion().position : world_.scenario().start;
    if (autopilot_) {
      endpoint_->poll(now);
      watch_clock(now, position);
      judge(now, position);
    }
    publish(now, position);
    if (log_ != nullptr && autopilot_ && step % kTruthSteps == 0) {
      log_->on_truth(world_time(now), position, autopilot_->true_motion().velocity, world_);
    }
    if (autopilot_) autopilot_->step();
    now_ = now;
  }

  [[nodiscard]] double now() const { return now_; }
  [[nodiscard]] bool failed() const {
    return flight_.outcome == bridge::Outcome::kCollision || flight_.outcome == bridge::Outcome::kLeftWorld;
  }

  [[nodiscard]] std::string status() const {
    const int readers = writer_ ? writer_->readers() : 0;
    const std::string tracks = fmt::format("{} track reader{}", readers, readers == 1 ? "" : "s");
    if (!autopilot_) return fmt::format("t {:6.1f} s  {}", now_, tracks);
    const Vec3& p = autopilot_->true_motion().position;
    return fmt::format("t {:6.1f} s  {}  at ({:.1f}, {:.1f}, {:.1f})  {:.1f} m to target  clearance {:.2f} m  {}",
                       clock_start_ ? world_time(now_) : 0.0, mode_text(), p.x(), p.y(), p.z(),
                       (p - world_.scenario().target).norm(), world_.clearance(p, world_time(now_)), tracks);
  }

  [[nodiscard]] bridge::FlightSummary summary() const {
    bridge::FlightSummary flight = flight_;
    if (flight.outcome == bridge::Outcome::kNone) {
      flight.outcome = bridge::Outcome::kAborted;
      flight.reason =
          clock_start_ ? "ended before the target was reached" : "the vehicle never came to the start in OFFBOARD";
    }
    return flight;
  }
  [[nodiscard]] double min_clearance() const { return min_clearance_; }

 private:
  using Vec3 = planner::Vec3;

  [[nodiscard]] double world_time(double now) const { return clock_start_ ? std::max(0.0, now - *clock_start_) : 0.0; }

  [[nodiscard]] std::string mode_text() const {
    switch (autopilot_->mode()) {
      case sim::FlightMode::kOffboard:
        return autopilot_->armed() ? "OFFBOARD" : "OFFBOARD (disarmed)";
      case sim::FlightMode::kHold:
        return autopilot_->armed() ? "HOLD" : "disarmed";
      case sim::FlightMode::kLand:
        return "LAND";
      case sim::FlightMode::kTakeoff:
        return "TAKEOFF";
      case sim::FlightMode::kReturn:
        return "RETURN";
      default:
        return autopilot_->armed() ? "other mode" : "disarmed";
    }
  }

  void say(const std::string& name, const std::string& text) {
    printer_.line(text);
    if (log_ != nullptr) log_->on_event(world_time(now_), name, text);
  }

  void start_clock(double now) {
    clock_start_ = now;
    say("clock", fmt::format("the scenario's clock runs, {} obstacles move", world_.obstacle_count()));
  }

  void watch_clock(double now, const Vec3& position) {
    if (clock_start_ || autopilot_->mode() != sim::FlightMode::kOffboard) return;
    if ((position - world_.scenario().start).norm() <= kAtStart) start_clock(now);
  }

  void publish(double now, const Vec3& position) {
    sensing_.step(now, world_, position, clock_start_.value_or(planner::kInfinity));
    sim::TrackMessage message;
    while (sensing_.poll(now, message)) {
      const double age = (now - message.stamp) / options_.speed;
      if (writer_ && !writer_->publish(message.tracks, unix_now() - age))
        say("publish_failed", "a track message could not be published");
    }
  }

  /// What the true motion since the last step means. A collision stops the motors, as it would.
  void judge(double now, const Vec3& position) {
    const double t = world_time(now);
    const sim::SweepResult sweep = world_.sweep(last_, last_time_, position, t);
    const double moved = (position - last_).norm();
    last_ = position;
    last_time_ = t;
    if (failed()) return;
    min_clearance_ = std::min(min_clearance_, sweep.min_clearance);
    if (sweep.min_clearance < 0.0) {
      flight_.reason = fmt::format("hit obstacle {} at t = {:.2f} s", sim::World::id(sweep.obstacle), sweep.t_min);
      flight_.outcome = bridge::Outcome::kCollision;
      say("collision", "COLLISION: " + flight_.reason + "; the motors stop");
      autopilot_->crash();
      return;
    }
    if (!clock_start_ || flight_.outcome == bridge::Outcome::kReached) return;
    flight_.flight_time = t;
    flight_.path_length += moved;
    flight_.max_speed = std::max(flight_.max_speed, autopilot_->true_motion().velocity.norm());
    if (!world_.inside(position) && autopilot_->mode() == sim::FlightMode::kOffboard) {
      flight_.outcome = bridge::Outcome::kLeftWorld;
      flight_.reason = fmt::format("left the world at t = {:.2f} s", t);
      say("left_world", "LEFT THE WORLD: " + flight_.reason);
      return;
    }
    if ((position - world_.scenario().target).norm() <= kAtTarget) {
      flight_.outcome = bridge::Outcome::kReached;
      flight_.reason = "the vehicle came to the target";
      say("reached", fmt::format("the vehicle came to the target at t = {:.2f} s", t));
    }
  }

  const SimOptions& options_;
  const Printer& printer_;
  FlightLog* log_;
  sim::World world_;
  sim::SensingPipeline sensing_;
  std::unique_ptr<bridge::DdsTrackWriter> writer_;  // none: somebody else tells of the obstacles
  std::optional<sim::Autopilot> autopilot_;
  std::unique_ptr<sim::MavlinkEndpoint> endpoint_;
  std::optional<double> clock_start_;
  bridge::FlightSummary flight_;
  double min_clearance_ = planner::kInfinity;
  Vec3 last_;
  double last_time_ = 0.0;
  double now_ = 0.0;
};

/// Steps in real time (or `speed` times it) until the end; a late step is caught up.
void run_in_real_time(Simulator& simulator, const SimOptions& options, const Printer& printer) {
  const auto begun = std::chrono::steady_clock::now();
  const bool live = printer.terminal();
  const int period = live ? kLiveSteps : static_cast<int>(kPlainPeriod / sim::VehicleModel::kStep);
  for (int step = 0; !interrupted(); ++step) {
    simulator.step(step);
    if (options.duration > 0.0 && simulator.now() >= options.duration) break;
    if (step > 0 && step % period == 0) live ? printer.live(simulator.status()) : printer.line(simulator.status());
    std::this_thread::sleep_until(
        begun + std::chrono::duration_cast<std::chrono::nanoseconds>(
                    std::chrono::duration<double>((step + 1) * sim::VehicleModel::kStep / options.speed)));
  }
}

int run(const SimOptions& options) {
  const Printer printer(options.common.json == "-");
  const config::Settings settings = options.common.settings();
  const config::Scenario scenario = config::load_scenario(options.scenario);
  catch_signals();
  std::unique_ptr<FlightLog> log;
  if (!options.log.empty())
    log = std::make_unique<FlightLog>(options.log, scenario_header(scenario, options.common.seed, settings));
  Simulator simulator(options, scenario, printer, log.get());
  printer.line(fmt::format(
      "scenario {}: {} obstacles{}, seed {}", scenario.name, scenario.obstacles.size(),
      options.no_tracks ? ", not told" : fmt::format(" as {} on DDS domain {}", bridge::kTracksTopic, options.domain),
      options.common.seed));
  if (!options.no_vehicle) {
    printer.line(
        fmt::format("autopilot: MAVLink from UDP {} to 127.0.0.1:{} (companion) and :14550 (ground station), system {}",
                    14580 + options.instance, 14540 + options.instance, options.instance + 1));
  }
  printer.line("Ctrl-C ends it");
  run_in_real_time(simulator, options, printer);
  if (log) log->close();
  if (options.no_vehicle) return kExitReached;
  const auto summary =
      flight_summary("scenario", scenario.name, options.common.seed, simulator.summary(), simulator.min_clearance());
  write_json(options.common.json, summary);
  printer.line(fmt::format("scenario {}: {} ({}), smallest clearance {:.2f} m", scenario.name,
                           summary["outcome"].get<std::string>(), summary["reason"].get<std::string>(),
                           simulator.min_clearance()));
  return simulator.failed() ? kExitFailed : kExitReached;
}

}  // namespace

Subcommand add_sim(CLI::App& jink) {
  CLI::App* app = jink.add_subcommand(
      "sim", "simulate a PX4-style vehicle on UDP and the scenario's obstacles on DDS, without a screen");
  const auto options = std::make_shared<SimOptions>();
  app->add_option("SCENARIO", options->scenario, "scenario file")->required();
  app->add_option("--speed", options->speed, "simulated seconds in a second, 0.5 to 20")
      ->check(CLI::Range(0.5, 20.0))
      ->capture_default_str();
  app->add_option("--clock", options->clock,
                  "start: obstacles stand until the vehicle is at the start in OFFBOARD; immediate")
      ->check(CLI::IsMember({"start", "immediate"}))
      ->capture_default_str();
  app->add_flag("--no-vehicle", options->no_vehicle,
                "obstacles alone, for use beside PX4 SITL or a real vehicle; their clock runs at once");
  app->add_flag("--no-tracks", options->no_tracks, "vehicle alone: another writer tells of the obstacles");
  app->add_option("--domain", options->domain, "DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app->add_option("--instance", options->instance, "N: ports 14580+N to 14540+N, MAVLink system N+1; 0 to 9")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  app->add_option("--duration", options->duration, "end after so many simulated seconds (default: at Ctrl-C)")
      ->check(CLI::Range(0.1, 1e6));
  app->add_option("--log", options->log, "write a flight log of the truth (JSON Lines)");
  options->common.add_to(*app);
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools
