// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot believes of its motion: the truth with the errors of a satellite-aided estimate.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/vehicle/gauss_markov.hpp"
#include "sim/vehicle/ins_errors.hpp"
#include "sim/vehicle/vehicle_model.hpp"

namespace jink::sim::vehicle {

/// What the estimate gets wrong. The figures are standard deviations per axis, on top of the filter's errors. The
/// noises are not white, as a filter's output is not: they die down within 1.5 s.
struct EstimateErrors {
  bool ins = false;             ///< errs as PX4's filter does (InsErrors), in attitude too
  double position_noise = 0.0;  ///< m
  double velocity_noise = 0.0;  ///< m/s
  double drift = 0.0;           ///< m, of the slow wander of the position
  double drift_time = 20.0;     ///< s, over which it dies down to 1/e
};

/// Not thread-safe. The same seed gives the same errors.
class Estimator {
 public:
  /// Throws std::invalid_argument for errors that are negative or not finite.
  Estimator(const EstimateErrors& errors, std::uint64_t seed, const Motion& truth, bool airborne = true);

  /// Advances by VehicleModel::kStep to the motion `truth`. Without GPS for longer than `timeout` (s) the horizontal
  /// position is no longer valid. `at_rest` and `height` (m above the ground) as for InsErrors.
  void step(const Motion& truth, double timeout, bool at_rest = false, double height = planner::base::kInfinity);
  /// Cuts and restores satellite navigation. Away, the horizontal velocity is dead reckoning and its error walks; back
  /// within the time-out the error dies down, later the position is reset.
  void set_gps(bool available);
  /// Moves the estimate at once, for good; counts as a reset. `by` is finite.
  void jump(const Vec3& by);
  /// A restart: the local frame begins at `origin` (in the simulation's), and the errors so far are forgotten.
  void restart(const Vec3& origin, const Motion& truth);

  /// In the autopilot's local frame.
  [[nodiscard]] const Motion& motion() const { return motion_; }
  /// The local frame's origin in the simulation's frame: zero until a restart.
  [[nodiscard]] const Vec3& origin() const { return origin_; }
  /// rad, the rotation vector from the true to the estimated attitude, ENU.
  [[nodiscard]] Vec3 attitude_error() const { return ins_ ? ins_->attitude() : Vec3::Zero().eval(); }
  /// The motion is the truth, bit by bit.
  [[nodiscard]] bool exact() const { return exact_; }
  [[nodiscard]] bool gps() const { return gps_; }
  [[nodiscard]] bool position_valid() const { return valid_; }
  /// Goes up by one, and around, whenever the estimate jumps.
  [[nodiscard]] std::uint8_t reset_counter() const { return resets_; }
  /// m, what the filter reckons its errors to be.
  [[nodiscard]] double horizontal_accuracy() const;
  [[nodiscard]] double vertical_accuracy() const;

 private:
  static constexpr double kStep = VehicleModel::kStep;

  void reckon();
  void update(const Motion& truth);

  std::optional<InsErrors> ins_;
  GaussMarkov position_noise_;
  GaussMarkov velocity_noise_;
  GaussMarkov drift_;
  planner::base::RandomStream walk_;
  Motion motion_;
  Vec3 origin_ = Vec3::Zero();
  Vec3 jumped_ = Vec3::Zero();
  Vec3 reckoned_position_ = Vec3::Zero();  ///< errors of dead reckoning
  Vec3 reckoned_velocity_ = Vec3::Zero();
  double accuracy_;    ///< m, standard deviation per axis, of what errs besides
  double away_ = 0.0;  ///< s without GPS
  std::uint8_t resets_ = 0;
  bool exact_;
  bool gps_ = true;
  bool valid_ = true;
};

}  // namespace jink::sim::vehicle
