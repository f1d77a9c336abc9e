// SPDX-License-Identifier: BSD-3-Clause
// Whether a vehicle gets on.
#pragma once

#include "planner/base/types.hpp"

namespace jink::planner::horizon {

/// Watches what is left of a way. Not thread-safe.
class Progress {
 public:
  static constexpr double kPatience = 4.0;  ///< s, without a gain
  static constexpr double kGain = 0.5;      ///< m, less left, that count as one

  /// Whether the least that was left, m, has not become less for long, at time `now`, s, as far as was asked.
  bool stalls(double now, double left) {
    if (left < least_ - kGain) {
      least_ = left;
      gained_at_ = now;
    }
    return now - gained_at_ > kPatience;
  }
  /// The way is another: whatever is left of it is a gain.
  void begin_anew() { least_ = base::kInfinity; }

 private:
  double least_ = base::kInfinity;
  double gained_at_ = 0.0;
};

}  // namespace jink::planner::horizon
