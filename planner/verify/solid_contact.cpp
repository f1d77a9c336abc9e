// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/solid_contact.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "planner/base/portable_math.hpp"
#include "planner/base/solid.hpp"

namespace jink::planner::verify {
namespace {

/// How far a point is from a solid's surface, and the direction in which that grows by as much as the point moves.
struct Nearest {
  double distance = 0.0;
  Vec3 outward = Vec3::Zero();
};

/// Of a coordinate beyond a half edge.
double beyond(double coordinate, double half) {
  return std::abs(coordinate) - half;
}

Nearest nearest_of_prism(const base::Solid& solid, const Vec3& point) {
  const Eigen::Matrix3d& axes = solid.pose().axes;
  const Vec3 own = axes.transpose() * (point - solid.pose().center);
  const Vec3 over(beyond(own.x(), solid.half().x()), beyond(own.y(), solid.half().y()),
                  beyond(own.z(), solid.half().z()));
  const Vec3 sign(std::copysign(1.0, own.x()), std::copysign(1.0, own.y()), std::copysign(1.0, own.z()));
  // On its plane: outside of the rectangle, or in it.
  Vec3 level(std::max(over.x(), 0.0), std::max(over.y(), 0.0), 0.0);
  double away = level.norm();
  if (away > 0.0) {
    level = level.cwiseProduct(sign) / away;
  } else {
    away = std::max(over.x(), over.y());
    level = over.x() > over.y() ? Vec3(sign.x(), 0.0, 0.0) : Vec3(0.0, sign.y(), 0.0);
  }
  away -= solid.corner();
  const Vec3 up(0.0, 0.0, sign.z());
  Nearest result;
  if (away > 0.0 && over.z() > 0.0) {
    result.distance = base::hypotenuse(away, over.z());
    result.outward = (away * level + over.z() * up) / result.distance;
  } else {
    result.distance = std::max(away, over.z());
    result.outward = away > over.z() ? level : up;
  }
  result.distance -= solid.rounding();
  result.outward = axes * result.outward;
  return result;
}

/// The point nearest to the origin in the hull of points: Wolfe's algorithm ("Finding the nearest point in a polytope",
/// 1976). It holds at most four of them, its corral, and walks from one's nearest point to the next.
class NearestOfHull {
 public:
  NearestOfHull(std::span<const Vec3> vertices, const Vec3& point) : vertices_(vertices), point_(point) {
    add(lowest(-point));
    weights_[0] = 1.0;
    x_ = corral_[0];
  }

  /// What is told is where a plane is that no vertex is beyond, so never more than the distance.
  Nearest find() {
    constexpr int kMostSteps = 200;
    constexpr double kGap = 1e-15;  // of the size
    Nearest best;
    bool nearer = true;
    for (int step = 0; step < kMostSteps; ++step) {
      const double length = x_.norm();
      if (length == 0.0) return {};
      const Vec3 candidate = lowest(x_);
      const double bound = x_.dot(candidate) / length;
      const bool better = bound > best.distance;
      if (better) best = {bound, -x_ / length};
      const double size = std::max(candidate.norm(), length);
      if (length - bound <= kGap * size || count_ == corral_.size()) break;
      if (!nearer && !better) break;  // as near as rounding allows
      weights_[count_] = 0.0;
      add(candidate);
      const double before = x_.squaredNorm();
      settle();
      nearer = x_.squaredNorm() < before;
    }
    return best;
  }

 private:
  [[nodiscard]] Vec3 lowest(const Vec3& direction) const {
    const auto vertex = std::min_element(vertices_.begin(), vertices_.end(), [&](const Vec3& a, const Vec3& b) {
      return a.dot(direction) < b.dot(direction);
    });
    return *vertex - point_;
  }
  void add(const Vec3& p) { corral_[count_++] = p; }

  using Edges = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;
  using Shares = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

  /// From the corral's first point to its others.
  [[nodiscard]] Edges edges() const {
    Edges edges(3, static_cast<Eigen::Index>(count_ - 1));
    for (std::size_t i = 1; i < count_; ++i) edges.col(static_cast<Eigen::Index>(i - 1)) = corral_[i] - corral_[0];
    return edges;
  }

