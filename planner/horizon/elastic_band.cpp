// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/elastic_band.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "planner/horizon/each_obstacle.hpp"

namespace jink::planner::horizon {
namespace {

constexpr int kSweeps = 2000;
constexpr int kRelaxed = 1500;           // sweeps of full tension, which fades then, so that what bounds the band wins
constexpr int kLookAgain = 50;           // sweeps after which the obstacles that are near are looked for again
constexpr double kFinest = 1e-3;         // of a piece, to which the place nearest to a solid is looked for
constexpr double kNearBy = 0.5;          // m, beyond what is kept, within which an obstacle counts as near
constexpr double kOverRelaxation = 1.6;  // of each point's way: successive over-relaxation; 1.9 rests at no corner
constexpr double kBeyond = 5e-3;         // m, kept beyond the margin, for what the sweeps leave over
constexpr double kSlowest = 0.3;         // m/s, as which a piece of no speed counts

/// An obstacle while the band's piece from point k - 1 to point k is flown, in which it moves evenly.
struct Push {
  std::size_t k = 0;
  Vec3 from, to;          // its centre
  double distance = 0.0;  // of the centres, kept; of the surface, from a solid
  PlacedSolid solid;      // in the middle of that time
};

class Band {
 public:
  Band(const base::TimedPath& path, const PathRequest& request, double acceleration) : path_(path), request_(request) {
    const std::size_t n = path.size();
    for (const base::TimedPoint& point : path) p_.push_back(point.position);
    took_.assign(n, 0.0);
    speed_.assign(n, 0.0);
    for (std::size_t k = 1; k < n; ++k) {
      took_[k] = path[k].t - path[k - 1].t;
      speed_[k] = std::max(kSlowest, (p_[k] - p_[k - 1]).norm() / took_[k]);
    }
    most_.assign(n, acceleration);
    for (std::size_t k = 0; k < n; ++k) most_[k] = std::max(acceleration, bend(k).norm());
  }

  base::TimedPath pulled_tight() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      if (sweep % kLookAgain == 0) look_around();
      const double fading = sweep < kRelaxed ? 1.0 : static_cast<double>(kSweeps - sweep) / (kSweeps - kRelaxed);
      tighten(kOverRelaxation * fading);
      for (const Push& push : pushes_) push.solid.is_none() ? push_out(push) : push_out_of_solid(push);
      for (std::size_t k = 0; k < p_.size(); ++k) straighten(k);
      for (std::size_t k = 1; k < p_.size(); ++k) flatten(k);
    }
    return timed();
  }

 private:
  [[nodiscard]] bool is_free(std::size_t k) const { return k > 0 && k + 1 < p_.size(); }
  [[nodiscard]] Vec3 velocity(std::size_t k) const { return (p_[k] - p_[k - 1]) / took_[k]; }

  /// Acceleration at point k: from the middle of the piece before to that of the piece after. At the ends from, and to,
  /// the path's own velocity there.
  [[nodiscard]] Vec3 bend(std::size_t k) const {
    if (k == 0) return (velocity(1) - path_.front().velocity) / (0.5 * took_[1]);
    if (k + 1 == p_.size()) return (path_.back().velocity - velocity(k)) / (0.5 * took_[k]);
    return (velocity(k + 1) - velocity(k)) / (0.5 * (took_[k] + took_[k + 1]));
  }

  void look_around() {
    pushes_.clear();
    for_each_obstacle(request_, request_.margin + kBeyond, [&](const auto& obstacle) { add_pushes(obstacle); });
  }

  /// Of one obstacle, for the pieces near which it comes while it counts.
  template <typename Obstacle>
  void add_pushes(const Obstacle& obstacle) {
    Vec3 to = obstacle.position(path_.front().t);
    for (std::size_t k = 1; k < p_.size() && path_[k - 1].t < obstacle.until; ++k) {
      const Vec3 from = to;
      to = obstacle.position(path_[k].t);
      const double moved = 0.5 * ((to - from).norm() + (p_[k] - p_[k - 1]).norm());
      const double near = obstacle.wanted + kNearBy + moved;
      if ((p_[k] + p_[k - 1] - from - to).squaredNorm() >= 4.0 * near * near) continue;
      const double middle = 0.5 * (path_[k - 1].t + path_[k].t);
      const PlacedSolid solid(obstacle.body, 0.5 * (from + to), middle);
      if (solid.is_none()) {
        pushes_.push_back({k, from, to, obstacle.wanted, solid});
      } else if (solid.distance(0.5 * (p_[k] + p_[k - 1])) < obstacle.kept + kNearBy + 2.0 * moved) {
        pushes_.push_back({k, from, to, obstacle.kept, solid});
      }
    }
  }

  /// Each point towards where its two pieces pull equally: a piece pulls by its length per what it was.
  void tighten(double share) {
    for (std::size_t k = 1; k + 1 < p_.size(); ++k) {
      const double before = speed_[k] * took_[k];
      const double after = speed_[k + 1] * took_[k + 1];
      const Vec3 rest = p_[k - 1] + before / (before + after) * (p_[k + 1] - p_[k - 1]);
      p_[k] += share * (rest - p_[k]);
      p_[k] = p_[k].cwiseMax(request_.volume.min).cwiseMin(request_.volume.max);
    }
  }

