// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/convex_hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace jink::tools::report {
namespace {

using Points = std::span<const Vec3>;

constexpr double kFlat = 1e-9;  // of the set's size

template <typename Measure>
std::pair<std::size_t, double> farthest(Points points, const Measure& measure) {
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (const double d = measure(points[i]); d > most) {
      most = d;
      best = i;
    }
  }
  return {best, most};
}

/// Height of `p` over the triangle's plane, on its outer side; 0 where the triangle has no area.
double height(Points points, const Triangle& f, const Vec3& p) {
  const Vec3 normal = (points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]);
  const double area = normal.norm();
  return area > 0.0 ? normal.dot(p - points[f[0]]) / area : 0.0;
}

/// The hull of points in the plane with that normal, fanned out and seen from both sides.
std::vector<Triangle> flat_hull(Points points, const Vec3& normal, double tolerance) {
  const std::vector<std::size_t> ring = hull_ring(points, normal, tolerance);
  std::vector<Triangle> faces;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    faces.push_back({ring[0], ring[i], ring[i + 1]});
    faces.push_back({ring[0], ring[i + 1], ring[i]});
  }
  return faces;
}

/// Replaces the faces that `i` sees by those from it to their horizon.
void add_point(Points points, std::vector<Triangle>& faces, std::size_t i, double tolerance) {
  std::set<std::pair<std::size_t, std::size_t>> edges;  // of the seen faces, directed
  const auto seen = [&](const Triangle& f) { return height(points, f, points[i]) > tolerance; };
  for (const Triangle& f : faces) {
    if (!seen(f)) continue;
    for (std::size_t k = 0; k < 3; ++k) edges.emplace(f[k], f[(k + 1) % 3]);
  }
  if (edges.empty()) return;
  std::erase_if(faces, seen);
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) faces.push_back({a, b, i});
  }
}

}  // namespace

std::vector<std::size_t> hull_ring(Points points, const Vec3& normal, double tolerance) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto key = [&](std::size_t i) { return std::pair(u.dot(points[i]), v.dot(points[i])); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<std::size_t> ring;  // monotone chain: lower, then upper
  const auto add = [&](std::size_t i, std::size_t least) {
    const auto turns_right = [&] {
      const Vec3 a = points[ring[ring.size() - 2]], b = points[ring.back()];
      return (b - a).cross(points[i] - b).dot(normal) <= tolerance * (b - a).norm();
    };
    while (ring.size() > least && turns_right()) ring.pop_back();
    ring.push_back(i);
  };
  for (const std::size_t i : order) add(i, 1);
  const std::size_t lower = ring.size();
  for (auto i = order.rbegin() + 1; i != order.rend(); ++i) add(*i, lower);
  if (ring.size() > 1) ring.pop_back();  // the first again
  return ring;
}

std::vector<Triangle> convex_hull(Points points) {
  const std::size_t a = 0;
  const auto [b, size] = farthest(points, [&](const Vec3& p) { return (p - points[a]).norm(); });
  const double tolerance = kFlat * size;
  if (!(size > 0.0)) return {{a, a, a}};
  const Vec3 along = (points[b] - points[a]) / size;
  const auto beside = [&](const Vec3& p) { return (p - points[a]).cross(along).norm(); };
  const auto [c, width] = farthest(points, beside);
  if (width <= tolerance) {
    const auto less = [&](const Vec3& p, const Vec3& q) { return along.dot(p) < along.dot(q); };
    const auto [first, last] = std::minmax_element(points.begin(), points.end(), less);
    const auto index = [&](auto place) { return static_cast<std::size_t>(place - points.begin()); };
    return {{index(first), index(last), index(last)}};
  }
  const Vec3 normal = along.cross(points[c] - points[a]).normalized();
  const auto [d, depth] = farthest(points, [&](const Vec3& p) { return std::abs(normal.dot(p - points[a])); });
  if (depth <= tolerance) return flat_hull(points, normal, tolerance);
  const bool above = normal.dot(points[d] - points[a]) > 0.0;
  const std::size_t p = above ? c : b, q = above ? b : c;  // a, p, q: counter-clockwise seen from away of d
  std::vector<Triangle> faces{{a, p, q}, {p, a, d}, {q, p, d}, {a, q, d}};
  for (std::size_t i = 0; i < points.size(); ++i) add_point(points, faces, i, tolerance);
  return faces;
}

}  // namespace jink::tools::report
