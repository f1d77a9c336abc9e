// SPDX-License-Identifier: BSD-3-Clause
// How far a point is from a solid, for the judges of planned paths: in long double, and of its own. Shares no code with
// the planner.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/fuzz/any_shape.hpp"
#include "tests/fuzz/judged_motion.hpp"

// What is promoted to long double here is meant to be.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

namespace jink::fuzz {

/// A solid at yaw 0, about its reference point.
class JudgedSolid {
 public:
  /// From the surface, m: negative within, minus the way out, but 0 in a hull. And the direction in which it grows.
  struct Nearest {
    Real distance = 0;
    Place normal;  ///< unit vector; zero in a hull
  };

  explicit JudgedSolid(const Shape& shape)
      : kind_(shape.kind), corner_(shape.corner), rounding_(shape.rounding), a_(shape.a), b_(shape.b) {
    for (Eigen::Index i = 0; i < 3; ++i) axes_[static_cast<std::size_t>(i)] = Place(shape.pose.axes.col(i));
    center_ = Place(shape.pose.center);
    half_ = Place(shape.half);
    for (const Vec3& vertex : shape.vertices) vertices_.emplace_back(vertex);
    if (kind_ == Shape::Kind::kHull) find_faces();
    if (kind_ == Shape::Kind::kHull) {
      for (const Place& v : vertices_) reach_ = std::max(reach_, v.length());
    } else if (kind_ == Shape::Kind::kCapsule) {
      reach_ = std::max(a_.length(), b_.length()) + rounding_;
    } else {
      reach_ = center_.length() + half_.length() + corner_ + rounding_;
    }
  }

  /// No point of it is farther from the reference point.
  [[nodiscard]] Real reach() const { return reach_; }
  [[nodiscard]] bool is_hull() const { return kind_ == Shape::Kind::kHull; }

  /// The largest direction · p of its points p. All of it is on the other side of that plane, so that nothing is nearer
  /// to a point q than direction · q - extent(direction), whatever the unit vector: what proves a distance.
  [[nodiscard]] Real extent(const Place& direction) const {
    if (is_hull()) {
      Real most = vertices_[0].dot(direction);
      for (const Place& v : vertices_) most = std::max(most, v.dot(direction));
      return most;
    }
    if (kind_ == Shape::Kind::kCapsule)
      return std::max(a_.dot(direction), b_.dot(direction)) + rounding_ * direction.length();
    const Place own = in_axes(direction);
    return center_.dot(direction) + half_.x * std::abs(own.x) + half_.y * std::abs(own.y) + half_.z * std::abs(own.z) +
           corner_ * own.level() + rounding_ * own.length();
  }

  [[nodiscard]] Nearest nearest(const Place& p) const {
    if (is_hull()) return of_hull(p);
    return kind_ == Shape::Kind::kCapsule ? of_capsule(p) : of_prism(p);
  }

  /// Whether it looks the same from all sides of the vertical through center().
  [[nodiscard]] bool is_round() const {
    if (is_hull()) return vertices_.size() == 1;
    if (kind_ == Shape::Kind::kCapsule) return a_.x == b_.x && a_.y == b_.y;
    return half_.x == 0 && half_.y == 0 && std::abs(axes_[2].z) == 1;
  }
  [[nodiscard]] Place center() const {
    if (is_hull()) return vertices_[0];
    return kind_ == Shape::Kind::kCapsule ? (a_ + b_) * 0.5L : center_;
  }

 private:
  static constexpr Real kNone = 1e-12L;  // m, a length in which no direction is told

  struct Face {
    Place origin, normal;  // outward
    std::array<Place, 3> corners, inward;
  };

  [[nodiscard]] Place in_axes(const Place& p) const { return {axes_[0].dot(p), axes_[1].dot(p), axes_[2].dot(p)}; }
  [[nodiscard]] Place from_axes(const Place& p) const { return axes_[0] * p.x + axes_[1] * p.y + axes_[2] * p.z; }

  [[nodiscard]] Nearest of_capsule(const Place& p) const {
    const Place along = b_ - a_;
    const Place nearest = on_segment(a_, b_, p);
    const Place away = p - nearest;
    const Real distance = away.length();
    if (distance > kNone) return {distance - rounding_, away * (1 / distance)};
    Place side = along.cross({1, 0, 0});
    if (std::abs(along.x) > std::abs(along.y)) side = along.cross({0, 1, 0});
    const Real length = side.length();
    return {distance - rounding_, length > 0 ? side * (1 / length) : Place(0, 0, 1)};
  }

