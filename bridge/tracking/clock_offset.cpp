// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/clock_offset.hpp"

#include <algorithm>
#include <utility>

namespace jink::bridge::tracking {
namespace {

// s of stamp for each second of reception, below which a writer's stamps stand still
constexpr double kStampRate = 0.1;
constexpr int kCertain = 3;  // messages

}  // namespace

std::optional<double> ClockOffsetEstimator::delay(double received, double stamp_age) {
  stamp_age -= set_;
  double stamp = received - stamp_age;  // to within a constant
  const double back = first_ ? 0.0 : stamp_ - stamp;
  if (back > kReordered && back <= kLongestDelay) {
    turned_ = turned_ > 0 && stamp > turned_stamp_ ? turned_ + 1 : 1;
    turned_stamp_ = stamp;
    if (turned_ < kCertain) return std::nullopt;
    const double age = received_ - stamp_;  // as before
    set_ += stamp_age - age;
    stamp_age = age;
    stamp = received - age;
  }
  turned_ = 0;
  const bool first = std::exchange(first_, false);
  const bool advanced = !first && stamp - stamp_ > kStampRate * (received - received_);
  advances_ = advances_ || advanced;
  smallest_age_ = first ? stamp_age : std::min(smallest_age_, stamp_age);
  stamp_ = stamp;
  received_ = received;
  if (!first && !advances_) {
    off_ = true;
    return 0.0;
  }
  if (stamp_age - smallest_age_ > kLongestDelay) {
    if (!late_since_) late_since_ = received;
    if (!advanced || received - *late_since_ <= kLongestDelay) return std::nullopt;
    smallest_age_ = stamp_age;
  }
  late_since_.reset();
  off_ = !(smallest_age_ >= 0.0 && smallest_age_ <= kLongestDelay);
  return std::min(off_ ? stamp_age - smallest_age_ : stamp_age, kLongestDelay);
}

}  // namespace jink::bridge::tracking
