// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace jink::planner {
namespace {

/// |p0 + p1 t + p2 t²|² on [0, duration]: the squared distance of two bodies in relative constant acceleration.
struct RelativeMotion {
  Vec3 p0, p1, p2;
  double duration = 0.0;

  [[nodiscard]] Vec3 at(double t) const { return p0 + t * (p1 + t * p2); }
  [[nodiscard]] double squared_distance(double t) const { return at(t).squaredNorm(); }
  [[nodiscard]] double slope(double t) const { return 2.0 * at(t).dot(p1 + 2.0 * t * p2); }
  [[nodiscard]] double speed(double t) const { return (p1 + 2.0 * t * p2).norm(); }
};

/// Sorted instants of [0, duration] between which the squared distance is monotone: the ends and every stationary
/// point. The slope is a cubic; the two zeros of its derivative split it in monotone pieces, each with at most one
/// root.
struct MonotonePieces {
  std::array<double, 5> t{};
  int count = 0;

  explicit MonotonePieces(const RelativeMotion& m) {
    std::array<double, 4> split{0.0, m.duration, m.duration, m.duration};
    std::size_t splits = 1;
    // slope(t)/2 = c0 + c1 t + c2 t² + c3 t³
    const double c1 = m.p1.squaredNorm() + 2.0 * m.p0.dot(m.p2);
    const double c2 = 3.0 * m.p1.dot(m.p2);
    const double c3 = 2.0 * m.p2.squaredNorm();
    const double discriminant = c2 * c2 - 3.0 * c3 * c1;
    if (c3 > 0.0 && discriminant > 0.0) {
      const double root = std::sqrt(discriminant);
      for (const double s : {(-c2 - root) / (3.0 * c3), (-c2 + root) / (3.0 * c3)}) {
        if (s > split[splits - 1] && s < m.duration) split[splits++] = s;
      }
    }
    split[splits] = m.duration;
    add(0.0);
    for (std::size_t i = 0; i < splits; ++i) add_root(m, split[i], split[i + 1]);
    add(m.duration);
  }

 private:
  void add(double value) { t[static_cast<std::size_t>(count++)] = value; }

  void add_root(const RelativeMotion& m, double low, double high) {
    double at_low = m.slope(low);
    const double at_high = m.slope(high);
    if (!(at_low * at_high < 0.0)) return;
    for (int i = 0; i < 80 && high - low > 1e-13; ++i) {
      const double middle = 0.5 * (low + high);
      const double value = m.slope(middle);
      if ((value < 0.0) == (at_low < 0.0)) {
        low = middle;
        at_low = value;
      } else {
        high = middle;
      }
    }
    if (count < 4) add(0.5 * (low + high));
  }
};

/// First instant of a monotonically falling piece at which the squared distance is below `limit`.
double crossing(const RelativeMotion& m, double low, double high, double limit) {
  for (int i = 0; i < 80 && high - low > 1e-13; ++i) {
    const double middle = 0.5 * (low + high);
    (m.squared_distance(middle) < limit ? high : low) = middle;
  }
  return high;
}

/// Folds one piece of relative motion, which starts at path time `t0`, into the result.
void fold(const RelativeMotion& m, double t0, double radius, std::uint64_t id, Verification& result) {
  const MonotonePieces pieces(m);
  double previous = 0.0;
  for (int i = 0; i < pieces.count; ++i) {
    const double t = pieces.t[static_cast<std::size_t>(i)];
    const double squared = m.squared_distance(t);
    const double clearance = std::sqrt(squared) - radius;
    if (clearance < result.min_clearance) {
      result.min_clearance = clearance;
      result.t_min_clearance = t0 + t;
      result.nearest_id = id;
    }
    if (clearance < 0.0) {
      const double contact = i == 0 ? 0.0 : crossing(m, previous, t, radius * radius);
      if (!result.first_contact || t0 + contact < *result.first_contact) {
        result.first_contact = t0 + contact;
        result.contact_speed = m.speed(contact);
      }
    }
    previous = t;
  }
}

/// Obstacle position, velocity and acceleration `t` seconds after its track's instant.
struct ObstacleAt {
  Vec3 position, velocity, acceleration;

