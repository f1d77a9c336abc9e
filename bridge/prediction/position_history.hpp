// SPDX-License-Identifier: BSD-3-Clause
// One obstacle's velocity where nothing but its positions is measured.
#pragma once

#include <vector>

#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// Where a track was. Its velocity is how far it has moved since kSpan before, or since it was first seen, and is as
/// uncertain as both positions and what it may have turned on the way make it. Not thread-safe.
class PositionHistory {
 public:
  /// Sets velocity and velocity_sigma of a track that is measured at `t`, with its position_sigma. 0 and kUnknown where
  /// the way tells no more, or is farther than what is still the same obstacle. O(positions within kSpan).
  void set_velocity(double t, planner::base::Track& track) const;
  /// Remembers its position. What comes earlier than the one before is left out.
  void add(double t, const planner::base::Track& measured);

  static constexpr double kSpan = 0.4;       ///< s, over which a velocity is measured
  static constexpr double kUnknown = 5.0;    ///< m/s, standard deviation of the velocity of what was seen once
  static constexpr double kManoeuvre = 1.0;  ///< m/s², standard deviation of an acceleration on the way
  static constexpr double kFastest = 100.0;  ///< m/s

 private:
  struct Place {
    double t = 0.0;
    Vec3 position = Vec3::Zero();
    double sigma = 0.0;
  };
  std::vector<Place> places_;  // oldest first; one of them kSpan old or older
};

}  // namespace jink::bridge::prediction
