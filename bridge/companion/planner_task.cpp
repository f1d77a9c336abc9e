// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/planner_task.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

#include "planner/horizon/path_check.hpp"

namespace jink::bridge::companion {
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

JobPlanner::JobPlanner(const PlannerTaskSettings& settings)
    : settings_(settings),
      planner_(settings.horizon, settings.optimizer),
      guided_(planner_, planner::horizon::Guide::Knowledge::kSensed),
      pool_(settings.threads) {}

// What climbs and what stops has nowhere to go.
planner::verify::Plan JobPlanner::plan(PlanJob& job, const planner::base::Budget& budget) {
  const prediction::Obstacles obstacles = obstacles_of(job, settings_.horizon);
  set_obstacles(job, obstacles);
  planner::verify::Plan plan;
  if (job.goal == Goal::Kind::kWaypoint) {
    if (planner::horizon::is_valid(job.request)) guided_by_ = job.map.map;
    plan = guided_.plan(job.request, job.start, {job.map.map.get(), job.map.up, job.map.floor, job.map.sigma},
                        job.previous, settings_.seed, job.number, budget, pool_);
    job.standing.assign(guided_.standing().begin(), guided_.standing().end());
  } else {
    plan = planner_.plan(job.request, job.previous, settings_.seed, job.number, budget, pool_);
  }
  forget_obstacles(job);
  return plan;
}

ThreadedPlanner::ThreadedPlanner(const PlannerTaskSettings& settings, const base::Clock& clock, base::Notifier* done)
    : clock_(clock), done_(done), planner_(settings), thread_([this](const std::stop_token& stop) { work(stop); }) {}

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
      const planner::base::HorizonSettings& horizon = planner_.settings().horizon;
      const auto deadline = std::chrono::duration<double, std::milli>(horizon.deadline_ms);
      const planner::base::Budget budget{
          horizon.generations,
          std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(deadline)};
      result.plan = planner_.plan(result.job, budget);
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
    : latency_(latency), planner_(settings) {}

void VirtualPlanner::start(PlanJob job) {
  assert(!result_);
  PlanResult& result = result_.emplace();
  result.job = std::move(job);
  result.plan =
      planner_.plan(result.job, {planner_.settings().horizon.generations, planner::base::Budget::Time::max()});
  result.ms = 1e3 * latency_;
}

std::optional<PlanResult> VirtualPlanner::poll(double now) {
  if (!result_ || now + 1e-9 < result_->job.begun + latency_) return std::nullopt;
  std::optional<PlanResult> result = std::exchange(result_, std::nullopt);
  result->missed = now > result->job.start + 1e-9;
  return result;
}

}  // namespace jink::bridge::companion
