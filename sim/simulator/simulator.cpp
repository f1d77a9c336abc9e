// SPDX-License-Identifier: BSD-3-Clause
#include "sim/simulator/simulator.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "sim/faults/vehicle_faults.hpp"

namespace jink::sim::simulator {
namespace {

constexpr double kPatience = 15.0;       // s, that a flight takes to its start without a word
constexpr std::int64_t kTruthSteps = 5;  // of 4 ms, between truth records: 50 Hz

}  // namespace

Simulator::Vehicle::Vehicle(const config::ScenarioVehicle& what, const vehicle::AutopilotOptions& how,
                            const mavlink::EndpointOptions& where)
    : spec(what), autopilot(how), endpoint(std::make_unique<mavlink::MavlinkEndpoint>(autopilot, where)) {}

Simulator::Simulator(const config::Scenario& scenario, const SimulatorOptions& options, SimulatorParts parts)
    : options_(options),
      parts_(std::move(parts)),
      world_(scenario),
      sensing_(scenario.sensing, options.seed),
      timeline_(scenario.faults),
      track_faults_(options.seed) {
  if (options_.vehicles) add_vehicles(config::all_vehicles(scenario));
  const auto& faults = scenario.faults;
  if (vehicles_.empty() && std::any_of(faults.begin(), faults.end(), [](const auto& f) { return f.of_vehicle(); }))
    emit_event("fault", "no vehicle here: the faults that befall one have no effect");
  if (vehicles_.empty() || options_.immediate_clock) start_clock();
}

void Simulator::add_vehicles(const std::vector<config::ScenarioVehicle>& specs) {
  double ground = 0.0;
  for (const config::ScenarioVehicle& spec : specs) ground = std::min(ground, spec.start.z());
  vehicles_.reserve(specs.size());  // an endpoint refers to its autopilot, which must not move
  for (std::size_t k = 0; k < specs.size(); ++k) {
    vehicle::AutopilotOptions vehicle;
    vehicle.limits = specs[k].vehicle;
    vehicle.ground_height = ground;
    vehicle.position = {specs[k].start.x(), specs[k].start.y(), ground};
    vehicle.cascade.max_descent = specs[k].vehicle.max_climb;
    faults::set_conditions(world_.scenario(), options_.seed, static_cast<int>(k), vehicle);
    mavlink::EndpointOptions endpoint;
    endpoint.instance = options_.instance + static_cast<int>(k);
    endpoint.clock_rate = options_.clock_rate;
    if (!options_.endpoints.empty()) endpoint = options_.endpoints.at(k);
    endpoint.seed = options_.seed;
    vehicle.system_id = endpoint.instance + 1;
    vehicle.version = options_.px4;
    vehicles_.emplace_back(specs[k], vehicle, endpoint);
  }
  judge_.emplace(world_, specs, positions());
}

void Simulator::step() {
  now_ = static_cast<double>(steps_) * vehicle::VehicleModel::kStep;
  watch_faults();
  for (Vehicle& vehicle : vehicles_) vehicle.endpoint->poll(now_);
  watch_clock();
  if (clock_runs()) world_.advance(scenario_time(), truth());
  judge();
  publish();
  if (steps_ % kTruthSteps == 0) tell_truth();
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    if (parts_.on_step) parts_.on_step(k, now_, vehicles_[k].autopilot);
    vehicles_[k].autopilot.step();
  }
  ++steps_;
}

bool Simulator::Vehicle::owes_setpoint() const {
  return autopilot.offboard_active() && endpoint->counters().setpoints == setpoints_before;
}

void Simulator::poll() {
  for (Vehicle& vehicle : vehicles_) vehicle.endpoint->poll(now_);
}

void Simulator::begin_turn() {
  for (Vehicle& vehicle : vehicles_) {
    const std::uint64_t setpoints = vehicle.endpoint->counters().setpoints;
    if (setpoints != vehicle.setpoints_before) vehicle.given_up = false;
    vehicle.setpoints_before = setpoints;
  }
}

bool Simulator::answered() const {
  return std::none_of(vehicles_.begin(), vehicles_.end(),
                      [](const Vehicle& vehicle) { return vehicle.owes_setpoint() && !vehicle.given_up; });
}

int Simulator::give_up() {
  int count = 0;
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    if (!vehicles_[k].owes_setpoint() || vehicles_[k].given_up) continue;
    vehicles_[k].given_up = true;
    ++count;
    emit_event("lockstep",
               named(static_cast<int>(k), "no setpoint from the companion: not waited for until one comes"));
  }
  return count;
}

double Simulator::scenario_time(double now) const {
  return clock_start_ ? std::max(0.0, now - *clock_start_) : 0.0;
}

std::vector<Vec3> Simulator::positions() const {
  std::vector<Vec3> all;
  for (const Vehicle& vehicle : vehicles_) all.push_back(vehicle.autopilot.true_motion().position);
  return all;
}

std::string Simulator::named(int vehicle, const std::string& text) const {
  return vehicles_.size() > 1 ? "vehicle " + std::to_string(vehicle) + ": " + text : text;
}

void Simulator::emit_event(std::string_view name, const std::string& text) {
  for (SimulatorObserver* observer : parts_.observers) observer->on_event(scenario_time(), name, text);
}

