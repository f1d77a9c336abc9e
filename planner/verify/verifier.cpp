// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/verifier.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/base/solid.hpp"
#include "planner/geometry/validity.hpp"
#include "planner/verify/relative_motion.hpp"
#include "planner/verify/solid_contact.hpp"
#include "planner/verify/sphere_contact.hpp"

namespace jink::planner::verify {
namespace {

/// Obstacle position, velocity and acceleration `t` seconds after its track's instant.
struct ObstacleAt {
  Vec3 position, velocity, acceleration;

  ObstacleAt(const base::Track& track, double t, double trust) {
    const double s = t < trust ? t : trust;
    velocity = track.velocity + s * track.acceleration;
    position = track.position + s * (track.velocity + 0.5 * s * track.acceleration) + (t - s) * velocity;
    acceleration = t < trust ? track.acceleration : Vec3::Zero();
  }
};

/// How long after `tracks_time` the track's acceleration is believed.
double believed(const base::Track& track, const VerifierInput& input) {
  const double left = input.acceleration_trust - track.age;
  return left > 0.0 ? left : 0.0;
}

/// Whether its yaw can be told within a time.
bool is_turned_little(const base::Body& body, double time) {
  return body.solid == nullptr || std::abs(body.yaw) + time * std::abs(body.yaw_rate) <= geometry::kTurned;
}

/// Whether the track stays, while it is looked at, where its distances can be told. Without a root: there are many.
bool stays_near(const base::Track& track, const VerifierInput& input, double time) {
  const double left = believed(track, input);
  const double accelerated = left < time ? left : time;
  const Vec3 speed = track.velocity.cwiseAbs() + accelerated * track.acceleration.cwiseAbs();
  return (track.position.cwiseAbs() + time * speed).sum() <= geometry::kFarthest &&
         geometry::is_within(speed, geometry::kFastest) && is_turned_little(track.body, time);
}

/// Whether the instants of the path's points, from `tracks_time` on, are told finely enough for its speed, and its yaw
/// within `time` of that.
bool is_on_time(const geometry::KnownPath& path, const VerifierInput& input, double time) {
  if (!is_turned_little(path.body, time)) return false;
  const double first = std::abs(input.tracks_time + (path.points.front().t - path.offset));
  const double last = std::abs(input.tracks_time + (path.points.back().t - path.offset));
  const double most = std::max({first, last, std::abs(input.tracks_time)});
  return most * geometry::kFastest <= geometry::kFarthest || most * path.fastest() <= geometry::kFarthest;
}

/// Whether all numbers are ones that a clearance follows from, to the accuracy stated.
bool can_judge(const VerifierInput& input) {
  if (!geometry::is_valid_path(input.path) || !geometry::is_amount(input.vehicle_radius) ||
      !(std::abs(input.tracks_time) <= geometry::kLongest) || std::isnan(input.until) ||
      !geometry::is_valid_world(input.volume, {}, input.known, input.acceleration_trust)) {
    return false;
  }
  const double last = std::min(input.path.back().t, input.until);
  const double time = std::max(std::abs(last - input.tracks_time), std::abs(input.path.front().t - input.tracks_time));
  const auto is_judged = [&](const base::Track& t) { return geometry::is_valid(t) && stays_near(t, input, time); };
  return std::all_of(input.tracks.begin(), input.tracks.end(), is_judged) &&
         std::all_of(input.standing.begin(), input.standing.end(),
                     [&](const base::Track& t) { return is_judged(t) && geometry::is_at_rest(t); }) &&
         std::all_of(input.known.begin(), input.known.end(),
                     [&](const geometry::KnownPath& path) { return is_on_time(path, input, time); });
}

/// Both ends of a segment inside: all of it is. The one that `until` is in counts up to there.
bool stays_inside(const VerifierInput& input) {
  constexpr double kRounding = 1e-9;  // m
  if (!input.volume.contains(input.path.front().position, kRounding)) return input.path.front().t > input.until;
  for (std::size_t i = 1; i < input.path.size(); ++i) {
    const base::TimedPoint& a = input.path[i - 1];
    const base::TimedPoint& b = input.path[i];
    if (a.t >= input.until) return true;
    const double share = b.t > input.until ? (input.until - a.t) / (b.t - a.t) : 1.0;
    if (!input.volume.contains(a.position + share * (b.position - a.position), kRounding)) return false;
  }
  return true;
}

/// What an obstacle is: its sphere, or a body in it. Times are the vehicle path's.
class Outline {
 public:
  Outline(const base::Body& body, double radius, std::uint64_t id, const VerifierInput& input)
      : body_(body), radius_(radius), id_(id), vehicle_radius_(input.vehicle_radius), time_(input.tracks_time) {}

