// SPDX-License-Identifier: BSD-3-Clause
// How far the vehicle is beside its reference, and how far it is going to be.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "planner/base/trajectory.hpp"

namespace jink::bridge::setpoints {

/// What the vehicle is expected to be beside its reference, from a time on, m: an offset whose rate dies down soon, and
/// which dies down smoothly itself. The autopilot's estimate of velocity is off for seconds, its controller follows it,
/// its integrator follows that: in 200 s of recordings of PX4 (hover and flight at 5 m/s) the offset's autocorrelation
/// is 0.92 after 1 s, 0.77 to 0.71 after 2 s and 0.58 to 0.36 after 3 s. Where the vehicle lags behind a reference that
/// dodges, its velocity is another one: in ten flights of PX4 the offset 0.1, 0.2, 0.3, 0.5 and 1 s later is 0.07,
/// 0.14, 0.20, 0.30 and 0.45 s times that difference more (regression, horizontal), and the forecast's error is 9 to 16
/// % less.
struct OffsetForecast {
  static constexpr double kFade = 6.0;      ///< s, until nothing is left
  static constexpr double kRateFade = 0.6;  ///< s, in which the rate is down to 1/e

  double begun = 0.0;          ///< s, in the companion's clock
  Vec3 offset = Vec3::Zero();  ///< m, then
  double fade = kFade;         ///< s
  Vec3 rate = Vec3::Zero();    ///< m/s, of the offset then

  /// The offset at time t, with its rate (m/s) and that one's (m/s²).
  [[nodiscard]] planner::base::TimedPoint at(double t) const;
  /// Where `reference` leads: with the offset added. Times are the companion's clock.
  [[nodiscard]] planner::base::TimedPath added_to(planner::base::TimedPath reference) const;
  /// The reference that leads along `flown`: with the offset taken off.
  [[nodiscard]] planner::base::TimedPath taken_off(planner::base::TimedPath flown) const;
};

/// Measures the offset and how wrong its forecasts have been. Not thread-safe.
class TrackingOffset {
 public:
  static constexpr double kAhead = 1.0;   ///< s, the forecasts that are judged: within it a plan has been renewed often
  static constexpr double kPeriod = 0.1;  ///< s, between two that are kept
  static constexpr std::size_t kKept = 100;  ///< of the last 10 s

  /// `offset`: the vehicle's position minus the reference, at time t, and `rate`: so its velocity. Times that do not
  /// grow are passed over.
  void observe(double t, const Vec3& offset, const Vec3& rate);
  /// The reference jumped: what was measured says nothing of the new one.
  void forget();

  /// From the newest offset on; none: zero.
  [[nodiscard]] const OffsetForecast& forecast() const { return newest_; }
  /// The distance, m, within which 95 % of the forecasts of the last 10 s came true kAhead later; none: fewer than a
  /// second's worth have been judged.
  [[nodiscard]] std::optional<double> error() const { return error_; }

 private:
  void judge();

  OffsetForecast newest_;
  std::optional<double> kept_at_;
  std::array<OffsetForecast, 11> forecasts_{};  // the last kAhead
  std::size_t forecast_count_ = 0;
  std::array<double, kKept> errors_{};
  std::size_t error_count_ = 0;
  std::optional<double> error_;
};

/// By how much the autopilot's estimate of the horizontal velocity is off, as far as its own estimate of the position
/// tells: that is drawn back by satellite navigation all the time, so that it does not move as the velocity says. With
/// PX4 in hover the difference correlates with the true error by 0.9; setpoints that make up for it halve the distance
/// of the estimate from its setpoint (0.33 to 0.17 m rms in twice 90 s). Not thread-safe.
class VelocityError {
 public:
  void observe(double t, const Vec3& position, const Vec3& velocity);
  /// The position jumped: the next is not compared with the last.
  void forget() { last_.reset(); }
  /// m/s, estimated minus true; what of it is believed.
  [[nodiscard]] Vec3 value() const;

 private:
  std::optional<planner::base::TimedPoint> last_;
  Vec3 difference_ = Vec3::Zero();
};

}  // namespace jink::bridge::setpoints