  ObstacleAt(const Track& track, double t, double trust) {
    const double s = t < trust ? t : trust;
    velocity = track.velocity + s * track.acceleration;
    position = track.position + s * (track.velocity + 0.5 * s * track.acceleration) + (t - s) * velocity;
    acceleration = t < trust ? track.acceleration : Vec3::Zero();
  }
};

/// How long after `tracks_time` the track's acceleration is believed.
double believed(const Track& track, const VerifierInput& input) {
  const double left = input.acceleration_trust - track.age;
  return left > 0.0 ? left : 0.0;
}

bool well_formed(const VerifierInput& input) {
  bool good = !input.path.empty() && std::isfinite(input.vehicle_radius);
  double before = -kInfinity;
  for (const TimedPoint& point : input.path) {
    good = good && point.position.allFinite() && std::isfinite(point.t) && point.t > before;
    before = point.t;
  }
  for (const Track& track : input.tracks) {
    good = good && track.position.allFinite() && track.velocity.allFinite() && track.acceleration.allFinite() &&
           std::isfinite(track.radius) && std::isfinite(track.age);
  }
  return good;
}

/// One vehicle segment against one track, split where the prediction stops accelerating.
void check_segment(const TimedPoint& a, const TimedPoint& b, const Track& track, const VerifierInput& input,
                   Verification& result) {
  const Vec3 velocity = (b.position - a.position) / (b.t - a.t);
  const double end = std::min(b.t, input.until);
  const double trust = believed(track, input);
  const double change = input.tracks_time + trust;
  double t = a.t;
  while (t < end) {
    const double stop = (change > t && change < end) ? change : end;
    // Rounding must not put the instant at which the acceleration ends before its end.
    const double elapsed = t < change ? t - input.tracks_time : std::max(t - input.tracks_time, trust);
    const ObstacleAt obstacle(track, elapsed, trust);
    const RelativeMotion m{a.position + (t - a.t) * velocity - obstacle.position, velocity - obstacle.velocity,
                           -0.5 * obstacle.acceleration, stop - t};
    fold(m, t, input.vehicle_radius + track.radius, track.id, result);
    t = stop;
  }
}

/// Where the vehicle is during some segments: never farther than `radius` from `center`, where it is at time `t`, and
/// that time never farther than `half` away.
struct Stretch {
  std::size_t first = 0, last = 0;  // segment i leads to point i
  Vec3 center = Vec3::Zero();
  double t = 0.0;
  double radius = 0.0;
  double half = 0.0;

  Stretch() = default;
  /// Segments first to last - 1, of which each begins before `until`.
  Stretch(std::span<const TimedPoint> path, std::size_t first_, std::size_t last_) : first(first_), last(last_) {
    const TimedPoint& middle = path[(first + last - 2) / 2];  // one that a segment begins with
    center = middle.position;
    t = middle.t;
    double squared = 0.0;
    for (std::size_t i = first - 1; i < last; ++i) {
      squared = std::max(squared, (path[i].position - center).squaredNorm());
    }
    radius = std::sqrt(squared);
    half = std::max(t - path[first - 1].t, path[last - 1].t - t);
  }
};

/// Bounds of the clearance to one track, to skip what can be neither the minimum nor a contact. It holds because an
/// obstacle's velocity changes along a straight line up to where its acceleration ends, so that its speed is largest at
/// one end.
class Bound {
 public:
  Bound(const Track& track, const VerifierInput& input, double begin, double end)
      : track_(track),
        tracks_time_(input.tracks_time),
        trust_(believed(track, input)),
        radius_(input.vehicle_radius + track.radius) {
    const double first = ObstacleAt(track, std::min(0.0, begin - tracks_time_), trust_).velocity.squaredNorm();
    const double last = ObstacleAt(track, end - tracks_time_, trust_).velocity.squaredNorm();
    speed_ = std::sqrt(first > last ? first : last);
  }

