// SPDX-License-Identifier: BSD-3-Clause
// How much longer open-loop plans are than the exact shortest paths round resting spheres and boxes.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/solid.hpp"
#include "planner/horizon/open_loop.hpp"
#include "tools/lab/bench/measure.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr double kSpan = 20.0;    // m, from start to target
constexpr double kMargin = 0.05;  // m, that the planner keeps, as `jink plan`; the exact path keeps none

struct Ball {
  Vec3 center = Vec3::Zero();
  double radius = 0.0;
};

/// Length of the shortest way from a to b round a ball: straight on, or both tangents and the arc between them.
double round_ball(const Vec3& a, const Vec3& b, const Ball& ball) {
  const Vec3 from = a - ball.center;
  const Vec3 to = b - ball.center;
  const Vec3 way = to - from;
  const double s = std::clamp(-from.dot(way) / way.squaredNorm(), 0.0, 1.0);
  if ((from + s * way).norm() >= ball.radius) return way.norm();
  const double turned = std::acos(std::clamp(from.dot(to) / (from.norm() * to.norm()), -1.0, 1.0)) -
                        std::acos(ball.radius / from.norm()) - std::acos(ball.radius / to.norm());
  const auto tangent = [&](const Vec3& p) { return std::sqrt(p.squaredNorm() - ball.radius * ball.radius); };
  return tangent(from) + ball.radius * turned + tangent(to);
}

/// The same round two balls with a plane across x between them, over the best place in that plane.
double round_both(const Vec3& a, const Vec3& b, const Ball& first, const Ball& second) {
  const double between = 0.5 * (first.center.x() + first.radius + second.center.x() - second.radius);
  const auto length = [&](double y, double z) {
    const Vec3 place(between, y, z);
    return round_ball(a, place, first) + round_ball(place, b, second);
  };
  double best = planner::base::kInfinity;
  for (const double begin_y : {-6.0, -2.0, 0.0, 2.0, 6.0}) {
    for (const double begin_z : {-6.0, -2.0, 0.0, 2.0, 6.0}) {
      double y = begin_y;
      double z = begin_z;
      double now = length(y, z);
      for (double step = 1.0; step > 1e-7;) {
        bool moved = false;
        for (const auto& [dy, dz] :
             {std::pair(1.0, 0.0), std::pair(-1.0, 0.0), std::pair(0.0, 1.0), std::pair(0.0, -1.0)}) {
          const double there = length(y + step * dy, z + step * dz);
          if (there >= now) continue;
          now = there;
          y += step * dy;
          z += step * dz;
          moved = true;
        }
        if (!moved) step *= 0.5;
      }
      best = std::min(best, now);
    }
  }
  return best;
}

/// A box that is higher than any way over it is short, turned on the level.
struct Tower {
  Vec3 center = Vec3::Zero();
  double length = 0.0;  // m
  double width = 0.0;   // m
  double yaw = 0.0;     // rad
};
constexpr double kHeight = 100.0;  // m, of a tower

/// The border of all that is within `radius` of a tower, on the level.
std::vector<Vec3> border(const Tower& tower, double radius) {
  constexpr int kArc = 2000;  // places in a quarter
  std::vector<Vec3> places;
  const Eigen::AngleAxisd turn(tower.yaw, Vec3::UnitZ());
  for (int n = 0; n < 4 * kArc; ++n) {
    const double angle = 0.5 * std::numbers::pi * (n + 0.5) / kArc;
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 corner(std::copysign(0.5 * tower.length, out.x()), std::copysign(0.5 * tower.width, out.y()), 0.0);
    places.push_back(tower.center + turn * Vec3(corner + radius * out));
  }
  return places;
}

/// Length of the shortest way from a to b, on the level, past what has this border and is convex: on either side that
/// of the border of the hull of all three.
double round_border(const Vec3& a, const Vec3& b, const std::vector<Vec3>& places) {
  const Vec3 way = b - a;
  const auto across = [](const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); };
  double best = planner::base::kInfinity;
  for (const double side : {1.0, -1.0}) {
    std::vector<Vec3> chain;  // the hull's border on that side, by the monotone chain of what lies along the way
    std::vector<Vec3> all;
    for (const Vec3& place : places) {
      const double along = (place - a).dot(way) / way.squaredNorm();
      if (along > 0.0 && along < 1.0) all.push_back(place);
    }
    std::sort(all.begin(), all.end(), [&](const Vec3& p, const Vec3& q) { return p.dot(way) < q.dot(way); });
    all.insert(all.begin(), a);
    all.push_back(b);
    for (const Vec3& place : all) {
      while (chain.size() > 1 && side * across(chain.back() - chain[chain.size() - 2], place - chain.back()) >= 0.0)
        chain.pop_back();
      chain.push_back(place);
    }
    double length = 0.0;
    for (std::size_t i = 1; i < chain.size(); ++i) length += (chain[i] - chain[i - 1]).norm();
    best = std::min(best, length);
  }
  return best;
}

/// What plans are longer than the exact path, as a share of it, and how many did not arrive.
struct Excess {
  std::vector<double> share;
  int missed = 0;
};

