// SPDX-License-Identifier: BSD-3-Clause
#include "sim/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "sim/autopilot.hpp"
#include "sim/sensing.hpp"

namespace jink::sim {
namespace {

bridge::FlightMode bridge_mode(FlightMode mode) {
  switch (mode) {
    case FlightMode::kManual:
    case FlightMode::kAcro:
    case FlightMode::kStabilized:
      return bridge::FlightMode::kManual;
    case FlightMode::kAltitude:
      return bridge::FlightMode::kAltitude;
    case FlightMode::kPosition:
      return bridge::FlightMode::kPosition;
    case FlightMode::kTakeoff:
      return bridge::FlightMode::kTakeoff;
    case FlightMode::kHold:
      return bridge::FlightMode::kHold;
    case FlightMode::kReturn:
      return bridge::FlightMode::kReturn;
    case FlightMode::kLand:
      return bridge::FlightMode::kLand;
    case FlightMode::kOffboard:
      return bridge::FlightMode::kOffboard;
  }
  return bridge::FlightMode::kOther;
}

constexpr double kGroundBelow = 1000.0;  // m

/// The autopilot without MAVLink between: telemetry is now, commands act at once.
class VirtualLink final : public bridge::VehicleLink {
 public:
  explicit VirtualLink(Autopilot& autopilot) : autopilot_(autopilot) {}

  bridge::VehicleState state() override {
    const Motion& motion = autopilot_.estimated_motion();
    const double now = autopilot_.time();
    bridge::VehicleState state;
    state.heartbeat_stamp = now;
    state.armed = autopilot_.armed();
    state.mode = bridge_mode(autopilot_.mode());
    state.position_stamp = now;
    state.position = motion.position;
    state.velocity = motion.velocity;
    state.yaw = motion.yaw;
    state.armable = autopilot_.prearm_ok();
    state.local_position_ok = true;
    state.in_air = autopilot_.landed_state() != LandedState::kOnGround;
    return state;
  }

  bool send(const bridge::Setpoint& setpoint) override {
    Setpoint out;
    out.position = setpoint.position;
    out.velocity = setpoint.velocity;
    out.acceleration = setpoint.acceleration;
    out.yaw = setpoint.yaw;
    return autopilot_.offboard_setpoint(out) == Result::kAccepted;
  }

  void request(bridge::Command command) override {
    Result result = Result::kUnsupported;
    switch (command) {
      case bridge::Command::kArm:
        result = autopilot_.arm();
        break;
      case bridge::Command::kDisarm:
        result = autopilot_.disarm();
        break;
      case bridge::Command::kOffboard:
        result = autopilot_.set_mode(6);
        break;
      case bridge::Command::kHold:
        result = autopilot_.hold();
        break;
      case bridge::Command::kLand:
        result = autopilot_.land();
        break;
    }
    const bool accepted = result == Result::kAccepted;
    reports_.push_back({command, accepted, accepted ? "" : "result " + std::to_string(static_cast<int>(result))});
  }

  std::optional<bridge::CommandReport> next_report() override {
    if (reports_.empty()) return std::nullopt;
    bridge::CommandReport report = std::move(reports_.front());
    reports_.pop_front();
    return report;
  }

 private:
  Autopilot& autopilot_;
  std::deque<bridge::CommandReport> reports_;
};

/// The world's sensing as the companion sees it over DDS, without DDS between.
class VirtualTracks final : public bridge::TrackSource {
 public:
  VirtualTracks(const config::Sensing& sensing, std::uint64_t seed) : pipeline_(sensing, seed) {}

  void step(double now, const World& world, const Vec3& vehicle) {
    pipeline_.step(now, world, vehicle);
    now_ = now;
  }

  bool poll(bridge::TrackMessage& message) override {
    TrackMessage measured;
    if (!pipeline_.poll(now_, measured)) return false;
    ++status_.messages;
    message = {1, now_, now_ - measured.stamp, std::move(measured.tracks), 0};
    return true;
  }
  [[nodiscard]] bridge::TrackSourceStatus status() const override { return status_; }

 private:
  SensingPipeline pipeline_;
  double now_ = 0.0;
  bridge::TrackSourceStatus status_{1, 0, 0, 0, {}};
};

/// Judges the true motion from step to step.
class FlightJudge {
 public:
  FlightJudge(const World& world, ClosedLoopResult& result)
      : world_(world), result_(result), last_(world.scenario().start) {}

