// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/common.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::algorithms {
namespace {

void at_least_one(const char* what, int value) {
  if (value < 1) throw std::invalid_argument(std::string(what) + ": " + std::to_string(value) + " is not at least 1");
}

}  // namespace

void check_settings(const planner::base::OptimizerSettings& settings, int objectives) {
  at_least_one("population", settings.population);
  at_least_one("iterations", settings.iterations);
  if (settings.archive <= objectives) {
    throw std::invalid_argument("archive: " + std::to_string(settings.archive) + " does not hold the extremes of " +
                                std::to_string(objectives) + " objectives");
  }
}

void check_budget(const planner::base::Budget& budget) {
  at_least_one("generations", budget.generations);
}

void first_solutions(const planner::optimizer::Problem& problem, std::span<const double> initial,
                     planner::base::RandomStream& random, std::span<double> x) {
  const auto lower = problem.lower();
  const auto upper = problem.upper();
  const std::size_t d = lower.size();
  const std::size_t given = std::min(initial.size() / d * d, x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t j = i % d;
    x[i] = i < given ? std::clamp(initial[i], lower[j], upper[j]) : random.uniform(lower[j], upper[j]);
  }
}

void Repository::clear() {
  x_.clear();
  costs_.clear();
}

void Repository::add(std::span<const double> x, const planner::optimizer::Cost& cost) {
  assert(x.size() == dimension_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    const bool same = costs_[i].f == cost.f && costs_[i].violation == cost.violation;
    // Members dominate each other not, so that where this one stops the newcomer, none has been taken out before.
    if (same || planner::optimizer::dominates(costs_[i], cost, objectives_)) return;
    if (planner::optimizer::dominates(cost, costs_[i], objectives_)) continue;
    if (kept != i) {
      costs_[kept] = costs_[i];
      std::copy_n(x_.begin() + static_cast<std::ptrdiff_t>(i * dimension_), dimension_,
                  x_.begin() + static_cast<std::ptrdiff_t>(kept * dimension_));
    }
    ++kept;
  }
  costs_.resize(kept);
  x_.resize(kept * dimension_);
  costs_.push_back(cost);
  x_.insert(x_.end(), x.begin(), x.end());
}

void Repository::remove(std::size_t i) {
  const auto begin = x_.begin() + static_cast<std::ptrdiff_t>(i * dimension_);
  x_.erase(begin, begin + static_cast<std::ptrdiff_t>(dimension_));
  costs_.erase(costs_.begin() + static_cast<std::ptrdiff_t>(i));
}

void Repository::copy_to(planner::optimizer::Front& front) const {
  front.dimension = static_cast<int>(dimension_);
  front.x = x_;
  front.costs = costs_;
}

std::size_t roulette(std::span<const double> weights, planner::base::RandomStream& random) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  double left = random.uniform() * total;
  std::size_t last = 0;  // rounding must not end in a place without weight
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    last = i;
    left -= weights[i];
    if (left < 0.0) break;
  }
  return last;
}

}  // namespace jink::tools::lab::algorithms
