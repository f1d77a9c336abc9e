// SPDX-License-Identifier: BSD-3-Clause
// Random requests (vehicles of 0.1 to 20 m/s and 0.5 to 30 m/s², tracks, known paths, solids in a third of them,
// volumes, plans before, absurd numbers), planned with a tiny search and judged by a judge of its own: it shares no
// code with planner/verify or the search. It has its own motion of all that moves, in long double, and proves a
// distance by halving time until nothing is fast enough to come nearer. The input: numbers of two bytes each; where it
// ends, numbers that follow from it. Solids follow from it too: they change none of the other numbers.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/open_loop.hpp"
#include "tests/fuzz/any_shape.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/judged_motion.hpp"
#include "tests/fuzz/judged_solid.hpp"
#include "tests/fuzz/numbers.hpp"

// What is promoted to long double here is meant to be.
#pragma GCC diagnostic ignored "-Wdouble-promotion"

namespace {

using namespace jink;
using namespace jink::planner;
using fuzz::Numbers;
using fuzz::Place;
using fuzz::Real;
using fuzz::require;
using fuzz::Shape;
using fuzz::Walker;

constexpr Real kClearance = 1e-7L;  // m, that the verifier may be off
constexpr Real kStated = 1e-3L;     // m, to which the clearance that a plan states is looked at
constexpr double kSame = 1e-6;      // m, within which places are the same
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// ---- What is asked ----

struct Case {
  base::HorizonSettings settings;
  std::vector<base::Track> tracks;
  std::vector<geometry::KnownPath> paths;
  std::vector<Shape> track_shapes, path_shapes;  // of those that are no spheres
  horizon::PathRequest request;
  base::TimedPath previous;
  bool open_loop = false;
  bool absurd = false;
  bool none = false;  // a number of the request is NaN
  std::uint64_t seed = 1;