  /// Both ends of a piece, the nearer one more.
  void push_out(const Push& push) {
    const std::size_t k = push.k;
    const Vec3 from = p_[k - 1] - push.from;
    const Vec3 way = p_[k] - push.to - from;
    const double length = way.squaredNorm();
    const double s = length > 0.0 ? std::clamp(-from.dot(way) / length, 0.0, 1.0) : 0.0;
    const Vec3 apart = from + s * way;
    const double distance = apart.norm();
    if (distance >= push.distance || distance == 0.0) return;
    move(k, s, (push.distance - distance) / distance * apart);
  }

  /// The same for a solid, which is seen to stand in the middle of its way.
  void push_out_of_solid(const Push& push) {
    const std::size_t k = push.k;
    const Vec3 half = 0.5 * (push.to - push.from);
    const Vec3 from = p_[k - 1] + half;
    const Vec3 way = p_[k] - half - from;
    double s = 0.5;
    double least = push.solid.distance(from + s * way);
    for (double step = 0.25; step > kFinest; step *= 0.5) {  // the distance is convex along the piece
      for (const double share : {s - step, s + step}) {
        const double distance = push.solid.distance(from + share * way);
        if (distance >= least) continue;
        least = distance;
        s = share;
        break;
      }
    }
    if (least < push.distance) move(k, s, (push.distance - least) * push.solid.outward(from + s * way));
  }

  /// Moves the place at `s` of the piece that ends at point k, by its ends.
  void move(std::size_t k, double s, const Vec3& out) {
    const double first = is_free(k - 1) ? 1.0 - s : 0.0;
    const double second = is_free(k) ? s : 0.0;
    const double both = first * first + second * second;
    if (both < 1e-6) return;
    p_[k - 1] += first / both * out;
    p_[k] += second / both * out;
  }

  /// A point and its neighbours, until it is accelerated by no more than it may be.
  void straighten(std::size_t k) {
    const Vec3 now = bend(k);
    const double much = now.norm();
    if (much <= most_[k]) return;
    const bool first = k == 0;
    const bool last = k + 1 == p_.size();
    const double span = 0.5 * ((first ? 0.0 : took_[k]) + (last ? 0.0 : took_[k + 1]));
    const double before = first ? 0.0 : 1.0 / (took_[k] * span);
    const double after = last ? 0.0 : 1.0 / (took_[k + 1] * span);
    const double by_before = !first && is_free(k - 1) ? before : 0.0;
    const double by_after = !last && is_free(k + 1) ? after : 0.0;
    const double by_itself = is_free(k) ? -before - after : 0.0;
    const double all = by_before * by_before + by_after * by_after + by_itself * by_itself;
    if (all == 0.0) return;
    const Vec3 less = (1.0 - most_[k] / much) / all * now;
    if (by_before != 0.0) p_[k - 1] -= by_before * less;
    if (by_after != 0.0) p_[k + 1] -= by_after * less;
    if (by_itself != 0.0) p_[k] -= by_itself * less;
  }

  /// Both ends of a piece that climbs or sinks too fast.
  void flatten(std::size_t k) {
    const double most = request_.vehicle.max_climb * took_[k];
    const double climb = p_[k].z() - p_[k - 1].z();
    const double over = climb > most ? climb - most : climb < -most ? climb + most : 0.0;
    if (over == 0.0) return;
    const double first = is_free(k - 1) ? 1.0 : 0.0;
    const double second = is_free(k) ? 1.0 : 0.0;
    if (first + second == 0.0) return;
    p_[k - 1].z() += over * first / (first + second);
    p_[k].z() -= over * second / (first + second);
  }

  /// The smooth motion through the points: a velocity is the mean of its two pieces'.
  [[nodiscard]] base::TimedPath timed() const {
    base::TimedPath path = path_;
    for (std::size_t k = 1; k + 1 < p_.size(); ++k) {
      path[k].position = p_[k];
      path[k].velocity = (took_[k + 1] * velocity(k) + took_[k] * velocity(k + 1)) / (took_[k] + took_[k + 1]);
    }
    for (std::size_t k = 1; k < p_.size(); ++k) {
      path[k - 1].acceleration = (path[k].velocity - path[k - 1].velocity) / took_[k];
    }
    return path;
  }

  const base::TimedPath& path_;
  const PathRequest& request_;
  std::vector<Vec3> p_;
  std::vector<double> took_;   // piece k - 1 to k, s
  std::vector<double> speed_;  // of that piece as it was, m/s
  std::vector<double> most_;   // acceleration at point k, m/s²
  std::vector<Push> pushes_;
};

}  // namespace

base::TimedPath elastic_band(const base::TimedPath& path, const PathRequest& request, double acceleration) {
  if (path.size() < 3) return path;
  return Band(path, request, acceleration).pulled_tight();
}

}  // namespace jink::planner::horizon
