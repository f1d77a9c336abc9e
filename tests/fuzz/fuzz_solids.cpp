// SPDX-License-Identifier: BSD-3-Clause
// The verifier among solids: boxes, plates, needles, cylinders, capsules, wires and hulls that move and turn, and paths
// that graze them, run along them, touch them or begin within. Its judge shares no code with planner/verify or
// planner/base/solid.cpp: it has its own motion and its own distances, in long double. No nearer than stated is proved
// by planes: all of a solid is on one side of a plane with its extent, so that what the vehicle's centre is beyond the
// plane bounds the distance, over an interval by its slope and the most that it bends; intervals are halved until that
// does. The input: numbers of two bytes each; where it ends, numbers that follow from it.
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/verify/verifier.hpp"
#include "tests/fuzz/any_shape.hpp"
#include "tests/fuzz/judged_motion.hpp"
#include "tests/fuzz/judged_solid.hpp"
#include "tests/fuzz/solid_cases.hpp"

// What is promoted to long double here is meant to be.
#pragma GCC diagnostic ignored "-Wdouble-promotion"

namespace {

using namespace jink;
using namespace jink::planner;
using Case = fuzz::SolidCase;
using fuzz::JudgedSolid;
using fuzz::Numbers;
using fuzz::Place;
using fuzz::Real;
using fuzz::require;
using fuzz::Shape;

constexpr Real kTolerance = 1e-8L;  // m, that a clearance may be off
constexpr int kMostLooks = 20000;   // at one obstacle; what takes more is not proved, but counted

/// The vehicle's motion relative to an obstacle while neither changes its acceleration.
struct Piece {
  Real begin = 0, end = 0;
  Place place, velocity, acceleration;  // at its begin

  [[nodiscard]] Place at(Real t) const {
    const Real s = t - begin;
    return place + (velocity + acceleration * (s / 2)) * s;
  }
  [[nodiscard]] Place velocity_at(Real t) const { return velocity + acceleration * (t - begin); }
};

/// Seen from a solid, in a frame in which it stands.
struct Look {
  JudgedSolid::Nearest nearest;
  Real beyond = 0;  // the plane of that normal, how far
  Real slope = 0;   // how fast that grows
  Real bend = 0;    // never faster against the slope than that
};

enum class Proof { kHolds, kFails, kCapped };

class Judged {
 public:
  Judged(const Shape& shape, const base::Body& body, std::uint64_t id, Real since)
      : solid_(shape), round_(solid_.is_round()), yaw_(body.yaw), rate_(body.yaw_rate), since_(since), id_(id) {}

  /// Cut where one of them turns. `instants`: where the motion may; `origin`: its time 0.
  template <typename Motion>
  void cut(const Case& c, const Motion& motion, std::vector<Real> instants, Real origin, Real until) {
    const fuzz::Walker vehicle(c.path, 0);
    const Real begin = c.path.front().t;
    if (c.path.size() == 1) {
      if (begin < until) pieces_.push_back({begin, begin, vehicle.at(begin) - motion.at(begin - origin), {}, {}});
      return;
    }
    const Real end = std::min({Real{c.path.back().t}, Real{c.until}, until});
    for (const base::TimedPoint& point : c.path) instants.push_back(point.t);
    instants.push_back(end);
    std::sort(instants.begin(), instants.end());
    Real t = begin;
    for (const Real next : instants) {
      if (next <= t || next > end) continue;
      const Real middle = (t + next) / 2;
      const Place acceleration = motion.acceleration_at(middle - origin) * -1;
      const Place velocity = vehicle.velocity_at(middle) - motion.velocity_at(middle - origin);
      pieces_.push_back(
          {t, next, vehicle.at(t) - motion.at(t - origin), velocity - acceleration * (middle - t), acceleration});
      t = next;
    }
  }

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] bool counts() const { return !pieces_.empty(); }
  [[nodiscard]] bool is_hull() const { return solid_.is_hull(); }

  /// From the vehicle's centre to its surface.
  [[nodiscard]] Real distance(Real t) const { return look(piece(t), t, 0).nearest.distance; }