  /// From a point to its surface at time t, while its centre is at `center`.
  [[nodiscard]] double distance(const Vec3& point, const Vec3& center, double t) const {
    if (body_.solid == nullptr) return (point - center).norm() - radius_;
    return solid_distance(body_.later(t - time_), point - center);
  }
  /// How fast a place on it moves about the centre at most.
  [[nodiscard]] double turning() const {
    return body_.solid == nullptr ? 0.0 : std::abs(body_.yaw_rate) * body_.solid->reach();
  }
  /// Folds a piece of relative motion that begins at time t into the result.
  void fold(const RelativeMotion& m, double t, Verification& result) const {
    if (body_.solid == nullptr) {
      fold_sphere(m, t, vehicle_radius_ + radius_, id_, result);
    } else {
      fold_solid(m, body_.later(t - time_), t, vehicle_radius_, id_, result);
    }
  }

 private:
  const base::Body& body_;
  double radius_;
  std::uint64_t id_;
  double vehicle_radius_, time_;
};

/// A track as the check sees it. Times are the vehicle path's.
class TrackMotion {
 public:
  TrackMotion(const base::Track& track, const VerifierInput& input)
      : track_(track),
        outline_(track.body, track.radius, track.id, input),
        tracks_time_(input.tracks_time),
        trust_(believed(track, input)) {}

  [[nodiscard]] const Outline& outline() const { return outline_; }
  [[nodiscard]] double until() const { return base::kInfinity; }
  [[nodiscard]] Vec3 position(double t) const { return ObstacleAt(track_, t - tracks_time_, trust_).position; }
  /// The largest speed between two instants: the velocity changes along a straight line up to where the acceleration
  /// ends, so that the speed is largest at one end.
  [[nodiscard]] double fastest(double begin, double end) const {
    const double first = ObstacleAt(track_, std::min(0.0, begin - tracks_time_), trust_).velocity.squaredNorm();
    const double last = ObstacleAt(track_, end - tracks_time_, trust_).velocity.squaredNorm();
    return std::sqrt(first > last ? first : last);
  }

  /// One vehicle segment, split where the prediction stops accelerating.
  void check(const base::TimedPoint& a, const base::TimedPoint& b, const VerifierInput& input,
             Verification& result) const {
    const Vec3 velocity = (b.position - a.position) / (b.t - a.t);
    const double end = std::min(b.t, input.until);
    const double change = tracks_time_ + trust_;
    double t = a.t;
    while (t < end) {
      const double stop = (change > t && change < end) ? change : end;
      // Rounding must not put the instant at which the acceleration ends before its end.
      const double elapsed = t < change ? t - tracks_time_ : std::max(t - tracks_time_, trust_);
      const ObstacleAt obstacle(track_, elapsed, trust_);
      const RelativeMotion m{a.position + (t - a.t) * velocity - obstacle.position, velocity - obstacle.velocity,
                             -0.5 * obstacle.acceleration, stop - t};
      outline_.fold(m, t, result);
      t = stop;
    }
  }

 private:
  const base::Track& track_;
  Outline outline_;
  double tracks_time_, trust_;
};

/// A known path as the check sees it: pieces of constant velocity, the one before point k being piece k, with a stand
/// before the first point and after the last.
class KnownMotion {
 public:
  KnownMotion(const geometry::KnownPath& path, const VerifierInput& input)
      : path_(path), outline_(path.body, path.radius, path.id, input), tracks_time_(input.tracks_time) {}

  [[nodiscard]] const Outline& outline() const { return outline_; }
  [[nodiscard]] double until() const { return tracks_time_ + path_.until; }
  [[nodiscard]] Vec3 position(double t) const { return on_piece(piece(t), t); }
  [[nodiscard]] double fastest(double /*begin*/, double /*end*/) const { return path_.fastest(); }

  /// One vehicle segment, split at the path's points.
  void check(const base::TimedPoint& a, const base::TimedPoint& b, const VerifierInput& input,
             Verification& result) const {
    const Vec3 velocity = (b.position - a.position) / (b.t - a.t);
    const double end = std::min({b.t, input.until, until()});
    double t = a.t;
    for (std::size_t k = piece(t); t < end; ++k) {
      const double stop = k < path_.points.size() ? std::clamp(instant(k), t, end) : end;
      if (stop > t) {
        const RelativeMotion m{a.position + (t - a.t) * velocity - on_piece(k, t), velocity - velocity_on(k),
                               Vec3::Zero(), stop - t};
        outline_.fold(m, t, result);
      }
      t = stop;
    }
  }

