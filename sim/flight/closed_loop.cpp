// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "config/solids.hpp"
#include "sim/faults/fault_timeline.hpp"
#include "sim/faults/vehicle_faults.hpp"
#include "sim/flight/closed_loop_judge.hpp"
#include "sim/flight/team_link.hpp"
#include "sim/flight/virtual_clouds.hpp"
#include "sim/flight/virtual_transport.hpp"
#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::flight {
namespace {

constexpr double kGroundBelow = 1000.0;  // m
constexpr double kAllRound_deg = 340.0;  // of a scan, from which on it does not matter where a vehicle looks

}  // namespace

config::Mission mission_of(const config::Scenario& scenario, std::size_t vehicle) {
  const config::ScenarioVehicle own = config::all_vehicles(scenario).at(vehicle);
  config::Mission mission;
  mission.name = scenario.name;
  mission.connection = "virtual time";
  mission.vehicle_name = own.vehicle_name;
  mission.vehicle = own.vehicle;
  mission.waypoints = {own.target};
  mission.arrival = config::Arrival::kHold;
  mission.geofence = scenario.world.value_or(planner::base::Box{});
  if (const auto& scan = scenario.sensing.scan) {  // the map is there to be seen
    mission.cloud.emplace();
    mission.cloud->range = scan->range;
    mission.cloud->unknown = scan->unknown;
    mission.cloud->all_round = scan->horizontal_deg > kAllRound_deg;
  } else {
    mission.map = config::make_map(scenario.map);
  }
  mission.min_height = scenario.world ? scenario.world->min.z() : std::min({0.0, own.start.z(), own.target.z()});
  mission.acceptance_radius = scenario.acceptance_radius;
  mission.hold_time = scenario.hold_time;
  mission.time_limit = scenario.time_limit;
  mission.tracks.sensed_from = scenario.sensing.sensed_from;
  mission.intents = !scenario.vehicles.empty();
  return mission;
}

config::Mission mission_of(const config::Scenario& scenario) {
  return mission_of(scenario, 0);
}

namespace {

vehicle::AutopilotOptions vehicle_of(const config::Scenario& scenario, std::uint64_t seed, std::size_t number) {
  const config::ScenarioVehicle own = config::all_vehicles(scenario).at(number);
  vehicle::AutopilotOptions vehicle;
  vehicle.system_id = 1 + static_cast<int>(number);
  vehicle.limits = own.vehicle;
  vehicle.position = own.start;
  vehicle.airborne = true;
  // The flight begins in the air wherever the start is, so the ground is out of reach; the world's floor is judged
  // apart.
  vehicle.ground_height = std::min({0.0, own.start.z(), own.target.z()}) - kGroundBelow;
  vehicle.ready_delay = 0.0;
  vehicle.cascade.max_descent = own.vehicle.max_climb;
  faults::set_conditions(scenario, seed, static_cast<int>(number), vehicle);
  return vehicle;
}

std::unique_ptr<bridge::companion::PlannerTask> make_planner(const config::Settings& settings,
                                                             const ClosedLoopOptions& options) {
  const bridge::companion::PlannerTaskSettings task{settings.horizon, settings.optimizer, options.seed,
                                                    options.threads};
  const double latency = 1e-3 * settings.companion.planner_latency_ms;
  if (options.planner) return options.planner(task, latency);
  return std::make_unique<bridge::companion::VirtualPlanner>(task, latency);
}

/// One vehicle with all that flies it.
struct Member {
  Member(std::size_t number, const world::World& world, const faults::FaultTimeline& timeline,
         const config::Settings& settings, const ClosedLoopOptions& options, bridge::team::IntentTransport* intents)
      : autopilot(vehicle_of(world.scenario(), options.seed, number)),
        link(autopilot, options.seed),
        tracks(world, timeline, options.seed),
        clouds(clouds_of(number, world, options)),
        planner(make_planner(settings, options)),
        companion(mission_of(world.scenario(), number), settings,
                  {link, tracks, *planner, observers_of(number, options), nullptr, intents, clouds.get()}) {}

  /// The flight observers are told of the first vehicle's companion.
  static std::vector<bridge::companion::FlightObserver*> observers_of(std::size_t number,
                                                                      const ClosedLoopOptions& options) {
    return number == 0 ? options.flight_observers : std::vector<bridge::companion::FlightObserver*>{};
  }
  static std::unique_ptr<VirtualClouds> clouds_of(std::size_t number, const world::World& world,
                                                  const ClosedLoopOptions& options) {
    std::unique_ptr<VirtualClouds> clouds;
    if (world.scenario().sensing.scan) clouds = std::make_unique<VirtualClouds>(world, options.seed, number);
    return clouds;
  }
  [[nodiscard]] world::VehicleTruth truth() const {
    return {autopilot.true_motion().position, autopilot.true_motion().velocity};
  }

