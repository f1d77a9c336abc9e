// SPDX-License-Identifier: BSD-3-Clause
// The simulator in one thing to step: world, sensing, and the vehicles with their MAVLink endpoints. What it tells of
// obstacles goes to whoever gives `publish`: it knows no DDS, no terminal and no wall clock.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "config/scenario.hpp"
#include "sim/faults/fault_timeline.hpp"
#include "sim/faults/track_faults.hpp"
#include "sim/flight/simulator_judge.hpp"
#include "sim/mavlink/endpoint.hpp"
#include "sim/vehicle/autopilot.hpp"
#include "sim/world/sensing.hpp"
#include "sim/world/truth_observer.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::simulator {

class SimulatorObserver : public world::TruthObserver {
 public:
  /// Something that a person wants to read, at scenario time `t`.
  virtual void on_event(double t, std::string_view name, const std::string& detail) = 0;
};

struct SimulatorOptions {
  std::uint64_t seed = 1;
  int instance = 0;              ///< vehicle k is MAVLink instance `instance` + k
  bool vehicles = true;          ///< false: the obstacles alone, and their clock runs at once
  bool immediate_clock = false;  ///< does not wait for the vehicles
  vehicle::Px4Version px4 = vehicle::Px4Version::k1_17;
  double clock_rate = 1.0;  ///< as EndpointOptions::clock_rate, where the instances are its own
  std::vector<mavlink::EndpointOptions>
      endpoints{};  ///< one for each vehicle, in place of the instances'; empty: those
};

struct SimulatorParts {
  /// Takes a track message that is due at `now`, in the simulator's time; false: it could not be published. None:
  /// nobody is told of the obstacles.
  std::function<bool(const world::TrackMessage&, double now)> publish{};
  std::vector<SimulatorObserver*> observers{};
  /// Before each step of vehicle k's autopilot, at `now`: for other links than MAVLink.
  std::function<void(std::size_t k, double now, vehicle::Autopilot&)> on_step{};
};

/// The vehicles stand on the ground below their starts. The obstacles stand at their t = 0 positions until every
/// vehicle has been within 0.5 m of its start in OFFBOARD, in truth or by its own estimate, which is what its companion
/// can fly by; then the scenario's clock runs. A collision stops the motors of the vehicles involved. The scenario's
/// faults happen to them, their companions' links and the tracks; each beginning and end is an event. All vehicles
/// share the scenario's origin, as a place on earth too. Not thread-safe.
class Simulator {
 public:
  static constexpr double kAtStart = 0.5;  ///< m, from the start, in OFFBOARD: ready for the clock

  /// The scenario as load_scenario checks it. Throws what MavlinkEndpoint throws: a port taken, an instance beyond 9.
  Simulator(const config::Scenario& scenario, const SimulatorOptions& options, SimulatorParts parts);

  /// One step of VehicleModel::kStep: what has arrived is handled, what is due is sent, then the vehicles move.
  void step();

  /// Takes what has arrived since, without time going on; for lockstep.
  void poll();
  /// For lockstep: the companions whose vehicles are in OFFBOARD owe a setpoint from now on.
  void begin_turn();
  /// Each of them has sent one since, or was given up and has not sent since that either.
  [[nodiscard]] bool answered() const;
  /// Whoever still owes one is not waited for until it sends again. Returns how many that is, with an event for each.
  int give_up();

  /// Time since the start of the step made last.
  [[nodiscard]] double now() const { return now_; }
  [[nodiscard]] bool clock_runs() const { return clock_start_.has_value(); }
  [[nodiscard]] double scenario_time() const { return scenario_time(now_); }
  [[nodiscard]] const world::World& world() const { return world_; }
  [[nodiscard]] std::size_t vehicle_count() const { return vehicles_.size(); }
  [[nodiscard]] const config::ScenarioVehicle& vehicle(std::size_t k) const { return vehicles_[k].spec; }
  [[nodiscard]] const vehicle::Autopilot& autopilot(std::size_t k) const { return vehicles_[k].autopilot; }
  [[nodiscard]] const mavlink::MavlinkEndpoint& endpoint(std::size_t k) const { return *vehicles_[k].endpoint; }
  /// What became of each vehicle so far; `aborted` with a reason for one that has not come to its target.
  [[nodiscard]] std::vector<flight::VehicleReport> reports() const;
  /// A vehicle hit something or left the world.
  [[nodiscard]] bool failed() const;

 private:
  struct Vehicle {
    Vehicle(const config::ScenarioVehicle& what, const vehicle::AutopilotOptions& how,
            const mavlink::EndpointOptions& where);
    config::ScenarioVehicle spec;
    vehicle::Autopilot autopilot;
    std::unique_ptr<mavlink::MavlinkEndpoint> endpoint;
    bool was_at_start = false;
    std::optional<double> away_from;  ///< when it was first in OFFBOARD in the air, before it was at its start
    bool away_said = false;
    std::uint64_t setpoints_before = 0;  ///< those that had come when the turn began
    bool given_up = false;

    [[nodiscard]] bool owes_setpoint() const;
  };

  [[nodiscard]] double scenario_time(double now) const;
  [[nodiscard]] std::vector<Vec3> positions() const;
  [[nodiscard]] std::vector<world::VehicleTruth> truth() const;
  [[nodiscard]] std::string named(int vehicle, const std::string& text) const;
  void emit_event(std::string_view name, const std::string& text);
  void add_vehicles(const std::vector<config::ScenarioVehicle>& specs);
  void start_clock();
  void watch_clock();
  void watch_faults();
  void judge();
  void publish();
  void tell_truth();

  SimulatorOptions options_;
  SimulatorParts parts_;
  world::World world_;
  world::SensingPipeline sensing_;
  faults::FaultTimeline timeline_;
  faults::TrackFaults track_faults_;
  std::vector<Vehicle> vehicles_;
  std::optional<flight::SimulatorJudge> judge_;
  std::optional<double> clock_start_;
  std::int64_t steps_ = 0;
  double now_ = 0.0;
};

}  // namespace jink::sim::simulator
