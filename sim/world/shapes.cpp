// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "planner/base/portable_math.hpp"

namespace jink::sim::world {
namespace {

/// A point of the difference of the hull and the way, seen from the way: the origin is in it where they touch.
struct Difference {
  Vec3 point = Vec3::Zero();
  double fraction = 0.0;  ///< the place on the way that it belongs to
};

struct Simplex {
  std::array<Difference, 4> corners;
  std::size_t size = 0;
};

/// Weights, adding up to 1, of the point nearest to the origin in the affine hull of the corners. False where the
/// corners are affinely dependent, or where that point is not between them.
bool nearest_weights(const Simplex& simplex, std::array<double, 4>& weights) {
  constexpr double kDependent = 1e-14;
  const Vec3& base = simplex.corners[0].point;
  // The edges from `base` are Q R by Gram-Schmidt; R w = -Q' base gives the weights of the other corners.
  std::array<Vec3, 3> q;
  Eigen::Matrix3d r = Eigen::Matrix3d::Zero();
  const int edges = static_cast<int>(simplex.size) - 1;
  for (int i = 0; i < edges; ++i) {
    const Vec3 edge = simplex.corners[static_cast<std::size_t>(i) + 1].point - base;
    Vec3 direction = edge;
    for (int j = 0; j < i; ++j) {
      r(j, i) = q[static_cast<std::size_t>(j)].dot(direction);
      direction -= r(j, i) * q[static_cast<std::size_t>(j)];
    }
    r(i, i) = direction.norm();
    if (!(r(i, i) > kDependent * edge.norm())) return false;
    q[static_cast<std::size_t>(i)] = direction / r(i, i);
  }
  weights[0] = 1.0;
  for (int i = edges - 1; i >= 0; --i) {
    double sum = -q[static_cast<std::size_t>(i)].dot(base);
    for (int j = i + 1; j < edges; ++j) sum -= r(i, j) * weights[static_cast<std::size_t>(j) + 1];
    const double weight = sum / r(i, i);
    weights[static_cast<std::size_t>(i) + 1] = weight;
    weights[0] -= weight;
  }
  return std::all_of(weights.begin(), weights.begin() + edges + 1, [](double w) { return w >= 0.0; });
}

/// Reduces the simplex to the corners that carry its point nearest to the origin, and returns that point. It tries
/// every subset: at most 15, and no case distinction that rounding could get wrong.
Difference reduce(Simplex& simplex) {
  Difference nearest;
  Simplex carrier;
  double smallest = planner::base::kInfinity;
  for (unsigned mask = 1; mask < (1U << simplex.size); ++mask) {
    Simplex subset;
    for (std::size_t i = 0; i < simplex.size; ++i) {
      if ((mask >> i & 1U) != 0) subset.corners[subset.size++] = simplex.corners[i];
    }
    std::array<double, 4> weights{};
    if (!nearest_weights(subset, weights)) continue;
    Difference mean;
    for (std::size_t i = 0; i < subset.size; ++i) {
      mean.point += weights[i] * subset.corners[i].point;
      mean.fraction += weights[i] * subset.corners[i].fraction;
    }
    if (mean.point.squaredNorm() < smallest) {
      smallest = mean.point.squaredNorm();
      nearest = mean;
      carrier = subset;
    }
  }
  simplex = carrier;
  return nearest;
}

/// Distance of the convex hull of `vertices` (at least one) from the way, 0 where they touch: Gilbert, Johnson and
/// Keerthi's algorithm on the hull's difference with the way.
SegmentDistance hull_distance(const std::vector<Vec3>& vertices, const Vec3& begin, const Vec3& end) {
  constexpr int kMaxSteps = 200;       // a few are usual; each step comes strictly nearer
  constexpr double kRelative = 1e-12;  // of the size of the difference
  double size = 0.0;
  for (const Vec3& v : vertices) size = std::max({size, (v - begin).norm(), (v - end).norm()});
  const auto support = [&](const Vec3& direction) {
    const auto lowest = std::min_element(vertices.begin(), vertices.end(), [&](const Vec3& a, const Vec3& b) {
      return a.dot(direction) < b.dot(direction);
    });
    const bool at_end = end.dot(direction) > begin.dot(direction);
    return at_end ? Difference{*lowest - end, 1.0} : Difference{*lowest - begin, 0.0};
  };
  Simplex simplex;
  simplex.corners[simplex.size++] = {vertices.front() - begin, 0.0};
  Difference nearest = simplex.corners[0];
  for (int step = 0; step < kMaxSteps; ++step) {
    const double length = nearest.point.norm();
    if (length <= kRelative * size) return {0.0, nearest.fraction};
    // No point of the difference is beyond the plane through the lowest one, which bounds the error.
    const Difference lowest = support(nearest.point);
    const double gap = nearest.point.dot(nearest.point - lowest.point);
    if (gap <= kRelative * size * length || simplex.size == simplex.corners.size()) break;
    simplex.corners[simplex.size++] = lowest;
    const Difference next = reduce(simplex);
    if (!(next.point.norm() < length)) break;  // as near as rounding allows
    nearest = next;
  }
  return {nearest.point.norm(), nearest.fraction};
}

// Here `point`, `begin` and `end` are relative to the reference point.

/// The smallest distance between two straight ways, and where on the first: at an end of one, or where both are met by
/// the line across them.
SegmentDistance lines_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto share_of = [](const Vec3& p, const Vec3& from, const Vec3& way) {
    const double square = way.squaredNorm();
    return square > 0.0 ? std::clamp((p - from).dot(way) / square, 0.0, 1.0) : 0.0;
  };
  const Vec3 u = b - a;
  const Vec3 v = d - c;
  SegmentDistance best;
  const auto consider = [&](double s) {
    const Vec3 p = a + s * u;
    const double distance = (p - c - share_of(p, c, v) * v).norm();
    if (distance < best.distance) best = {distance, s};
  };
  consider(0.0);
  consider(1.0);
  consider(share_of(c, a, u));
  consider(share_of(d, a, u));
  const double parallel = u.dot(v);
  const double across = u.squaredNorm() * v.squaredNorm() - parallel * parallel;
  if (across > 0.0) consider(std::clamp((parallel * v.dot(a - c) - v.squaredNorm() * u.dot(a - c)) / across, 0.0, 1.0));
  return best;
}

double signed_distance(const config::SphereShape& shape, const Vec3& point) {
  return point.norm() - shape.radius;
}

double signed_distance(const config::BoxShape& shape, const Vec3& point) {
  const Vec3 beyond = point.cwiseAbs() - 0.5 * shape.edges;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

double signed_distance(const config::CylinderShape& shape, const Vec3& point) {
  const double aside = point.head<2>().norm() - shape.radius;
  const double above = std::abs(point.z()) - 0.5 * shape.height;
  return planner::base::hypotenuse(std::max(aside, 0.0), std::max(above, 0.0)) + std::min(std::max(aside, above), 0.0);
}

double signed_distance(const config::CapsuleShape& shape, const Vec3& point) {
  return lines_distance(point, point, shape.a, shape.b).distance - shape.radius;
}

double signed_distance(const config::VertexShape& shape, const Vec3& point) {
  return hull_distance(shape.vertices, point, point).distance;
}

SegmentDistance along(const config::SphereShape& shape, const Vec3& begin, const Vec3& end) {
  const Vec3 way = end - begin;
  const double square = way.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp(-begin.dot(way) / square, 0.0, 1.0) : 0.0;
  return {signed_distance(shape, begin + fraction * way), fraction};
}

/// The few places where the minimum of a box's distance along a line can be.
class Candidates {
 public:
  void add(double fraction) {
    if (fraction >= 0.0 && fraction <= 1.0) values_[size_++] = fraction;
  }
  void sort() { std::sort(begin(), end()); }
  [[nodiscard]] double* begin() { return values_.data(); }
  [[nodiscard]] double* end() { return values_.data() + size_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double operator[](std::size_t i) const { return values_[i]; }

 private:
  // 2 ends, 6 planes, 7 pieces between them, 12 meetings of two axes and 3 centre planes.
  std::array<double, 32> values_{};
  std::size_t size_ = 0;
};

/// Outside, the squared distance is the sum of the squares by which each axis is beyond its face: a convex function,
/// quadratic between the places where the way crosses a face's plane. Adds the minimum of each piece.
void add_outside_minima(const Vec3& half, const Vec3& begin, const Vec3& way, Candidates& candidates) {
  candidates.sort();
  const std::size_t pieces = candidates.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const Vec3 middle = begin + 0.5 * (candidates[i] + candidates[i + 1]) * way;
    double slope = 0.0;
    double curvature = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(middle[axis]) <= half[axis]) continue;
      slope += (begin[axis] - std::copysign(half[axis], middle[axis])) * way[axis];
      curvature += way[axis] * way[axis];
    }
    if (curvature > 0.0) candidates.add(std::clamp(-slope / curvature, candidates[i], candidates[i + 1]));
  }
}

