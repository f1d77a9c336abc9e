// SPDX-License-Identifier: BSD-3-Clause
// The last steps of several paths in lockstep, kept to be looked at together: what none of them can meet is left out.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "planner/horizon/lanes.hpp"
#include "planner/horizon/nearby_obstacles.hpp"

namespace jink::planner::horizon {

/// Steps that follow one another, and the box around all lanes' places in them.
template <std::size_t kLanes>
struct StretchLanes {
  static constexpr std::size_t kMost = 10;  ///< steps in a stretch

  std::size_t count = 0;                             ///< steps in it
  std::array<PointLanes<kLanes>, kMost + 1> places;  ///< where it begins, and after each of its steps
  std::array<Lanes<kLanes>, kMost> moved;            ///< in each of its steps
  PointLanes<kLanes> least,                          ///< smallest coordinates of its places, m
      most;                                          ///< largest coordinates of its places, m

  /// Begins at `start`, without a step.
  [[gnu::always_inline]] explicit StretchLanes(const PointLanes<kLanes>& start) {
    places[0].copy(start);
    least.copy(start);
    most.copy(start);
  }

  /// Whether it takes no more steps until restart().
  [[gnu::always_inline]] [[nodiscard]] bool full() const { return count == kMost; }

  /// Begins where it has ended, without a step.
  [[gnu::always_inline]] void restart() {
    places[0].copy(places[count]);
    least.copy(places[0]);
    most.copy(places[0]);
    count = 0;
  }

  /// A step in which the vehicles fly evenly from where they were to `to`.
  [[gnu::always_inline]] void add(const PointLanes<kLanes>& to) {
    PointLanes<kLanes> from;
    from.copy(places[count]);
    Lanes<kLanes> way;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = to.x[i];
      const double y = to.y[i];
      const double z = to.z[i];
      const double mx = x - from.x[i];
      const double my = y - from.y[i];
      const double mz = z - from.z[i];
      way[i] = std::sqrt(mx * mx + my * my + mz * mz);
      least.x[i] = x < least.x[i] ? x : least.x[i];
      least.y[i] = y < least.y[i] ? y : least.y[i];
      least.z[i] = z < least.z[i] ? z : least.z[i];
      most.x[i] = x > most.x[i] ? x : most.x[i];
      most.y[i] = y > most.y[i] ? y : most.y[i];
      most.z[i] = z > most.z[i] ? z : most.z[i];
    }
    for (std::size_t i = 0; i < kLanes; ++i) moved[count][i] = way[i];
    places[++count].copy(to);
  }

  /// Around the places of all lanes.
  [[gnu::always_inline]] [[nodiscard]] PlainBox bounds() const {
    return {smallest(least.x), smallest(least.y), smallest(least.z), largest(most.x), largest(most.y), largest(most.z)};
  }

  /// Around the places of all lanes in step j.
  [[gnu::always_inline]] [[nodiscard]] PlainBox bounds_of(std::size_t j) const {
    const PointLanes<kLanes>& from = places[j];
    const PointLanes<kLanes>& to = places[j + 1];
    PointLanes<kLanes> low, high;
    for (std::size_t i = 0; i < kLanes; ++i) {
      low.x[i] = from.x[i] < to.x[i] ? from.x[i] : to.x[i];
      low.y[i] = from.y[i] < to.y[i] ? from.y[i] : to.y[i];
      low.z[i] = from.z[i] < to.z[i] ? from.z[i] : to.z[i];
      high.x[i] = from.x[i] > to.x[i] ? from.x[i] : to.x[i];
      high.y[i] = from.y[i] > to.y[i] ? from.y[i] : to.y[i];
      high.z[i] = from.z[i] > to.z[i] ? from.z[i] : to.z[i];
    }
    return {smallest(low.x), smallest(low.y), smallest(low.z), largest(high.x), largest(high.y), largest(high.z)};
  }

  /// Below 0 for each lane that may not keep the soft distance in step j, with what counts in advance. Relative motion
  /// is straight, so during the step the distance is not below that of the middles by more than half of both ways.
  [[gnu::always_inline]] void find_near(const NearbyObstacle& obstacle, std::size_t j, Lanes<kLanes>& sign) const {
    const PointLanes<kLanes>& from = places[j];
    const PointLanes<kLanes>& to = places[j + 1];
    const Lanes<kLanes>& way = moved[j];
    const Vec3 middle = obstacle.middle;
    const double near = obstacle.near;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = 0.5 * (from.x[i] + to.x[i]) - middle.x();
      const double y = 0.5 * (from.y[i] + to.y[i]) - middle.y();
      const double z = 0.5 * (from.z[i] + to.z[i]) - middle.z();
      const double limit = near + 0.5 * way[i] + obstacle.advance(way[i]);
      sign[i] = x * x + y * y + z * z < limit * limit ? -1.0 : 1.0;
    }
  }
};

}  // namespace jink::planner::horizon
