// SPDX-License-Identifier: BSD-3-Clause
// How several paths are flown in lockstep, one in each lane.
#pragma once

#include <array>
#include <cstddef>

#include "planner/base/types.hpp"
#include "planner/horizon/lanes.hpp"
#include "planner/horizon/path_scene.hpp"

namespace jink::planner::horizon {

/// The flight that decision variables ask for, step by step.
template <std::size_t kLanes>
struct FlightLanes {
  const PathScene& scene;               ///< what all lanes share
  std::array<const double*, kLanes> x;  ///< the variables of each lane
  PointLanes<kLanes> position,          ///< now, m
      velocity;                         ///< now, m/s
  PointLanes<kLanes> begin,             ///< the leg's first offset, m
      drift,                            ///< the offset's mean change in a second, m/s
      onward,                           ///< what of that is along the axis and does not lead back
      wished;                           ///< the leg's last offset, m

  /// At the start of the horizon. Keeps references to both arguments' data.
  [[gnu::always_inline]] FlightLanes(const PathScene& scene_, const std::array<const double*, kLanes>& x_)
      : scene(scene_), x(x_) {
    position.set(scene.position);
    velocity.set(scene.velocity);
    wished.set(Vec3::Zero());
  }

  /// ENU offset from unobstructed flight at the leg's end, moved into the volume where it leads out of it.
  [[gnu::always_inline]] void begin_leg(int leg) {
    begin.copy(wished);
    const auto k = static_cast<std::size_t>(leg);
    const Reach reach = scene.reach[k];
    const Vec3 base = scene.unobstructed[(k + 1) * static_cast<std::size_t>(scene.steps_per_leg)];
    PointLanes<kLanes> asked;
    for (std::size_t i = 0; i < kLanes; ++i) {
      asked.x[i] = x[i][3 * k];
      asked.y[i] = x[i][3 * k + 1];
      asked.z[i] = x[i][3 * k + 2];
    }
    aim(0, asked, reach, base.x(), wished.x);
    aim(1, asked, reach, base.y(), wished.y);
    aim(2, asked, reach, base.z(), wished.z);
    const double mean_speed = scene.mean_speed[k];
    const double per_second = 1.0 / (scene.steps_per_leg * scene.step);
    for (std::size_t i = 0; i < kLanes; ++i) {
      drift.x[i] = (wished.x[i] - begin.x[i]) * per_second;
      drift.y[i] = (wished.y[i] - begin.y[i]) * per_second;
      drift.z[i] = (wished.z[i] - begin.z[i]) * per_second;
      const Vec3& axis = scene.frame.axis;
      const double along = drift.x[i] * axis.x() + drift.y[i] * axis.y() + drift.z[i] * axis.z();
      const double ahead = along > -mean_speed ? along : -mean_speed;
      onward.x[i] = ahead * axis.x();
      onward.y[i] = ahead * axis.y();
      onward.z[i] = ahead * axis.z();
    }
  }

  /// ENU coordinate j of the leg's last offset.
  [[gnu::always_inline]] void aim(int j, const PointLanes<kLanes>& asked, const Reach& reach, double base,
                                  Lanes<kLanes>& to) {
    const geometry::PathFrame& frame = scene.frame;
    const double axis = frame.axis[j];
    const double left = frame.left[j] * reach.aside;
    const double up = frame.up[j] * reach.aside;
    const double low = scene.volume.min[j];
    const double high = scene.volume.max[j];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double along = asked.x[i] * (asked.x[i] > 0.0 ? reach.ahead : reach.behind);
      const double wish = base + along * axis + asked.y[i] * left + asked.z[i] * up;
      const double above = wish < low ? low : wish;
      to[i] = (above > high ? high : above) - base;
    }
  }

  /// Flies the leg's step i, which is the horizon's step `n`.
  [[gnu::always_inline]] void fly(int n, int i) {
    const double per_catch_up = scene.per_catch_up;
    const Vec3 base = scene.unobstructed[static_cast<std::size_t>(n)];
    const Vec3 forward = scene.speed[static_cast<std::size_t>(n) + 1] * scene.frame.axis;
    const double since = i * scene.step;
    const double uneven = scene.uneven[static_cast<std::size_t>(n)];
    const Follower follower = scene.follower;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double wx = forward.x() + drift.x[l] + uneven * onward.x[l] +
                        (base.x() + begin.x[l] + since * drift.x[l] - position.x[l]) * per_catch_up;
      const double wy = forward.y() + drift.y[l] + uneven * onward.y[l] +
                        (base.y() + begin.y[l] + since * drift.y[l] - position.y[l]) * per_catch_up;
      const double wz = forward.z() + drift.z[l] + uneven * onward.z[l] +
                        (base.z() + begin.z[l] + since * drift.z[l] - position.z[l]) * per_catch_up;
      follower.advance(position.x[l], position.y[l], position.z[l], velocity.x[l], velocity.y[l], velocity.z[l], wx, wy,
                       wz);
    }
  }
};

}  // namespace jink::planner::horizon