  /// What is left of it without its rounding is a rectangle with rounded corners times a line.
  [[nodiscard]] Nearest of_prism(const Place& p) const {
    const Place own = in_axes(p - center_);
    const Place beside(own.x - std::clamp(own.x, -half_.x, half_.x), own.y - std::clamp(own.y, -half_.y, half_.y), 0);
    const Real apart = beside.level();
    const Real over = std::abs(own.z) - half_.z;
    const Place up(0, 0, own.z < 0 ? -1 : 1);
    Real level = apart - corner_;
    Place out = apart > 0 ? beside * (1 / apart) : Place();
    if (apart <= 0) {
      const Real x = std::abs(own.x) - half_.x;
      const Real y = std::abs(own.y) - half_.y;
      level = std::max(x, y) - corner_;
      out = x > y ? Place(own.x < 0 ? -1 : 1, 0, 0) : Place(0, own.y < 0 ? -1 : 1, 0);
    }
    if (level <= kNone || over <= kNone) {
      return {std::max(level, over) - rounding_, from_axes(level > over ? out : up)};
    }
    const Place away = out * level + up * over;
    const Real distance = away.length();
    return {distance - rounding_, from_axes(away * (1 / distance))};
  }

  [[nodiscard]] Nearest of_hull(const Place& p) const {
    const auto behind = [&](const Face& face) { return face.normal.dot(p - face.origin) <= 0; };
    if (!flat_ && std::all_of(faces_.begin(), faces_.end(), behind)) return {};
    Place away = p - vertices_[0];
    Real least = away.dot(away);
    const auto look = [&](const Place& there) {
      const Real squared = there.dot(there);
      if (!(squared < least)) return;
      least = squared;
      away = there;
    };
    for (const Face& face : faces_) {
      const Real height = face.normal.dot(p - face.origin);
      if (height * height >= least) continue;
      bool above = true;
      for (std::size_t i = 0; i < 3 && above; ++i) above = face.inward[i].dot(p - face.corners[i]) >= 0;
      if (above) look(face.normal * height);
    }
    for (const auto& [a, b] : edges_) look(p - on_segment(a, b, p));
    const Real distance = std::sqrt(least);
    return {distance, distance > 0 ? away * (1 / distance) : Place()};
  }

  static Place on_segment(const Place& a, const Place& b, const Place& p) {
    const Place along = b - a;
    const Real squared = along.dot(along);
    return squared > 0 ? a + along * std::clamp((p - a).dot(along) / squared, Real{0}, Real{1}) : a;
  }

  /// A point outside of a hull is nearest to a triangle of its surface, and all of that is made of triangles of three
  /// vertices with no two others on either side. So is all of a hull that is flat.
  void find_faces() {
    const std::size_t count = vertices_.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        edges_.push_back({vertices_[i], vertices_[j]});
        for (std::size_t k = j + 1; k < count; ++k) add_face(vertices_[i], vertices_[j], vertices_[k]);
      }
    }
    flat_ = flat_ || faces_.empty();
  }

  void add_face(const Place& a, const Place& b, const Place& c) {
    const Place normal = (b - a).cross(c - a);
    const Real size = std::max({(b - a).length(), (c - a).length(), (c - b).length()});
    const Real length = normal.length();
    if (length <= kNone * size) return;  // a line: the edges hold it
    Face face{a, normal * (1 / length), {a, b, c}, {}};
    Real low = 0;
    Real high = 0;
    for (const Place& v : vertices_) {
      const Real height = face.normal.dot(v - a);
      low = std::min(low, height);
      high = std::max(high, height);
    }
    if (low < -kNone && high > kNone) return;
    flat_ = flat_ || (low >= -kNone && high <= kNone);
    const Place inward = face.normal;
    face.inward = {inward.cross(b - a), inward.cross(c - b), inward.cross(a - c)};
    if (high > kNone) face.normal = face.normal * -1;
    faces_.push_back(face);
  }

  Shape::Kind kind_;
  std::array<Place, 3> axes_;
  Place center_, half_;
  Real corner_, rounding_;
  Place a_, b_;
  std::vector<Place> vertices_;
  std::vector<Face> faces_;
  bool flat_ = false;  // all vertices are on one plane
  std::vector<std::array<Place, 2>> edges_;
  Real reach_ = 0;
};

}  // namespace jink::fuzz

#pragma GCC diagnostic pop
