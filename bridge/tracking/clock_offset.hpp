// SPDX-License-Identifier: BSD-3-Clause
// How old a message was when it came, by its stamp, where the sender's clock is not ours.
#pragma once

#include <cstdint>
#include <optional>

#include "bridge/base/stamped.hpp"

namespace jink::bridge::tracking {

/// The stamps of one writer. A stamp that lies in the future or more than kLongestDelay back tells of a clock that is
/// off: then the smallest stamp age so far stands for the offset and what exceeds it for the delay. A message whose
/// delay exceeds kLongestDelay is too old; where that lasts for kLongestDelay with stamps that advance, a clock was set
/// and its offset is learned anew. A writer whose stamps never advance does not stamp: its delay is taken for 0.
///
/// Stamps that go back by more than kReordered, though by no more than that, and go on from there tell of a clock that
/// was set: a delay that grows holds messages up, but never turns their order. From the third on they are as old as
/// those before were.
class ClockOffsetEstimator {
 public:
  static constexpr double kLongestDelay = 1.0;  ///< s, from stamp to reception
  static constexpr double kReordered = 0.15;    ///< s, by which messages overtake each other

  /// The delay of a message received at `received` (our clock) when its stamp was `stamp_age` old by system time, in
  /// [0, kLongestDelay]; nothing where it is too old to say anything of the present.
  std::optional<double> delay(double received, double stamp_age);
  /// When what the message holds was true, by our clock; nothing where it is too old.
  template <base::Frame F>
  std::optional<double> stamp(const base::Reception<F>& message) {
    const std::optional<double> late = delay(message.received, message.stamp_age);
    return late ? std::optional(message.received - *late) : std::nullopt;
  }
  /// The newest stamp could not be believed: only changes of the delay are known.
  [[nodiscard]] bool off() const { return off_; }

 private:
  double smallest_age_ = 0.0;  // of the stamps
  double stamp_ = 0.0;         // the newest message's, to within a constant
  double received_ = 0.0;
  std::optional<double> late_since_;
  double set_ = 0.0;           // s, by which clocks were set, as the stamps' ages grew
  int turned_ = 0;             // messages in a row whose stamps are before the newest
  double turned_stamp_ = 0.0;  // of the last of these
  bool first_ = true;
  bool advances_ = false;
  bool off_ = false;
};

}  // namespace jink::bridge::tracking
