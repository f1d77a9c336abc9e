// SPDX-License-Identifier: BSD-3-Clause
// How things move, for the judges of planned paths: in long double, and of their own. Shares no code with the planner.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

// What is promoted to long double here is meant to be.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

namespace jink::fuzz {

using Real = long double;

struct Place {
  Real x = 0, y = 0, z = 0;

  Place() = default;
  explicit Place(const Vec3& v) : x(v.x()), y(v.y()), z(v.z()) {}
  Place(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
  Place operator+(const Place& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Place operator-(const Place& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Place operator*(Real s) const { return {x * s, y * s, z * s}; }
  [[nodiscard]] Real dot(const Place& o) const { return x * o.x + y * o.y + z * o.z; }
  [[nodiscard]] Place cross(const Place& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
  [[nodiscard]] Real length() const { return std::sqrt(dot(*this)); }
  [[nodiscard]] Real level() const { return std::sqrt(x * x + y * y); }  ///< of its part on the level
};

/// A yaw, as a rotation about the vertical.
struct Turn {
  Real sine = 0, cosine = 1;

  Turn() = default;
  explicit Turn(Real yaw) : sine(std::sin(yaw)), cosine(std::cos(yaw)) {}
  [[nodiscard]] Place operator()(const Place& p) const {
    return {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z};
  }
  [[nodiscard]] Place back(const Place& p) const { return {cosine * p.x + sine * p.y, cosine * p.y - sine * p.x, p.z}; }
};

/// A body on a timed path: stands before it and after it.
class Walker {
 public:
  Walker(const planner::base::TimedPath& points, Real offset) : points_(points), offset_(offset) {
    for (std::size_t i = 1; i < points.size(); ++i) fastest_ = std::max(fastest_, velocity(i).length());
  }

  [[nodiscard]] Place at(Real t) const {
    const Real own = t + offset_;
    if (own <= points_.front().t) return Place(points_.front().position);
    if (own >= points_.back().t) return Place(points_.back().position);
    const std::size_t to = next(own);
    return Place(points_[to - 1].position) + velocity(to) * (own - points_[to - 1].t);
  }
  /// At an instant that is none of a point.
  [[nodiscard]] Place velocity_at(Real t) const {
    const Real own = t + offset_;
    return own <= points_.front().t || own >= points_.back().t ? Place() : velocity(next(own));
  }
  [[nodiscard]] Place acceleration_at(Real /*t*/) const { return {}; }
  [[nodiscard]] Real fastest() const { return fastest_; }
  /// Mean velocity from point i - 1 to i.
  [[nodiscard]] Place velocity(std::size_t i) const {
    return (Place(points_[i].position) - Place(points_[i - 1].position)) *
           (1 / (Real{points_[i].t} - Real{points_[i - 1].t}));
  }

 private:
  /// The point after a time between the first and the last.
  [[nodiscard]] std::size_t next(Real own) const {
    std::size_t low = 0;
    std::size_t high = points_.size() - 1;
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (points_[middle].t <= own ? low : high) = middle;
    }
    return high;
  }

  const planner::base::TimedPath& points_;
  Real offset_;
  Real fastest_ = 0;
};

/// A body that a track tells, `until` seconds after its instant at most: accelerated for a while, then not.
class Thrown {
 public:
  Thrown(const planner::base::Track& track, Real trust, Real until)
      : position_(track.position),
        velocity_(track.velocity),
        acceleration_(track.acceleration),
        bend_(std::max(Real{0}, trust - Real{track.age})) {
    fastest_ = velocity_.length() + acceleration_.length() * std::min(bend_, until);
  }

  [[nodiscard]] Place at(Real t) const {
    const Real a = std::min(t, bend_);
    const Place bent = position_ + velocity_ * a + acceleration_ * (a * a / 2);
    return bent + (velocity_ + acceleration_ * a) * (t - a);
  }
  [[nodiscard]] Place velocity_at(Real t) const { return velocity_ + acceleration_ * std::min(t, bend_); }
  [[nodiscard]] Place acceleration_at(Real t) const { return t < bend_ ? acceleration_ : Place(); }
  [[nodiscard]] Real fastest() const { return fastest_; }
  /// When it is no longer accelerated.
  [[nodiscard]] Real bend() const { return bend_; }

 private:
  Place position_, velocity_, acceleration_;
  Real bend_;
  Real fastest_ = 0;
};

}  // namespace jink::fuzz

#pragma GCC diagnostic pop
