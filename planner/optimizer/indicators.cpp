// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/indicators.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/base/portable_math.hpp"

namespace jink::planner::optimizer {
namespace {

/// Sorted by the first objective, without the points that another dominates or equals.
std::vector<Point2> non_dominated(std::span<const Point2> points) {
  std::vector<Point2> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<Point2> front;
  for (const Point2& p : sorted) {
    if (front.empty() || p[1] < front.back()[1]) front.push_back(p);
  }
  return front;
}

double extent(std::span<const Point2> points, std::size_t objective) {
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(), [=](const Point2& a, const Point2& b) { return a[objective] < b[objective]; });
  return (*high)[objective] - (*low)[objective];
}

}  // namespace

FrontBounds front_bounds(std::span<const Point2> points) {
  const std::vector<Point2> front = non_dominated(points);
  assert(!front.empty());
  return {{front.front()[0], front.back()[1]}, {front.back()[0], front.front()[1]}};
}

Point2 normalise(const Point2& point, const FrontBounds& bounds) {
  Point2 result{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double range = bounds.nadir[k] - bounds.ideal[k];
    if (range > 0.0) result[k] = (point[k] - bounds.ideal[k]) / range;
  }
  return result;
}

double hypervolume(std::span<const Point2> points, const Point2& reference) {
  double area = 0.0;
  double ceiling = reference[1];
  for (const Point2& p : non_dominated(points)) {
    if (p[0] >= reference[0] || p[1] >= ceiling) continue;
    area += (reference[0] - p[0]) * (ceiling - p[1]);
    ceiling = p[1];
  }
  return area;
}

double maximum_spread(std::span<const Point2> front, std::span<const Point2> reference) {
  assert(!front.empty() && !reference.empty());
  double sum = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double whole = extent(reference, k);
    const double ratio = whole > 0.0 ? extent(front, k) / whole : 1.0;
    sum += ratio * ratio;
  }
  return std::sqrt(sum / 2.0);
}

double hole_relative_size(std::span<const Point2> front) {
  const std::vector<Point2> sorted = non_dominated(front);
  if (sorted.size() < 3) return 1.0;
  double largest = 0.0;
  double sum = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = base::hypotenuse(sorted[i][0] - sorted[i - 1][0], sorted[i][1] - sorted[i - 1][1]);
    largest = std::max(largest, gap);
    sum += gap;
  }
  return sum > 0.0 ? largest / (sum / static_cast<double>(sorted.size() - 1)) : 1.0;
}

double straight_line_rate(double path_length, double straight_length) {
  if (straight_length > 0.0) return path_length / straight_length;
  return path_length > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
}

}  // namespace jink::planner::optimizer