  [[nodiscard]] horizon::PathRequest bound() const {
    horizon::PathRequest r = request;
    r.tracks = tracks;
    r.paths = paths;
    return r;
  }
};

base::HorizonSettings tiny_search(Numbers& n) {
  base::HorizonSettings s;
  s.waypoints = 2 + static_cast<int>(n.below(3));
  s.time = n.in(2.0, 6.0);
  s.step = n.one_in(4) ? n.in(0.05, 0.3) : 0.1;
  s.slaves = 2;
  s.sharing = 1;
  s.population = n.one_in(2) ? 12 : 36;
  s.generations = 1 + static_cast<int>(n.below(15));
  return s;
}

base::VehicleLimits any_vehicle(Numbers& n) {
  base::VehicleLimits v;
  v.max_speed = n.scale(0.1, 20.0);
  v.cruise_speed = v.max_speed * n.in(0.2, 1.0);
  v.max_climb = v.max_speed * n.in(0.1, 1.0);
  v.max_acceleration = n.scale(0.5, 30.0);
  v.radius = n.scale(0.05, 1.5);
  return v;
}

// Something to meet on the way: most are near it, at about the vehicle's speed.
base::Track any_track(Numbers& n, const horizon::PathRequest& r, std::uint64_t id) {
  base::Track track;
  track.id = id;
  const double way = (r.target - r.position).norm();
  track.radius = n.scale(0.05, 2.0);
  track.position = r.position + n.unit() * (r.target - r.position) + n.vec(0.3 * way + 2.0);
  track.velocity = n.vec(n.one_in(3) ? 0.0 : 1.5 * r.vehicle.max_speed);
  track.acceleration = n.vec(n.one_in(2) ? 0.0 : 5.0);
  track.position_sigma = n.in(0.0, 0.2);
  track.velocity_sigma = n.in(0.0, 0.3);
  track.age = n.in(0.0, 0.5);
  return track;
}

geometry::KnownPath any_path(Numbers& n, const horizon::PathRequest& r, std::uint64_t id) {
  geometry::KnownPath path;
  path.id = id;
  path.offset = n.one_in(2) ? 0.0 : n.in(-1.0, 1e5);
  path.radius = n.scale(0.05, 2.0);
  path.margin = n.in(0.0, 0.3);
  path.position_sigma = n.in(0.0, 0.2);
  path.velocity_sigma = n.in(0.0, 0.1);
  path.age = n.in(0.0, 1.0);
  path.until = n.one_in(2) ? base::kInfinity : n.in(0.0, 6.0);
  const double way = (r.target - r.position).norm();
  Vec3 position = r.position + n.unit() * (r.target - r.position) + n.vec(0.3 * way + 2.0);
  double t = path.offset + n.in(-2.0, 2.0);
  const std::size_t points = 1 + n.below(6);
  for (std::size_t i = 0; i < points; ++i) {
    path.points.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
    const double duration = n.in(0.05, 2.0);
    t += duration;
    position += n.vec(r.vehicle.max_speed * duration);
  }
  return path;
}

/// Of a third of all that moves only a solid in its sphere is there.
void give_body(Numbers& n, base::Body& body, double radius, Shape& shape) {
  if (!n.one_in(3)) return;
  shape = fuzz::any_shape(n);
  const double reach = std::max(shape.solid()->reach(), 1e-6);
  shape.grow((n.one_in(2) ? 1.0 : n.in(0.5, 1.0)) * radius / reach);
  body = {shape.solid(), n.in(-7.0, 7.0), n.one_in(2) ? 0.0 : n.in(-3.0, 3.0)};
}

/// How a body is turned, or how suddenly a track changed, becomes what nobody meant.
void make_other_absurd(Numbers& n, Case& c, double value) {
  if (n.one_in(4)) {
    c.tracks.front().sudden_change = value;
    c.absurd = true;
    c.none = std::isnan(value);
    return;
  }
  base::Body& body = n.one_in(2) ? c.tracks.front().body : c.paths.front().body;
  (n.one_in(2) ? body.yaw : body.yaw_rate) = value;
  c.absurd = true;
  c.none = std::isnan(value) && body.solid != nullptr;
}

/// One number of the request becomes one that nobody meant.
void make_absurd(Numbers& n, Numbers& others, Case& c) {
  if (c.tracks.empty()) {
    c.tracks.emplace_back();
    c.track_shapes.emplace_back();
  }
  if (c.paths.empty()) {
    c.paths.emplace_back().points.emplace_back();
    c.path_shapes.emplace_back();
  }
  horizon::PathRequest& r = c.request;
  base::Track& track = c.tracks[n.below(c.tracks.size())];
  geometry::KnownPath& path = c.paths[n.below(c.paths.size())];
  base::TimedPoint& point = path.points[n.below(path.points.size())];
  const auto axis = static_cast<Eigen::Index>(n.below(3));
  const std::array<double*, 31> fields{&r.position[axis],
                                       &r.velocity[axis],
                                       &r.target[axis],
                                       &r.volume.min[axis],
                                       &r.volume.max[axis],
                                       &r.volume_clearance,
                                       &r.vehicle.radius,
                                       &r.vehicle.max_speed,
                                       &r.vehicle.cruise_speed,
                                       &r.vehicle.max_climb,
                                       &r.vehicle.max_acceleration,
                                       &r.margin,
                                       &r.track_acceleration,
                                       &r.sudden_change,
                                       &r.time_price,
                                       &r.acceleration_trust,
                                       &track.position[axis],
                                       &track.velocity[axis],
                                       &track.acceleration[axis],
                                       &track.radius,
                                       &track.position_sigma,
                                       &track.velocity_sigma,
                                       &track.age,
                                       &point.position[axis],
                                       &point.t,
                                       &path.offset,
                                       &path.radius,
                                       &path.margin,
                                       &path.position_sigma,
                                       &path.age,
                                       &path.until};
  const std::array<double, 16> values{
      kNaN, base::kInfinity, -base::kInfinity, 1e308, -1e308, 1e200, 1e160, -1e160, 1e15, -1e15, 1e9, -1e6, 1e5, -1.0,
      0.0,  5e-324};
  double& field = *fields[n.below(fields.size())];
  const double value = values[n.below(values.size())];
  if (others.one_in(8)) {
    make_other_absurd(others, c, value);
    return;
  }
  field = value;
  c.absurd = true;
  c.none = std::isnan(field);
}

Case any_case(Numbers& n, Numbers& others) {
  Case c;
  c.settings = tiny_search(n);
  c.seed = n.below(65536);
  horizon::PathRequest& r = c.request;
  r.vehicle = any_vehicle(n);
  r.position = n.vec(n.one_in(8) ? 2000.0 : 30.0);
  r.velocity = n.one_in(4) ? Vec3::Zero() : n.vec(0.7 * r.vehicle.max_speed);
  r.target = r.position + n.vec(n.one_in(8) ? 0.1 : 10.0 * r.vehicle.cruise_speed);
  if (n.one_in(16)) r.target = r.position;
  if (!n.one_in(3)) {
    const double room = n.scale(0.05, 10.0);
    r.volume = {(r.position.cwiseMin(r.target).array() - room).matrix(),
                (r.position.cwiseMax(r.target).array() + room).matrix()};
    if (n.one_in(8)) r.volume.max += n.vec(2.0 * room).cwiseMax(-2.0 * room);  // which may leave its start out
    r.volume.max = r.volume.max.cwiseMax(r.volume.min);
  }
  r.volume_clearance = n.one_in(2) ? 0.0 : n.in(0.0, 1.0);
  r.margin = n.in(0.0, 0.5);
  r.track_acceleration = n.in(0.0, 1.0);
  r.sudden_change = n.one_in(2) ? 0.0 : n.in(0.0, 3.0);
  r.time_price = n.one_in(2) ? 0.0 : n.in(0.0, 5.0);
  r.acceleration_trust = n.one_in(4) ? base::kInfinity : n.in(0.0, 2.0);
  r.stuck = n.one_in(8);
  r.holds = n.one_in(8);
  r.visit = n.one_in(8);
  const std::size_t tracks = n.below(9);
  for (std::size_t i = 0; i < tracks; ++i) c.tracks.push_back(any_track(n, r, i));
  const std::size_t paths = n.one_in(2) ? n.below(3) : 0;
  for (std::size_t i = 0; i < paths; ++i) c.paths.push_back(any_path(n, r, 100 + i));
  c.open_loop = n.one_in(64);
  if (c.open_loop) r.velocity.setZero();
  for (base::Track& track : c.tracks) give_body(others, track.body, track.radius, c.track_shapes.emplace_back());
  for (geometry::KnownPath& path : c.paths) give_body(others, path.body, path.radius, c.path_shapes.emplace_back());
  for (base::Track& track : c.tracks) {
    if (!others.one_in(4)) continue;
    track.position_sigma = track.velocity_sigma = 0.0;
    track.sudden_change = others.in(0.0, 4.0);
  }
  return c;
}

// ---- The judge ----

/// What is in a sphere: all of it, or a solid.
class Outline {
 public:
  Outline(const base::Body& body, const Shape& shape, double radius)
      : radius_(radius), yaw_(body.yaw), rate_(body.yaw_rate) {
    if (body.solid != nullptr) solid_.emplace(shape);
  }
  /// From a place relative to the centre to the surface, at a time; where the sphere is as far as `enough`, no more
  /// than that.
  [[nodiscard]] Real distance(const Place& from, Real t, Real enough) const {
    const Real sphere = from.length() - (solid_ ? solid_->reach() : radius_);
    if (!solid_ || sphere >= enough) return sphere;
    return solid_->nearest(fuzz::Turn(yaw_ + rate_ * t).back(from)).distance;
  }
  /// How fast its surface moves about the centre at most.
  [[nodiscard]] Real turning() const { return solid_ ? std::abs(rate_) * solid_->reach() : 0; }

