// SPDX-License-Identifier: BSD-3-Clause
// The plain prediction of a track. What has been learned of its motion goes beyond it: motion_learner, learned_motion.
#pragma once

#include "bridge/base/stamped.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// The track at `now`, which is its stamp or later: constant acceleration for at most `trust` seconds, then constant
/// velocity. Of a track with sigmas that is the acceleration which leads where a coordinated turn does in that time
/// (Bar-Shalom, Li, Kirubarajan 2001, section 11.7). Its age counts from the stamp.
[[nodiscard]] planner::base::Track predict(const base::Stamped<planner::base::Track, base::Frame::kLocal>& track,
                                           double now, double trust);

}  // namespace jink::bridge::prediction
