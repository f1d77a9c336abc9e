// SPDX-License-Identifier: BSD-3-Clause
#include "planner/momvo.hpp"

#include <algorithm>
#include <cassert>

#include "planner/multiverse.hpp"

namespace jink::planner {

Momvo::Momvo(std::size_t universes, int dimension, int objectives, const OptimizerSettings& settings)
    : universes_(universes),
      dimension_(dimension),
      objectives_(objectives),
      settings_(settings),
      archive_(static_cast<std::size_t>(settings.archive), dimension, objectives, settings.crowding),
      ranking_(universes),
      x_(universes * static_cast<std::size_t>(dimension)),
      previous_(x_.size()),
      costs_(universes) {
  assert(universes > 0);
}

void Momvo::reset(const Problem& problem, RandomStream random) {
  assert(problem.dimension() == dimension_ && problem.objectives() == objectives_);
  problem_ = &problem;
  random_ = random;
  archive_.clear();
  order_ = {};
  const auto lower = problem.lower();
  const auto upper = problem.upper();
  for (std::size_t i = 0; i < universes_; ++i) {
    const auto x = universe(i);
    for (std::size_t j = 0; j < x.size(); ++j) x[j] = random_.uniform(lower[j], upper[j]);
  }
}

void Momvo::place(std::size_t slot, std::span<const double> x) {
  std::copy(x.begin(), x.end(), universe(slot % universes_).begin());
}

void Momvo::clamp() {
  const auto lower = problem_->lower();
  const auto upper = problem_->upper();
  for (std::size_t i = 0; i < universes_; ++i) {
    const auto x = universe(i);
    for (std::size_t j = 0; j < x.size(); ++j) x[j] = std::clamp(x[j], lower[j], upper[j]);
  }
}

void Momvo::iterate(double fraction) {
  assert(problem_ != nullptr);
  clamp();
  problem_->evaluate(x_, costs_);
  for (std::size_t i = 0; i < universes_; ++i) {
    make_rankable(costs_[i]);
    archive_.add(universe(i), costs_[i], random_);
  }
  archive_.weigh();
  order_ = ranking_.order(costs_, objectives_);
  move(fraction);
}

void Momvo::move(double fraction) {
  const double wep = wormhole_probability(fraction, settings_);
  const double tdr = travelling_distance(fraction, settings_);
  const auto lower = problem_->lower();
  const auto upper = problem_->upper();
  const auto d = static_cast<std::size_t>(dimension_);
  std::copy(x_.begin(), x_.end(), previous_.begin());
  for (std::size_t position = 0; position < universes_; ++position) {
    const auto x = universe(static_cast<std::size_t>(order_[position]));
    const auto leader = archive_.x(archive_.draw(random_));
    // Normalised inflation rate: 0 for the best, 1 for the worst; the best takes nothing from others.
    const double inflation = universes_ > 1 ? static_cast<double>(position) / static_cast<double>(universes_ - 1) : 0.0;
    for (std::size_t j = 0; j < d; ++j) {
      if (random_.uniform() < inflation) {
        const auto giver = static_cast<std::size_t>(order_[white_hole(universes_, random_)]);
        x[j] = previous_[giver * d + j];
      }
      if (random_.uniform() < wep) x[j] = wormhole(leader[j], tdr, lower[j], upper[j], random_);
    }
  }
}

std::span<const double> Momvo::representative() {
  representative_ = archive_.draw(random_);
  return archive_.x(representative_);
}

void Momvo::replace_worst(std::size_t rank, std::span<const double> x) {
  assert(order_.size() == universes_);
  const std::size_t position = universes_ - 1 - std::min(rank, universes_ - 1);
  place(static_cast<std::size_t>(order_[position]), x);
}

}  // namespace jink::planner
