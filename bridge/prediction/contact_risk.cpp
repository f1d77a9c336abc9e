// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/contact_risk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "planner/base/solid.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kStep = 0.1;  // s
constexpr std::size_t kMostInstants = 32;
constexpr double kFarSigmas = 6.0;  // as far away as no risk

/// How far its surface is from its centre towards a place `away` from it, no less than that.
double extent(const Prediction& prediction, const Vec3& away, double distance, double t) {
  if (prediction.body.solid == nullptr || !(distance > 0.0)) return prediction.radius;
  const double yaw = prediction.body.later(t).yaw;
  const Vec3 direction(std::cos(yaw) * away.x() + std::sin(yaw) * away.y(),
                       std::cos(yaw) * away.y() - std::sin(yaw) * away.x(), away.z());
  return std::min(prediction.radius, prediction.body.solid->extent(direction / distance));
}

}  // namespace

double contact_probability(double distance, double radius, double sigma) {
  if (radius <= 0.0) return 0.0;
  if (!(sigma > 1e-9)) return distance < radius ? 1.0 : 0.0;
  const double near = (radius - distance) / sigma;
  if (near < -kFarSigmas) return 0.0;
  const double far = (radius + distance) / sigma;
  const auto erf = [](double x) { return std::erf(x / std::numbers::sqrt2); };
  const auto bell = [](double x) { return std::exp(-0.5 * x * x); };
  if (distance < 1e-3 * sigma) {
    const double x = radius / sigma;
    return erf(x) - std::sqrt(2.0 / std::numbers::pi) * x * bell(x);
  }
  const double inside = 0.5 * (erf(far) + erf(near));
  return std::clamp(inside - sigma / (distance * std::sqrt(2.0 * std::numbers::pi)) * (bell(near) - bell(far)), 0.0,
                    1.0);
}

double contact_risk(const planner::base::TimedPath& path, std::span<const Prediction> predictions, double radius,
                    double until, const Evasion& evasion, double enough) {
  std::array<Vec3, kMostInstants> places;
  std::array<double, kMostInstants> credits{};
  std::size_t instants = 0;
  for (; instants < kMostInstants && static_cast<double>(instants) * kStep <= until + 1e-9; ++instants) {
    const double t = static_cast<double>(instants) * kStep;
    const double free = std::max(0.0, t - evasion.reaction);
    places[instants] = planner::base::sample(path, t).position;
    credits[instants] = 0.5 * evasion.acceleration * free * free;
  }
  double none = 1.0;
  for (const Prediction& prediction : predictions) {
    double most = 0.0;
    for (std::size_t n = 0; n < instants; ++n) {
      const double t = static_cast<double>(n) * kStep;
      if (prediction.radius + radius <= credits[n]) break;
      const Vec3 away = places[n] - prediction.position(t);
      const double distance = away.norm();
      const double touching = extent(prediction, away, distance, t) + radius - credits[n];
      most = std::max(most, contact_probability(distance, touching, prediction.sigma(t)));
    }
    none *= 1.0 - most;
    if (1.0 - none >= enough) break;
  }
  return 1.0 - none;
}

}  // namespace jink::bridge::prediction