  /// Weights, adding up to 1, of the corral's point nearest to the origin on the line, plane or space that it spans.
  [[nodiscard]] std::array<double, 4> affine() const {
    std::array<double, 4> weights{1.0};
    if (count_ == 1) return weights;
    const Shares solved = edges().colPivHouseholderQr().solve(-corral_[0]);
    for (std::size_t i = 1; i < count_; ++i) {
      weights[i] = solved[static_cast<Eigen::Index>(i - 1)];
      weights[0] -= weights[i];
    }
    return weights;
  }

  /// To the nearest point of the corral's hull; what does not carry it leaves the corral.
  void settle() {
    for (std::size_t rounds = 0; rounds < corral_.size(); ++rounds) {
      const std::array<double, 4> wanted = affine();
      double share = 1.0;
      for (std::size_t i = 0; i < count_; ++i) {
        if (wanted[i] < 0.0) share = std::min(share, weights_[i] / (weights_[i] - wanted[i]));
      }
      for (std::size_t i = 0; i < count_; ++i) weights_[i] += share * (wanted[i] - weights_[i]);
      const bool arrived = share >= 1.0;
      std::size_t kept = 0;
      bool dropped = false;
      for (std::size_t i = 0; i < count_; ++i) {
        if (!arrived && !dropped && weights_[i] <= 1e-15) {
          dropped = true;
          continue;
        }
        weights_[kept] = weights_[i];
        corral_[kept++] = corral_[i];
      }
      count_ = kept;
      if (arrived || !dropped) break;
    }
    x_.setZero();
    for (std::size_t i = 0; i < count_; ++i) x_ += weights_[i] * corral_[i];
    if (count_ == 1) return;
    // As much as that sum was rounded, a short x would not be at right angles to the corral, but it must be.
    const Edges all = edges();
    const Shares askew = all.colPivHouseholderQr().solve(x_);
    x_ -= all * askew;
  }

  std::span<const Vec3> vertices_;
  Vec3 point_;
  std::array<Vec3, 4> corral_;
  std::array<double, 4> weights_{};
  std::size_t count_ = 0;
  Vec3 x_ = Vec3::Zero();
};

Nearest nearest_of(const base::Solid& solid, const Vec3& point) {
  return solid.is_hull() ? NearestOfHull(solid.vertices(), point).find() : nearest_of_prism(solid, point);
}

/// Turned back about the vertical by a yaw.
Vec3 turned_back(const Vec3& p, double yaw) {
  const auto [sine, cosine] = base::sine_cosine(yaw);
  return {cosine * p.x() + sine * p.y(), cosine * p.y() - sine * p.x(), p.z()};
}

/// How far a place on it moves at most where it turns about the vertical: 0 where it is round.
double wobble(const base::Solid& solid) {
  if (!solid.is_hull()) {
    const base::Solid::Pose& pose = solid.pose();
    return 2.0 * (pose.center.head<2>().norm() + solid.half().head<2>().norm() +
                  pose.axes.col(2).head<2>().norm() * (solid.half().z() + solid.corner()));
  }
  double most = 0.0;
  for (const Vec3& vertex : solid.vertices()) most = std::max(most, 2.0 * vertex.head<2>().norm());
  return most;
}

/// The distance, and how fast it changes, at one instant.
struct Sample {
  double t = 0.0;
  double distance = 0.0;
  double slope = 0.0;
  Vec3 outward = Vec3::Zero();  ///< in which direction it grows, in axes that turn with the body
};

class Search {
 public:
  Search(const RelativeMotion& m, const base::Body& body)
      : m_(m), body_(body), rate_(wobble(*body.solid) > kWobble ? body.yaw_rate : 0.0) {
    const double travel = m.duration * (m.p1.norm() + m.duration * m.p2.norm());
    tolerance_ = kTolerance + kRounding * (m.p0.norm() + travel + body.solid->reach());
    instant_ = kInstant + kRounding * m.duration;
  }

