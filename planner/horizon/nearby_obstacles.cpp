// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/nearby_obstacles.hpp"

#include <algorithm>
#include <cmath>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/geometry/static_map.hpp"

namespace jink::planner::horizon {
namespace {

constexpr std::size_t kGroup = 8;  // steps tested at once
// m, added to what is tested for, far above rounding: an obstacle left out would have added exactly nothing.
constexpr double kSlack = 1e-6;

double squared_distance(const Vec3& p, const base::Box& box) {
  return (p - p.cwiseMax(box.min).cwiseMin(box.max)).squaredNorm();
}

base::Box united(const base::Box& a, const base::Box& b) {
  return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

/// How an obstacle on a track moves.
class TrackMotion {
 public:
  TrackMotion(const base::Track& track, const Clearance& clearance)
      : track_(track),
        trust_(clearance.acceleration_trust),
        evasion_(clearance.evasion(track.is_exact() ? std::min(clearance.sudden_change, track.sudden_change)
                                                    : clearance.sudden_change)) {}

  [[nodiscard]] Vec3 position(double t) const { return geometry::predict_position(track_, t, trust_); }
  /// The largest speed within the first `time` seconds: the velocity changes along a line, so it is one end's.
  [[nodiscard]] double fastest(double time) const {
    return std::sqrt(
        std::max(track_.velocity.squaredNorm(), geometry::predict_velocity(track_, time, trust_).squaredNorm()));
  }
  [[nodiscard]] double radius() const { return track_.radius; }
  [[nodiscard]] static double hard(const Clearance& clearance) { return clearance.hard; }
  [[nodiscard]] const base::Body& body() const { return track_.body; }
  [[nodiscard]] double until() const { return base::kInfinity; }
  /// How far it strays from even motion between two instants. differs: that an accelerated track does so, by at most
  /// an eighth of its acceleration times step², is left to the margin.
  [[nodiscard]] double bend(double /*begin*/, double /*end*/) const { return 0.0; }
  /// A bound of bend() for any two instants that are `step` apart.
  [[nodiscard]] double most_bend(double /*step*/) const { return 0.0; }
  /// Clearance asked for on top of the hard distance after t seconds.
  [[nodiscard]] double uncertainty(const Clearance& clearance, double t) const {
    const double ahead = t + track_.age;
    const double moved = track_.velocity_sigma * ahead;
    const double sigma = std::sqrt(track_.position_sigma * track_.position_sigma + moved * moved);
    const double unsure = clearance.sigma_factor * sigma + 0.5 * clearance.track_acceleration * ahead * ahead;
    return std::max(evasion_, std::min(clearance.limit, unsure));
  }
  /// A bound of uncertainty().
  [[nodiscard]] double most_uncertainty(const Clearance& clearance) const {
    return std::max(evasion_, clearance.limit);
  }
  /// How far it gains on a vehicle that evades it, should it move otherwise at once, m.
  [[nodiscard]] double evasion() const { return evasion_; }

 private:
  const base::Track& track_;
  double trust_;
  double evasion_;
};

/// The same of one on a known path.
class PathMotion {
 public:
  explicit PathMotion(const geometry::KnownPath& path) : path_(path), fastest_(path.fastest()) {}

  [[nodiscard]] Vec3 position(double t) const { return path_.position(t); }
  [[nodiscard]] double fastest(double /*time*/) const { return fastest_; }
  [[nodiscard]] double radius() const { return path_.radius; }
  [[nodiscard]] double hard(const Clearance& clearance) const { return path_.margin + clearance.hard; }
  [[nodiscard]] const base::Body& body() const { return path_.body; }
  [[nodiscard]] double until() const { return path_.until; }
  /// Both the path and even motion are straight between the path's points, so they are farthest apart at one of them.
  [[nodiscard]] double bend(double begin, double end) const {
    const base::TimedPath& points = path_.points;
    const Vec3 from = position(begin);
    const Vec3 velocity = (position(end) - from) / (end - begin);
    const auto later = [](double t, const base::TimedPoint& point) { return t < point.t; };
    double most = 0.0;
    for (auto p = std::upper_bound(points.begin(), points.end(), begin + path_.offset, later);
         p != points.end() && p->t < end + path_.offset; ++p) {
      most = std::max(most, (p->position - from - (p->t - path_.offset - begin) * velocity).norm());
    }
    return most;
  }
  /// From the nearer end of the step both have come at most half a step at the largest speed.
  [[nodiscard]] double most_bend(double step) const { return fastest_ * step; }
  [[nodiscard]] double uncertainty(const Clearance& clearance, double t) const {
    const double moved = path_.velocity_sigma * (t + path_.age);
    const double sigma = std::sqrt(path_.position_sigma * path_.position_sigma + moved * moved);
    const double after = std::max(0.0, t + path_.offset - path_.points.back().t);
    return std::min(clearance.limit,
                    clearance.sigma_factor * sigma + 0.5 * clearance.track_acceleration * after * after);
  }
  [[nodiscard]] static double most_uncertainty(const Clearance& clearance) { return clearance.limit; }
  [[nodiscard]] static double evasion() { return 0.0; }

 private:
  const geometry::KnownPath& path_;
  double fastest_;
};

/// What turns by `turn` in a step, rad, while a vehicle and it move by `moved` against each other, is measured as if
/// the place in its own axes changed evenly. That strays by at most the distance from its middle times q = turn² / 8,
/// the arc beyond the chord, and moved times turn / 4: so much more is to be kept from it, where `size` is the distance
/// to its middle and its own reach.
double turning_slack(double turn, double moved, double size) {
  const double q = 0.125 * turn * turn;
  return q < 0.5 ? (size * q + 0.25 * turn * moved) / (1.0 - q) : base::kInfinity;
}

/// The solid of what moves so, where it is during step n, to be looked at by who is within `kept` of it, or comes
/// nearer.
template <typename Motion>
NearbySolid solid_during(const Motion& motion, const NearbyObstacle& obstacle, double step, std::size_t n,
                         double kept) {
  const double begin = step * static_cast<double>(n);
  const double end = step * static_cast<double>(n + 1);
  base::Track there;
  there.body = motion.body();
  there.position = obstacle.from;
  there.body.yaw += begin * there.body.yaw_rate;
  const base::Box before = geometry::box_around(there);
  there.position = obstacle.to;
  there.body.yaw += step * there.body.yaw_rate;
  // No part of it is farther from where it is halfway than this.
  const double strays =
      0.5 * ((obstacle.to - obstacle.from).norm() + std::abs(motion.body().yaw_rate) * step * motion.radius());
  return {{motion.body(), obstacle.from, begin},
          {motion.body(), obstacle.middle, 0.5 * (begin + end)},
          {motion.body(), obstacle.to, end},
          motion.radius(),
          kept + strays,
          geometry::grown(united(before, geometry::box_around(there)), kept + obstacle.most_advance)};
}

}  // namespace

void NearbyObstacles::build(std::span<const base::Track> tracks, std::span<const geometry::KnownPath> paths,
                            std::span<const base::Track> standing, const Clearance& clearance, double step,
                            double fastest, std::span<const base::Box> where) {
  groups_.clear();
  found_.clear();
  solids_.clear();
  standing_.clear();
  boxes_.clear();
  step_.clear();
  obstacles_ = 0;
  base::Box everywhere = where.front();
  for (std::size_t first = 0; first < where.size(); first += kGroup) {
    Group group{first, std::min(first + kGroup, where.size()), where[first]};
    for (std::size_t n = group.first; n < group.last; ++n) group.where = united(group.where, where[n]);
    everywhere = united(everywhere, group.where);
    groups_.push_back(group);
  }
  for (const base::Track& track : tracks) {
    add(TrackMotion(track, clearance), clearance, step, fastest, where, everywhere);
  }
  for (const geometry::KnownPath& path : paths) add(PathMotion(path), clearance, step, fastest, where, everywhere);
  for (const base::Track& track : standing) add_standing(track, clearance, where, everywhere);

  begin_.assign(where.size() + 1, 0);
  for (const std::size_t n : step_) ++begin_[n + 1];
  for (std::size_t n = 0; n < where.size(); ++n) begin_[n + 1] += begin_[n];
  next_ = begin_;
  met_.resize(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i) met_[next_[step_[i]]++] = found_[i];
  for (std::vector<double>* numbers : {&x_, &y_, &z_, &near_squared_}) numbers->resize(met_.size() + kAtOnce);
  for (std::size_t i = 0; i < met_.size(); ++i) {
    x_[i] = met_[i].middle.x();
    y_[i] = met_[i].middle.y();
    z_[i] = met_[i].middle.z();
    const double near = met_[i].near + met_[i].most_advance;
    near_squared_[i] = near * near;
  }
}

template <typename Motion>
void NearbyObstacles::add(const Motion& motion, const Clearance& clearance, double step, double fastest,
                          std::span<const base::Box> where, const base::Box& everywhere) {
  const double horizon = step * static_cast<double>(where.size());
  const double speed = motion.fastest(horizon);
  const double hard = motion.radius() + motion.hard(clearance);
  const double most_bend = motion.most_bend(step);
  const double advance = std::min({clearance.limit, motion.evasion(), clearance.reaction * fastest});
  const double room = motion.most_uncertainty(clearance) + advance;
  const bool is_solid = motion.body().solid != nullptr;
  const double passed = (speed + fastest) * step;
  const double slack = kSlack + (is_solid ? turning_slack(std::abs(motion.body().yaw_rate) * step, passed,
                                                          hard + room + most_bend + motion.radius())
                                          : 0.0);
  const double ever = hard + room + speed * horizon + most_bend + slack;
  if (squared_distance(motion.position(0.0), everywhere) >= ever * ever) return;
  const std::size_t before = found_.size();
  for (const Group& group : groups_) {
    const double begin = step * static_cast<double>(group.first);
    if (begin >= motion.until()) break;
    const double half = 0.5 * step * static_cast<double>(group.last - group.first);
    const double wanted = hard + room + speed * half + most_bend + slack;
    if (squared_distance(motion.position(begin + half), group.where) >= wanted * wanted) continue;
    NearbyObstacle obstacle;
    obstacle.to = motion.position(begin);
    obstacle.reaction = clearance.reaction / step;
    obstacle.most_advance = advance;
    for (std::size_t n = group.first; n < group.last && static_cast<double>(n) * step < motion.until(); ++n) {
      const double end = static_cast<double>(n + 1) * step;
      obstacle.from = obstacle.to;
      obstacle.to = motion.position(end);
      obstacle.middle = 0.5 * (obstacle.from + obstacle.to);
      const double moved = 0.5 * (obstacle.to - obstacle.from).norm();
      const double bent = hard + motion.bend(static_cast<double>(n) * step, end);
      const double most = bent + room + moved + slack;
      const double distance = squared_distance(obstacle.middle, where[n]);
      if (distance >= most * most) continue;
      obstacle.hard = bent;
      obstacle.soft = bent + motion.uncertainty(clearance, end);
      obstacle.near = obstacle.soft + moved + slack;
      const double near = obstacle.near + advance;
      if (distance >= near * near) continue;
      if (is_solid) {
        const NearbySolid placed = solid_during(motion, obstacle, step, n, obstacle.soft - motion.radius() + slack);
        if (geometry::distance(where[n], placed.keep_out) > 0.0) continue;
        obstacle.solid = static_cast<int>(solids_.size());
        solids_.push_back(placed);
      }
      found_.push_back(obstacle);
      step_.push_back(n);
    }
  }
  if (found_.size() > before) ++obstacles_;
}

// That it is where it is said to be is all that may be wrong.
void NearbyObstacles::add_standing(const base::Track& track, const Clearance& clearance,
                                   std::span<const base::Box> where, const base::Box& everywhere) {
  NearbyObstacle obstacle;
  obstacle.from = obstacle.to = obstacle.middle = track.position;
  obstacle.hard = track.radius + clearance.hard_beside_standing;
  obstacle.soft = obstacle.hard + std::min(clearance.limit, clearance.sigma_factor * track.position_sigma);
  obstacle.near = obstacle.soft + kSlack;
  if (squared_distance(track.position, everywhere) >= obstacle.near * obstacle.near) return;
  const base::Box box = geometry::grown(geometry::box_around(track), obstacle.near - track.radius);
  const auto meets = [&box](const base::Box& part) { return geometry::distance(part, box) == 0.0; };
  if (std::none_of(where.begin(), where.end(), meets)) return;
  if (const PlacedSolid solid(track.body, track.position, 0.0); !solid.is_none()) {
    obstacle.solid = static_cast<int>(solids_.size());
    solids_.push_back({solid, solid, solid, track.radius, obstacle.near - track.radius, box});
  }
  standing_.push_back(obstacle);
  boxes_.push_back(box);
  ++obstacles_;
}

}  // namespace jink::planner::horizon
