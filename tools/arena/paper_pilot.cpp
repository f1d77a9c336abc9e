// SPDX-License-Identifier: BSD-3-Clause
#include "tools/arena/paper_pilot.hpp"

#include <algorithm>

#include "planner/paper_planner.hpp"
#include "planner/random.hpp"
#include "tools/arena/motion.hpp"

namespace jink::arena {
namespace {

constexpr std::uint64_t kPaperStream = 0x7061706572ULL;  // "paper" in ASCII: apart from the other users of the seed

}  // namespace

PaperPilot::PaperPilot(const bridge::PlannerTaskSettings& settings, const planner::PaperSettings& paper)
    : settings_(settings), paper_(paper), optimizer_(settings.optimizer, 2, 2), pool_(settings.threads) {}

planner::Plan PaperPilot::plan(const bridge::PlanJob& job) {
  const planner::PathRequest& request = job.request;
  // Known paths are tracks here: the paper knows no others.
  std::vector<planner::Track> tracks = kept_clear(request, settings_.horizon);
  const double added = request.vehicle.radius + request.margin;
  for (planner::Track& track : tracks) track.radius -= added;

  planner::PaperRequest asked;
  asked.start = request.position;
  asked.target = request.target;
  asked.volume = request.volume;
  asked.vehicle = request.vehicle;
  asked.tracks = tracks;
  asked.optimizer = settings_.optimizer;
  asked.settings = paper_;
  asked.settings.margin = std::max(paper_.margin, request.margin);
  asked.seed = planner::RandomStream(settings_.seed, kPaperStream, job.number).next();
  const planner::Plan wished = planner::plan_paper(asked, optimizer_, pool_);

  Motion motion(request, settings_.horizon, normal_acceleration(request, settings_.horizon));
  motion.follow(wished.path);
  motion.fly_to_target();
  planner::Plan plan = judged(motion.path(), request, settings_.horizon.time);
  plan.evaluations = wished.evaluations;
  plan.schedule = wished.schedule;
  plan.generations = wished.generations;
  plan.front = wished.front;
  return plan;
}

}  // namespace jink::arena