  vehicle::Autopilot autopilot;
  VirtualLink link;
  VirtualTracks tracks;
  std::unique_ptr<VirtualClouds> clouds;  // null: nothing is scanned
  std::unique_ptr<bridge::companion::PlannerTask> planner;
  bridge::companion::Companion companion;
  bool over = false;  ///< its companion is done; it hangs where that left it
};

/// A scenario's vehicles in flight.
class Flight {
 public:
  Flight(world::World& world, const config::Settings& settings, const ClosedLoopOptions& options)
      : world_(world),
        options_(options),
        timeline_(world.scenario().faults),
        intents_(TeamLinkOptions{.seed = options.seed}),
        judge_(world),
        steps_per_turn_(std::max(1, static_cast<int>(std::lround(
                                        1.0 / (settings.companion.setpoint_rate_hz * vehicle::VehicleModel::kStep))))) {
    const std::size_t count = 1 + world.scenario().vehicles.size();
    for (std::size_t k = 0; k < count; ++k) {
      bridge::team::IntentTransport* intents = count > 1 ? &intents_.join() : nullptr;
      members_.push_back(std::make_unique<Member>(k, world, timeline_, settings, options, intents));
    }
  }

  ClosedLoopResult fly() {
    for (int step = 0; go_on(step); ++step) {
      for (const auto& member : members_) member->autopilot.step();
    }
    return result();
  }

 private:
  /// What happens at the present instant. False: the flight is over.
  bool go_on(int step) {
    const double t = members_.front()->autopilot.time();
    const bool turn = step % steps_per_turn_ == 0;
    befall(t);
    intents_.advance(t);
    std::vector<world::VehicleTruth> truths;
    for (const auto& member : members_) {
      member->link.advance(t);
      truths.push_back(member->truth());
    }
    world_.advance(t, truths);
    const bool ended = judge_.watch(t, truths);
    for (const auto& member : members_)
      if (member->clouds) member->clouds->advance(t, member->autopilot);
    for (const auto& member : members_) member->tracks.advance(t, truths, faults::estimate_error(member->autopilot));
    if (turn || ended) {
      for (world::TruthObserver* observer : options_.truth_observers) observer->on_truth(t, truths, world_);
    }
    if (ended) return false;
    return !turn || turn_companions(t);
  }

  bool turn_companions(double t) {
    const bool interrupted = options_.interrupted && options_.interrupted();
    bool going = false;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      Member& member = *members_[k];
      if (member.over) continue;
      member.link.send_telemetry();
      if (interrupted) member.companion.interrupt(t);
      member.over = !member.companion.step(t);
      if (member.over || member.companion.supervisor().arrived()) judge_.close(k);
      going = going || !member.over;
    }
    return going;
  }

  /// What the timeline does at `t`, with an event for each change.
  void befall(double t) {
    const std::vector<faults::FaultChange> changes = timeline_.advance(t);
    for (const faults::FaultChange& change : changes) {
      for (std::size_t k = 0; k < members_.size(); ++k) befall(change, k);
      for (bridge::companion::FlightObserver* observer : options_.flight_observers)
        observer->on_event(t, "fault", timeline_.describe(change));
    }
    if (changes.empty()) return;
    for (std::size_t k = 0; k < members_.size(); ++k) members_[k]->link.impair(timeline_.link(static_cast<int>(k)));
  }

  void befall(const faults::FaultChange& change, std::size_t number) {
    Member& member = *members_[number];
    vehicle::Autopilot& autopilot = member.autopilot;
    const auto resets = autopilot.estimator().reset_counter();
    const int reboots = autopilot.reboots();
    const Vec3 before = autopilot.estimated_motion().position;
    faults::apply(timeline_, change, static_cast<int>(number), autopilot);
    if (autopilot.reboots() == reboots && autopilot.estimator().reset_counter() != resets)
      member.link.note_reset(autopilot.estimated_motion().position - before);
  }

  ClosedLoopResult result() {
    std::vector<bridge::companion::FlightSummary> seen;
    for (const auto& member : members_) seen.push_back(member->companion.summary());
    ClosedLoopResult result = judge_.result(std::move(seen));
    if (!judge_.ended()) return result;
    for (bridge::companion::FlightObserver* observer : options_.flight_observers)
      observer->on_event(judge_.time(), bridge::supervisor::to_string(result.flight.outcome), result.flight.reason);
    return result;
  }

  world::World& world_;
  const ClosedLoopOptions& options_;
  faults::FaultTimeline timeline_;
  TeamLink intents_;
  ClosedLoopJudge judge_;
  std::vector<std::unique_ptr<Member>> members_;  // a link refers to its autopilot, which must not move
  int steps_per_turn_;
};

}  // namespace

ClosedLoopResult fly_closed_loop(const config::Scenario& scenario, const config::Settings& settings,
                                 const ClosedLoopOptions& options) {
  world::World world(scenario);
  if (std::optional<ClosedLoopResult> blocked = ClosedLoopJudge(world).start_blocked()) return *std::move(blocked);
  return Flight(world, settings, options).fly();
}

}  // namespace jink::sim::flight
