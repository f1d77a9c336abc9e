// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/linear_program.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace jink::tools::lab::baselines {
namespace {

constexpr double kParallel = 1e-9;  // sine of an angle

bool holds(const HalfSpace& h, const Vec3& v) {
  return h.normal.dot(v) >= h.offset - kTolerance;
}

/// A flat piece of the allowed speeds: the part of a plane within the ball of them is a disc.
struct Disc {
  Vec3 normal, center;
  double radius = 0.0;

  [[nodiscard]] Vec3 nearest(const Vec3& wished) const {
    const Vec3 in_plane = wished - center - normal.dot(wished - center) * normal;
    const double length = in_plane.norm();
    return length > radius ? Vec3(center + in_plane * (radius / length)) : Vec3(center + in_plane);
  }
};

/// The nearest on the line that bounds `edge` in the disc's plane, within the disc and `half_spaces`.
std::optional<Vec3> nearest_on_line(std::span<const HalfSpace> half_spaces, const Disc& disc, const HalfSpace& edge,
                                    const Vec3& wished) {
  const Vec3 in_plane = edge.normal - edge.normal.dot(disc.normal) * disc.normal;
  const double length = in_plane.norm();
  const double distance = (edge.offset - edge.normal.dot(disc.center)) / length;
  if (std::abs(distance) > disc.radius) return std::nullopt;
  const Vec3 point = disc.center + in_plane * (distance / length);
  const Vec3 direction = disc.normal.cross(in_plane / length);
  double high = std::sqrt(disc.radius * disc.radius - distance * distance);
  double low = -high;
  for (const HalfSpace& h : half_spaces) {
    const double slope = h.normal.dot(direction);
    const double missing = h.offset - h.normal.dot(point);
    if (std::abs(slope) < kParallel) {
      if (missing > kTolerance) return std::nullopt;
    } else if (slope > 0.0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  if (low > high + kTolerance) return std::nullopt;
  const double along = std::clamp(direction.dot(wished - point), std::min(low, high), std::max(low, high));
  return point + along * direction;
}

/// The nearest on the plane that bounds `face`, within the ball and `half_spaces`.
std::optional<Vec3> nearest_on_plane(std::span<const HalfSpace> half_spaces, const HalfSpace& face, double speed,
                                     const Vec3& wished) {
  if (std::abs(face.offset) > speed) return std::nullopt;
  const Disc disc{face.normal, face.offset * face.normal, std::sqrt(speed * speed - face.offset * face.offset)};
  Vec3 v = disc.nearest(wished);
  for (std::size_t i = 0; i < half_spaces.size(); ++i) {
    const HalfSpace& h = half_spaces[i];
    if (holds(h, v)) continue;
    if (h.normal.cross(disc.normal).norm() < kParallel) return std::nullopt;
    const std::optional<Vec3> next = nearest_on_line(half_spaces.first(i), disc, h, wished);
    if (!next) return std::nullopt;
    v = *next;
  }
  return v;
}

}  // namespace

std::optional<Vec3> nearest_velocity(std::span<const HalfSpace> half_spaces, double speed, const Vec3& wished) {
  const double wished_speed = wished.norm();
  Vec3 v = wished_speed > speed ? Vec3(wished * (speed / wished_speed)) : wished;
  for (std::size_t i = 0; i < half_spaces.size(); ++i) {
    if (holds(half_spaces[i], v)) continue;
    const std::optional<Vec3> next = nearest_on_plane(half_spaces.first(i), half_spaces[i], speed, wished);
    if (!next) return std::nullopt;
    v = *next;
  }
  return v;
}

Vec3 least_violating_velocity(std::span<const HalfSpace> hard, std::span<const HalfSpace> soft, double speed,
                              const Vec3& wished, double* relaxed) {
  std::vector<HalfSpace> all(hard.begin(), hard.end());
  all.insert(all.end(), soft.begin(), soft.end());
  const auto moved_back = [&](double distance) {
    for (std::size_t i = 0; i < soft.size(); ++i) all[hard.size() + i].offset = soft[i].offset - distance;
    return nearest_velocity(all, speed, wished);
  };
  if (relaxed != nullptr) *relaxed = 0.0;
  std::optional<Vec3> best = moved_back(0.0);
  if (best) return *best;
  // At v = 0 a half-space is violated by its offset, so all are satisfied when moved back by the largest.
  double high = speed;
  for (const HalfSpace& h : soft) high = std::max(high, h.offset);
  double low = 0.0;
  best = moved_back(high);
  if (!best) return Vec3::Zero();
  while (high - low > kTolerance) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    if (const std::optional<Vec3> found = moved_back(middle)) {
      best = found;
      high = middle;
    } else {
      low = middle;
    }
  }
  if (relaxed != nullptr) *relaxed = high;
  return *best;
}

}  // namespace jink::tools::lab::baselines
