// SPDX-License-Identifier: BSD-3-Clause
// How far a clearance is off, against minimisation in long double that shares nothing with the verifier: the distance's
// derivative as a polynomial, whose roots are found by those of its own derivatives.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/verify/verifier.hpp"

// What is promoted to long double here is meant to be.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"

namespace jink::planner::verify {
namespace {

using Real = long double;
using Polynomial = std::vector<Real>;  // the constant first

Real value(const Polynomial& p, Real t) {
  Real sum = 0;
  for (std::size_t i = p.size(); i-- > 0;) sum = sum * t + p[i];
  return sum;
}

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.size(); ++i) d.push_back(p[i] * static_cast<Real>(i));
  return d;
}

// Where it changes its sign: between two roots of its derivative at most once.
std::vector<Real> roots(const Polynomial& p, Real begin, Real end) {
  if (p.size() < 2) return {};
  std::vector<Real> split{begin};
  for (const Real t : roots(derivative(p), begin, end)) split.push_back(t);
  split.push_back(end);
  std::vector<Real> found;
  for (std::size_t i = 1; i < split.size(); ++i) {
    Real low = split[i - 1];
    Real high = split[i];
    const bool below = value(p, low) < 0;
    if (below == (value(p, high) < 0)) continue;
    for (int k = 0; k < 100; ++k) {
      const Real middle = (low + high) / 2;
      ((value(p, middle) < 0) == below ? low : high) = middle;
    }
    found.push_back((low + high) / 2);
  }
  return found;
}

/// One coordinate of a distance: c[0] + c[1] t + c[2] t².
using Coordinate = std::array<Real, 3>;

Real least_distance(const std::array<Coordinate, 3>& relative, Real duration) {
  Polynomial squared(5, Real{0});
  for (const Coordinate& c : relative) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) squared[i + j] += c[i] * c[j];
    }
  }
  const auto distance = [&](Real t) {
    Real sum = 0;
    for (const Coordinate& c : relative) {
      const Real x = c[0] + t * (c[1] + t * c[2]);
      sum += x * x;
    }
    return std::sqrt(sum);
  };
  Real least = std::min(distance(0), distance(duration));
  for (const Real t : roots(derivative(squared), 0, duration)) least = std::min(least, distance(t));
  return least;
}

struct Case {
  base::TimedPath path;
  base::Track track;
  double trust = base::kInfinity;
  double radius = 0.3;
};

Real reference(const Case& c) {
  Real best = base::kInfinity;
  const Real trust = std::max(Real{0}, Real{c.trust} - c.track.age);
  for (std::size_t i = 1; i < c.path.size(); ++i) {
    const base::TimedPoint& a = c.path[i - 1];
    const base::TimedPoint& b = c.path[i];
    std::vector<Real> instants{Real{a.t}};
    if (trust > a.t && trust < b.t) instants.push_back(trust);
    instants.push_back(b.t);
    for (std::size_t n = 1; n < instants.size(); ++n) {
      const Real t = instants[n - 1];
      const Real accelerated = std::min(t, trust);
      std::array<Coordinate, 3> relative{};
      for (Eigen::Index k = 0; k < 3; ++k) {
        const Real speed = (Real{b.position[k]} - a.position[k]) / (Real{b.t} - a.t);
        const Real acceleration = c.track.acceleration[k];
        const Real obstacle_speed = c.track.velocity[k] + accelerated * acceleration;
        const Real obstacle = c.track.position[k] + accelerated * c.track.velocity[k] +
                              accelerated * accelerated / 2 * acceleration + (t - accelerated) * obstacle_speed;
        relative[static_cast<std::size_t>(k)] = {a.position[k] + (t - a.t) * speed - obstacle, speed - obstacle_speed,
                                                 t < trust ? -acceleration / 2 : Real{0}};
      }
      best = std::min(best, least_distance(relative, instants[n] - t));
    }
  }
  return best - c.track.radius - c.radius;
}

/// Coordinate k of a path at an instant; `offset` of its own clock is 0.
Real place(const base::TimedPath& path, double offset, Real t, Eigen::Index k) {
  const auto instant = [&](const base::TimedPoint& point) { return Real{point.t} - offset; };
  if (t <= instant(path.front())) return path.front().position[k];
  for (std::size_t i = 1; i < path.size(); ++i) {
    const base::TimedPoint& a = path[i - 1];
    const base::TimedPoint& b = path[i];
    const Real share = (t - instant(a)) / (instant(b) - instant(a));
    if (share <= 1) return a.position[k] + share * (Real{b.position[k]} - a.position[k]);
  }
  return path.back().position[k];
}

/// Between two instants at which one of them turns both move evenly.
Real reference(const base::TimedPath& path, const geometry::KnownPath& known, double radius) {
  std::vector<Real> instants;
  for (const base::TimedPoint& point : path) instants.push_back(point.t);
  for (const base::TimedPoint& point : known.points) {
    const Real t = Real{point.t} - known.offset;
    if (t > path.front().t && t < path.back().t) instants.push_back(t);
  }
  std::sort(instants.begin(), instants.end());
  Real best = base::kInfinity;
  for (std::size_t i = 1; i < instants.size(); ++i) {
    const Real duration = instants[i] - instants[i - 1];
    if (duration <= 0) continue;
    std::array<Coordinate, 3> relative{};
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto apart = [&](Real t) { return place(path, 0.0, t, k) - place(known.points, known.offset, t, k); };
      const Real first = apart(instants[i - 1]);
      relative[static_cast<std::size_t>(k)] = {first, (apart(instants[i]) - first) / duration, 0};
    }
    best = std::min(best, least_distance(relative, duration));
  }
  return best - known.radius - radius;
}

