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
    const Eigen::Matrix3d a = axes_;
    const Vec3 shift = shift_;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = places.x[i];
      const double y = places.y[i];
      const double z = places.z[i];
      own.x[i] = a(0, 0) * x + a(1, 0) * y + a(2, 0) * z - shift.x();
      own.y[i] = a(0, 1) * x + a(1, 1) * y + a(2, 1) * z - shift.y();
      own.z[i] = a(0, 2) * x + a(1, 2) * y + a(2, 2) * z - shift.z();
    }
  }

  /// distance() of places in the solid's own axes.
  template <std::size_t kLanes>
  [[gnu::always_inline]] void distances(const PointLanes<kLanes>& own, Lanes<kLanes>& result) const {
    solid_->is_hull() ? Slabs(*solid_).distances(own, result) : Prism(*solid_).distances(own, result);
  }

  /// The smallest distance() of some places on each lane's line from `a` to `b`, in the solid's own axes: those in the
  /// middles of kPlaces equal parts.
  template <std::size_t kPlaces, std::size_t kLanes>
  [[gnu::always_inline]] void least_distances(const PointLanes<kLanes>& a, const PointLanes<kLanes>& b,
                                              Lanes<kLanes>& least) const {
    solid_->is_hull() ? least_of<kPlaces>(Slabs(*solid_), a, b, least) : least_of<kPlaces>(Prism(*solid_), a, b, least);
  }

 private:
  // Without a branch, for loops over places. Beyond the rectangle by `away` on its plane, and by `up` upwards.
  struct Prism {
    double half_x, half_y, half_z, corner, rounding;

    [[gnu::always_inline]] explicit Prism(const base::Solid& solid)
        : half_x(solid.half().x()),
          half_y(solid.half().y()),
          half_z(solid.half().z()),
          corner(solid.corner()),
          rounding(solid.rounding()) {}

    template <std::size_t kLanes>
    [[gnu::always_inline]] void distances(const PointLanes<kLanes>& own, Lanes<kLanes>& result) const {
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double x = std::abs(own.x[i]) - half_x;
        const double y = std::abs(own.y[i]) - half_y;
        const double up = std::abs(own.z[i]) - half_z;
        const double away = outside(x, y) - corner;
        result[i] = outside(away, up) - rounding;
      }
    }
  };

  struct Slabs {
    std::span<const base::Solid::Slab> slabs;

    [[gnu::always_inline]] explicit Slabs(const base::Solid& solid) : slabs(solid.slabs()) {}

    template <std::size_t kLanes>
    [[gnu::always_inline]] void distances(const PointLanes<kLanes>& own, Lanes<kLanes>& result) const {
      for (std::size_t i = 0; i < kLanes; ++i) result[i] = -base::kInfinity;
      for (const base::Solid::Slab& slab : slabs) {
        const Vec3 n = slab.normal;
        for (std::size_t i = 0; i < kLanes; ++i) {
          const double along = n.x() * own.x[i] + n.y() * own.y[i] + n.z() * own.z[i];
          const double above = along - slab.high;
          const double below = slab.low - along;
          const double more = above > below ? above : below;
          result[i] = more > result[i] ? more : result[i];
        }
      }
    }
  };

  template <std::size_t kPlaces, std::size_t kLanes, typename Shape>
  [[gnu::always_inline]] static void least_of(const Shape& shape, const PointLanes<kLanes>& a,
                                              const PointLanes<kLanes>& b, Lanes<kLanes>& least) {
    PointLanes<kLanes> place;
    Lanes<kLanes> distance;
    for (std::size_t i = 0; i < kLanes; ++i) least[i] = base::kInfinity;
    for (std::size_t n = 0; n < kPlaces; ++n) {
      const double s = (0.5 + static_cast<double>(n)) / kPlaces;
      for (std::size_t i = 0; i < kLanes; ++i) {
        place.x[i] = a.x[i] + s * (b.x[i] - a.x[i]);
        place.y[i] = a.y[i] + s * (b.y[i] - a.y[i]);
        place.z[i] = a.z[i] + s * (b.z[i] - a.z[i]);
      }
      shape.distances(place, distance);
      for (std::size_t i = 0; i < kLanes; ++i) least[i] = distance[i] < least[i] ? distance[i] : least[i];
    }
  }

  /// Of two distances beyond faces that are at right angles, one: the corner between them is round.
  [[gnu::always_inline]] static double outside(double a, double b) {
    const double over_a = a > 0.0 ? a : 0.0;
    const double over_b = b > 0.0 ? b : 0.0;
    const double more = a > b ? a : b;
    return std::sqrt(over_a * over_a + over_b * over_b) + (more < 0.0 ? more : 0.0);
  }

  const base::Solid* solid_ = nullptr;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< its own, in ENU, the columns
  Vec3 shift_ = Vec3::Zero();                           ///< of its middle, in its own axes
};

}  // namespace jink::planner::horizon
