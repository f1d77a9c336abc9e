// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/plain_prediction.hpp"

#include <algorithm>

#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {

planner::base::Track predict(const base::Stamped<planner::base::Track, base::Frame::kLocal>& track, double now,
                             double trust) {
  const double age = std::max(0.0, track.age(now));
  planner::base::Track predicted = planner::geometry::predict(track.value, age, trust);
  predicted.age = age;
  return predicted;
}

}  // namespace jink::bridge::prediction
