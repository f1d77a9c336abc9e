// SPDX-License-Identifier: BSD-3-Clause
#include "planner/base/trajectory.hpp"

#include <algorithm>
#include <cassert>

namespace jink::planner::base {

TimedPoint sample(const TimedPath& path, double t) {
  assert(!path.empty());
  const auto after = std::upper_bound(path.begin(), path.end(), t,
                                      [](double time, const TimedPoint& point) { return time < point.t; });
  if (after == path.begin()) return {t, path.front().position, path.front().velocity, path.front().acceleration};
  if (after == path.end()) return {t, path.back().position, Vec3::Zero(), Vec3::Zero()};
  const TimedPoint& a = *(after - 1);
  const TimedPoint& b = *after;
  const double s = (t - a.t) / (b.t - a.t);
  return {t, a.position + s * (b.position - a.position), a.velocity + s * (b.velocity - a.velocity),
          a.acceleration + s * (b.acceleration - a.acceleration)};
}

double path_length(const TimedPath& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i].position - path[i - 1].position).norm();
  return length;
}

TimedPath remainder(const TimedPath& path, double t) {
  assert(!path.empty());
  TimedPath rest;
  rest.push_back(sample(path, t));
  for (const TimedPoint& point : path) {
    if (point.t > t) rest.push_back(point);
  }
  return rest;
}

TimedPath later(const TimedPath& path, double t) {
  TimedPath rest = remainder(path, t);
  for (TimedPoint& point : rest) point.t -= t;
  return rest;
}

}  // namespace jink::planner::base