 private:
  Real radius_, yaw_, rate_;
  std::optional<fuzz::JudgedSolid> solid_;
};

/// True unless two bodies come nearer than `distance` between two instants. In the middle of an interval they are at
/// some distance, and to its ends it changes by no more than their speeds allow; else the interval is halved.
template <typename Body>
bool stay_apart(const Walker& vehicle, const Body& body, const Outline& outline, Real distance, Real begin, Real end) {
  const Real speed = vehicle.fastest() + body.fastest() + outline.turning();
  struct Interval {
    Real begin, end;
  };
  std::array<Interval, 80> open{};
  std::size_t count = 0;
  open[count++] = {begin, end};
  while (count > 0) {
    const Interval i = open[--count];
    const Real middle = (i.begin + i.end) / 2;
    const Real half = (i.end - i.begin) / 2;
    const Real apart = outline.distance(vehicle.at(middle) - body.at(middle), middle, distance + speed * half);
    if (!(apart >= distance)) return false;
    // Touching is apart: what a fraction of the tolerance decides is not looked at more closely.
    if (apart - speed * half >= distance || speed * half < kClearance / 100) continue;
    open[count++] = {middle, i.end};
    open[count++] = {i.begin, middle};
  }
  return true;
}

/// No nearer to anything than `clearance` between the surfaces, up to a time; a path that ends before waits there.
bool is_clear(const Case& c, const base::TimedPath& path, Real clearance, Real until) {
  const Walker vehicle(path, 0);
  const Real reach = Real{c.request.vehicle.radius} + clearance;
  for (std::size_t i = 0; i < c.tracks.size(); ++i) {
    const base::Track& track = c.tracks[i];
    const fuzz::Thrown body(track, c.request.acceleration_trust, until);
    const Outline outline(track.body, c.track_shapes[i], track.radius);
    if (!stay_apart(vehicle, body, outline, reach, 0, until)) return false;
  }
  for (std::size_t i = 0; i < c.paths.size(); ++i) {
    const geometry::KnownPath& known = c.paths[i];
    const Real end = std::min(until, Real{known.until});
    if (end <= 0) continue;
    const Walker body(known.points, known.offset);
    const Outline outline(known.body, c.path_shapes[i], known.radius);
    if (!stay_apart(vehicle, body, outline, reach, 0, end)) return false;
  }
  return true;
}

bool is_inside(const base::Box& volume, const Place& p) {
  const Real slack = 1e-8L;
  return p.x >= volume.min.x() - slack && p.x <= volume.max.x() + slack && p.y >= volume.min.y() - slack &&
         p.y <= volume.max.y() + slack && p.z >= volume.min.z() - slack && p.z <= volume.max.z() + slack;
}

bool stays_inside(const Case& c, const base::TimedPath& path, Real until) {
  for (const base::TimedPoint& point : path) {
    if (point.t <= until && !is_inside(c.request.volume, Place(point.position))) return false;
  }
  return is_inside(c.request.volume, Walker(path, 0).at(until));
}

void check_limits(const Case& c, const base::TimedPath& path) {
  const base::VehicleLimits& limits = c.request.vehicle;
  const Real rounding = 1e-9L * (1 + Place(c.request.position).length());  // m/s, of places over a step
  const Real most = std::max(Real{limits.max_speed}, Place(c.request.velocity).length()) * (1 + 1e-9L) + rounding;
  const Real climb = std::max(Real{limits.max_climb}, std::abs(Real{c.request.velocity.z()})) * (1 + 1e-9L) + rounding;
  const Walker vehicle(path, 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Place v = vehicle.velocity(i);
    require(v.length() <= most, "a plan beyond the speed");
    require(std::abs(v.z) <= climb, "a plan beyond the climb");
    if (i == 1) continue;
    // A plan before is cut within its first segment, and one at its time limit within its last: the velocity is that of
    // the whole one.
    Real whole = i == 2 ? Real{path[2].t} - Real{path[1].t} : 0;
    if (c.open_loop && i + 1 == path.size()) whole = std::max(whole, Real{path[i - 1].t} - Real{path[i - 2].t});
    const Real between = std::max(whole, (Real{path[i].t} - Real{path[i - 2].t}) / 2);
    const Real change = (v - vehicle.velocity(i - 1)).length();
    require(change <= between * limits.max_acceleration * (1 + 1e-6L) + rounding, "a plan beyond the acceleration");
  }
}

void check_path(const Case& c, const verify::Plan& plan) {
  const base::TimedPath& path = plan.path;
  require(path.front().t == 0.0, "a plan that does not begin at time 0");
  require((path.front().position - c.request.position).norm() <= kSame, "a plan that begins elsewhere");
  require(plan.kept_previous || path.front().position == c.request.position, "a new plan that begins elsewhere");
  for (std::size_t i = 0; i < path.size(); ++i) {
    require(path[i].position.allFinite() && std::isfinite(path[i].t), "a plan that is not finite");
    require(i == 0 || path[i].t > path[i - 1].t, "a plan whose times do not increase");
  }
}

void check_plan(const Case& c, const verify::Plan& plan) {
  using verify::PlanStatus;
  if (plan.status == PlanStatus::kInvalid) {
    require(plan.path.empty(), "a path for a request that was refused");
    require(c.absurd, "a request refused that is reasonable");
    return;
  }
  require(!c.none, "a plan for a number that is none");
  require(!plan.path.empty(), "no path, and no reason");
  check_path(c, plan);
  if (plan.status != PlanStatus::kReaches && plan.status != PlanStatus::kProgresses) return;
  const bool reaches = plan.status == PlanStatus::kReaches;
  require(plan.verification.free(), "free by its status, not by its verification");
  require(!reaches || (plan.path.back().position - c.request.target).norm() <= kSame, "reaches what it does not");
  const Real end = plan.path.back().t;
  Real until = plan.horizon;
  if (reaches) until = std::max(until, end);
  if (c.open_loop) until = end;
  require(stays_inside(c, plan.path, until), "free, but outside of the volume");
  require(is_clear(c, plan.path, -kClearance, until), "free, but it hits");
  const Real stated = std::min(Real{plan.verification.min_clearance}, Real{1e6});
  require(is_clear(c, plan.path, stated - kStated, until), "nearer than it says");
  // A plan before may be rejoined a little harder than that: it is not called reaching then.
  if ((reaches || !plan.kept_previous) && !c.absurd) check_limits(c, plan.path);
}

// ---- The harness ----

verify::Plan make_plan(const Case& c, base::WorkerPool& pool) {
  if (c.open_loop)
    return horizon::plan_open_loop(c.settings, {}, {c.bound(), 4.0, 1.0}, c.seed, {c.settings.generations}, pool);
  return horizon::HorizonPlanner(c.settings).plan(c.bound(), c.previous, c.seed, 0, {c.settings.generations}, pool);
}

bool same_bits(const verify::Plan& a, const verify::Plan& b) {
  const auto same = [](const Vec3& p, const Vec3& q) {
    return std::memcmp(p.data(), q.data(), 3 * sizeof(double)) == 0;
  };
  return a.status == b.status && a.kept_previous == b.kept_previous &&
         std::equal(a.path.begin(), a.path.end(), b.path.begin(), b.path.end(),
                    [&](const base::TimedPoint& p, const base::TimedPoint& q) {
                      return p.t == q.t && same(p.position, q.position) && same(p.velocity, q.velocity);
                    });
}

/// A plan from here is followed for a while; then it is the plan before, of a world that has moved on.
void follow(Numbers& n, Case& c, base::WorkerPool& pool) {
  const verify::Plan before = make_plan(c, pool);
  check_plan(c, before);
  if (before.path.empty()) return;
  const double t = n.one_in(4) ? 0.0 : n.in(0.0, 1.2 * std::min(before.path.back().t, c.settings.time));
  for (base::Track& track : c.tracks) {
    const double bend = std::min(t, std::max(0.0, c.request.acceleration_trust - track.age));
    const Vec3 velocity = track.velocity + bend * track.acceleration;
    track.position += bend * track.velocity + 0.5 * bend * bend * track.acceleration + (t - bend) * velocity;
    track.velocity = velocity;
    track.age += t;
    track.body = track.body.later(t);
  }
  for (geometry::KnownPath& path : c.paths) {
    path.offset += t;
    path.age += t;
    path.until -= t;
    path.body = path.body.later(t);
  }
  const base::TimedPoint now = base::sample(before.path, t);
  c.request.position = now.position;
  c.request.velocity = now.velocity;
  c.previous = base::later(before.path, t);
}

/// The plan before is not what it should be: it begins elsewhere, at another speed, or is no path.
void spoil(Numbers& n, Case& c) {
  if (c.previous.empty()) c.previous.emplace_back();
  const Vec3 jump = n.vec(n.scale(1e-7, 10.0));
  const std::size_t any = n.below(c.previous.size());
  switch (n.below(5)) {
    case 0:
      for (base::TimedPoint& point : c.previous) point.position += jump;
      break;
    case 1:
      for (base::TimedPoint& point : c.previous) point.t += jump.x();
      break;
    case 2:
      for (base::TimedPoint& point : c.previous) point.t *= n.in(0.0, 2.0);
      break;
    case 3:
      c.previous[any].position.y() = n.one_in(2) ? kNaN : 1e200;
      break;
    default:
      c.previous[any].t = n.one_in(2) ? kNaN : 1e300;
      break;
  }
}

/// Says at the end what became of all requests.
struct Tally {
  std::array<std::uint64_t, 5> plans{};
  std::uint64_t kept = 0, open_loop = 0, twice = 0;

