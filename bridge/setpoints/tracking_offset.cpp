// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/tracking_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jink::bridge::setpoints {
namespace {

constexpr double kSmoothing = 0.5;  // s
constexpr double kGap = 0.3;        // s, from which on a difference of positions says nothing
constexpr double kBelieved = 0.8;   // of the difference
constexpr double kMostError = 1.0;  // m/s
constexpr double kJitter = 0.005;   // s
constexpr double kQuantile = 0.95;
constexpr std::size_t kEnough = 10;  // errors, a second's worth

planner::base::TimedPath moved(planner::base::TimedPath path, const OffsetForecast& forecast, double sign) {
  for (planner::base::TimedPoint& point : path) {
    const planner::base::TimedPoint offset = forecast.at(point.t);
    point.position += sign * offset.position;
    point.velocity += sign * offset.velocity;
    point.acceleration += sign * offset.acceleration;
  }
  return path;
}

}  // namespace

// 1 - 10 s³ + 15 s⁴ - 6 s⁵ goes from 1 to 0 with neither slope nor curvature at its ends.
planner::base::TimedPoint OffsetForecast::at(double t) const {
  if (fade <= 0.0) return {t};
  const double s = std::clamp((t - begun) / fade, 0.0, 1.0);
  const double left = 1.0 - s * s * s * (10.0 - s * (15.0 - 6.0 * s));
  const double slope = -30.0 * s * s * (1.0 - s) * (1.0 - s) / fade;
  const double curvature = -60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (fade * fade);
  const double since = std::max(0.0, t - begun);
  const double rate_left = std::exp(-since / kRateFade);
  const Vec3 way = offset + kRateFade * (1.0 - rate_left) * rate;
  const Vec3 velocity = rate_left * rate;
  return {t, left * way, slope * way + left * velocity, curvature * way + (2.0 * slope - left / kRateFade) * velocity};
}

planner::base::TimedPath OffsetForecast::added_to(planner::base::TimedPath reference) const {
  return moved(std::move(reference), *this, 1.0);
}

planner::base::TimedPath OffsetForecast::taken_off(planner::base::TimedPath flown) const {
  return moved(std::move(flown), *this, -1.0);
}

void TrackingOffset::observe(double t, const Vec3& offset, const Vec3& rate) {
  if (kept_at_ && t <= newest_.begun) return;
  newest_ = {t, offset, OffsetForecast::kFade, rate};
  if (kept_at_ && t - *kept_at_ < kPeriod - kJitter) return;
  kept_at_ = t;
  judge();
  forecasts_[forecast_count_++ % forecasts_.size()] = newest_;
}

void TrackingOffset::judge() {
  if (forecast_count_ < forecasts_.size()) return;
  const OffsetForecast& oldest = forecasts_[forecast_count_ % forecasts_.size()];
  errors_[error_count_++ % kKept] = (newest_.offset - oldest.at(newest_.begun).position).norm();
  const std::size_t count = std::min(error_count_, kKept);
  if (count < kEnough) return;
  std::array<double, kKept> sorted = errors_;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(count - 1));
  std::nth_element(sorted.begin(), at, sorted.begin() + static_cast<std::ptrdiff_t>(count));
  error_ = *at;
}

void VelocityError::observe(double t, const Vec3& position, const Vec3& velocity) {
  if (last_ && t <= last_->t) return;
  const double dt = last_ ? t - last_->t : kGap;
  if (dt < kGap) {
    Vec3 difference = 0.5 * (velocity + last_->velocity) - (position - last_->position) / dt;
    difference.z() = 0.0;
    difference_ += -std::expm1(-dt / kSmoothing) * (difference - difference_);
  }
  last_ = {t, position, velocity, Vec3::Zero()};
}

Vec3 VelocityError::value() const {
  const double size = difference_.norm();
  return size > 0.0 ? Vec3(kBelieved * std::min(1.0, kMostError / size) * difference_) : Vec3::Zero();
}

void TrackingOffset::forget() {
  newest_ = {};
  kept_at_.reset();
  forecast_count_ = 0;
}

}  // namespace jink::bridge::setpoints
