// SPDX-License-Identifier: BSD-3-Clause
#include "sim/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "sim/autopilot.hpp"
#include "sim/faults.hpp"
#include "sim/vehicle_faults.hpp"
#include "sim/virtual_transport.hpp"

namespace jink::sim {
namespace {

constexpr double kGroundBelow = 1000.0;  // m

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

namespace {

AutopilotOptions vehicle_of(const config::Scenario& scenario, std::uint64_t seed) {
  AutopilotOptions vehicle;
  vehicle.limits = scenario.vehicle;
  vehicle.position = scenario.start;
  vehicle.airborne = true;
  // The flight begins in the air wherever the start is, so the ground is out of reach; the world's floor is judged
  // apart.
  vehicle.ground_height = std::min({0.0, scenario.start.z(), scenario.target.z()}) - kGroundBelow;
  vehicle.ready_delay = 0.0;
  vehicle.cascade.max_descent = scenario.vehicle.max_climb;
  set_conditions(scenario, seed, 0, vehicle);
  return vehicle;
}

/// What the timeline does at `t`, with an event for each change.
void befall(double t, FaultTimeline& timeline, Autopilot& autopilot, VirtualLink& link,
            const std::vector<bridge::FlightObserver*>& observers) {
  const std::vector<FaultChange> changes = timeline.advance(t);
  for (const FaultChange& change : changes) {
    const auto resets = autopilot.estimator().reset_counter();
    const int reboots = autopilot.reboots();
    const Vec3 before = autopilot.estimated_motion().position;
    apply(timeline, change, 0, autopilot);
    if (autopilot.reboots() == reboots && autopilot.estimator().reset_counter() != resets)
      link.note_reset(autopilot.estimated_motion().position - before);
    for (bridge::FlightObserver* observer : observers) observer->on_event(t, "fault", timeline.describe(change));
  }
  if (!changes.empty()) link.impair(timeline.link(0));
}

std::unique_ptr<bridge::PlannerTask> make_planner(const config::Settings& settings, const ClosedLoopOptions& options) {
  const bridge::PlannerTaskSettings task{settings.horizon, settings.optimizer, options.seed, options.threads};
  const double latency = 1e-3 * settings.companion.planner_latency_ms;
  if (options.planner) return options.planner(task, latency);
  return std::make_unique<bridge::VirtualPlanner>(task, latency);
}

/// The companion's summary with the truth's figures in place of those that it could only estimate.
void complete(ClosedLoopResult& result, const bridge::FlightSummary& seen, bridge::Outcome ended, double max_speed,
              const std::vector<bridge::FlightObserver*>& observers) {
  const bridge::FlightSummary judged = result.flight;
  bridge::FlightSummary& flight = result.flight;
  flight = seen;
  flight.flight_time = judged.flight_time;
  flight.path_length = judged.path_length;
  flight.straight_length = judged.straight_length;
  flight.max_speed = max_speed;
  if (ended == bridge::Outcome::kNone) return;
  flight.outcome = ended;
  flight.reason = judged.reason;
  for (bridge::FlightObserver* observer : observers)
    observer->on_event(flight.flight_time, bridge::to_string(ended), flight.reason);
}

}  // namespace

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
  FaultTimeline timeline(scenario.faults);
  Autopilot autopilot(vehicle_of(scenario, options.seed));
  VirtualLink link(autopilot, options.seed);
  VirtualTracks tracks(world, timeline, options.seed);
  const std::unique_ptr<bridge::PlannerTask> planner = make_planner(settings, options);
  bridge::Companion companion(mission_of(scenario), settings, {link, tracks, *planner, options.flight_observers});

  FlightJudge judge(world, result);
  const int steps_per_turn =
      std::max(1, static_cast<int>(std::lround(1.0 / (settings.companion.setpoint_rate_hz * VehicleModel::kStep))));
  bridge::Outcome ended = bridge::Outcome::kNone;
  double max_speed = 0.0;
  for (int step = 0;; ++step) {
    const double t = autopilot.time();
    const bool turn = step % steps_per_turn == 0;
    befall(t, timeline, autopilot, link, options.flight_observers);
    link.advance(t);
    const VehicleTruth truth{autopilot.true_motion().position, autopilot.true_motion().velocity};
    max_speed = std::max(max_speed, truth.velocity.norm());
    ended = judge.watch(t, truth.position);
    tracks.advance(t, truth);
    if (turn || ended != bridge::Outcome::kNone) {
      for (TruthObserver* observer : options.truth_observers) observer->on_truth(t, std::span(&truth, 1), world);
    }
    if (ended != bridge::Outcome::kNone) break;
    if (turn) {
      link.send_telemetry();
      if (!companion.step(t)) break;
    }
    autopilot.step();
  }
  complete(result, companion.summary(), ended, max_speed, options.flight_observers);
  return result;
}

}  // namespace jink::sim
