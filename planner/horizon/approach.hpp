// SPDX-License-Identifier: BSD-3-Clause
// How a motion in steps comes to rest on a place, to the bit, without more speed, climb or acceleration than it may
// use.
#pragma once

#include <optional>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

namespace jink::planner::horizon {

/// What an approach may use.
struct ApproachLimits {
  double step = 0.1;       ///< s, in which the acceleration is constant
  double cruise = 0.0;     ///< m/s, flown where there is room
  double max_climb = 0.0;  ///< m/s, up and down
  double change = 0.0;     ///< m/s, the most that the velocity changes in a step
  double braking = 0.0;    ///< m/s, by which it falls in a step of braking, where that is enough; not above `change`
};

/// The end of an approach: one step to a velocity that points to the target, then even braking on the straight line,
/// which takes `braking` steps and ends at rest on the target.
struct Landing {
  Vec3 velocity = Vec3::Zero();  ///< after the first step, m/s
  int braking = 1;               ///< further steps, at least 1
  double change = 0.0;           ///< largest change of the velocity in a step, m/s
};

/// Approaches to one target. From velocity v at a distance d (vectors) one step to velocity w and N steps of even
/// braking cover h ((v + w) / 2 + N w / 2), h the step. That is d for w = (2 d / h - v) / (N + 1), whatever N is: the
/// more steps, the slower.
class Approach {
 public:
  /// What is approached, and with what.
  Approach(const Vec3& target, const ApproachLimits& limits) : target_(target), limits_(limits) {}

  /// The landing to begin now, if there is one within the limits that is no slower than braking asks for; above a limit
  /// of speed or climb it is nowhere faster than now. Of those that brake harder than need be, as hard as the limits
  /// allow, the one that changes the velocity least at first. O(1).
  [[nodiscard]] std::optional<Landing> landing(const base::TimedPoint& now) const;
  /// The landing that takes this many steps, at least 2, if it is within the limits. O(1).
  [[nodiscard]] std::optional<Landing> landing_in(const base::TimedPoint& now, int steps) const;
  /// Where there is none: the velocity to steer for in the next step, at cruise speed at most.
  [[nodiscard]] Vec3 wished_velocity(const base::TimedPoint& now) const;
  /// Flies a landing from the path's end, which becomes its first point. Precondition: `landing` is of that point.
  void fly(const Landing& landing, base::TimedPath& path) const;
  /// Where the landing that begins at `from` is after `steps` steps, of at least one.
  [[nodiscard]] base::TimedPoint after(const Landing& landing, const base::TimedPoint& from, int steps) const;

 private:
  /// (2 d / h - v), of which w is the (N + 1)th part.
  [[nodiscard]] Vec3 asked(const base::TimedPoint& now) const;
  [[nodiscard]] std::optional<Landing> checked(const base::TimedPoint& now, const Vec3& asked, int braking) const;

  Vec3 target_;
  ApproachLimits limits_;
};

}  // namespace jink::planner::horizon
