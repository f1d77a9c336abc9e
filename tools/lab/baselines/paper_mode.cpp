// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/paper_mode.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/paper/paper_planner.hpp"
#include "tools/lab/baselines/path_builder.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr std::uint64_t kPaperStream = 0x7061706572ULL;  // "paper" in ASCII: apart from the other users of the seed

/// How a vehicle gets up to cruise speed along its way: the paper's has it from the first instant.
struct RunUp {
  double speed = 0.0, cruise = 0.0, acceleration = 0.0;  ///< now, wished, m/s; m/s²

  /// How much later than at cruise speed all the way it has flown `way` metres, s.
  [[nodiscard]] double lag(double way) const {
    const double run_up = (cruise * cruise - speed * speed) / (2.0 * acceleration);
    const double flown = std::min(way, run_up);
    return (std::sqrt(speed * speed + 2.0 * acceleration * flown) - speed) / acceleration - flown / cruise;
  }
};

}  // namespace

PaperPilot::PaperPilot(const bridge::companion::PlannerTaskSettings& settings,
                       const planner::base::PaperSettings& paper)
    : settings_(settings), paper_(paper), optimizer_(settings.optimizer, 2, 2), pool_(settings.threads) {}

planner::verify::Plan PaperPilot::ask(const bridge::companion::PlanJob& job, double lag) {
  const planner::horizon::PathRequest& request = job.request;
  // Known paths are tracks here: the paper knows no others.
  std::vector<planner::base::Track> tracks = inflated_obstacles(request, settings_.horizon);
  const double added = request.vehicle.radius + request.margin;
  for (planner::base::Track& track : tracks) {
    track = planner::geometry::predict(track, lag, request.acceleration_trust);
    track.radius -= added;
  }
  planner::paper::PaperRequest asked;
  asked.start = request.position;
  asked.target = request.target;
  asked.volume = request.volume;
  asked.vehicle = request.vehicle;
  asked.tracks = tracks;
  asked.optimizer = settings_.optimizer;
  asked.settings = paper_;
  asked.settings.margin = std::max(paper_.margin, request.margin);
  asked.seed = planner::base::RandomStream(settings_.seed, kPaperStream, job.number).next();
  return planner::paper::plan_paper(asked, optimizer_, pool_);
}

planner::verify::Plan PaperPilot::plan(const bridge::companion::PlanJob& job) {
  const planner::horizon::PathRequest& request = job.request;
  const double time = settings_.horizon.time;
  const auto keeps_margin = [&](const planner::verify::Plan& plan) {
    return check(plan.path, request, request.margin, time).free();
  };
  planner::verify::Plan best;
  if (!job.previous.empty()) {
    best = verified_plan(planner::base::remainder(job.previous, 0.0), request, time);
    best.kept_previous = true;
    if (keeps_margin(best)) return best;
  }
  const double normal = normal_acceleration(request, settings_.horizon);
  const Vec3 ahead = unobstructed_velocity(request, settings_.horizon.braking, request.position);
  const double cruise = request.vehicle.cruise_speed;
  const double speed = ahead.norm() > 0.0 ? request.velocity.dot(ahead.normalized()) : cruise;
  const RunUp run_up{std::clamp(speed, 0.0, cruise), cruise, normal};
  planner::verify::Plan wished = ask(job, run_up.lag(planner::base::kInfinity));
  double way = 0.0;
  for (std::size_t i = 1; i < wished.path.size(); ++i) {
    way += (wished.path[i].position - wished.path[i - 1].position).norm();
    wished.path[i].t += run_up.lag(way);
  }
  for (const double acceleration : {normal, hardest_acceleration(request, settings_.horizon)}) {
    PathBuilder motion(request, settings_.horizon, acceleration);
    motion.follow(wished.path);
    motion.fly_to_target();
    planner::verify::Plan flown = verified_plan(motion.path(), request, time);
    flown.emergency = acceleration > normal;
    const bool good = keeps_margin(flown);
    if (good || best.path.empty() || is_safer(flown.verification, best.verification)) best = std::move(flown);
    if (good) break;
  }
  best.evaluations = wished.evaluations;
  best.schedule = wished.schedule;
  best.generations = wished.generations;
  best.front = wished.front;
  return best;
}

}  // namespace jink::tools::lab::baselines
