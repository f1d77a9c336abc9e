// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "planner/optimizer/indicators.hpp"
#include "planner/paper/paper_planner.hpp"
#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::study {
namespace {

using planner::optimizer::Point2;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

planner::base::OptimizerSettings sizes(const Job& job, const Setting& setting) {
  planner::base::OptimizerSettings settings = setting.planner.optimizer;
  settings.sharing = job.variant.sharing;
  settings.population = job.variant.population;
  settings.iterations = job.variant.iterations;
  return settings;
}

std::unique_ptr<planner::optimizer::Optimizer> make_optimizer(const Job& job, const Setting& setting) {
  const algorithms::Algorithm* const algorithm = algorithms::find_algorithm(job.variant.algorithm);
  if (algorithm == nullptr) throw std::runtime_error(fmt::format("there is no algorithm '{}'", job.variant.algorithm));
  return algorithm->make(sizes(job, setting), 2, 2);
}

std::vector<Point2> points_of(const planner::optimizer::Front& front) {
  std::vector<Point2> points;
  for (const planner::optimizer::Cost& cost : front.costs) points.push_back({cost.f[0], cost.f[1]});
  if (points.empty()) throw std::runtime_error("the algorithm gave an empty front");
  return points;
}

void make_front(const Job& job, const Setting& setting, planner::base::WorkerPool& pool, Record& record) {
  const std::vector<FrontStep>& steps = setting.steps_of(job.variant.world);
  const auto optimizer = make_optimizer(job, setting);
  const double share = 1.0 / static_cast<double>(steps.size());
  for (const char* name : {key::kHv, key::kMs, key::kHrs, key::kSize, key::kEvaluations}) record.values[name] = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const planner::optimizer::Front& front =
        optimizer->run(steps[i].problem, {}, job.seed, i, planner::base::Budget{job.variant.iterations}, pool);
    const std::vector<Point2> points = points_of(front);
    const Indicators found = indicators(points, steps[i].reference);
    record.values[key::kHv] += share * found.hv;
    record.values[key::kMs] += share * found.ms;
    record.values[key::kHrs] += share * found.hrs;
    record.values[key::kSize] += share * static_cast<double>(points.size());
    record.values[key::kEvaluations] += static_cast<double>(optimizer->report().evaluations);
    if (i > 0) continue;
    std::vector<Point2> sorted = points;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double>& f1 = record.series[key::kF1];
    std::vector<double>& f2 = record.series[key::kF2];
    for (const Point2& p : sorted) {
      const Point2 scaled = planner::optimizer::normalise(p, steps[i].reference.bounds);
      f1.push_back(scaled[0]);
      f2.push_back(scaled[1]);
    }
  }
}

void make_path(const Job& job, const Setting& setting, planner::base::WorkerPool& pool, Record& record) {
  const World world = setting.scenes.world(job.variant.world, job.run);
  const planner::paper::PaperRequest request{world.start,  world.target,        world.volume,          world.vehicle,
                                             world.tracks, sizes(job, setting), setting.planner.paper, job.seed};
  const auto begun = Clock::now();
  const auto optimizer = make_optimizer(job, setting);
  const planner::verify::Plan plan = planner::paper::plan_paper(request, *optimizer, pool);
  record.measured[key::kPlanning] = seconds_since(begun);
  const double length = planner::base::path_length(plan.path);
  record.values[key::kReached] = plan.status == planner::verify::PlanStatus::kReaches ? 1.0 : 0.0;
  record.values[key::kLength] = length;
  record.values[key::kSlr] = planner::optimizer::straight_line_rate(length, (world.target - world.start).norm());
  record.values[key::kFlight] = plan.path.empty() ? 0.0 : plan.path.back().t;
  record.values[key::kClearance] = plan.verification.min_clearance;
  record.values[key::kEvaluations] = static_cast<double>(plan.evaluations);
  if (!is_pictured(job.variant.world)) return;
  for (const planner::base::TimedPoint& p : plan.path) {
    record.series[key::kT].push_back(p.t);
    record.series[key::kX].push_back(p.position.x());
    record.series[key::kY].push_back(p.position.y());
    record.series[key::kZ].push_back(p.position.z());
  }
}

void make_anytime(const Job& job, const Setting& setting, planner::base::WorkerPool& pool, Record& record) {
  const std::vector<FrontStep>& steps = setting.steps_of(job.variant.world);
  const auto optimizer = make_optimizer(job, setting);
  const double share = 1.0 / static_cast<double>(steps.size());
  const std::vector<double> shares = checkpoints();
  record.values[key::kEvaluations] = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const int stop = std::max(1, static_cast<int>(std::lround(shares[i] * job.variant.iterations)));
    double hv = 0.0, seconds = 0.0, evaluations = 0.0;
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const auto begun = Clock::now();
      const planner::base::Budget budget{job.variant.iterations, planner::base::Budget::Time::max(), stop};
      const planner::optimizer::Front& front = optimizer->run(steps[s].problem, {}, job.seed, s, budget, pool);
      seconds += share * seconds_since(begun);
      hv += share * indicators(points_of(front), steps[s].reference).hv;
      evaluations += share * static_cast<double>(optimizer->report().evaluations);
      record.values[key::kEvaluations] += static_cast<double>(optimizer->report().evaluations);
    }
    record.series[key::kEvaluationsAt].push_back(evaluations);
    record.series[key::kHvAt].push_back(hv);
    record.measured[key::seconds_at(i)] = seconds;
  }
}

}  // namespace

Setting::Setting(const StudySettings& settings, const config::Settings& p)
    : planner(p),
      scenes(settings.seed),
      steps(front_steps(scenes.world(hardest_world(false), 0), p.paper, false)),
      blocked_steps(front_steps(scenes.world(hardest_world(true), 0), p.paper, true)) {
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    try {
      static_cast<void>(algorithm.make(planner.optimizer, 2, 2));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", algorithm.label, error.what()));
    }
  }
}

std::vector<double> checkpoints() {
  return {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0};
}

Record make_run(const Job& job, const Setting& setting, planner::base::WorkerPool& pool) {
  Record record;
  record.job = job;
  record.measured[key::kThreads] = pool.threads();
  switch (job.variant.kind) {
    case RunKind::kFront:
      make_front(job, setting, pool, record);
      break;
    case RunKind::kPath:
      make_path(job, setting, pool, record);
      break;
    case RunKind::kAnytime:
      make_anytime(job, setting, pool, record);
      break;
  }
  return record;
}

}  // namespace jink::tools::lab::study