  /// Whether a speed over its surface is one at that instant: one of two where the motion changes.
  [[nodiscard]] bool has_speed(Real t, Real speed) const {
    constexpr Real kNear = 1e-9L;  // s
    for (const Piece& p : pieces_) {
      if (t < p.begin - kNear || t > p.end + kNear) continue;
      if (std::abs(over(p, t).length() - speed) <= 1e-6L * (1 + speed)) return true;
    }
    return false;
  }

  /// Whether it stays at least that far away, up to an instant.
  [[nodiscard]] Proof keeps(Real limit, Real until) const {
    if (is_hull() && limit <= 0) return Proof::kHolds;
    int looks = 0;
    for (const Piece& p : pieces_) {
      if (p.begin > until) break;
      const Proof proof = keeps(p, limit, std::min(p.end, until), looks);
      if (proof != Proof::kHolds) return proof;
    }
    return Proof::kHolds;
  }

 private:
  struct Interval {
    Real begin, end;
  };

  [[nodiscard]] const Piece& piece(Real t) const {
    std::size_t i = 0;
    while (i + 1 < pieces_.size() && t > pieces_[i].end) ++i;
    return pieces_[i];
  }
  [[nodiscard]] Real yaw(Real t) const { return yaw_ + rate_ * (t - since_); }
  [[nodiscard]] Place over(const Piece& p, Real t) const {
    const Place place = p.at(t);
    return p.velocity_at(t) - Place(-rate_ * place.y, rate_ * place.x, 0);
  }

  /// What is round about a vertical need not be turned: only the vertical goes round. `half`: the bend holds so far.
  [[nodiscard]] Look look(const Piece& p, Real t, Real half) const {
    const Place place = p.at(t);
    const Place velocity = p.velocity_at(t);
    const Place& acceleration = p.acceleration;
    const fuzz::Turn turn(rate_ == 0 ? Real{yaw_} : yaw(t));
    Place seen;
    Place moving;
    Real level = acceleration.level();
    if (round_) {
      const Place center = turn(solid_.center());
      seen = place - center + solid_.center();
      moving = velocity - Place(-rate_ * center.y, rate_ * center.x, 0);
      level += rate_ * rate_ * center.level();
    } else {
      seen = turn.back(place);
      moving = turn.back(over(p, t));
      const Real speed = velocity.level() + acceleration.level() * half;
      level += std::abs(rate_) * (2 * speed + std::abs(rate_) * (place.level() + speed * half));
    }
    Look l;
    l.nearest = solid_.nearest(seen);
    const Place& normal = l.nearest.normal;
    l.beyond = normal.dot(seen) - solid_.extent(normal);
    l.slope = normal.dot(moving);
    l.bend = rate_ == 0 ? std::max(Real{0}, -normal.dot(turn.back(acceleration)))
                        : normal.level() * level + std::abs(normal.z * acceleration.z);
    if (rate_ == 0 && round_) l.bend = std::max(Real{0}, -normal.dot(acceleration));
    return l;
  }

  [[nodiscard]] Proof keeps(const Piece& p, Real limit, Real until, int& looks) const {
    std::array<Interval, 80> open{};
    std::size_t count = 0;
    open[count++] = {p.begin, until};
    while (count > 0) {
      const Interval i = open[--count];
      const Real middle = (i.begin + i.end) / 2;
      const Real half = (i.end - i.begin) / 2;
      const Real travel = (p.velocity_at(middle).length() + p.acceleration.length() * half) * half;
      if (p.at(middle).length() - solid_.reach() - travel >= limit) continue;
      if (++looks > kMostLooks || count + 2 > open.size()) return Proof::kCapped;
      const Look l = look(p, middle, half);
      if (l.nearest.distance < limit) return Proof::kFails;
      if (l.beyond - (std::abs(l.slope) + l.bend * half / 2) * half >= limit) continue;
      open[count++] = {middle, i.end};
      open[count++] = {i.begin, middle};
    }
    return Proof::kHolds;
  }

  JudgedSolid solid_;
  bool round_;
  Real yaw_, rate_, since_;
  std::uint64_t id_;
  std::vector<Piece> pieces_;
};