  void add(const verify::Plan& plan, bool open) {
    ++plans.at(static_cast<std::size_t>(plan.status));
    kept += plan.kept_previous ? 1 : 0;
    open_loop += open ? 1 : 0;
  }
  ~Tally() {
    for (std::size_t i = 0; i < plans.size(); ++i) {
      std::fprintf(stderr, "%llu %s, ", static_cast<unsigned long long>(plans[i]),
                   std::string(verify::to_string(static_cast<verify::PlanStatus>(i))).c_str());
    }
    std::fprintf(stderr, "of these %llu kept, %llu in open loop, %llu made twice\n",
                 static_cast<unsigned long long>(kept), static_cast<unsigned long long>(open_loop),
                 static_cast<unsigned long long>(twice));
  }
};
Tally tally;

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static base::WorkerPool one(1);
  static base::WorkerPool two(2);
  Numbers n(data, size);
  Numbers others = n.others();
  Case c = any_case(n, others);
  if (!c.open_loop && n.one_in(3)) {
    follow(n, c, one);
    if (n.one_in(3)) spoil(n, c);
  }
  if (n.one_in(6)) make_absurd(n, others, c);
  const verify::Plan plan = make_plan(c, one);
  check_plan(c, plan);
  tally.add(plan, c.open_loop);
  if (!n.one_in(16)) return 0;
  require(same_bits(plan, make_plan(c, two)), "another plan with two threads");
  ++tally.twice;
  return 0;
}
