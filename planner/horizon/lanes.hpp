// SPDX-License-Identifier: BSD-3-Clause
// What is worked on for several paths in lockstep, one in each lane: numbers, points, and a box around them. Loops over
// a fixed number of lanes, which the compiler turns into wide registers; a path gets the same bits in every lane, among
// whatever others.
#pragma once

#include <array>
#include <cstddef>

#include "planner/base/types.hpp"

namespace jink::planner::horizon {

/// One number for each lane.
template <std::size_t kLanes>
struct alignas(kLanes >= 4 ? 32 : 8) Lanes {
  std::array<double, kLanes> at;  ///< by lane

  /// Any numbers: setting them would take as long as the work that is done on them.
  Lanes() {}  // NOLINT(cppcoreguidelines-pro-type-member-init,modernize-use-equals-default): set by who uses it
  /// The same number in every lane.
  [[gnu::always_inline]] explicit Lanes(double value) { at.fill(value); }

  /// The number of lane i < kLanes.
  [[gnu::always_inline]] double& operator[](std::size_t i) { return at[i]; }
  /// The number of lane i < kLanes.
  [[gnu::always_inline]] const double& operator[](std::size_t i) const { return at[i]; }
};

/// One point or vector for each lane, ENU.
template <std::size_t kLanes>
struct PointLanes {
  Lanes<kLanes> x,  ///< east
      y,            ///< north
      z;            ///< up

  /// The same point in every lane.
  [[gnu::always_inline]] void set(const Vec3& p) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      x[i] = p.x();
      y[i] = p.y();
      z[i] = p.z();
    }
  }
  /// By lanes: a copy of the whole would be made in other registers than its lanes are read in, which stalls.
  [[gnu::always_inline]] void copy(const PointLanes& p) {
    for (std::size_t i = 0; i < kLanes; ++i) x[i] = p.x[i];
    for (std::size_t i = 0; i < kLanes; ++i) y[i] = p.y[i];
    for (std::size_t i = 0; i < kLanes; ++i) z[i] = p.z[i];
  }
  /// Lanes of more, from `first` on.
  template <std::size_t kMore>
  [[gnu::always_inline]] void copy(const PointLanes<kMore>& p, std::size_t first) {
    for (std::size_t i = 0; i < kLanes; ++i) x[i] = p.x[first + i];
    for (std::size_t i = 0; i < kLanes; ++i) y[i] = p.y[first + i];
    for (std::size_t i = 0; i < kLanes; ++i) z[i] = p.z[first + i];
  }
  /// The point of lane i < kLanes.
  [[nodiscard]] Vec3 lane(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// The smallest of all lanes.
template <std::size_t kLanes>
[[gnu::always_inline]] inline double smallest(const Lanes<kLanes>& v) {
  if constexpr (kLanes == 1) {
    return v[0];
  } else {
    constexpr std::size_t kPart = kLanes > 4 ? 4 : kLanes / 2;
    Lanes<kPart> part;
    for (std::size_t i = 0; i < kPart; ++i) part[i] = v[i];
    for (std::size_t j = kPart; j < kLanes; j += kPart) {
      for (std::size_t i = 0; i < kPart; ++i) part[i] = v[j + i] < part[i] ? v[j + i] : part[i];
    }
    return smallest(part);
  }
}

/// The smallest of kPart lanes, from `first` on.
template <std::size_t kPart, std::size_t kLanes>
[[gnu::always_inline]] inline double smallest_of(const Lanes<kLanes>& v, std::size_t first) {
  Lanes<kPart> part;
  for (std::size_t i = 0; i < kPart; ++i) part[i] = v[first + i];
  return smallest(part);
}

/// The largest of all lanes.
template <std::size_t kLanes>
[[gnu::always_inline]] inline double largest(const Lanes<kLanes>& v) {
  if constexpr (kLanes == 1) {
    return v[0];
  } else {
    constexpr std::size_t kPart = kLanes > 4 ? 4 : kLanes / 2;
    Lanes<kPart> part;
    for (std::size_t i = 0; i < kPart; ++i) part[i] = v[i];
    for (std::size_t j = kPart; j < kLanes; j += kPart) {
      for (std::size_t i = 0; i < kPart; ++i) part[i] = v[j + i] > part[i] ? v[j + i] : part[i];
    }
    return largest(part);
  }
}

/// A box in plain numbers.
struct PlainBox {
  double min_x,  ///< west, m
      min_y,     ///< south
      min_z,     ///< bottom
      max_x,     ///< east
      max_y,     ///< north
      max_z;     ///< top

  /// How far `value` lies outside [low, high]; 0 inside.
  [[gnu::always_inline]] static double outside(double low, double high, double value) {
    const double below = low - value;
    const double above = value - high;
    const double more = below > above ? below : above;
    return more > 0.0 ? more : 0.0;
  }
  /// Of a point to the box; 0 inside.
  [[gnu::always_inline]] [[nodiscard]] double squared_distance(double px, double py, double pz) const {
    const double x = outside(min_x, max_x, px);
    const double y = outside(min_y, max_y, py);
    const double z = outside(min_z, max_z, pz);
    return x * x + y * y + z * z;
  }
  /// Whether it has a place in common with another box. True where a number is not one.
  [[gnu::always_inline]] [[nodiscard]] bool meets(const base::Box& box) const {
    return !(min_x > box.max.x() || max_x < box.min.x() || min_y > box.max.y() || max_y < box.min.y() ||
             min_z > box.max.z() || max_z < box.min.z());
  }
  /// False where a number is not one.
  [[gnu::always_inline]] [[nodiscard]] bool inside(const base::Box& box) const {
    return min_x >= box.min.x() && min_y >= box.min.y() && min_z >= box.min.z() && max_x <= box.max.x() &&
           max_y <= box.max.y() && max_z <= box.max.z();
  }
};

}  // namespace jink::planner::horizon
