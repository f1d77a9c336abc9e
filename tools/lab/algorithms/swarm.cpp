// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/swarm.hpp"

#include <algorithm>
#include <cassert>

namespace jink::tools::lab::algorithms {

Swarm::Swarm(const planner::base::OptimizerSettings& settings, int dimension, int objectives) {
  check_settings(settings, objectives);
  const auto population = static_cast<std::size_t>(settings.population);
  x_.resize(population * static_cast<std::size_t>(dimension));
  costs_.resize(population);
}

const planner::optimizer::Front& Swarm::run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                            std::uint64_t seed, std::uint64_t stream,
                                            const planner::base::Budget& budget, planner::base::WorkerPool& /*pool*/) {
  check_budget(budget);
  assert(x_.size() == costs_.size() * problem.lower().size());
  lower_ = problem.lower();
  upper_ = problem.upper();
  random_ = planner::base::RandomStream(seed, stream);
  report_ = {};
  first_solutions(problem, initial, random_, x_);
  begin();
  const int last = std::min(budget.generations, budget.stop_after);
  while (report_.generations < last && !report_.deadline_reached) {
    if (report_.generations > 0) {
      move(static_cast<double>(report_.generations) / budget.generations);
      for (std::size_t i = 0; i < x_.size(); ++i) {
        x_[i] = std::clamp(x_[i], lower_[i % lower_.size()], upper_[i % lower_.size()]);
      }
    }
    problem.evaluate(x_, costs_);
    std::for_each(costs_.begin(), costs_.end(), planner::optimizer::make_rankable);
    learn();
    report_.evaluations += static_cast<std::int64_t>(costs_.size());
    ++report_.generations;
    report_.deadline_reached = report_.generations < budget.generations && budget.expired();
  }
  repository().copy_to(front_);
  return front_;
}

}  // namespace jink::tools::lab::algorithms
