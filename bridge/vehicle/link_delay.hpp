// SPDX-License-Identifier: BSD-3-Clause
// How long what is said takes from one end of the link to the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "planner/base/types.hpp"

namespace jink::bridge::vehicle {

/// By the link's round trips: half of the shortest of the newest ones, since what is longer waited somewhere. A link
/// that is slower one way than the other is taken for one that is not; what is wrong then is bounded by the half. Not
/// thread-safe.
class LinkDelay {
 public:
  static constexpr double kPeriod = 0.2;            ///< s, at which to ask
  static constexpr std::size_t kKept = 10;          ///< answers
  static constexpr double kLongestRoundTrip = 2.0;  ///< s; an answer to nothing that was asked lately is none

  /// What was sent at `sent` was answered at `now`.
  void answered(double sent, double now) {
    const double round_trip = now - sent;
    if (!(round_trip >= 0.0 && round_trip <= kLongestRoundTrip)) return;
    round_trips_[count_++ % kKept] = round_trip;
  }
  /// s; nothing while nobody has answered.
  [[nodiscard]] std::optional<double> round_trip() const {
    if (count_ == 0) return std::nullopt;
    return *std::min_element(round_trips_.begin(),
                             round_trips_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kKept)));
  }
  /// s; 0 while nobody has answered.
  [[nodiscard]] double one_way() const { return 0.5 * round_trip().value_or(0.0); }

 private:
  std::array<double, kKept> round_trips_{};
  std::size_t count_ = 0;
};

/// By the stamps of what comes one way alone. Clocks drift apart, and who synchronises them sets them: what is less
/// than kDoubt is taken for that. Not thread-safe.
class StampDelay {
 public:
  /// s. Of a PX4 whose simulation runs 0.5 % slow, positions seemed up to 0.23 s old by the agent's clock, and twice a
  /// minute its synchronisation made them new again (1.17, uXRCE-DDS agent 2.3).
  static constexpr double kDoubt = 0.3;
  static constexpr double kLongest = 1.0;  ///< s; what is older says nothing of the present
  static constexpr double kWindow = 5.0;   ///< s, for once to twice of which the least age is remembered

  /// s, from its stamp to its reception at `now`, of a message whose stamp was `age` old by our system's clock; nothing
  /// where it is older than kLongest. Where the stamps are by another clock (the least age lately is not one that a
  /// message can have) age counts from the least.
  std::optional<double> of(double now, double age) {
    if (now - begun_ > kWindow) {
      before_ = now - begun_ > 2.0 * kWindow ? kNone : least_;
      least_ = kNone;
      begun_ = now;
    }
    const double floor = std::min(least_, before_);
    const bool ours = floor >= -kDoubt && floor <= kLongest;
    const double late = floor == kNone ? 0.0 : age - (ours ? 0.0 : floor);
    if (late > kLongest) return std::nullopt;
    least_ = std::min(least_, age);
    return late > kDoubt ? late : 0.0;
  }

 private:
  static constexpr double kNone = planner::base::kInfinity;
  double begun_ = 0.0;
  double least_ = kNone, before_ = kNone;  // age, since `begun_` and in the window before that
};

}  // namespace jink::bridge::vehicle