std::vector<Judged> obstacles_of(const Case& c) {
  std::vector<Judged> all;
  const Real since = c.tracks_time;
  for (std::size_t i = 0; i < c.tracks.size(); ++i) {
    const base::Track& track = c.tracks[i];
    const fuzz::Thrown motion(track, c.trust, base::kInfinity);
    all.emplace_back(c.track_shapes[i], track.body, track.id, since)
        .cut(c, motion, {since + motion.bend()}, since, base::kInfinity);
  }
  for (std::size_t i = 0; i < c.known.size(); ++i) {
    const geometry::KnownPath& known = c.known[i];
    std::vector<Real> instants;
    for (const base::TimedPoint& point : known.points) instants.push_back(since + (Real{point.t} - known.offset));
    const fuzz::Walker motion(known.points, known.offset);
    all.emplace_back(c.known_shapes[i], known.body, known.id, since)
        .cut(c, motion, instants, since, since + known.until);
  }
  return all;
}

/// Says at the end what was judged.
struct Tally {
  unsigned long long judged = 0, contacts = 0, within = 0, grazes = 0, alone = 0, capped = 0;

  ~Tally() {
    std::fprintf(stderr,
                 "%llu judged: %llu with a contact, %llu of them deep, %llu that touch to 1e-8 m, %llu without an "
                 "obstacle in time; %llu not proved in %d steps\n",
                 judged, contacts, within, grazes, alone, capped, kMostLooks);
  }
};
Tally tally;

void check_contact(const Case& c, const std::vector<Judged>& obstacles, const verify::Verification& v, bool& capped) {
  constexpr Real kBefore = 1e-10L;  // s
  const Real radius = c.radius;
  if (!v.first_contact) {
    require(v.min_clearance >= -kTolerance, "no contact, but nearer than that");
    return;
  }
  require(v.min_clearance < kTolerance, "a contact, but not near");
  bool touches = false;
  for (const Judged& obstacle : obstacles) {
    if (!obstacle.counts()) continue;
    const Proof proof = obstacle.keeps(radius - kTolerance, *v.first_contact - kBefore);
    require(proof != Proof::kFails, "a contact before the first one");
    capped = capped || proof == Proof::kCapped;
    touches = touches || (obstacle.distance(*v.first_contact) <= radius + kTolerance &&
                          obstacle.has_speed(*v.first_contact, v.contact_speed));
  }
  require(touches, "a contact where there is none, or at another speed");
}

void check(const Case& c, const verify::Verification& v) {
  const std::vector<Judged> obstacles = obstacles_of(c);
  require(v.valid, "not judged");
  require(v.inside_volume, "outside of what has no bounds");
  bool capped = false;
  bool counts = false;
  bool attained = false;
  const Real stated = Real{v.min_clearance} + Real{c.radius};
  for (const Judged& obstacle : obstacles) {
    if (!obstacle.counts()) continue;
    counts = true;
    if (obstacle.id() == v.nearest_id)
      attained = attained || std::abs(obstacle.distance(v.t_min_clearance) - stated) <= kTolerance;
    const Proof proof = obstacle.keeps(stated - kTolerance, base::kInfinity);
    require(proof != Proof::kFails, "nearer than it says");
    capped = capped || proof == Proof::kCapped;
  }
  require(counts == std::isfinite(v.min_clearance), "a clearance to nothing");
  require(attained == counts, "not as near as it says");
  if (counts) {
    constexpr double kRounding = 1e-12;  // s
    require(v.t_min_clearance >= c.path.front().t, "nearest before the path");
    require(v.t_min_clearance <= c.path.back().t + kRounding, "nearest after the path");
    check_contact(c, obstacles, v, capped);
  }
  ++tally.judged;
  tally.contacts += v.first_contact ? 1 : 0;
  tally.within += v.first_contact && v.min_clearance <= -c.radius ? 1 : 0;
  tally.grazes += std::abs(v.min_clearance) <= 1e-8 ? 1 : 0;
  tally.alone += counts ? 0 : 1;
  tally.capped += capped ? 1 : 0;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Numbers n(data, size);
  const Case c = fuzz::any_solid_case(n);
  verify::VerifierInput input;
  input.path = c.path;
  input.tracks = c.tracks;
  input.tracks_time = c.tracks_time;
  input.vehicle_radius = c.radius;
  input.acceleration_trust = c.trust;
  input.until = c.until;
  input.known = c.known;
  check(c, verify::verify(input));
  return 0;
}
