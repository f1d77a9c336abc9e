// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/enclosing_sphere.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace jink::planner::geometry {
namespace {

/// Up to four points span a sphere in space; a fifth is the one about to enter.
constexpr std::size_t kMaxBasis = 4;
/// A direction shorter than this part of its edge is rounding: the points are affinely dependent.
constexpr double kDependent = 1e-14;
/// Radii grow strictly, so that the loop ends by itself; the cap only stops a cycle that rounding might cause.
constexpr int kMaxExchanges = 1000;

struct PointList {
  PointList() { points.fill(Vec3::Zero()); }  // Eigen's own default leaves them unset

  std::array<Vec3, kMaxBasis + 1> points;
  std::size_t size = 0;
};

double largest_distance(std::span<const Vec3> points, const Vec3& center) {
  double largest = 0.0;
  for (const Vec3& p : points) largest = std::max(largest, (p - center).norm());
  return largest;
}

/// The centre of the smallest sphere through all (one to four) points, which lies in their affine hull. False where
/// they are affinely dependent; a smaller subset then does the same.
bool circumcenter(std::span<const Vec3> points, Vec3& center) {
  // With a_i = p_i - p_0 the centre p_0 + x has a_i . x = |a_i|^2 / 2. Gram-Schmidt turns that into a triangular
  // system.
  std::array<Vec3, 3> basis;
  Vec3 x = Vec3::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 a = points[i] - points[0];
    Vec3 direction = a;
    for (std::size_t j = 0; j + 1 < i; ++j) direction -= basis[j].dot(direction) * basis[j];
    const double length = direction.norm();
    if (!(length > kDependent * a.norm())) return false;
    direction /= length;
    basis[i - 1] = direction;
    x += (0.5 * a.squaredNorm() - a.dot(x)) / a.dot(direction) * direction;
  }
  center = points[0] + x;
  return center.allFinite();
}

/// Replaces `list` (up to five points) by the subset that spans its smallest enclosing sphere, and returns the sphere.
Sphere solve_basis(PointList& list) {
  const std::span<const Vec3> all(list.points.data(), list.size);
  Sphere best{all[0], base::kInfinity};
  PointList best_subset;
  for (unsigned mask = 1; mask < (1U << list.size); ++mask) {
    if (std::popcount(mask) > static_cast<int>(kMaxBasis)) continue;
    PointList subset;
    for (std::size_t i = 0; i < list.size; ++i) {
      if ((mask >> i & 1U) != 0) subset.points[subset.size++] = all[i];
    }
    Vec3 center;
    if (!circumcenter({subset.points.data(), subset.size}, center)) continue;
    // Each centre with the radius that reaches every point is an enclosing sphere, and the smallest is among them: no
    // tolerance is needed to say which subset is valid.
    const double radius = largest_distance(all, center);
    if (radius < best.radius) {
      best = {center, radius};
      best_subset = subset;
    }
  }
  list = best_subset;
  return best;
}

}  // namespace

Sphere smallest_enclosing_sphere(std::span<const Vec3> points) {
  assert(!points.empty());
  if (points.empty()) return {};
  PointList basis;
  basis.points[basis.size++] = points[0];
  Sphere sphere{points[0], 0.0};
  for (int exchange = 0; exchange < kMaxExchanges; ++exchange) {
    std::size_t farthest = 0;
    double distance = -1.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = (points[i] - sphere.center).norm();
      if (d > distance) {
        distance = d;
        farthest = i;
      }
    }
    if (distance <= sphere.radius) break;
    basis.points[basis.size++] = points[farthest];
    const Sphere grown = solve_basis(basis);
    if (!(grown.radius > sphere.radius)) break;  // outside by rounding alone
    sphere = grown;
  }
  sphere.radius = largest_distance(points, sphere.center);
  return sphere;
}

}  // namespace jink::planner::geometry