  [[nodiscard]] Sample sample(double t) const {
    const double yaw = body_.yaw + t * rate_;
    const Vec3 place = m_.at(t);
    const auto [distance, outward] = nearest_of(*body_.solid, turned_back(place, yaw));
    const double slope = outward.dot(turned_back(velocity(t, rate_), yaw));
    return {t, distance, slope, outward};
  }

  /// Of the vehicle over the body's surface.
  [[nodiscard]] double speed(double t) const { return velocity(t, body_.yaw_rate).norm(); }

  /// The smallest distance below `least`.
  [[nodiscard]] std::optional<Sample> smallest(double least) {
    std::optional<Sample> found;
    const auto look = [&](const Sample& s) {
      if (!(s.distance < least)) return;
      least = s.distance;
      found = s;
    };
    const auto refine = [&](const auto& self, const Sample& a, const Sample& b) -> void {
      const Bound bound = bounded(a, b);
      if (bound.distance >= least - tolerance_ || !may_split(a, b)) return;
      const Sample middle = sample(bound.t);
      look(middle);
      self(self, a, middle);
      self(self, middle, b);
    };
    const Sample first = sample(0.0);
    const Sample last = sample(m_.duration);
    look(first);
    look(last);
    if (m_.duration > 0.0) refine(refine, first, last);
    return found;
  }

  /// The first instant at which the distance is below `limit`, up to `until`.
  [[nodiscard]] std::optional<double> first_below(double limit, double until) {
    const auto refine = [&](const auto& self, const Sample& a, const Sample& b) -> std::optional<double> {
      if (a.distance < limit) return a.t;
      const Bound bound = bounded(a, b);
      const bool crosses = b.distance < limit;
      if (a.t >= until || (!crosses && bound.distance >= limit - tolerance_)) return std::nullopt;
      if (b.t - a.t <= instant_ || !may_split(a, b)) return crosses ? std::optional(b.t) : std::nullopt;
      const Sample middle = sample(crosses ? 0.5 * (a.t + b.t) : bound.t);
      const std::optional<double> before = self(self, a, middle);
      return before ? before : self(self, middle, b);
    };
    return refine(refine, sample(0.0), sample(m_.duration));
  }

  /// Whether it gave up.
  [[nodiscard]] bool gave_up() const { return splits_ > kMostSplits; }

 private:
  static constexpr double kTolerance = 1e-9;  // m
  static constexpr double kRounding = 1e-14;  // of the largest length, or time
  static constexpr double kInstant = 1e-12;   // s
  static constexpr double kWobble = 1e-12;    // m, what moves by less need not be turned
  static constexpr double kNarrow = 0.1;      // of an interval, at least on either side of a split
  static constexpr int kMostSplits = 100000;

  struct Bound {
    double t = 0.0;  ///< where the tangents meet
    double distance = 0.0;
  };

  /// Seen from what turns at that rate, ENU.
  [[nodiscard]] Vec3 velocity(double t, double rate) const {
    const Vec3 place = m_.at(t);
    return m_.velocity(t) - Vec3(-rate * place.y(), rate * place.x(), 0.0);
  }

  [[nodiscard]] bool may_split(const Sample& a, const Sample& b) {
    return b.t - a.t > instant_ && !gave_up() && ++splits_ > 0;
  }

  /// No distance between a and b is below that of the bound: the better one of two.
  [[nodiscard]] Bound bounded(const Sample& a, const Sample& b) const {
    const double width = b.t - a.t;
    const double bend = 2.0 * m_.p2.head<2>().norm();
    const double rate = std::abs(rate_);
    const double fast = m_.velocity(a.t).head<2>().norm() + bend * width;
    const double far = m_.at(a.t).head<2>().norm() + fast * width;
    const double level = bend + rate * (2.0 * fast + rate * far);
    const double upright = 2.0 * std::abs(m_.p2.z());  // which no turning changes
    const auto most = [&](const Vec3& g) { return g.head<2>().norm() * level + std::abs(g.z()) * upright; };
    const double bend_a = most(a.outward);
    const double bend_b = most(b.outward);
    Bound bound = where_lines_meet(a, b, a.slope - 0.5 * bend_a * width, b.slope + 0.5 * bend_b * width);
    const double sag = width * (a.slope - b.slope - 0.5 * width * std::max(bend_a, bend_b));
    bound.distance = std::max(bound.distance, between_planes(a, b, sag));
    return bound;
  }