/// How large the numbers of a case are, m, m/s, m/s², s.
struct Scale {
  const char* name;
  double place, step, speed, acceleration, before, duration;
};

// A track that meets the path, or nearly, at some instant of it: there a distance has its sharpest minimum.
Case random_case(const Scale& s, std::uint64_t seed) {
  base::RandomStream random(seed);
  const auto vec = [&](double range) {
    const double x = random.uniform(-range, range);
    const double y = random.uniform(-range, range);
    return Vec3(x, y, random.uniform(-range, range));
  };
  Case c;
  Vec3 position = vec(s.place);
  double t = random.uniform(0.0, s.before);
  const std::size_t points = 2 + random.below(6);
  for (std::size_t i = 0; i < points; ++i) {
    c.path.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
    t += random.uniform(0.05, s.duration);
    position += vec(s.step);
  }
  c.trust = random.below(3) == 0 ? base::kInfinity : random.uniform(0.0, 4.0);
  c.track.velocity = vec(s.speed);
  c.track.acceleration = vec(s.acceleration);
  c.track.radius = random.uniform(0.1, 3.0);
  c.track.age = random.uniform(0.0, 0.5);
  const double at = random.uniform(c.path.front().t, c.path.back().t);
  const double accelerated = std::min(at, std::max(0.0, c.trust - c.track.age));
  const Vec3 moved = accelerated * c.track.velocity + 0.5 * accelerated * accelerated * c.track.acceleration +
                     (at - accelerated) * (c.track.velocity + accelerated * c.track.acceleration);
  c.track.position = base::sample(c.path, at).position - moved;
  if (random.below(2) == 0) c.track.position += vec(2.0 * c.track.radius);
  return c;
}

double worst_error(const Scale& scale, int cases) {
  double worst = 0.0;
  int judged = 0;
  for (int seed = 0; seed < cases; ++seed) {
    const Case c = random_case(scale, static_cast<std::uint64_t>(seed));
    const std::vector<base::Track> tracks{c.track};
    const Verification v = verify({c.path, tracks, 0.0, c.radius, {}, c.trust});
    if (!v.valid) continue;
    ++judged;
    worst = std::max(worst, static_cast<double>(std::abs(v.min_clearance - reference(c))));
  }
  EXPECT_GT(judged, cases / 10) << scale.name;
  return worst;
}

TEST(Verifier, IsAsAccurateAsItSays) {
  constexpr int kCases = 10000;
  for (const Scale& scale :
       {Scale{"a room", 5, 1, 4, 0, 1, 1.5}, Scale{"a room, accelerated", 5, 1, 4, 3, 1, 1.5},
        Scale{"1 km", 1000, 50, 50, 0, 10, 10}, Scale{"1 km, accelerated", 1000, 50, 50, 6, 10, 10},
        Scale{"600 s", 5000, 500, 10, 0, 500, 30}, Scale{"300 m/s", 5000, 3000, 170, 0, 30, 20}}) {
    EXPECT_LE(worst_error(scale, kCases), kUsualAccuracy) << scale.name;
  }
  for (const Scale& scale : {Scale{"600 s, accelerated", 1000, 3000, 300, 6, 100, 60},
                             Scale{"fast", 1000, 1, 5e4, 0, 1, 1}, Scale{"fast and hard", 5e4, 3000, 3e4, 1e4, 1, 1},
                             Scale{"far", 5e7, 3, 5, 1, 10, 6}, Scale{"far and fast", 5e7, 3000, 5e4, 0, 100, 6}}) {
    const double worst = worst_error(scale, kCases);
    EXPECT_LE(worst, kAccuracy) << scale.name;
    EXPECT_GT(worst, kAccuracy / 1000.0) << scale.name;  // the statement is not far from what is
  }
}

// Around a place 1 km away, on a clock that counts from 1970, or one far away.
TEST(Verifier, IsAsAccurateOfKnownPathsAsItSays) {
  for (const double from : {0.0, 1.7e9}) {
    for (const double away : {1e3, 5e7}) {
      double worst = 0.0;
      for (std::uint64_t seed = 0; seed < 10000; ++seed) {
        base::RandomStream random(seed);
        const auto walk = [&](double begin) {
          base::TimedPath path;
          Vec3 position(random.uniform(-3.0, 3.0), away + random.uniform(-3.0, 3.0), -away);
          const std::size_t points = 2 + random.below(8);
          for (std::size_t i = 0; i < points; ++i) {
            path.push_back({begin, position, Vec3::Zero(), Vec3::Zero()});
            begin += random.uniform(0.05, 1.0);
            position += Vec3(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
          }
          return path;
        };
        const base::TimedPath path = walk(random.uniform(0.0, 300.0));
        geometry::KnownPath known;
        known.offset = from;
        known.points = walk(from + path.front().t + random.uniform(-2.0, 2.0));
        known.radius = 0.5;
        const Verification v = verify({path, {}, 0.0, 0.3, {}, base::kInfinity, base::kInfinity, {&known, 1}});
        ASSERT_TRUE(v.valid);
        worst = std::max(worst, static_cast<double>(std::abs(v.min_clearance - reference(path, known, 0.3))));
      }
      EXPECT_LE(worst, away > 1e4 ? kAccuracy : kUsualAccuracy) << from << " s, " << away << " m";
    }
  }
}

}  // namespace
}  // namespace jink::planner::verify

#pragma GCC diagnostic pop
