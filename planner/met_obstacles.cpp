// SPDX-License-Identifier: BSD-3-Clause
#include "planner/met_obstacles.hpp"

#include <algorithm>
#include <cmath>

#include "planner/obstacle_motion.hpp"

namespace jink::planner {
namespace {

constexpr std::size_t kGroup = 8;  // steps tested at once
// m, added to what is tested for, far above rounding: an obstacle left out would have added exactly nothing.
constexpr double kSlack = 1e-6;

double squared_distance(const Vec3& p, const Box& box) {
  return (p - p.cwiseMax(box.min).cwiseMin(box.max)).squaredNorm();
}

Box united(const Box& a, const Box& b) {
  return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

/// The largest speed within the first `time` seconds: the velocity changes along a line, so it is one end's.
double fastest(const Track& track, double time, double trust) {
  return std::sqrt(std::max(track.velocity.squaredNorm(), predict_velocity(track, time, trust).squaredNorm()));
}

/// Clearance asked for on top of the hard distance after t seconds.
double uncertainty(const Track& track, const Clearance& clearance, double t) {
  const double ahead = t + track.age;
  const double moved = track.velocity_sigma * ahead;
  const double sigma = std::sqrt(track.position_sigma * track.position_sigma + moved * moved);
  return std::min(clearance.limit, clearance.sigma_factor * sigma + 0.5 * clearance.track_acceleration * ahead * ahead);
}

}  // namespace

void MetObstacles::build(std::span<const Track> tracks, const Clearance& clearance, double step,
                         std::span<const Box> where) {
  groups_.clear();
  found_.clear();
  step_.clear();
  tracks_ = 0;
  Box everywhere = where.front();
  for (std::size_t first = 0; first < where.size(); first += kGroup) {
    Group group{first, std::min(first + kGroup, where.size()), where[first]};
    for (std::size_t n = group.first; n < group.last; ++n) group.where = united(group.where, where[n]);
    everywhere = united(everywhere, group.where);
    groups_.push_back(group);
  }
  const double horizon = step * static_cast<double>(where.size());
  for (const Track& track : tracks) {
    const double travel = fastest(track, horizon, clearance.acceleration_trust) * horizon;
    const double wanted = track.radius + clearance.hard + clearance.limit + travel + kSlack;
    if (squared_distance(track.position, everywhere) < wanted * wanted) add(track, clearance, step, where);
  }

  begin_.assign(where.size() + 1, 0);
  for (const std::size_t n : step_) ++begin_[n + 1];
  for (std::size_t n = 0; n < where.size(); ++n) begin_[n + 1] += begin_[n];
  next_ = begin_;
  met_.resize(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i) met_[next_[step_[i]]++] = found_[i];
}

void MetObstacles::add(const Track& track, const Clearance& clearance, double step, std::span<const Box> where) {
  const double trust = clearance.acceleration_trust;
  const double speed = fastest(track, step * static_cast<double>(where.size()), trust);
  const double hard = track.radius + clearance.hard;
  const std::size_t before = found_.size();
  for (const Group& group : groups_) {
    const double begin = step * static_cast<double>(group.first);
    const double half = 0.5 * step * static_cast<double>(group.last - group.first);
    const double wanted = hard + clearance.limit + speed * half + kSlack;
    if (squared_distance(predict_position(track, begin + half, trust), group.where) >= wanted * wanted) continue;
    MetObstacle obstacle;
    obstacle.to = predict_position(track, begin, trust);
    for (std::size_t n = group.first; n < group.last; ++n) {
      const double end = static_cast<double>(n + 1) * step;
      obstacle.from = obstacle.to;
      obstacle.to = predict_position(track, end, trust);
      obstacle.middle = 0.5 * (obstacle.from + obstacle.to);
      const double moved = 0.5 * (obstacle.to - obstacle.from).norm();
      const double most = hard + clearance.limit + moved + kSlack;
      const double distance = squared_distance(obstacle.middle, where[n]);
      if (distance >= most * most) continue;
      obstacle.hard = hard;
      obstacle.soft = hard + uncertainty(track, clearance, end);
      obstacle.near = obstacle.soft + moved + kSlack;
      obstacle.near_squared = obstacle.near * obstacle.near;
      if (distance >= obstacle.near_squared) continue;
      found_.push_back(obstacle);
      step_.push_back(n);
    }
  }
  if (found_.size() > before) ++tracks_;
}

}  // namespace jink::planner