void plan_round(const std::vector<planner::base::Track>& tracks, double exact, std::uint64_t seed,
                planner::base::WorkerPool& pool, Excess& excess) {
  const planner::base::HorizonSettings settings;
  planner::horizon::OpenLoopRequest request;
  request.path.target = Vec3(kSpan, 0.0, 0.0);
  request.path.tracks = tracks;
  request.path.margin = kMargin;
  request.time_limit = 100.0;
  const planner::verify::Plan plan =
      planner::horizon::plan_open_loop(settings, {}, request, seed, {settings.generations}, pool);
  if (plan.status == planner::verify::PlanStatus::kReaches) {
    excess.share.push_back(planner::base::path_length(plan.path) / exact - 1.0);
  } else {
    ++excess.missed;
  }
}

/// Balls are grown by the vehicle's radius.
std::vector<planner::base::Track> tracks_of(const std::vector<Ball>& balls) {
  std::vector<planner::base::Track> tracks;
  for (const Ball& ball : balls) {
    planner::base::Track track;
    track.id = tracks.size();
    track.position = ball.center;
    track.radius = ball.radius - planner::base::VehicleLimits().radius;
    tracks.push_back(track);
  }
  return tracks;
}

Ball draw(double least_x, double most_x, double most_radius, planner::base::RandomStream& random) {
  const planner::base::VehicleLimits vehicle;
  Ball ball;
  ball.radius = random.uniform(0.5, most_radius) + vehicle.radius;
  ball.center = Vec3(random.uniform(least_x, most_x), random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
  return ball;
}

Excess round_one_sphere(int cases, planner::base::WorkerPool& pool) {
  const Vec3 target(kSpan, 0.0, 0.0);
  planner::base::RandomStream random(kSeed);
  Excess excess;
  for (int n = 0; n < cases;) {
    const Ball ball = draw(5.0, 15.0, 4.0, random);
    const double exact = round_ball(Vec3::Zero(), target, ball);
    if (exact <= kSpan) continue;
    plan_round(tracks_of({ball}), exact, static_cast<std::uint64_t>(++n), pool, excess);
  }
  return excess;
}

Excess round_two_spheres(int cases, planner::base::WorkerPool& pool) {
  const Vec3 target(kSpan, 0.0, 0.0);
  planner::base::RandomStream random(kSeed);
  Excess excess;
  for (int n = 0; n < cases;) {
    const Ball first = draw(4.0, 9.0, 3.0, random);
    const Ball second = draw(11.0, 16.0, 3.0, random);
    if (first.center.x() + first.radius >= second.center.x() - second.radius) continue;
    if (round_ball(Vec3::Zero(), target, first) <= kSpan || round_ball(Vec3::Zero(), target, second) <= kSpan) continue;
    plan_round(tracks_of({first, second}), round_both(Vec3::Zero(), target, first, second),
               static_cast<std::uint64_t>(++n), pool, excess);
  }
  return excess;
}

Excess round_a_box(int cases, planner::base::WorkerPool& pool) {
  const planner::base::VehicleLimits vehicle;
  const Vec3 target(kSpan, 0.0, 0.0);
  planner::base::RandomStream random(kSeed);
  Excess excess;
  for (int n = 0; n < cases;) {
    Tower tower;
    tower.center = Vec3(random.uniform(6.0, 14.0), random.uniform(-3.0, 3.0), 0.0);
    tower.length = random.uniform(0.2, 8.0);
    tower.width = random.uniform(0.2, 8.0);
    tower.yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double exact = round_border(Vec3::Zero(), target, border(tower, vehicle.radius));
    planner::base::Track track;
    track.position = tower.center;
    track.body = {planner::base::Solid::box({tower.length, tower.width, kHeight}, {}), tower.yaw, 0.0};
    track.radius = track.body.solid->reach();
    if (exact <= kSpan || planner::verify::start_blocked(Vec3::Zero(), 1.0, {{track}}) ||
        planner::verify::start_blocked(target, 1.0, {{track}}))
      continue;
    plan_round({track}, exact, static_cast<std::uint64_t>(++n), pool, excess);
  }
  return excess;
}

}  // namespace

void bench_tangent(const Options& options) {
  const int cases = options.quick ? 10 : 500;
  print_title("open loop, beside the exact shortest path",
              fmt::format("{} random worlds each of what rests on the way of {} m, planned as `jink plan` does. "
                          "excess: of the plan's length over the exact path's, which keeps no margin.",
                          cases, kSpan));
  Table table({"round", "planned", "excess: mean, %", "p90, %", "most, %"});
  planner::base::WorkerPool pool(options.cores);
  const auto row = [&](const char* name, const Excess& excess) {
    table.row({name, fmt::format("{}", excess.share.size()), fmt::format("{:.3f}", 100.0 * mean(excess.share)),
               fmt::format("{:.3f}", 100.0 * quantile(excess.share, 0.9)),
               fmt::format("{:.3f}", 100.0 * quantile(excess.share, 1.0))});
  };
  row("one sphere", round_one_sphere(cases, pool));
  row("two spheres", round_two_spheres(cases, pool));
  row("a box", round_a_box(cases, pool));
  table.print();
}

}  // namespace jink::tools::lab::bench
