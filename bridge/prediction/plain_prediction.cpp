// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/plain_prediction.hpp"

#include <algorithm>
#include <cmath>

#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kFastestTurn = 3.0;  // rad/s

/// The constant acceleration that leads in `time` seconds to the velocity to which a coordinated turn leads, one at a
/// constant speed, that begins with this velocity and this acceleration across it.
Vec3 mean_of_turn(const Vec3& velocity, const Vec3& acceleration, double time) {
  const double speed = velocity.norm();
  const double across = acceleration.norm();
  if (!(speed > 0.0 && across > 0.0)) return Vec3::Zero();
  const double angle = std::min(across / speed, kFastestTurn) * time;
  return ((std::cos(angle) - 1.0) * velocity + std::sin(angle) * speed / across * acceleration) / time;
}

}  // namespace

planner::base::Track predict(const base::Stamped<planner::base::Track, base::Frame::kLocal>& track, double now,
                             double trust) {
  const double age = std::max(0.0, track.age(now));
  planner::base::Track now_on = track.value;
  const bool estimated = now_on.velocity_sigma > 0.0;
  if (estimated && trust > 0.0 && std::isfinite(trust))
    now_on.acceleration = mean_of_turn(now_on.velocity, now_on.acceleration, trust);
  planner::base::Track predicted = planner::geometry::predict(now_on, age, trust);
  predicted.age = age;
  return predicted;
}

}  // namespace jink::bridge::prediction