void Simulator::start_clock() {
  clock_start_ = now_;
  emit_event("clock", "the scenario's clock runs, " + std::to_string(world_.obstacle_count()) + " obstacles move");
}

void Simulator::watch_clock() {
  if (clock_start_) return;
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    Vehicle& vehicle = vehicles_[k];
    const bool offboard = vehicle.autopilot.mode() == vehicle::FlightMode::kOffboard;
    const auto away = [&](const vehicle::Motion& motion) { return (motion.position - vehicle.spec.start).norm(); };
    const double nearest = std::min(away(vehicle.autopilot.true_motion()), away(vehicle.autopilot.estimated_motion()));
    if (offboard && nearest <= kAtStart) vehicle.was_at_start = true;
    if (!offboard || !vehicle.autopilot.armed() || vehicle.was_at_start || vehicle.away_said) continue;
    if (!vehicle.away_from) vehicle.away_from = now_;
    if (now_ - *vehicle.away_from < kPatience) continue;
    vehicle.away_said = true;
    emit_event("clock", named(static_cast<int>(k),
                              "flies, but has not been within 0.5 m of its start: until then all obstacles stand"));
  }
  if (std::all_of(vehicles_.begin(), vehicles_.end(), [](const Vehicle& v) { return v.was_at_start; })) start_clock();
}

void Simulator::watch_faults() {
  const std::vector<faults::FaultChange> changes = timeline_.advance(scenario_time());
  for (const faults::FaultChange& change : changes) {
    emit_event("fault", "fault: " + timeline_.describe(change));
    for (std::size_t k = 0; k < vehicles_.size(); ++k)
      faults::apply(timeline_, change, static_cast<int>(k), vehicles_[k].autopilot);
  }
  for (std::size_t k = 0; k < vehicles_.size() && !changes.empty(); ++k)
    vehicles_[k].endpoint->impair(timeline_.link(static_cast<int>(k)));
}

/// What the true motion since the last step means. A collision stops the motors, as it would.
void Simulator::judge() {
  if (!judge_) return;
  std::vector<flight::JudgedVehicle> now;
  for (const Vehicle& vehicle : vehicles_) {
    const vehicle::Motion& motion = vehicle.autopilot.true_motion();
    now.push_back({motion.position, motion.velocity, vehicle.autopilot.mode() == vehicle::FlightMode::kOffboard});
  }
  for (const flight::Verdict& verdict : judge_->watch(scenario_time(), clock_runs(), now)) {
    const std::string text = named(verdict.vehicle, verdict.reason);
    switch (verdict.outcome) {
      case bridge::supervisor::Outcome::kCollision:
        vehicles_[static_cast<std::size_t>(verdict.vehicle)].autopilot.crash();
        emit_event("collision", "COLLISION: " + text + "; the motors stop");
        break;
      case bridge::supervisor::Outcome::kLeftWorld:
        emit_event("left_world", "LEFT THE WORLD: " + text);
        break;
      default:
        emit_event("reached", text);
        break;
    }
  }
}

void Simulator::publish() {
  std::vector<Vec3> sensors = positions();
  if (sensors.empty()) sensors.push_back(world_.scenario().start);
  // One publisher for all: tracks sensed from the vehicle are those of a lone one.
  const world::EstimateError error =
      vehicles_.empty() ? world::EstimateError{} : faults::estimate_error(vehicles_.front().autopilot);
  sensing_.step(now_, world_, sensors, clock_start_.value_or(planner::base::kInfinity), error);
  world::TrackMessage message;
  while (sensing_.poll(now_, message)) {
    if (!track_faults_.apply(timeline_, world_, truth(), message)) continue;
    if (parts_.publish && !parts_.publish(message, now_)) {
      emit_event("publish_failed", "a track message could not be published");
    }
  }
}

std::vector<world::VehicleTruth> Simulator::truth() const {
  std::vector<world::VehicleTruth> all;
  for (const Vehicle& vehicle : vehicles_) {
    all.push_back({vehicle.autopilot.true_motion().position, vehicle.autopilot.true_motion().velocity});
  }
  return all;
}

void Simulator::tell_truth() {
  if (vehicles_.empty()) return;
  const std::vector<world::VehicleTruth> now = truth();
  for (SimulatorObserver* observer : parts_.observers) observer->on_truth(scenario_time(), now, world_);
}

std::vector<flight::VehicleReport> Simulator::reports() const {
  if (!judge_) return {};
  std::vector<flight::VehicleReport> reports = judge_->reports();
  for (std::size_t k = 0; k < reports.size(); ++k) {
    bridge::companion::FlightSummary& flight = reports[k].flight;
    if (flight.outcome != bridge::supervisor::Outcome::kNone) continue;
    flight.outcome = bridge::supervisor::Outcome::kAborted;
    flight.reason = clock_runs()                ? "ended before the target was reached"
                    : vehicles_[k].was_at_start ? "another vehicle never came to its start in OFFBOARD"
                                                : "the vehicle never came to the start in OFFBOARD";
  }
  return reports;
}

bool Simulator::failed() const {
  if (!judge_) return false;
  const auto& reports = judge_->reports();
  return std::any_of(reports.begin(), reports.end(), [](const flight::VehicleReport& r) { return r.failed(); });
}

}  // namespace jink::sim::simulator