 private:
  [[nodiscard]] double instant(std::size_t k) const { return tracks_time_ + (path_.points[k].t - path_.offset); }
  /// The piece that begins at t or holds it.
  [[nodiscard]] std::size_t piece(double t) const {
    std::size_t low = 0;
    std::size_t high = path_.points.size();
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      instant(middle) <= t ? low = middle + 1 : high = middle;
    }
    return low;
  }
  [[nodiscard]] Vec3 velocity_on(std::size_t k) const {
    if (k == 0 || k == path_.points.size()) return Vec3::Zero();
    const base::TimedPoint& from = path_.points[k - 1];
    const base::TimedPoint& to = path_.points[k];
    return (to.position - from.position) / (to.t - from.t);
  }
  [[nodiscard]] Vec3 on_piece(std::size_t k, double t) const {
    if (k == 0) return path_.points.front().position;
    if (k == path_.points.size()) return path_.points.back().position;
    return path_.points[k - 1].position + (t - instant(k - 1)) * velocity_on(k);
  }

  const geometry::KnownPath& path_;
  Outline outline_;
  double tracks_time_;
};

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
  Stretch(std::span<const base::TimedPoint> path, std::size_t first_, std::size_t last_) : first(first_), last(last_) {
    const base::TimedPoint& middle = path[(first + last - 2) / 2];  // one that a segment begins with
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

/// Bounds of the clearance to one obstacle, to skip what can be neither the minimum nor a contact. They follow from its
/// largest speed.
template <typename Motion>
class Bound {
 public:
  Bound(const Motion& motion, const VerifierInput& input, double begin, double end)
      : motion_(motion),
        radius_(input.vehicle_radius),
        speed_(motion.fastest(begin, end) + motion.outline().turning()) {}

  /// Whether the clearance can fall below zero or below `ceiling` while the vehicle is within `radius` of `center` and
  /// time within `half` of `t`. Lowers `ceiling` to the clearance at `center` and `t` where that counts.
  [[nodiscard]] bool matters(const Vec3& center, double t, double radius, double half, double& ceiling) const {
    const Vec3 obstacle = motion_.position(t);
    const double distance = motion_.outline().distance(center, obstacle, t);
    const double travel = speed_ * half;
    const double scale = center.cwiseAbs().maxCoeff() + obstacle.cwiseAbs().maxCoeff() + radius + travel + 1.0;
    const double limit = std::max(0.0, ceiling);
    if (t < motion_.until()) ceiling = std::min(ceiling, distance - radius_);
    // Not "less than": numbers so large that their sums overflow must be looked at.
    return !(distance - radius - travel - radius_ - kRounding * scale > limit);
  }

 private:
  // Of a sum of some ten numbers, relative to the largest: 64 times what they can amount to.
  static constexpr double kRounding = 1e-13;
  const Motion& motion_;
  double radius_, speed_;
};

/// A path cut in stretches, for all obstacles.
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

  template <typename Motion>
  void add(const Motion& motion, Verification& result) {
    if (input_.path.size() == 1) add_place(motion, input_.path[0], result);
    if (count_ == 0) return;
    const Bound bound(motion, input_, input_.path.front().t, input_.path.back().t);
    if (!bound.matters(whole_.center, whole_.t, whole_.radius, whole_.half, ceiling_)) return;
    for (std::size_t n = 0; n < count_; ++n) {
      const Stretch& s = stretches_[n];
      if (!bound.matters(s.center, s.t, s.radius, s.half, ceiling_)) continue;
      for (std::size_t i = s.first; i < s.last; ++i) {
        const base::TimedPoint& a = input_.path[i - 1];
        const base::TimedPoint& b = input_.path[i];
        const double half = 0.5 * (std::min(b.t, input_.until) - a.t);
        const Vec3 way = (half / (b.t - a.t)) * (b.position - a.position);
        if (!bound.matters(a.position + way, a.t + half, way.norm(), half, ceiling_)) continue;
        motion.check(a, b, input_, result);
        ceiling_ = std::min(ceiling_, result.min_clearance);
      }
    }
  }

 private:
  template <typename Motion>
  void add_place(const Motion& motion, const base::TimedPoint& place, Verification& result) const {
    if (place.t >= motion.until()) return;
    motion.outline().fold({place.position - motion.position(place.t), Vec3::Zero(), Vec3::Zero(), 0.0}, place.t,
                          result);
  }

  static constexpr std::size_t kStretches = 12;
  const VerifierInput& input_;
  Stretch whole_;
  std::array<Stretch, kStretches> stretches_;
  std::size_t count_ = 0;
  double ceiling_ = base::kInfinity;  // a clearance that is reached, to any track
};

}  // namespace

Verification verify(const VerifierInput& input) {
  Verification result;
  result.valid = can_judge(input);
  if (!result.valid) return result;
  result.inside_volume = stays_inside(input);
  PathCheck check(input);
  for (const std::span<const base::Track> tracks : {input.tracks, input.standing}) {
    for (const base::Track& track : tracks) check.add(TrackMotion(track, input), result);
  }
  for (const geometry::KnownPath& known : input.known) check.add(KnownMotion(known, input), result);
  if (input.limits) result.limits = use_of_limits(input.path, *input.limits);
  return result;
}

}  // namespace jink::planner::verify