  static Bound where_lines_meet(const Sample& a, const Sample& b, double down, double up) {
    const double width = b.t - a.t;
    if (down >= 0.0) return {a.t + kNarrow * width, a.distance};
    if (up <= 0.0) return {b.t - kNarrow * width, b.distance};
    const double share = std::clamp((b.distance - a.distance - up * width) / ((down - up) * width), 0.0, 1.0);
    return {a.t + std::clamp(share, kNarrow, 1.0 - kNarrow) * width, a.distance + down * share * width};
  }

  /// The least of (1 - s) a + s b + s (1 - s) sag, s from 0 to 1.
  static double least_between(double a, double b, double sag) {
    if (sag >= 0.0) return std::min(a, b);
    const double s = std::clamp(0.5 + 0.5 * (b - a) / sag, 0.0, 1.0);
    return (1.0 - s) * a + s * b + s * (1.0 - s) * sag;
  }

  /// Of the two planes that bound the body, mixed from one to the other as time passes. Their mixed normal is shorter
  /// than 1, by s (1 - s) / 2 of the squared difference, so that the mixed plane is as much farther away, which is what
  /// a path around a corner of the body needs. Rounded corners are bounded still closer: what is mixed is of their
  /// core.
  [[nodiscard]] double between_planes(const Sample& a, const Sample& b, double sag) const {
    constexpr double kMostTurned = 1.0;  // up to there 1 / length is above 1 by at most (1 + turned / 4) times as much
    const double least = least_between(a.distance, b.distance, sag);
    const base::Solid& solid = *body_.solid;
    const double turned = (b.outward - a.outward).squaredNorm();
    if (turned > kMostTurned) return least;
    const double core = least + solid.rounding();
    double gain = turned * (core < 0.0 ? core * (1.0 + 0.25 * turned) : core);
    if (solid.corner() > 0.0) {  // round on its own plane
      const auto plane = solid.pose().axes.leftCols<2>().transpose();
      const Eigen::Vector2d level_a = plane * a.outward;
      const Eigen::Vector2d level_b = plane * b.outward;
      const double longer = std::max(level_a.norm(), level_b.norm());
      const double stretched = level_b.norm() - level_a.norm();
      const double level_turned = (level_b - level_a).squaredNorm() - stretched * stretched;
      if (longer > 0.0) gain += solid.corner() * std::max(level_turned, 0.0) / longer;
    }
    return gain > 0.0 ? least_between(a.distance, b.distance, sag + 0.5 * gain) : least;
  }

  const RelativeMotion& m_;
  const base::Body& body_;
  double rate_;             // rad/s
  double tolerance_ = 0.0;  // m
  double instant_ = 0.0;    // s
  int splits_ = 0;
};

}  // namespace

double solid_distance(const base::Body& body, const Vec3& point) {
  return nearest_of(*body.solid, turned_back(point, body.yaw)).distance;
}

void fold_solid(const RelativeMotion& m, const base::Body& body, double t0, double vehicle_radius, std::uint64_t id,
                Verification& result) {
  Search search(m, body);
  // Where something else is nearer, a contact counts all the same.
  const double least = std::max(result.min_clearance, 0.0) + vehicle_radius;
  const std::optional<Sample> nearest = search.smallest(least);
  if (nearest && nearest->distance - vehicle_radius < result.min_clearance) {
    result.min_clearance = nearest->distance - vehicle_radius;
    result.t_min_clearance = t0 + nearest->t;
    result.nearest_id = id;
  }
  if (nearest && nearest->distance < vehicle_radius) {
    const double until = result.first_contact ? *result.first_contact - t0 : base::kInfinity;
    if (const std::optional<double> contact = search.first_below(vehicle_radius, until); contact && *contact < until) {
      result.first_contact = t0 + *contact;
      result.contact_speed = search.speed(*contact);
    }
  }
  if (search.gave_up()) result.valid = false;
}

}  // namespace jink::planner::verify
