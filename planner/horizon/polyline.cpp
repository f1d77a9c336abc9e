// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/polyline.hpp"

#include <algorithm>

namespace jink::planner::horizon {

Vec3 nearest_on_line(const Vec3& place, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double squared = way.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((place - from).dot(way) / squared, 0.0, 1.0) : 0.0;
  return from + share * way;
}

double length_of(std::span<const Vec3> way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  return length;
}

Vec3 place_along(std::span<const Vec3> way, double along) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vec3 leg = way[i] - way[i - 1];
    const double length = leg.norm();
    if (length > along) return way[i - 1] + along / length * leg;
    along -= length;
  }
  return way.back();
}

double left_along(std::span<const Vec3> way, const Vec3& place) {
  double least = (way.back() - place).norm();
  double left = least;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vec3 nearest = nearest_on_line(place, way[i - 1], way[i]);
    const double beside = (nearest - place).norm();
    if (beside >= least) continue;
    least = beside;
    left = beside + (way[i] - nearest).norm() + length_of(way.subspan(i));
  }
  return left;
}

}  // namespace jink::planner::horizon
