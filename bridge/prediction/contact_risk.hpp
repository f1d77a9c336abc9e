// SPDX-License-Identifier: BSD-3-Clause
// How likely a vehicle that flies a path is to be hit.
#pragma once

#include <span>

#include "bridge/prediction/prediction_error.hpp"
#include "planner/base/trajectory.hpp"

namespace jink::bridge::prediction {

/// What a vehicle can do about what it has not foreseen.
struct Evasion {
  double reaction = 0.0;      ///< s, from the path's beginning, before it can do something else
  double acceleration = 0.0;  ///< m/s², with which it does
};

/// Probability that one of them touches a vehicle of that radius, m, on its path from its time 0 to `until`, s: for
/// each, that of its worst instant, independent of the others. By ½ a t² after the reaction the vehicle can be
/// elsewhere, as one that sees it come. How far they may be from where they are predicted follows `laws`. The
/// predictions are valid at the path's time 0. Where it is `enough` or more than that, something between that and it.
/// O(predictions · until).
[[nodiscard]] double contact_risk(const planner::base::TimedPath& path, std::span<const Prediction> predictions,
                                  const LawsByKind& laws, double radius, double until, const Evasion& evasion,
                                  double enough = 1.0);

}  // namespace jink::bridge::prediction
