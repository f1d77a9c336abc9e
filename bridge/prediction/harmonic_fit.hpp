// SPDX-License-Identifier: BSD-3-Clause
// The periodic motion that explains what was seen of a track best.
#pragma once

#include <optional>
#include <span>

#include "bridge/prediction/learned_motion.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// A track as it was measured at time `t`, or the mean of so many `measurements` about it.
struct MotionSample {
  double t = 0.0;
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  double measurements = 1.0;
};

struct HarmonicFit {
  HarmonicMotion motion;  ///< valid at the last sample's time
  double misfit = 0.0;    ///< root mean square of the residuals in standard deviations
};

/// Weighted least squares of positions and velocities, with a weak wish for small amplitudes, over the frequencies
/// from a twentieth to one hertz (`guess` 0), or near `guess` (rad/s). Nothing for fewer than kFewest samples.
/// O(samples · frequencies), thread safe, no allocation.
[[nodiscard]] std::optional<HarmonicFit> fit_harmonics(std::span<const MotionSample> samples, double position_sigma,
                                                       double velocity_sigma, double guess = 0.0);

inline constexpr std::size_t kFewestSamples = 8;

}  // namespace jink::bridge::prediction
