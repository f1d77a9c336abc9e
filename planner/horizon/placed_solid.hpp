// SPDX-License-Identifier: BSD-3-Clause
// A solid where it is at one time, and how far places are from it, one by one or in lockstep. A hull counts as all that
// is between its slabs: what is a hair's breadth beside it the search may take for touched; the verifier does not.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <span>

#include "planner/base/portable_math.hpp"
#include "planner/base/solid.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/lanes.hpp"

namespace jink::planner::horizon {

/// A solid in its place. It must outlive this.
class PlacedSolid {
 public:
  /// None: only is_none() may be asked.
  PlacedSolid() = default;
  /// The body's solid about `center`, ENU, m, after `t` seconds; none where the body has no solid.
  PlacedSolid(const base::Body& body, const Vec3& center, double t) : solid_(body.solid.get()) {
    if (solid_ == nullptr) return;
    const auto [sine, cosine] = base::sine_cosine(body.yaw + t * body.yaw_rate);
    Eigen::Matrix3d yaw;
    yaw << cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0;
    axes_ = yaw * solid_->pose().axes;
    shift_ = axes_.transpose() * (center + yaw * solid_->pose().center);
  }

  /// Whether there is no solid.
  [[nodiscard]] bool is_none() const { return solid_ == nullptr; }

  /// From a place to the surface, m; negative inside.
  [[nodiscard]] double distance(const Vec3& place) const {
    PointLanes<1> own;
    own.set(axes_.transpose() * place - shift_);
    Lanes<1> result;
    distances(own, result);
    return result[0];
  }

  /// The direction in which distance() grows by as much as the place moves: unit vector, ENU.
  [[nodiscard]] Vec3 outward(const Vec3& place) const;

  /// How far it reaches in a direction, unit vector, ENU, from its `center`, m.
  [[nodiscard]] double extent(const Vec3& direction) const;

  /// Places in the solid's own axes.
  template <std::size_t kLanes>
  [[gnu::always_inline]] void to_own(const PointLanes<kLanes>& places, PointLanes<kLanes>& own) const {
    // Number by number: a copy of the whole would be made in other registers than it is read in, which stalls.
    const double xx = axes_(0, 0), xy = axes_(1, 0), xz = axes_(2, 0), x0 = shift_.x();
    const double yx = axes_(0, 1), yy = axes_(1, 1), yz = axes_(2, 1), y0 = shift_.y();
    const double zx = axes_(0, 2), zy = axes_(1, 2), zz = axes_(2, 2), z0 = shift_.z();
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = places.x[i];
      const double y = places.y[i];
      const double z = places.z[i];
      own.x[i] = xx * x + xy * y + xz * z - x0;
      own.y[i] = yx * x + yy * y + yz * z - y0;
      own.z[i] = zx * x + zy * y + zz * z - z0;
    }
  }

  /// distance() of places in the solid's own axes.
  template <std::size_t kLanes>
  [[gnu::always_inline]] void distances(const PointLanes<kLanes>& own, Lanes<kLanes>& result) const {
    solid_->is_hull()        ? distances_of(Slabs(*solid_), own, result)
    : solid_->corner() > 0.0 ? distances_of(Prism<true>(*solid_), own, result)
                             : distances_of(Prism<false>(*solid_), own, result);
  }

  /// The smallest distance() of some places on each lane's line from `a` to `b`, in the solid's own axes: those in the
  /// middles of kPlaces equal parts.
  template <std::size_t kPlaces, std::size_t kLanes>
  [[gnu::always_inline]] void least_distances(const PointLanes<kLanes>& a, const PointLanes<kLanes>& b,
                                              Lanes<kLanes>& least) const {
    solid_->is_hull()        ? least_of<kPlaces>(Slabs(*solid_), a, b, least)
    : solid_->corner() > 0.0 ? least_of<kPlaces>(Prism<true>(*solid_), a, b, least)
                             : least_of<kPlaces>(Prism<false>(*solid_), a, b, least);
  }

 private:
  // Shapes measure without a branch, for loops over places: the squared distance outside, and what is at most 0 inside.
  // The distance is the root of the one and the other; of several places, that of the least of both.

  /// Where kCorner, its upright edges are rounded.
  template <bool kCorner>
  struct Prism {
    double half_x, half_y, half_z, corner, rounding;

    [[gnu::always_inline]] explicit Prism(const base::Solid& solid)
        : half_x(solid.half().x()),
          half_y(solid.half().y()),
          half_z(solid.half().z()),
          corner(solid.corner()),
          rounding(solid.rounding()) {}

