// SPDX-License-Identifier: BSD-3-Clause
// What an INS/GNSS filter gets wrong: the errors of PX4's EKF2 on the sensors of its built-in simulator (SIH).
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "planner/base/random.hpp"
#include "sim/vehicle/vehicle_model.hpp"

namespace jink::sim::vehicle {

/// The error state of an extended Kalman filter, propagated with the filter's own linearised equations and corrected
/// with the filter's own gains, while the noise is what the sensors really have. So the errors of position, velocity
/// and attitude depend on each other, on the manoeuvre and on time as the real filter's do: a tilt that is wrong by a
/// degree is an acceleration that is wrong by 0.17 m/s^2, and the velocity follows it for seconds.
///
/// Figures: PX4 1.17, the defaults of EKF2_* for what the filter assumes; sih.cpp, SensorGpsSim.cpp, SensorBaroSim.cpp
/// and SensorMagSim.cpp for the sensors. Not modelled: the delayed fusion horizon, innovation gates, wind, airspeed,
/// magnetic field states (the heading is measured directly), errors of scale and alignment. The same seed gives the
/// same errors. Not thread-safe; step() does not allocate.
class InsErrors {
 public:
  /// What the sensors meet besides the motion.
  struct Surroundings {
    bool at_rest = false;  ///< stands, motors off: little vibration, and the filter knows that its velocity is zero
    bool gnss = true;
    double height = 0.0;  ///< m above the ground, for the rangefinder
  };

  /// Begins standing with no error but that of the first fix. `airborne`: as after half a minute of hover.
  InsErrors(std::uint64_t seed, const Motion& truth, bool airborne);

  /// Advances by VehicleModel::kStep to the motion `truth`.
  void step(const Motion& truth, const Surroundings& surroundings);
  /// Takes position and velocity from the next fix, as the filter does when GNSS is back after a long time.
  void reset();

  /// Estimate less truth: m and m/s, ENU, and the rotation vector (rad, ENU) from the true to the estimated attitude.
  [[nodiscard]] Vec3 position() const { return error_.segment<3>(kPosition); }
  [[nodiscard]] Vec3 velocity() const { return error_.segment<3>(kVelocity); }
  [[nodiscard]] Vec3 attitude() const { return error_.segment<3>(kAttitude); }
  /// m, what the filter believes its error to be: MAVLink's eph and epv, ESTIMATOR_STATUS.
  [[nodiscard]] double horizontal_accuracy() const;
  [[nodiscard]] double vertical_accuracy() const;

 private:
  static constexpr double kStep = VehicleModel::kStep;

  /// Where each part of the error state begins; the biases are the filter's estimates of what is truly zero.
  enum Index {
    kPosition = 0,
    kVelocity = 3,
    kAttitude = 6,
    kGyroBias = 9,
    kAccelBias = 12,
    kBaroBias = 15,
    kSize = 16
  };

  void propagate(const Motion& truth, bool at_rest);
  void propagate_covariance(const Motion& truth);
  void fuse_gnss();
  void fuse_height(const Surroundings& surroundings, double speed);
  /// Fuses a measurement of the states at `index` and, unless negative, `other`, less `offset`.
  void fuse(int index, double assumed_sigma, double true_sigma, int other = -1, double offset = 0.0);

  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  planner::base::RandomStream random_;
  Eigen::Matrix<double, kSize, 1> error_ = Eigen::Matrix<double, kSize, 1>::Zero();
  Covariance covariance_ = Covariance::Zero();
  std::int64_t steps_ = 0;
  double terrain_ = 0.0;  ///< m, error of the height of the ground while the rangefinder is used
  bool uses_rangefinder_ = false;
};

}  // namespace jink::sim::vehicle
