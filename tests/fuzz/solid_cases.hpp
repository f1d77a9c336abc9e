// SPDX-License-Identifier: BSD-3-Clause
// Paths among solids that move and turn, for fuzz_solids: how an obstacle is met is chosen, and where and when, and its
// motion is such that it is.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "planner/base/trajectory.hpp"
#include "planner/geometry/known_path.hpp"
#include "tests/fuzz/any_shape.hpp"
#include "tests/fuzz/numbers.hpp"

namespace jink::fuzz {

namespace base = planner::base;
using planner::geometry::KnownPath;

struct SolidCase {
  double radius = 0.0;  // of the vehicle
  double tracks_time = 0.0;
  double trust = base::kInfinity;
  double until = base::kInfinity;
  base::TimedPath path;
  std::vector<base::Track> tracks;
  std::vector<KnownPath> known;
  std::vector<Shape> track_shapes, known_shapes;
};

/// How an obstacle meets the path.
enum class Meeting { kAnyhow, kAnyhowToo, kHits, kGrazes, kGrazesToo, kAlong, kWithin, kBeside };

/// A place on a solid's surface, and a direction in which all of the solid is behind it.
struct Spot {
  Vec3 place, normal;
};

inline Vec3 any_perpendicular(Numbers& n, const Vec3& to) {
  const Vec3 side = n.direction().cross(to);
  return side.norm() > 1e-6 ? side.normalized() : to.unitOrthogonal();
}

inline Spot spot_of_capsule(Numbers& n, const Shape& s) {
  const Vec3 along = s.b - s.a;
  if (along.norm() == 0.0 || n.one_in(3)) {
    const Vec3 normal = n.direction();
    return {(normal.dot(along) > 0.0 ? s.b : s.a) + s.rounding * normal, normal};
  }
  const Vec3 normal = any_perpendicular(n, along.normalized());
  return {s.a + n.unit() * along + s.rounding * normal, normal};
}

inline Spot spot_of_hull(Numbers& n, const Shape& s) {
  Vec3 normal = n.direction();
  const Vec3& a = s.vertices[n.below(s.vertices.size())];
  const Vec3& b = s.vertices[n.below(s.vertices.size())];
  const Vec3& c = s.vertices[n.below(s.vertices.size())];
  const Vec3 face = (b - a).cross(c - a);
  if (face.norm() > 1e-9 && !n.one_in(3)) normal = n.one_in(2) ? face.normalized() : -face.normalized();
  if (a != b && n.one_in(3)) normal = any_perpendicular(n, (b - a).normalized());
  double most = -base::kInfinity;
  for (const Vec3& vertex : s.vertices) most = std::max(most, normal.dot(vertex));
  Spot spot{Vec3::Zero(), normal};
  double sum = 0.0;
  for (const Vec3& vertex : s.vertices) {  // of a face any place
    if (normal.dot(vertex) < most - 1e-9) continue;
    const double weight = n.in(0.01, 1.0);
    spot.place += weight * vertex;
    sum += weight;
  }
  spot.place /= sum;
  return spot;
}

/// On a face, an edge or a corner.
inline Spot spot_of_prism(Numbers& n, const Shape& s) {
  Vec3 normal = Vec3::Zero();
  const std::size_t on = 1 + n.below(7);
  for (Eigen::Index i = 0; i < 3; ++i) {
    if ((on >> static_cast<unsigned>(i) & 1U) != 0) normal[i] = (n.one_in(2) ? 1.0 : -1.0) * n.in(0.05, 1.0);
  }
  normal.normalize();
  Vec3 place = Vec3::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    place[i] = normal[i] == 0.0 ? n.in(-1.0, 1.0) * s.half[i] : std::copysign(s.half[i], normal[i]);
  }
  const double level = normal.head<2>().norm();
  if (level > 0.0) place.head<2>() += s.corner / level * normal.head<2>();
  return {s.pose.center + s.pose.axes * (place + s.rounding * normal), s.pose.axes * normal};
}

inline Spot any_spot(Numbers& n, const Shape& s) {
  if (s.kind == Shape::Kind::kHull) return spot_of_hull(n, s);
  return s.kind == Shape::Kind::kCapsule ? spot_of_capsule(n, s) : spot_of_prism(n, s);
}

inline double any_gap(Numbers& n) {
  switch (n.below(4)) {
    case 0:
      return 0.0;
    case 1:
      return n.one_in(2) ? 1e-9 : -1e-9;
    case 2:
      return n.in(-1e-3, 1e-3);
    default:
      return n.in(-0.5, 2.0);
  }
}

inline base::TimedPath any_path(Numbers& n, Meeting meeting, const Vec3& from, double t) {
  base::TimedPath path;
  Vec3 position = from;
  const bool straight = meeting == Meeting::kAlong || n.one_in(4);
  Vec3 velocity = n.in(0.0, 20.0) * n.direction();
  if (meeting == Meeting::kBeside || n.one_in(8)) velocity.setZero();
  const std::size_t points = 1 + n.below(6);
  for (std::size_t i = 0; i < points; ++i) {
    path.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
    const double duration = n.scale(0.05, 3.0);
    t += duration;
    position += duration * velocity;
    if (!straight) velocity = n.in(0.0, 20.0) * n.direction();
  }
  return path;
}

/// Of the path at an instant of it.
inline Vec3 velocity_of(const base::TimedPath& path, double t) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (t <= path[i].t) return (path[i].position - path[i - 1].position) / (path[i].t - path[i - 1].t);
  }
  return Vec3::Zero();
}

