// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/ins_errors.hpp"

#include <cmath>

namespace jink::sim::vehicle {
namespace {

constexpr std::uint64_t kStream = 0x696e73;  // "ins": a name of its own among the streams of a seed

/// Standard deviations: what the filter assumes, and what the sensor has. 0 and less: not a part of it.
struct Sigma {
  double assumed;
  double real;
};

// Per axis of the body (ahead, left, up) and sample of kStep, in flight and standing with motors off.
const Vec3 kAccelNoise(0.6, 2.1, 1.4);         // m/s^2
const Vec3 kGyroNoise(0.175, 0.0875, 0.0375);  // rad/s
constexpr double kAccelNoiseAtRest = 0.1;      // m/s^2
constexpr double kGyroNoiseAtRest = 0.01;      // rad/s

// What the filter assumes of them per update of kFilterStep: EKF2_ACC_NOISE, EKF2_GYR_NOISE, EKF2_ACC_B_NOISE,
// EKF2_GYR_B_NOISE, and its noise of the barometer's bias.
constexpr double kFilterStep = 0.01;  // s, EKF2_PREDICT_US
constexpr double kAssumedAccel = 0.35;
constexpr double kAssumedGyro = 0.015;
constexpr double kAssumedAccelBias = 3e-3;
constexpr double kAssumedGyroBias = 1e-3;
constexpr double kAssumedBaroBias = 0.13;  // m per square root of a second

constexpr Sigma kGnssPosition{0.9, 0.2};   // m, horizontal; the filter takes the receiver's eph
constexpr Sigma kGnssHeight{1.78, 0.5};    // its epv
constexpr Sigma kGnssVelocity{0.4, 0.07};  // m/s
constexpr Sigma kGnssVerticalVelocity{0.6, 0.158};
constexpr Sigma kHeading{0.3, 0.1};       // rad, EKF2_HEAD_NOISE
constexpr Sigma kBarometer{3.5, 0.085};   // m, EKF2_BARO_NOISE; 1 Pa
constexpr Sigma kRangefinder{0.1, 0.02};  // m, EKF2_RNG_NOISE
constexpr Sigma kStandstill{0.01, 0.0};   // m/s

// The rangefinder is used low and slow: EKF2_RNG_A_HMAX and EKF2_RNG_A_VMAX.
constexpr double kRangefinderHeight = 5.0;
constexpr double kRangefinderSpeed = 1.0;

// Steps between: 50 Hz, 8 Hz, 10 Hz.
constexpr int kCovarianceSteps = 5;
constexpr int kGnssSteps = 31;
constexpr int kRangefinderSteps = 25;

constexpr double kSettleTime = 30.0;  // s of hover, after which the errors are those of any other moment

double square(double x) {
  return x * x;
}

}  // namespace

InsErrors::InsErrors(std::uint64_t seed, const Motion& truth, bool airborne) : random_(seed, kStream) {
  reset();
  if (!airborne) return;
  const Surroundings hover{.at_rest = false, .gnss = true, .height = kRangefinderHeight + 1.0};
  for (int k = 0; k < static_cast<int>(kSettleTime / kStep); ++k) step(truth, hover);
}

void InsErrors::reset() {
  error_.setZero();
  covariance_.setZero();
  const auto variance = [this](Index index, double sigma) {
    covariance_.diagonal().segment<3>(index).setConstant(square(sigma));
  };
  variance(kPosition, 0.5);
  variance(kVelocity, 0.3);
  variance(kAttitude, 0.01);
  variance(kGyroBias, 0.01);
  variance(kAccelBias, 0.2);
  covariance_(kBaroBias, kBaroBias) = 0.5;
  uses_rangefinder_ = false;
}

void InsErrors::step(const Motion& truth, const Surroundings& surroundings) {
  propagate(truth, surroundings.at_rest);
  if (steps_ % kCovarianceSteps == 0) {
    propagate_covariance(truth);
    fuse(kAttitude + 2, kHeading.assumed, kHeading.real);
    fuse(kPosition + 2, kBarometer.assumed, kBarometer.real, kBaroBias);
    for (int axis = 0; surroundings.at_rest && axis < 3; ++axis) {
      fuse(kVelocity + axis, kStandstill.assumed, kStandstill.real);
    }
  }
  if (steps_ % kRangefinderSteps == 0) fuse_height(surroundings, truth.velocity.head<2>().norm());
  if (surroundings.gnss && steps_ % kGnssSteps == 0) fuse_gnss();
  ++steps_;
}

/// With R_est = (1 + [e]x) R for an attitude error e: v' = e x f + R (noise - bias), e' = R (noise - bias).
void InsErrors::propagate(const Motion& truth, bool at_rest) {
  Vec3 accel = at_rest ? Vec3::Constant(kAccelNoiseAtRest) : kAccelNoise;
  Vec3 gyro = at_rest ? Vec3::Constant(kGyroNoiseAtRest) : kGyroNoise;
  for (int axis = 0; axis < 3; ++axis) {
    accel[axis] *= random_.normal();
    gyro[axis] *= random_.normal();
  }
  accel -= error_.segment<3>(kAccelBias);
  gyro -= error_.segment<3>(kGyroBias);
  const Vec3 attitude = error_.segment<3>(kAttitude);
  error_.segment<3>(kPosition) += kStep * error_.segment<3>(kVelocity);
  error_.segment<3>(kVelocity) += kStep * (attitude.cross(truth.specific_force) + truth.attitude * accel);
  error_.segment<3>(kAttitude) += kStep * (truth.attitude * gyro);
}

void InsErrors::propagate_covariance(const Motion& truth) {
  constexpr double kTime = kCovarianceSteps * kStep;
  const Eigen::Matrix3d rotation = truth.attitude.toRotationMatrix();
  const Vec3& f = truth.specific_force;
  Eigen::Matrix3d force;  // e x f = -[f]x e
  force << 0, f.z(), -f.y(), -f.z(), 0, f.x(), f.y(), -f.x(), 0;
  Covariance transition = Covariance::Identity();
  transition.block<3, 3>(kPosition, kVelocity).diagonal().setConstant(kTime);
  transition.block<3, 3>(kVelocity, kAttitude) = kTime * force;
  transition.block<3, 3>(kVelocity, kAccelBias) = -kTime * rotation;
  transition.block<3, 3>(kAttitude, kGyroBias) = -kTime * rotation;
  // Eigen's product of large matrices fuses multiplications with additions where a processor can.
  const Covariance moved = transition.lazyProduct(covariance_);
  covariance_ = moved.lazyProduct(transition.transpose());
  const auto add = [this](Index index, double sigma) {
    covariance_.diagonal().segment<3>(index).array() += square(sigma) * kFilterStep * kTime;
  };
  add(kVelocity, kAssumedAccel);
  add(kAttitude, kAssumedGyro);
  add(kAccelBias, kAssumedAccelBias);
  add(kGyroBias, kAssumedGyroBias);
  covariance_(kBaroBias, kBaroBias) += square(kAssumedBaroBias) * kTime;
}

void InsErrors::fuse_gnss() {
  for (int axis = 0; axis < 3; ++axis) {
    const Sigma& position = axis < 2 ? kGnssPosition : kGnssHeight;
    const Sigma& velocity = axis < 2 ? kGnssVelocity : kGnssVerticalVelocity;
    fuse(kPosition + axis, position.assumed, position.real);
    fuse(kVelocity + axis, velocity.assumed, velocity.real);
  }
}

/// The height of the ground is what the filter believes when it begins to use the rangefinder.
void InsErrors::fuse_height(const Surroundings& surroundings, double speed) {
  const bool uses = !surroundings.at_rest && surroundings.height < kRangefinderHeight && speed < kRangefinderSpeed;
  if (uses && !uses_rangefinder_) terrain_ = error_[kPosition + 2];
  uses_rangefinder_ = uses;
  if (uses) fuse(kPosition + 2, kRangefinder.assumed, kRangefinder.real, -1, terrain_);
}

void InsErrors::fuse(int index, double assumed_sigma, double true_sigma, int other, double offset) {
  Eigen::Matrix<double, kSize, 1> column = covariance_.col(index);
  if (other >= 0) column += covariance_.col(other);
  double variance = column[index] + square(assumed_sigma);
  double residual = error_[index] - offset + true_sigma * random_.normal();
  if (other >= 0) {
    variance += column[other];
    residual += error_[other];
  }
  error_ -= column * (residual / variance);
  covariance_ -= (column * column.transpose()) / variance;
}

double InsErrors::horizontal_accuracy() const {
  return std::sqrt(covariance_(kPosition, kPosition) + covariance_(kPosition + 1, kPosition + 1));
}

double InsErrors::vertical_accuracy() const {
  return std::sqrt(covariance_(kPosition + 2, kPosition + 2));
}

}  // namespace jink::sim::vehicle
