// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/planner_task.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

#include "planner/horizon/path_check.hpp"

namespace jink::bridge::companion {
namespace {

// What climbs and what stops has nowhere to go.
void lead(planner::horizon::Guide& guide, PlanJob& job, prediction::Obstacles& obstacles,
          std::shared_ptr<const planner::geometry::StaticMap>& guided_by) {
  if (job.goal != Goal::Kind::kWaypoint) return;
  guide.lead(job.request, job.start, {job.map.map.get(), job.map.up, job.map.floor, job.map.sigma});
  if (planner::horizon::is_valid(job.request)) guided_by = job.map.map;
  job.standing.assign(guide.standing().begin(), guide.standing().end());
  planner::horizon::set_apart(job.standing, obstacles.tracks, obstacles.standing);
  set_obstacles(job, obstacles);
}

}  // namespace

void MapView::append_to(std::vector<planner::base::Track>& tracks) const {
  if (map == nullptr) return;
  const std::size_t before = tracks.size();
  map->near(where, up, tracks);
  const auto first = tracks.begin() + static_cast<std::ptrdiff_t>(before);
  const auto is_ground = [this](const planner::base::Track& track) {
    return planner::geometry::box_around(track).max.z() <= floor;
  };
  tracks.erase(std::remove_if(first, tracks.end(), is_ground), tracks.end());
  for (std::size_t i = before; i < tracks.size(); ++i) tracks[i].position_sigma = sigma;
}

ThreadedPlanner::ThreadedPlanner(const PlannerTaskSettings& settings, const base::Clock& clock, base::Notifier* done)
    : settings_(settings),
      clock_(clock),
      done_(done),
      guide_(settings.horizon, planner::horizon::Guide::Knowledge::kSensed),
      planner_(settings.horizon, settings.optimizer),
      pool_(settings.threads),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

ThreadedPlanner::~ThreadedPlanner() {
  thread_.request_stop();
  wake_.notify_all();
}

void ThreadedPlanner::start(PlanJob job) {
  {
    const std::scoped_lock lock(mutex_);
    assert(!busy_);
    job_ = std::move(job);
    busy_ = true;
  }
  wake_.notify_all();
}

bool ThreadedPlanner::busy() const {
  const std::scoped_lock lock(mutex_);
  return busy_;
}

std::optional<PlanResult> ThreadedPlanner::poll(double now) {
  const std::scoped_lock lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  if (!result_) return std::nullopt;
  busy_ = false;
  std::optional<PlanResult> result = std::exchange(result_, std::nullopt);
  result->missed = now > result->job.start;
  return result;
}

void ThreadedPlanner::work(const std::stop_token& stop) {
  while (true) {
    PlanResult result;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [&] { return job_.has_value(); })) return;
      result.job = std::move(*job_);
      job_.reset();
    }
    try {
      const double begun = clock_.now();
      prediction::Obstacles obstacles = obstacles_of(result.job, settings_.horizon);
      set_obstacles(result.job, obstacles);
      lead(guide_, result.job, obstacles, guided_by_);
      const auto deadline = std::chrono::duration<double, std::milli>(settings_.horizon.deadline_ms);
      const planner::base::Budget budget{
          settings_.horizon.generations,
          std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(deadline)};
      result.plan =
          planner_.plan(result.job.request, result.job.previous, settings_.seed, result.job.number, budget, pool_);
      forget_obstacles(result.job);
      result.ms = 1e3 * (clock_.now() - begun);
      const std::scoped_lock lock(mutex_);
      result_ = std::move(result);
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      failure_ = std::current_exception();
    }
    if (done_ != nullptr) done_->notify();
  }
}

VirtualPlanner::VirtualPlanner(const PlannerTaskSettings& settings, double latency)
    : settings_(settings),
      latency_(latency),
      guide_(settings.horizon, planner::horizon::Guide::Knowledge::kSensed),
      planner_(settings.horizon, settings.optimizer),
      pool_(settings.threads) {}

void VirtualPlanner::start(PlanJob job) {
  assert(!result_);
  PlanResult& result = result_.emplace();
  result.job = std::move(job);
  prediction::Obstacles obstacles = obstacles_of(result.job, settings_.horizon);
  set_obstacles(result.job, obstacles);
  lead(guide_, result.job, obstacles, guided_by_);
  const planner::base::Budget budget{settings_.horizon.generations, planner::base::Budget::Time::max()};
  result.plan =
      planner_.plan(result.job.request, result.job.previous, settings_.seed, result.job.number, budget, pool_);
  forget_obstacles(result.job);
  result.ms = 1e3 * latency_;
}

std::optional<PlanResult> VirtualPlanner::poll(double now) {
  if (!result_ || now + 1e-9 < result_->job.begun + latency_) return std::nullopt;
  std::optional<PlanResult> result = std::exchange(result_, std::nullopt);
  result->missed = now > result->job.start + 1e-9;
  return result;
}

}  // namespace jink::bridge::companion