/// Where the vehicle is from the obstacle at an instant, and how fast it then moves relative to it.
struct Encounter {
  double t = 0.0;
  Vec3 place, velocity;
};

inline Encounter any_encounter(Numbers& n, const SolidCase& c, Meeting meeting, const Shape& shape,
                               const base::Body& body) {
  Encounter e;
  const double first = c.path.front().t;
  e.t = n.one_in(4) ? first : n.in(first, c.path.back().t);
  if (n.one_in(8)) e.t = c.path.back().t;
  if (meeting == Meeting::kAnyhow || meeting == Meeting::kAnyhowToo) {
    e.place = n.vec(n.scale(0.5, 30.0));
    e.velocity = n.in(0.0, 20.0) * n.direction();
    return e;
  }
  const Spot spot = any_spot(n, shape);
  const double yaw = body.yaw + (e.t - c.tracks_time) * body.yaw_rate;
  const Eigen::AngleAxisd turn(yaw, Vec3::UnitZ());
  const Vec3 normal = turn * spot.normal;
  e.place = turn * spot.place;
  if (meeting == Meeting::kWithin) {
    e.place *= n.unit();
  } else {
    e.place += (c.radius + any_gap(n)) * normal;
  }
  const double speed = n.in(0.0, 20.0);
  e.velocity =
      speed * (meeting == Meeting::kHits || meeting == Meeting::kWithin ? n.direction() : any_perpendicular(n, normal));
  if (meeting == Meeting::kBeside) e.velocity.setZero();
  return e;
}

inline void add_track(Numbers& n, SolidCase& c, const Encounter& e, const base::Body& body) {
  base::Track track;
  track.id = c.tracks.size() + 1;
  track.age = n.one_in(2) ? 0.0 : n.in(0.0, 0.5);
  if (n.one_in(3)) track.acceleration = n.vec(5.0);
  const double elapsed = e.t - c.tracks_time;
  const double bend = std::min(elapsed, std::max(0.0, c.trust - track.age));
  track.velocity = velocity_of(c.path, e.t) - e.velocity - bend * track.acceleration;
  const Vec3 moved = bend * track.velocity + 0.5 * bend * bend * track.acceleration +
                     (elapsed - bend) * (track.velocity + bend * track.acceleration);
  track.position = base::sample(c.path, e.t).position - e.place - moved;
  track.radius = body.solid->reach() * (n.one_in(2) ? 1.0 : n.in(1.0, 2.0));
  track.body = body;
  c.tracks.push_back(track);
}

inline void add_known(Numbers& n, SolidCase& c, Meeting meeting, const Encounter& e, const base::Body& body) {
  KnownPath known;
  known.id = 100 + c.known.size();
  known.offset = n.one_in(2) ? 0.0 : n.in(-1.0, 1e5);
  Vec3 velocity = velocity_of(c.path, e.t) - e.velocity;
  known.points = any_path(n, meeting, Vec3::Zero(), known.offset + n.in(-2.0, 2.0));
  if (meeting != Meeting::kAnyhow && known.points.size() > 1) {  // the piece that is met moves as wanted
    const double own = e.t - c.tracks_time + known.offset;
    const bool straight = meeting == Meeting::kAlong || n.one_in(2);
    for (std::size_t i = 1; i < known.points.size(); ++i) {
      if (!straight && own > known.points[i].t) continue;
      const Vec3 end = known.points[i - 1].position + (known.points[i].t - known.points[i - 1].t) * velocity;
      const Vec3 shift = end - known.points[i].position;
      for (std::size_t k = i; k < known.points.size(); ++k) known.points[k].position += shift;
      if (!straight) break;
    }
  }
  known.radius = body.solid->reach() * (n.one_in(2) ? 1.0 : n.in(1.0, 2.0));
  known.until = n.one_in(4) ? n.in(0.0, 8.0) : base::kInfinity;
  known.body = body;
  const Vec3 shift = base::sample(c.path, e.t).position - e.place - known.position(e.t - c.tracks_time);
  for (base::TimedPoint& point : known.points) point.position += shift;
  c.known.push_back(known);
}

inline SolidCase any_solid_case(Numbers& n) {
  SolidCase c;
  const auto meeting = static_cast<Meeting>(n.below(8));
  c.radius = n.one_in(16) ? 0.0 : n.scale(0.05, 1.5);
  c.tracks_time = n.one_in(2) ? 0.0 : n.in(-5.0, 5.0);
  c.trust = n.one_in(2) ? base::kInfinity : n.in(0.0, 3.0);
  const double start = c.tracks_time + (n.one_in(2) ? 0.0 : n.in(0.0, 3.0));
  c.path = any_path(n, meeting, n.vec(n.one_in(8) ? 2000.0 : 20.0), start);
  if (n.one_in(16)) c.until = start + n.in(0.0, 5.0);
  const std::size_t obstacles = n.one_in(3) ? 2 : 1;
  for (std::size_t i = 0; i < obstacles; ++i) {
    const Shape shape = any_shape(n);
    base::Body body{shape.solid(), n.one_in(3) ? 0.0 : n.in(-7.0, 7.0), 0.0};
    if (n.one_in(meeting == Meeting::kBeside ? 1 : 4)) body.yaw_rate = n.scale(0.01, 10.0) * (n.one_in(2) ? 1.0 : -1.0);
    const Encounter e = any_encounter(n, c, meeting, shape, body);
    if (n.one_in(2)) {
      add_track(n, c, e, body);
      c.track_shapes.push_back(shape);
    } else {
      add_known(n, c, meeting, e, body);
      c.known_shapes.push_back(shape);
    }
  }
  return c;
}

}  // namespace jink::fuzz
