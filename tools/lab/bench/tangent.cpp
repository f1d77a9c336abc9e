// SPDX-License-Identifier: BSD-3-Clause
// How much longer open-loop plans are than the exact shortest paths round resting spheres.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
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

/// What plans are longer than the exact path, as a share of it, and how many did not arrive.
struct Excess {
  std::vector<double> share;
  int missed = 0;
};

/// Plans round balls grown by the vehicle's radius.
void plan_round(const std::vector<Ball>& balls, double exact, std::uint64_t seed, planner::base::WorkerPool& pool,
                Excess& excess) {
  const planner::base::HorizonSettings settings;
  planner::horizon::OpenLoopRequest request;
  std::vector<planner::base::Track> tracks;
  for (const Ball& ball : balls) {
    planner::base::Track track;
    track.id = tracks.size();
    track.position = ball.center;
    track.radius = ball.radius - request.path.vehicle.radius;
    tracks.push_back(track);
  }
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
    plan_round({ball}, exact, static_cast<std::uint64_t>(++n), pool, excess);
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
    plan_round({first, second}, round_both(Vec3::Zero(), target, first, second), static_cast<std::uint64_t>(++n), pool,
               excess);
  }
  return excess;
}

}  // namespace

void bench_tangent(const Options& options) {
  const int cases = options.quick ? 10 : 500;
  print_title("open loop, beside the exact shortest path",
              fmt::format("{} random worlds each of resting spheres on the way of {} m, planned as `jink plan` does. "
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
  table.print();
}

}  // namespace jink::tools::lab::bench