/// Inside, the distance is the largest of the six ±x - half: piecewise linear, so its minimum is where two of them
/// meet.
void add_inside_minima(const Vec3& half, const Vec3& begin, const Vec3& way, Candidates& candidates) {
  for (int i = 0; i < 3; ++i) {
    if (way[i] != 0.0) candidates.add(-begin[i] / way[i]);
    for (int j = 0; j < i; ++j) {
      for (const double si : {1.0, -1.0}) {
        for (const double sj : {1.0, -1.0}) {
          const double slope = si * way[i] - sj * way[j];
          if (slope != 0.0) candidates.add((half[i] - half[j] - si * begin[i] + sj * begin[j]) / slope);
        }
      }
    }
  }
}

SegmentDistance along(const config::BoxShape& shape, const Vec3& begin, const Vec3& end) {
  const Vec3 half = 0.5 * shape.edges;
  const Vec3 way = end - begin;
  Candidates candidates;
  candidates.add(0.0);
  candidates.add(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.0) continue;
    candidates.add((half[axis] - begin[axis]) / way[axis]);
    candidates.add((-half[axis] - begin[axis]) / way[axis]);
  }
  add_outside_minima(half, begin, way, candidates);
  add_inside_minima(half, begin, way, candidates);
  SegmentDistance best;
  for (const double fraction : candidates) {
    const double value = signed_distance(shape, begin + fraction * way);
    if (value < best.distance) best = {value, fraction};
  }
  return best;
}

