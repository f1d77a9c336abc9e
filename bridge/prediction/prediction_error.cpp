// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/prediction_error.hpp"

#include <algorithm>
#include <cmath>

#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kKeptEvery = 0.1;   // s, between predictions that are kept
constexpr double kLeastLead = 0.25;  // s, ahead, from which on they are held against what came
constexpr double kMostLead = 1.05;   // s, ahead
constexpr double kMemory = 1.0;      // s, time constant with which errors are forgotten
constexpr double kPrior = 0.1;       // s⁴, weight of what is assumed of a new track
constexpr double kNoise = 1e-3;      // m, m/s

double square(double x) {
  return x * x;
}

}  // namespace

Vec3 Prediction::position(double t) const {
  if (const auto* track = std::get_if<planner::base::Track>(&motion))
    return planner::geometry::predict_position(*track, t, trust);
  if (const auto* swing = std::get_if<HarmonicMotion>(&motion)) return swing->position(t);
  return std::get<BouncingMotion>(motion).position(t);
}

double Prediction::sigma(double t) const {
  const double since = age + t;
  return std::sqrt(square(position_sigma) + square(velocity_sigma * since) +
                   square(0.5 * acceleration_sigma * since * since));
}

void PredictionError::observe(double t, const planner::base::Track& measured, const Prediction& predicted) {
  const bool swings = std::holds_alternative<HarmonicMotion>(predicted.motion);
  if (!begun_ || swings != swings_) {
    const bool noisy = measured.position_sigma > kNoise || measured.velocity_sigma > kNoise;
    const double assumed = noisy && !swings ? measured.velocity.squaredNorm() / square(kTurning) : 0.0;
    errors_ = kPrior * std::max(square(acceleration_sigma()), assumed);
    weights_ = kPrior;
    size_ = 0;
    last_ = t;
    begun_ = true;
    swings_ = swings;
  }
  const double keep = std::exp(-std::max(0.0, t - last_) / kMemory);
  last_ = t;
  errors_ *= keep;
  weights_ = std::max(kPrior, weights_ * keep);
  while (size_ > 0 && t - kept_[size_ - 1].t > kMostLead) --size_;
  for (std::size_t i = 0; i < size_; ++i) {
    const double lead = t - kept_[i].t;
    if (lead < kLeastLead) continue;
    Prediction then = kept_[i].prediction;
    then.acceleration_sigma = 0.0;
    const double noise = 3.0 * (square(measured.position_sigma) + square(then.sigma(lead)));
    const double weight = 0.75 * square(square(lead));  // of three axes at ½ lead²
    errors_ += (measured.position - then.position(lead)).squaredNorm() - noise;
    weights_ += weight;
  }
  if (size_ > 0 && t - kept_[0].t < kKeptEvery - 1e-3) return;
  size_ = std::min(size_ + 1, kMost);
  std::move_backward(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(size_ - 1),
                     kept_.begin() + static_cast<std::ptrdiff_t>(size_));
  kept_[0] = {t, predicted};
}

double PredictionError::acceleration_sigma() const {
  return weights_ > 0.0 ? std::sqrt(std::max(0.0, errors_ / weights_)) : 0.0;
}

bool PredictionError::watched() const {
  return weights_ > 2.0 * kPrior;
}

}  // namespace jink::bridge::prediction
