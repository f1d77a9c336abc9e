// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/estimator.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "planner/base/portable_math.hpp"

namespace jink::sim::vehicle {
namespace {

constexpr double kNoiseTime = 1.5;      // s, from the recordings: 1 cm/s from sample to sample at 30 Hz
constexpr double kWalk = 0.1;           // m/s per square root of a second without GPS: this model's choice
constexpr double kRecoveryTime = 1.0;   // s, in which GPS takes the errors of dead reckoning away
constexpr double kReckonedNone = 1e-4;  // m and m/s: gone

// Names of their own among the streams of a seed.
constexpr std::uint64_t kPositionStream = 0x706f736e;
constexpr std::uint64_t kVelocityStream = 0x76656c6e;
constexpr std::uint64_t kDriftStream = 0x64726966;
constexpr std::uint64_t kWalkStream = 0x77616c6b;

const EstimateErrors& checked(const EstimateErrors& errors) {
  for (const double value : {errors.position_noise, errors.velocity_noise, errors.drift, errors.drift_time}) {
    if (!std::isfinite(value) || value < 0.0) {
      throw std::invalid_argument("estimate: noises, drift and drift_time must be finite and not negative");
    }
  }
  return errors;
}

}  // namespace

Estimator::Estimator(const EstimateErrors& errors, std::uint64_t seed, const Motion& truth, bool airborne)
    : position_noise_(checked(errors).position_noise, kNoiseTime, kStep,
                      planner::base::RandomStream(seed, kPositionStream)),
      velocity_noise_(errors.velocity_noise, kNoiseTime, kStep, planner::base::RandomStream(seed, kVelocityStream)),
      drift_(errors.drift, errors.drift_time, kStep, planner::base::RandomStream(seed, kDriftStream)),
      walk_(seed, kWalkStream),
      accuracy_(planner::base::hypotenuse(errors.position_noise, errors.drift)),
      exact_(!errors.ins && errors.position_noise == 0.0 && errors.velocity_noise == 0.0 && errors.drift == 0.0) {
  if (errors.ins) ins_.emplace(seed, truth, airborne);
  update(truth);
}

void Estimator::set_gps(bool available) {
  if (gps_ == available) return;
  gps_ = available;
  away_ = 0.0;
  if (!available) {
    exact_ = false;
    return;
  }
  if (valid_) return;
  valid_ = true;
  if (ins_) ins_->reset();
  motion_.position -= reckoned_position_;
  motion_.velocity -= reckoned_velocity_;
  reckoned_position_.setZero();
  reckoned_velocity_.setZero();
  ++resets_;
}

void Estimator::jump(const Vec3& by) {
  exact_ = false;
  jumped_ += by;
  motion_.position += by;
  ++resets_;
}

void Estimator::restart(const Vec3& origin, const Motion& truth) {
  exact_ = false;
  valid_ = gps_;
  origin_ = origin;
  jumped_.setZero();
  reckoned_position_.setZero();
  reckoned_velocity_.setZero();
  away_ = 0.0;
  resets_ = 0;
  if (ins_) ins_->reset();
  update(truth);
}

void Estimator::reckon() {
  if (!gps_ && !ins_) {
    const double walk = kWalk * std::sqrt(kStep);
    const double x = walk_.normal();
    reckoned_velocity_ += Vec3(walk * x, walk * walk_.normal(), 0.0);
    reckoned_position_ += kStep * reckoned_velocity_;
    return;
  }
  if (reckoned_position_.norm() + reckoned_velocity_.norm() < kReckonedNone) {
    reckoned_position_.setZero();
    reckoned_velocity_.setZero();
    return;
  }
  reckoned_position_ *= 1.0 - kStep / kRecoveryTime;
  reckoned_velocity_ *= 1.0 - kStep / kRecoveryTime;
}

void Estimator::step(const Motion& truth, double timeout, bool at_rest, double height) {
  if (ins_) ins_->step(truth, {.at_rest = at_rest, .gnss = gps_, .height = height});
  position_noise_.step();
  velocity_noise_.step();
  drift_.step();
  reckon();
  if (!gps_) {
    away_ += kStep;
    if (away_ >= timeout) valid_ = false;
  }
  update(truth);
}

void Estimator::update(const Motion& truth) {
  motion_ = truth;
  if (exact_) return;
  motion_.position += position_noise_.value() + drift_.value() + jumped_ + reckoned_position_ - origin_;
  motion_.velocity += velocity_noise_.value() + reckoned_velocity_;
  if (!ins_) return;
  motion_.position += ins_->position();
  motion_.velocity += ins_->velocity();
  const Vec3 error = ins_->attitude();
  if (error.norm() > 0.0) motion_.attitude = Eigen::AngleAxisd(error.norm(), error.normalized()) * truth.attitude;
  motion_.yaw = std::remainder(truth.yaw + error.z(), 2.0 * std::numbers::pi);
}

double Estimator::horizontal_accuracy() const {
  if (ins_) return ins_->horizontal_accuracy();
  return std::numbers::sqrt2 * accuracy_ + kWalk * away_ * std::sqrt(away_);
}

double Estimator::vertical_accuracy() const {
  return ins_ ? ins_->vertical_accuracy() : accuracy_;
}

}  // namespace jink::sim::vehicle
