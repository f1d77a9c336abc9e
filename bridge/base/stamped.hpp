// SPDX-License-Identifier: BSD-3-Clause
// Values that say when they were true and in which frame, so that neither a delay nor a frame can be forgotten: the
// vehicle's position, obstacle tracks, the team's paths. All times are the companion's clock.
#pragma once

#include <cstdint>

#include "planner/base/types.hpp"

namespace jink::bridge::base {

enum class Frame {
  kLocal,  ///< east, north, up from the autopilot's local origin
  kSender  ///< east, north, up from the origin that the sender names
};

inline constexpr double kNever = -planner::base::kInfinity;  ///< longer ago than anything

template <class T, Frame F>
struct Stamped {
  T value{};
  double stamp = kNever;     ///< when it was true
  double received = kNever;  ///< when it was heard

  [[nodiscard]] bool heard() const { return stamp > kNever; }
  /// s; infinite where nothing was heard.
  [[nodiscard]] double age(double now) const { return now - stamp; }
  /// s since it was heard; likewise.
  [[nodiscard]] double silence(double now) const { return now - received; }
  /// s that it was on its way.
  [[nodiscard]] double delay() const { return heard() ? received - stamp : 0.0; }
};

/// Where something is and how it moves.
struct Kinematics {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

/// Where it is at time t, at constant velocity.
template <class T, Frame F>
[[nodiscard]] Vec3 position_at(const Stamped<T, F>& moving, double t) {
  return moving.value.position + (t - moving.stamp) * moving.value.velocity;
}

/// How a message came: its stamp is by a clock that need not be ours. ClockOffsetEstimator makes its content Stamped.
template <Frame F>
struct Reception {
  static constexpr Frame kFrame = F;
  std::uint64_t writer = 0;  ///< stable identity of the writer
  double received = 0.0;     ///< at reception
  double stamp_age = 0.0;    ///< system time at reception minus the message's stamp; as measured, may be absurd
};

}  // namespace jink::bridge::base
