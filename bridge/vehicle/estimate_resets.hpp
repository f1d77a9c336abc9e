// SPDX-License-Identifier: BSD-3-Clause
// Jumps of the autopilot's position estimate: how many, and how far in all. The vehicle did not move; the map did.
// No transport and no clock: samples come in with the autopilot's own time.
#pragma once

#include <cstdint>
#include <optional>

#include "planner/base/types.hpp"

namespace jink::bridge::vehicle {

/// Two witnesses. ODOMETRY carries a counter, which the estimator raises when it resets its position, velocity or
/// heading: the shift is then the position after it less the one before, carried on with the velocity. A local position
/// (which has no counter, and is what the companion flies by) tells of a jump by itself where it is more than
/// kUnexplained beyond what velocity and a bounded acceleration explain. A jump that both tell of counts once.
///
/// A reset becomes visible with the first local position that it has moved. Where a small one (below kUnexplained)
/// shows in a local position before ODOMETRY tells of it, it is late by at most one interval of ODOMETRY.
///
/// Lost messages: a counter that went on by several counts as so many, with one shift over the gap; over a gap longer
/// than kLongestGap nobody can tell a jump from motion, so the count alone goes on. Not thread-safe.
class EstimateResets {
 public:
  static constexpr double kUnexplained = 1.0;       ///< m
  static constexpr double kMaxAcceleration = 20.0;  ///< m/s^2, of any motion that is believed
  static constexpr double kJumpGap = 0.2;           ///< s, the longest between positions that are compared
  static constexpr double kLongestGap = 1.0;        ///< s, the longest over which a declared reset's shift is measured
  static constexpr double kSameClock = 2.0;  ///< s; ODOMETRY whose time is farther off is of another clock: unused

  struct Sample {
    double time = 0.0;  ///< autopilot's, s since its boot
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
  };

  /// `counter`: ODOMETRY.reset_counter, which wraps. A sample that is not newer than the one before is left out.
  void on_odometry(const Sample& sample, std::uint8_t counter);
  void on_position(const Sample& sample);
  /// The autopilot began anew: what was heard before says nothing of what comes. Count and shift stay.
  void restart();

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const Vec3& shift() const { return shift_; }

 private:
  struct Jump {
    double begin = 0.0;  // autopilot's time of the last sample before it, and of the first one after it
    double end = 0.0;
    std::uint32_t resets = 1;
    Vec3 shift = Vec3::Zero();
  };
  static Vec3 jump_between(const Sample& before, const Sample& after);
  void apply(const Jump& jump);

  std::uint32_t count_ = 0;
  Vec3 shift_ = Vec3::Zero();
  std::optional<Sample> odometry_;
  std::uint8_t counter_ = 0;
  std::optional<Sample> position_;
  std::optional<Jump> declared_;  // by ODOMETRY, not yet in a local position
  std::optional<Jump> seen_;      // in local positions, not yet declared
};

}  // namespace jink::bridge::vehicle
