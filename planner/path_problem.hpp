// SPDX-License-Identifier: BSD-3-Clause
// The remaining path at once: K waypoints, each a place and a time, and the motion that follows from them.
#pragma once

#include <span>
#include <vector>

#include "planner/geometry.hpp"
#include "planner/problem.hpp"
#include "planner/settings.hpp"
#include "planner/trajectory.hpp"
#include "planner/types.hpp"

namespace jink::planner {

/// What a horizon plan starts from. Everything is valid at path time 0, tracks too.
struct PathRequest {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  Box volume;
  VehicleLimits vehicle;
  std::span<const Track> tracks;
  double margin = 0.0;                    ///< kept from every obstacle on top of the radii
  double track_acceleration = 0.0;        ///< what a track's acceleration may be off by, m/s²
  double acceleration_trust = kInfinity;  ///< as in predict_position
};

/// Decision variables: for each of K waypoints at times k·T/K three numbers in [-1, 1], its offset from where
/// undisturbed flight (straight on, at cruise speed, braking for the target) would be then: along the path frame's axis
/// (behind, or waiting, below 0; ahead, above), left, and up. Between waypoints the offset changes evenly. The vehicle
/// follows with bounded speed, climb and acceleration, so whatever the variables are, the motion is flyable at every
/// instant; with all of them 0 it is undisturbed flight.
///
/// f1: length flown in the horizon plus the straight rest (Eq. (2) over the whole path) plus the time lost against
/// undisturbed flight, as length at cruise speed, plus a share of the mean distance from it, so that of equal paths the
/// one at cruise speed wins. f2: sum of the steering angles between the legs (Eq. (3)), rad. f3: how deep, how long and
/// how soon the path dips into the clearance that the tracks' uncertainty asks for. Violation: the same for the hard
/// margin, and for leaving the volume.
class PathProblem final : public Problem {
 public:
  /// Throws std::invalid_argument for no waypoint, a step or time that is not positive, or more than 256 steps.
  explicit PathProblem(const HorizonSettings& settings);

  /// Prepares a plan: the frame, undisturbed flight, and at every step of the horizon the obstacles that can be met.
  /// O(tracks · steps).
  void prepare(const PathRequest& request);

  [[nodiscard]] int dimension() const override { return 3 * settings_.waypoints; }
  [[nodiscard]] int objectives() const override { return 3; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override;

  /// The motion of one solution, on to the target and at rest there: one point for each step.
  [[nodiscard]] TimedPath motion(std::span<const double> x) const;
  /// Objectives and violation of any path that starts at time 0, measured like those of a solution.
  [[nodiscard]] Cost cost_of(const TimedPath& path) const;

  /// Variables whose waypoints lie on a path, as near as the box allows: the warm start.
  void imitate(const TimedPath& path, std::span<double> x) const;
  /// Variables of a manoeuvre: `share` in [-1, 1] of the way ahead (or back), and metres left and up of the straight
  /// line, kept for two thirds of the horizon.
  void manoeuvre(double share, double left, double up, std::span<double> x) const;

  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] double horizon() const { return steps_ * settings_.step; }
  /// How many obstacles can be met within the horizon.
  [[nodiscard]] std::size_t obstacles() const { return kept_; }

 private:
  static constexpr int kMaxSteps = 256;

  struct Flight {
    Vec3 position, velocity;
  };
  [[nodiscard]] Vec3 undisturbed(int step) const {
    return frame_.origin + undisturbed_[static_cast<std::size_t>(step)] * frame_.axis;
  }
  [[nodiscard]] Vec3 offset(std::span<const double> x, int k) const;
  /// Calls visit(step, flight) with the motion's state at the end of each step of the horizon.
  template <typename Visit>
  void fly(std::span<const double> x, const Visit& visit) const;
  void advance(Flight& flight, const Vec3& wish) const;
  void undisturbed_flight();
  void predict_obstacles();
  void fly_to_target(TimedPath& path, Flight flight) const;
  [[nodiscard]] double straight_rest(const Vec3& before, const Vec3& end) const;
  [[nodiscard]] Cost cost_of_positions(std::span<const Vec3> positions) const;
  void add_obstacles(int step, const Vec3& from, const Vec3& to, Cost& cost) const;

  HorizonSettings settings_;
  PathRequest request_;
  PathFrame frame_;
  int steps_per_leg_;
  int steps_;
  std::vector<double> lower_, upper_;
  std::vector<double> speed_;                   // along the axis after each step
  double cruise_ = 0.0;                         // along the axis, the climb limit considered
  std::vector<double> undisturbed_;             // distance along the axis after each step
  std::vector<double> ahead_, behind_, aside_;  // how far a variable of ±1 reaches at each waypoint, m
  double undisturbed_time_ = 0.0;               // to the target
  std::size_t kept_ = 0;
  // A row of kept_ values for each instant: positions, and the distances of hard and of wished clearance.
  std::vector<double> x_, y_, z_, hard_, soft_;
};

}  // namespace jink::planner
