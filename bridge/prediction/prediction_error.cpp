// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/prediction_error.hpp"

#include <algorithm>
#include <cmath>

#include "planner/base/settings.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kKeptEvery = 0.1;   // s, between predictions that are kept
constexpr double kLeastLead = 0.25;  // s, from a measurement, from which on they are held against what came
constexpr double kMostLead = 1.05;   // s
constexpr double kMemory = 1.0;      // s, time constant with which errors are forgotten
constexpr double kPrior = 0.1;       // s⁴, weight of what is assumed of a new track
constexpr double kNoise = 1e-3;      // m, m/s
constexpr double kSlack = 1e-3;      // s
constexpr double kReaction = planner::base::HorizonSettings::kReaction;  // s
constexpr double kAbout = 0.16;  // s, before and after an instant: six periods of 20 Hz

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

// What is measured about then, on average: of that it is known how far it is off, and what the prediction was made of
// has no part in it.
void PredictionError::judge(double t, const planner::base::Track& measured, LawsByKind& laws) {
  for (std::size_t i = 0; i < size_; ++i) {
    Kept& kept = kept_[i];
    const double lead = t - kept.t;
    while (kept.judged < ErrorLaws::kLeads.size() && lead > ErrorLaws::kLeads[kept.judged] + kAbout) {
      const double n = kept.measurements;
      const double sigma = kept.prediction.sigma(ErrorLaws::kLeads[kept.judged]);
      if (n > 0.0 && sigma > kNoise) {
        laws[kept.prediction.motion.index()].saw(kept.judged, (kept.errors / n).norm(), sigma,
                                                 measured.position_sigma / std::sqrt(n));
      }
      kept.errors.setZero();
      kept.measurements = 0.0;
      ++kept.judged;
    }
    if (kept.judged == ErrorLaws::kLeads.size() || lead < ErrorLaws::kLeads[kept.judged] - kAbout) continue;
    kept.errors += measured.position - kept.prediction.position(lead);
    kept.measurements += 1.0;
  }
  while (size_ > 0 && kept_[size_ - 1].judged == ErrorLaws::kLeads.size()) --size_;
  alike_ = std::min(alike_, size_);
}

void PredictionError::observe(double t, const planner::base::Track& measured, const Prediction& predicted,
                              LawsByKind& laws) {
  judge(t, measured, laws);
  const bool swings = std::holds_alternative<HarmonicMotion>(predicted.motion);
  if (!begun_ || swings != swings_) {
    const bool noisy = measured.position_sigma > kNoise || measured.velocity_sigma > kNoise;
    const double assumed = noisy && !swings ? measured.velocity.squaredNorm() / square(kTurning) : 0.0;
    errors_ = kPrior * std::max(square(acceleration_sigma()), assumed);
    weights_ = kPrior;
    alike_ = 0;
    last_ = t;
    begun_ = true;
    swings_ = swings;
  }
  const double keep = std::exp(-std::max(0.0, t - last_) / kMemory);
  last_ = t;
  errors_ *= keep;
  weights_ = std::max(kPrior, weights_ * keep);
  for (std::size_t i = 0; i < alike_; ++i) {
    const double lead = t - kept_[i].t;
    Prediction then = kept_[i].prediction;
    const double since = then.age + lead;
    if (since < kLeastLead || since > kMostLead) continue;
    then.acceleration_sigma = 0.0;
    const Vec3 error = measured.position - then.position(lead);
    // What changes does so after a prediction was kept, by kKeptEvery at most: so much later it is looked at.
    if (measured.is_exact() && then.position_sigma <= 0.0 && since > kReaction - kSlack &&
        since < kReaction + kKeptEvery - kSlack)
      sudden_change_ = std::max(sudden_change_, error.norm() / kReaction);
    const double noise = 3.0 * (square(measured.position_sigma) + square(then.sigma(lead)));
    const double weight = 0.75 * square(square(since));  // of three axes at ½ since²
    errors_ += error.squaredNorm() - noise;
    weights_ += weight;
  }
  const double valid = t + predicted.age;
  if (size_ > 0 && valid - kept_[0].t < kKeptEvery - kSlack) return;
  size_ = std::min(size_ + 1, kMost);
  alike_ = std::min(alike_ + 1, kMost);
  std::move_backward(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(size_ - 1),
                     kept_.begin() + static_cast<std::ptrdiff_t>(size_));
  kept_[0] = {valid, predicted};
  kept_[0].prediction.acceleration_sigma = acceleration_sigma();
}

double PredictionError::acceleration_sigma() const {
  return weights_ > 0.0 ? std::sqrt(std::max(0.0, errors_ / weights_)) : 0.0;
}

bool PredictionError::watched() const {
  return weights_ > 2.0 * kPrior;
}

}  // namespace jink::bridge::prediction
