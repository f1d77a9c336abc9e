// SPDX-License-Identifier: BSD-3-Clause
// Judges a flight in virtual time, of one vehicle or several: from the air at the starts until all are done or one has
// failed. For sim/flight/closed_loop alone; the simulator in real time has sim/flight/simulator_judge.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "sim/flight/closed_loop.hpp"
#include "sim/world/truth_observer.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::flight {

/// Vehicles go straight between two steps; contacts are found in continuous time. Not thread-safe.
class ClosedLoopJudge {
 public:
  /// The world outlives it.
  explicit ClosedLoopJudge(const world::World& world);

  /// The result of a flight that cannot begin, as a vehicle overlaps an obstacle or another one at its start.
  [[nodiscard]] std::optional<ClosedLoopResult> start_blocked() const;

  /// The motion up to `t`, by number. True: a vehicle has hit something or left the world, which ends the flight.
  bool watch(double t, std::span<const world::VehicleTruth> now);
  /// That vehicle has been at its target, or is done: what it flies from now on does not count, but what it hits does.
  void close(std::size_t vehicle) { closed_[vehicle] = true; }

  /// Whether watch() has ended the flight, and the time that it was last told.
  [[nodiscard]] bool ended() const;
  [[nodiscard]] double time() const { return last_t_; }

  /// What became of all, from what each companion saw.
  [[nodiscard]] ClosedLoopResult result(std::vector<bridge::companion::FlightSummary> seen) const;

 private:
  void watch_obstacles(std::size_t k, double t, const Vec3& to);
  void watch_pair(std::size_t a, std::size_t b, double t, std::span<const world::VehicleTruth> now);
  void fail(std::size_t k, bridge::supervisor::Outcome outcome, const std::string& reason);

  const world::World& world_;
  std::vector<config::ScenarioVehicle> vehicles_;
  std::vector<VehicleReport> reports_;
  std::vector<bool> closed_;
  std::vector<Vec3> last_;
  double last_t_ = 0.0;
};

}  // namespace jink::sim::flight
