// SPDX-License-Identifier: BSD-3-Clause
// How long what is said takes from one end of the link to the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

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

}  // namespace jink::bridge::vehicle