    template <std::size_t kLanes>
    [[gnu::always_inline]] void measure(const PointLanes<kLanes>& own, Lanes<kLanes>& squared,
                                        Lanes<kLanes>& depth) const {
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double x = std::abs(own.x[i]) - half_x;
        const double y = std::abs(own.y[i]) - half_y;
        const double up = std::abs(own.z[i]) - half_z;
        const double over_x = x > 0.0 ? x : 0.0;
        const double over_y = y > 0.0 ? y : 0.0;
        const double over_up = up > 0.0 ? up : 0.0;
        double level = over_x * over_x + over_y * over_y;  // on its plane, squared
        double away = x > y ? x : y;                       // on its plane, where that is not above 0
        if constexpr (kCorner) {
          away = std::sqrt(level) + (away < 0.0 ? away : 0.0) - corner;
          const double over = away > 0.0 ? away : 0.0;
          level = over * over;
        }
        const double more = away > up ? away : up;
        squared[i] = level + over_up * over_up;
        depth[i] = more < 0.0 ? more : 0.0;
      }
    }
  };

  struct Slabs {
    static constexpr double rounding = 0.0;
    std::span<const base::Solid::Slab> slabs;

    [[gnu::always_inline]] explicit Slabs(const base::Solid& solid) : slabs(solid.slabs()) {}

    template <std::size_t kLanes>
    [[gnu::always_inline]] void measure(const PointLanes<kLanes>& own, Lanes<kLanes>& squared,
                                        Lanes<kLanes>& depth) const {
      Lanes<kLanes> most;
      for (std::size_t i = 0; i < kLanes; ++i) most[i] = -base::kInfinity;
      for (const base::Solid::Slab& slab : slabs) {
        const Vec3 n = slab.normal;
        for (std::size_t i = 0; i < kLanes; ++i) {
          const double along = n.x() * own.x[i] + n.y() * own.y[i] + n.z() * own.z[i];
          const double above = along - slab.high;
          const double below = slab.low - along;
          const double more = above > below ? above : below;
          most[i] = more > most[i] ? more : most[i];
        }
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double over = most[i] > 0.0 ? most[i] : 0.0;
        squared[i] = over * over;
        depth[i] = most[i] < 0.0 ? most[i] : 0.0;
      }
    }
  };

  template <std::size_t kLanes, typename Shape>
  [[gnu::always_inline]] static void distances_of(const Shape& shape, const PointLanes<kLanes>& own,
                                                  Lanes<kLanes>& result) {
    Lanes<kLanes> squared, depth;
    shape.measure(own, squared, depth);
    for (std::size_t i = 0; i < kLanes; ++i) result[i] = std::sqrt(squared[i]) + depth[i] - shape.rounding;
  }

  template <std::size_t kPlaces, std::size_t kLanes, typename Shape>
  [[gnu::always_inline]] static void least_of(const Shape& shape, const PointLanes<kLanes>& a,
                                              const PointLanes<kLanes>& b, Lanes<kLanes>& least) {
    PointLanes<kPlaces * kLanes> places;  // all at once: as many as are worked on elsewhere
    Lanes<kPlaces * kLanes> squared, depth;
    for (std::size_t n = 0; n < kPlaces; ++n) {
      const double s = (0.5 + static_cast<double>(n)) / kPlaces;
      for (std::size_t i = 0; i < kLanes; ++i) places.x[n * kLanes + i] = a.x[i] + s * (b.x[i] - a.x[i]);
      for (std::size_t i = 0; i < kLanes; ++i) places.y[n * kLanes + i] = a.y[i] + s * (b.y[i] - a.y[i]);
      for (std::size_t i = 0; i < kLanes; ++i) places.z[n * kLanes + i] = a.z[i] + s * (b.z[i] - a.z[i]);
    }
    shape.measure(places, squared, depth);
    for (std::size_t n = 1; n < kPlaces; ++n) {
      for (std::size_t i = 0; i < kLanes; ++i)
        squared[i] = squared[n * kLanes + i] < squared[i] ? squared[n * kLanes + i] : squared[i];
      for (std::size_t i = 0; i < kLanes; ++i)
        depth[i] = depth[n * kLanes + i] < depth[i] ? depth[n * kLanes + i] : depth[i];
    }
    for (std::size_t i = 0; i < kLanes; ++i) least[i] = std::sqrt(squared[i]) + depth[i] - shape.rounding;
  }

  const base::Solid* solid_ = nullptr;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< its own, in ENU, the columns
  Vec3 shift_ = Vec3::Zero();                           ///< of its middle, in its own axes
};

}  // namespace jink::planner::horizon
