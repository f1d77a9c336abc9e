// SPDX-License-Identifier: BSD-3-Clause
// What the true motion of a simulation's vehicles means: hit, left, reached. For the simulator in real time; in virtual
// time, where flights begin in the air and end with the companions, it is sim/flight/closed_loop_judge.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "config/scenario.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::flight {

/// One vehicle at the end of a step.
struct JudgedVehicle {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  bool offboard = false;  ///< armed and in OFFBOARD: only then is leaving the world its companion's failure
};

/// What was judged just now.
struct Verdict {
  int vehicle = 0;
  bridge::supervisor::Outcome outcome = bridge::supervisor::Outcome::kNone;
  std::string reason;
};

/// What became of one vehicle.
struct VehicleReport {
  bridge::companion::FlightSummary flight;          ///< times and lengths are those since the scenario's clock started
  double min_clearance = planner::base::kInfinity;  ///< to any obstacle or other vehicle, before and after that too
  /// It hit something or left the world.
  [[nodiscard]] bool failed() const {
    return flight.outcome == bridge::supervisor::Outcome::kCollision ||
           flight.outcome == bridge::supervisor::Outcome::kLeftWorld;
  }
};

/// Judges from step to step, in continuous time: vehicles go straight between two steps. Not thread-safe.
class SimulatorJudge {
 public:
  static constexpr double kAtTarget = 0.5;  ///< m, from the target: reached

  /// `vehicles` begin at `positions`, one each. The world outlives the judge.
  SimulatorJudge(const world::World& world, std::vector<config::ScenarioVehicle> vehicles,
                 std::span<const Vec3> positions);

  /// The motion up to scenario time `t`, which stands while the clock does not run. Each vehicle is told of once: hit
  /// (obstacle or vehicle, also after it reached its target), left, or reached. Only hits count while the clock stands.
  std::vector<Verdict> watch(double t, bool clock_runs, std::span<const JudgedVehicle> now);

  /// By vehicle number.
  [[nodiscard]] const std::vector<VehicleReport>& reports() const { return reports_; }

 private:
  void judge_collisions(double t, std::span<const JudgedVehicle> now, std::vector<Verdict>& verdicts);
  void judge_obstacles(std::size_t k, double t, const Vec3& to, std::vector<Verdict>& verdicts);
  void judge_pair(std::size_t a, std::size_t b, double t, std::span<const JudgedVehicle> now,
                  std::vector<Verdict>& verdicts);
  void judge_progress(std::size_t k, double t, const JudgedVehicle& now, std::vector<Verdict>& verdicts);
  void hit(std::size_t k, const std::string& what, double t, std::vector<Verdict>& verdicts);
  void decide(std::size_t k, bridge::supervisor::Outcome outcome, std::string reason, std::vector<Verdict>& verdicts);

  const world::World& world_;
  std::vector<config::ScenarioVehicle> vehicles_;
  std::vector<Vec3> last_;
  double last_t_ = 0.0;
  std::vector<VehicleReport> reports_;
};

/// The worst of several outcomes: collision, left world, then anything that is not reached, then reached. Empty: none.
[[nodiscard]] bridge::supervisor::Outcome worst(std::span<const VehicleReport> reports);

}  // namespace jink::sim::flight
