// SPDX-License-Identifier: BSD-3-Clause
// Where the vehicle will be in a moment, by what has been asked of it.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>

#include "bridge/vehicle/vehicle_link.hpp"
#include "planner/base/trajectory.hpp"

namespace jink::bridge::setpoints {

/// PX4's position and velocity loop with its default gains, and a thrust that follows them with two lags as its SITL's
/// does: of what was sent within the last third of a second, most has not been answered yet. Drag and damping, the
/// share of an acceleration that the velocity loop takes off again, are learned from what it accelerates with (least
/// mean squares, normalised); what is left then (wind, other gains) counts as an acceleration that stays for a while.
/// Velocities are the vehicle's own, in ENU, times the companion's clock. Not thread-safe.
class VehicleResponse {
 public:
  /// To begin with, 1/s and a share, and the largest speed on the level, m/s.
  VehicleResponse(double drag, double damping, double max_speed)
      : max_speed_(max_speed), drag_(drag), damping_(damping) {}

  /// A setpoint that is heard at time t.
  void sent(double t, const vehicle::Setpoint& setpoint);
  /// Where the vehicle was at time t. Times that do not grow are passed over. `learns`: it followed what was sent.
  void observe(double t, const Vec3& position, const Vec3& velocity, bool learns);
  /// What was sent and measured says nothing of what comes: an estimate jumped.
  void forget();

  /// At time t, after the newest measurement, where `later` gives the setpoints that are still to be heard. None:
  /// nothing was measured within a second of that.
  [[nodiscard]] std::optional<planner::base::TimedPoint> at(
      double t, const std::function<vehicle::Setpoint(double t)>& later) const;

  /// What it accelerates with that setpoints do not explain, m/s².
  [[nodiscard]] const Vec3& unexplained() const { return unexplained_; }
  [[nodiscard]] double drag() const { return drag_; }        ///< 1/s
  [[nodiscard]] double damping() const { return damping_; }  ///< of an acceleration on the level

 private:
  struct Sent {
    double t = 0.0;
    vehicle::Setpoint setpoint;
  };
  /// Behind two lags.
  struct Lagged {
    Vec3 first = Vec3::Zero(), value = Vec3::Zero();
    void follow(const Vec3& input, double dt);
  };
  struct State {
    double t = 0.0;
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(), acceleration = Vec3::Zero();
    Vec3 integral = Vec3::Zero();  // of the velocity loop, m/s²
    Lagged thrust;                 // m/s², gravity made up for, but for the damping
    Lagged acceleration_fed_back;  // what the damping is of
  };
  [[nodiscard]] const Sent* heard_at(double t) const;
  void advance(double dt, const vehicle::Setpoint& setpoint, State& state) const;
  void learn(double dt, const Vec3& lacking);

  std::array<Sent, 32> sent_{};
  std::size_t sent_count_ = 0;
  std::optional<State> state_;       // none: nothing was measured
  Vec3 unexplained_ = Vec3::Zero();  // m/s²
  double max_speed_;
  double drag_;
  double damping_;
};

}  // namespace jink::bridge::setpoints
