// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/contact_risk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "planner/base/solid.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kStep = 0.1;  // s
constexpr std::size_t kMostInstants = 32;

/// How far its surface is from its centre towards a place `away` from it, no less than that.
double extent(const Prediction& prediction, const Vec3& away, double distance, double t) {
  if (prediction.body.solid == nullptr || !(distance > 0.0)) return prediction.radius;
  const double yaw = prediction.body.later(t).yaw;
  const Vec3 direction(std::cos(yaw) * away.x() + std::sin(yaw) * away.y(),
                       std::cos(yaw) * away.y() - std::sin(yaw) * away.x(), away.z());
  return std::min(prediction.radius, prediction.body.solid->extent(direction / distance));
}

}  // namespace

double contact_risk(const planner::base::TimedPath& path, std::span<const Prediction> predictions,
                    const LawsByKind& laws, double radius, double until, const Evasion& evasion, double enough) {
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
    const ErrorLaws& law = laws[prediction.motion.index()];
    double most = 0.0;
    for (std::size_t n = 0; n < instants; ++n) {
      const double t = static_cast<double>(n) * kStep;
      if (prediction.radius + radius <= credits[n]) break;
      const Vec3 away = places[n] - prediction.position(t);
      const double distance = away.norm();
      const double touching = extent(prediction, away, distance, t) + radius - credits[n];
      most = std::max(most, law.at(t).contact_probability(distance, touching, prediction.sigma(t)));
    }
    none *= 1.0 - most;
    if (1.0 - none >= enough) break;
  }
  return 1.0 - none;
}

}  // namespace jink::bridge::prediction