  /// Whether the clearance can fall below zero or below `ceiling` while the vehicle is within `radius` of `center` and
  /// time within `half` of `t`. Lowers `ceiling` to the clearance at `center` and `t`.
  [[nodiscard]] bool matters(const Vec3& center, double t, double radius, double half, double& ceiling) const {
    const Vec3 obstacle = ObstacleAt(track_, t - tracks_time_, trust_).position;
    const double distance = (center - obstacle).norm();
    const double travel = speed_ * half;
    const double scale = center.cwiseAbs().maxCoeff() + obstacle.cwiseAbs().maxCoeff() + radius + travel + 1.0;
    const double limit = std::max(0.0, ceiling);
    ceiling = std::min(ceiling, distance - radius_);
    // Not "less than": numbers so large that their sums overflow must be looked at.
    return !(distance - radius - travel - radius_ - kRounding * scale > limit);
  }

 private:
  // Of a sum of some ten numbers, relative to the largest: 64 times what they can amount to.
  static constexpr double kRounding = 1e-13;
  const Track& track_;
  double tracks_time_, trust_, radius_, speed_ = 0.0;
};

/// A path cut in stretches, for all tracks.
class PathCheck {
 public:
  explicit PathCheck(const VerifierInput& input) : input_(input) {
    std::size_t end = 1;
    while (end < input.path.size() && !(input.path[end - 1].t >= input.until)) ++end;
    if (end == 1) return;
    whole_ = Stretch(input.path, 1, end);
    const std::size_t segments = (end - 1 + kStretches - 1) / kStretches;
    for (std::size_t first = 1; first < end; first += segments) {
      stretches_[count_++] = Stretch(input.path, first, std::min(first + segments, end));
    }
  }

  void add(const Track& track, Verification& result) {
    if (count_ == 0) return;
    const Bound bound(track, input_, input_.path.front().t, input_.path.back().t);
    if (!bound.matters(whole_.center, whole_.t, whole_.radius, whole_.half, ceiling_)) return;
    for (std::size_t n = 0; n < count_; ++n) {
      const Stretch& s = stretches_[n];
      if (!bound.matters(s.center, s.t, s.radius, s.half, ceiling_)) continue;
      for (std::size_t i = s.first; i < s.last; ++i) {
        const TimedPoint& a = input_.path[i - 1];
        const TimedPoint& b = input_.path[i];
        const double half = 0.5 * (std::min(b.t, input_.until) - a.t);
        const Vec3 way = (half / (b.t - a.t)) * (b.position - a.position);
        if (!bound.matters(a.position + way, a.t + half, way.norm(), half, ceiling_)) continue;
        check_segment(a, b, track, input_, result);
        ceiling_ = std::min(ceiling_, result.min_clearance);
      }
    }
  }

 private:
  static constexpr std::size_t kStretches = 12;
  const VerifierInput& input_;
  Stretch whole_;
  std::array<Stretch, kStretches> stretches_;
  std::size_t count_ = 0;
  double ceiling_ = kInfinity;  // a clearance that is reached, to any track
};

}  // namespace

Verification verify(const VerifierInput& input) {
  Verification result;
  result.valid = well_formed(input);
  if (!result.valid) return result;
  for (const TimedPoint& point : input.path) {
    if (!input.volume.contains(point.position, 1e-9)) result.inside_volume = false;
  }
  PathCheck check(input);
  for (const Track& track : input.tracks) {
    if (input.path.size() > 1) {
      check.add(track, result);
      continue;
    }
    const ObstacleAt obstacle(track, input.path[0].t - input.tracks_time, believed(track, input));
    fold({input.path[0].position - obstacle.position, Vec3::Zero(), Vec3::Zero(), 0.0}, input.path[0].t,
         input.vehicle_radius + track.radius, track.id, result);
  }
  return result;
}

}  // namespace jink::planner