  /// The outcome that ends the flight here, if any.
  bridge::Outcome watch(double t, const Vec3& position) {
    const SweepResult sweep = world_.sweep(last_, last_t_, position, t);
    result_.min_clearance = std::min(result_.min_clearance, sweep.min_clearance);
    result_.flight.path_length += (position - last_).norm();
    result_.flight.flight_time = t;
    last_ = position;
    last_t_ = t;
    if (sweep.min_clearance < 0.0) {
      result_.flight.reason =
          "hit obstacle " + std::to_string(World::id(sweep.obstacle)) + " at t = " + std::to_string(sweep.t_min) + " s";
      return bridge::Outcome::kCollision;
    }
    if (!world_.inside(position)) {
      result_.flight.reason = "left the world at t = " + std::to_string(t) + " s";
      return bridge::Outcome::kLeftWorld;
    }
    return bridge::Outcome::kNone;
  }

 private:
  const World& world_;
  ClosedLoopResult& result_;
  Vec3 last_;
  double last_t_ = 0.0;
};

}  // namespace

config::Mission mission_of(const config::Scenario& scenario) {
  config::Mission mission;
  mission.name = scenario.name;
  mission.connection = "virtual time";
  mission.vehicle_name = scenario.vehicle_name;
  mission.vehicle = scenario.vehicle;
  mission.waypoints = {scenario.target};
  mission.arrival = config::Arrival::kHold;
  mission.geofence = scenario.world.value_or(planner::Box{});
  mission.min_height =
      scenario.world ? scenario.world->min.z() : std::min({0.0, scenario.start.z(), scenario.target.z()});
  mission.time_limit = scenario.time_limit;
  return mission;
}

ClosedLoopResult fly_closed_loop(const config::Scenario& scenario, const config::Settings& settings,
                                 const ClosedLoopOptions& options) {
  const World world(scenario);
  ClosedLoopResult result;
  result.flight.straight_length = (scenario.target - scenario.start).norm();
  if (world.start_blocked()) {
    result.flight.outcome = bridge::Outcome::kStartBlocked;
    result.flight.reason = "the start is inside an obstacle";
    result.min_clearance = world.clearance(scenario.start, 0.0);
    return result;
  }
  AutopilotOptions vehicle;
  vehicle.limits = scenario.vehicle;
  vehicle.position = scenario.start;
  vehicle.airborne = true;
  // The flight begins in the air wherever the start is, so the ground is out of reach; the world's floor is judged
  // apart.
  vehicle.ground_height = std::min({0.0, scenario.start.z(), scenario.target.z()}) - kGroundBelow;
  vehicle.ready_delay = 0.0;
  vehicle.cascade.max_descent = scenario.vehicle.max_climb;
  Autopilot autopilot(vehicle);
  VirtualLink link(autopilot);
  VirtualTracks tracks(scenario.sensing, options.seed);
  bridge::VirtualPlanner planner({settings.horizon, settings.optimizer, options.seed, options.threads},
                                 1e-3 * settings.companion.planner_latency_ms);
  bridge::Companion companion(mission_of(scenario), settings, {link, tracks, planner, options.flight_observers});

  FlightJudge judge(world, result);
  const int steps_per_turn =
      std::max(1, static_cast<int>(std::lround(1.0 / (settings.companion.setpoint_rate_hz * VehicleModel::kStep))));
  bridge::Outcome ended = bridge::Outcome::kNone;
  double max_speed = 0.0;
  for (int step = 0;; ++step) {
    const double t = autopilot.time();
    const Motion& motion = autopilot.true_motion();
    max_speed = std::max(max_speed, motion.velocity.norm());
    ended = judge.watch(t, motion.position);
    tracks.step(t, world, motion.position);
    if (step % steps_per_turn == 0 || ended != bridge::Outcome::kNone) {
      const VehicleTruth truth{motion.position, motion.velocity};
      for (TruthObserver* observer : options.truth_observers) observer->on_truth(t, std::span(&truth, 1), world);
    }
    if (ended != bridge::Outcome::kNone) break;
    if (step % steps_per_turn == 0 && !companion.step(t)) break;
    autopilot.step();
  }
  const bridge::FlightSummary seen = companion.summary();
  bridge::FlightSummary& flight = result.flight;
  const std::string judged = flight.reason;
  const double time = flight.flight_time;
  const double length = flight.path_length;
  const double straight = flight.straight_length;
  flight = seen;
  flight.flight_time = time;
  flight.path_length = length;
  flight.straight_length = straight;
  flight.max_speed = max_speed;
  if (ended != bridge::Outcome::kNone) {
    flight.outcome = ended;
    flight.reason = judged;
    for (bridge::FlightObserver* observer : options.flight_observers) {
      observer->on_event(time, bridge::to_string(ended), judged);
    }
  }
  return result;
}

}  // namespace jink::sim