/// Along a line the distance is convex: the interval that holds its minimum is cut in thirds.
SegmentDistance along(const config::CylinderShape& shape, const Vec3& begin, const Vec3& end) {
  const auto at = [&](double s) { return signed_distance(shape, begin + s * (end - begin)); };
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double a = low + (high - low) / 3.0;
    const double b = high - (high - low) / 3.0;
    at(a) < at(b) ? high = b : low = a;
  }
  SegmentDistance best;
  for (const double s : {0.0, 0.5 * (low + high), 1.0}) {
    if (at(s) < best.distance) best = {at(s), s};
  }
  return best;
}

SegmentDistance along(const config::CapsuleShape& shape, const Vec3& begin, const Vec3& end) {
  const SegmentDistance line = lines_distance(begin, end, shape.a, shape.b);
  return {line.distance - shape.radius, line.fraction};
}

SegmentDistance along(const config::VertexShape& shape, const Vec3& begin, const Vec3& end) {
  return hull_distance(shape.vertices, begin, end);
}

double depth(const config::SphereShape& shape) {
  return shape.radius;
}
double depth(const config::BoxShape& shape) {
  return 0.5 * shape.edges.minCoeff();
}
double depth(const config::CylinderShape& shape) {
  return std::min(shape.radius, 0.5 * shape.height);
}
double depth(const config::CapsuleShape& shape) {
  return shape.radius;
}
double depth(const config::VertexShape& /*shape*/) {
  return 0.0;
}

}  // namespace

double distance(const config::Shape& shape, const Vec3& reference, const Vec3& point) {
  return std::visit([&](const auto& s) { return signed_distance(s, point - reference); }, shape);
}

SegmentDistance segment_distance(const config::Shape& shape, const Vec3& reference, const Vec3& begin,
                                 const Vec3& end) {
  return std::visit([&](const auto& s) { return along(s, begin - reference, end - reference); }, shape);
}

double deepest(const config::Shape& shape) {
  return std::visit([](const auto& s) { return -depth(s); }, shape);
}

}  // namespace jink::sim::world
