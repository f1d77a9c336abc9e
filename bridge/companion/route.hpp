// SPDX-License-Identifier: BSD-3-Clause
// The mission's waypoints, and how far the vehicle has come on them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/horizon/progress.hpp"

namespace jink::bridge::companion {

/// At least one waypoint. Pure logic.
class Route {
 public:
  static constexpr double kArrival = 0.3;       ///< m, to the last waypoint
  static constexpr double kArrivalSpeed = 0.5;  ///< m/s
  static constexpr double kPassing = 0.7;       ///< m, to a waypoint on the way

  /// `acceptance`: config::Mission::acceptance_radius.
  explicit Route(std::vector<Vec3> waypoints, double acceptance = 0.0)
      : waypoints_(std::move(waypoints)), acceptance_(acceptance) {}
  /// The same waypoints elsewhere.
  void place(std::vector<Vec3> waypoints) { waypoints_ = std::move(waypoints); }

  /// The waypoint flown to.
  [[nodiscard]] const Vec3& target() const { return waypoints_[next_]; }
  [[nodiscard]] std::size_t passed() const { return next_; }
  [[nodiscard]] std::size_t size() const { return waypoints_.size(); }
  /// Goes on to the next waypoint where the vehicle is at one on the way; then true.
  bool pass(const Vec3& position);
  /// At that place, slow.
  [[nodiscard]] static bool at(const Vec3& place, const Vec3& position, const Vec3& velocity) {
    return (position - place).norm() < kArrival && velocity.norm() < kArrivalSpeed;
  }
  /// At the last waypoint, slow; or near enough.
  [[nodiscard]] bool arrived(const Vec3& position, const Vec3& velocity) const;
  /// It was led elsewhere: that it came no nearer says nothing.
  void begin_anew() { progress_.begin_anew(); }
  /// Whether the vehicle has long come no nearer to where it goes. To be asked in each plan.
  bool stuck(double now, const Vec3& position);

 private:
  std::vector<Vec3> waypoints_;
  double acceptance_;  // m, to the last waypoint
  std::size_t next_ = 0;
  planner::horizon::Progress progress_;  // towards it
};

}  // namespace jink::bridge::companion
