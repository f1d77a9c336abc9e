// SPDX-License-Identifier: BSD-3-Clause
// One obstacle's motion out of noisy measurements of its position and velocity.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// An interacting multiple model estimator (Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and
/// Navigation", 2001, section 11.6.6) of four models: one that flies straight, one whose velocity wanders, one whose
/// velocity is another at once, as of who stops or turns on the spot, and one whose acceleration wanders. The axes are
/// independent and measured alike, so they share their covariances. What is so far off all models that noise cannot
/// explain it, as after a bounce, begins anew from the measurement. Not thread-safe.
class ImmFilter {
 public:
  /// Takes in a measurement, `dt` seconds after the one before, with standard deviations per axis. `measured` gives
  /// position, velocity and their sigmas, one of which may be 0 and then counts as a centimetre (per second).
  void update(double dt, const planner::base::Track& measured);

  /// The estimate at the instant of the newest measurement in place of that: position, velocity, acceleration and the
  /// sigmas. The acceleration is that of a turn, across the velocity, the less of it the less sure it is (by the shares
  /// of its square and its variance): to go on at a speed that changes foresaw real people and drones worse. No sigma
  /// falls below kLeastShare of the measured one: what a writer reports may be filtered already.
  void apply(planner::base::Track& track) const;

  static constexpr double kLeastShare = 0.17;

 private:
  using Matrix3 = Eigen::Matrix3d;
  static constexpr std::size_t kModels = 4;
  struct Model {
    Matrix3 state = Matrix3::Zero();       ///< rows: position, velocity, acceleration; a column per axis
    Matrix3 covariance = Matrix3::Zero();  ///< of position, velocity and acceleration, for each axis
    double probability = 0.0;
  };
  struct Noise {
    double position_variance = 0.0, velocity_variance = 0.0;
  };

  void begin(const planner::base::Track& measured, const Noise& noise);
  void mix(double dt);
  /// The log-likelihood of the measurement and its squared Mahalanobis distance, of six degrees of freedom.
  struct Fit {
    double log_likelihood = 0.0, distance = 0.0;
  };
  Fit correct(Model& model, const planner::base::Track& measured, const Noise& noise) const;

  std::array<Model, kModels> models_;  // straight, wandering, sudden, turning
  bool begun_ = false;
};

}  // namespace jink::bridge::prediction
