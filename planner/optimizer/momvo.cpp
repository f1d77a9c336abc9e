// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/momvo.hpp"

#include <algorithm>
#include <cassert>

namespace jink::planner::optimizer {
Momvo::Momvo(std::size_t universes, int dimension, int objectives, const base::OptimizerSettings& settings)
    : universes_(universes),
      dimension_(dimension),
      objectives_(objectives),
      settings_(settings),
      archive_(static_cast<std::size_t>(settings.archive), dimension, objectives),
      ranking_(universes),
      x_(universes * static_cast<std::size_t>(dimension)),
      previous_(x_.size()),
      costs_(universes),
      kinds_(universes, Move::kWide) {
  assert(universes > 0);
}

void Momvo::reset(const Problem& problem, base::RandomStream random) {
  assert(problem.dimension() == dimension_ && problem.objectives() == objectives_);
  problem_ = &problem;
  random_ = random;
  archive_.clear();
  order_ = {};
  moves_ = {};
  std::fill(kinds_.begin(), kinds_.end(), Move::kWide);
  lower_ = problem.lower();
  upper_ = problem.upper();
  for (std::size_t i = 0; i < universes_; ++i) {
    const auto x = universe(i);
    const bool opposite = settings_.opposition && i % 2 == 1;
    for (std::size_t j = 0; j < x.size(); ++j) {
      x[j] = opposite ? lower_[j] + upper_[j] - universe(i - 1)[j] : random_.uniform(lower_[j], upper_[j]);
    }
  }
}

void Momvo::place(std::size_t slot, std::span<const double> x) {
  const auto to = universe(slot % universes_);
  for (std::size_t j = 0; j < to.size(); ++j) to[j] = std::clamp(x[j], lower_[j], upper_[j]);
}

void Momvo::rank() {
  assert(problem_ != nullptr);
  problem_->evaluate(x_, costs_);
  for (Cost& cost : costs_) make_rankable(cost);
  order_ = ranking_.order(costs_, objectives_);
}

void Momvo::iterate(const Schedule& schedule) {
  rank();
  for (std::size_t i = 0; i < universes_; ++i) {
    const bool added = archive_.add(universe(i), costs_[i], random_);
    moves_.judge(kinds_[i], added);
  }
  archive_.settle(random_);
  if (settings_.operators == base::Operators::kAdaptive) moves_.adapt();
  move(schedule);
}

void Momvo::move(const Schedule& schedule) {
  std::copy(x_.begin(), x_.end(), previous_.begin());
  // Normalised inflation rates: 0 for the best, which takes nothing from others, to 1 for the worst.
  const double last = universes_ > 1 ? static_cast<double>(universes_ - 1) : 1.0;
  const double worst = settings_.operators == base::Operators::kPrinted ? 0.0 : 1.0;  // Eq. (18) uses no rate
  base::RandomStream random = random_;                                                // a local one stays in registers
  for (std::size_t position = 0; position < universes_; ++position) {
    const auto i = static_cast<std::size_t>(order_[position]);
    kinds_[i] = settings_.operators == base::Operators::kAdaptive ? moves_.draw(random) : Move::kWide;
    if (kinds_[i] == Move::kNarrow) {
      move_narrowly(i, schedule.tdr, random);
    } else {
      move_widely(i, worst * static_cast<double>(position) / last, schedule, random);
    }
  }
  random_ = random;
}

// White holes and wormholes. Every draw is made, used or not, and the outcome selected: cheaper than branches that
// nobody can predict.
void Momvo::move_widely(std::size_t i, double inflation, const Schedule& schedule, base::RandomStream& random) {
  const auto d = static_cast<std::size_t>(dimension_);
  double* x = x_.data() + i * d;
  const double* leader = archive_.x(archive_.draw(random)).data();
  for (std::size_t j = 0; j < d; ++j) {
    const auto giver = static_cast<std::size_t>(order_[white_hole(universes_, random)]);
    const double through_wormhole =
        wormhole(leader[j], schedule.tdr, lower_[j], upper_[j], settings_.operators, random);
    const auto [inflate, worm] = random.uniform_pair();
    const double kept = inflate < inflation ? previous_[giver * d + j] : x[j];
    x[j] = std::clamp(worm < schedule.wep ? through_wormhole : kept, lower_[j], upper_[j]);
  }
}

// A leader, moved in a few variables by steps that are mostly small.
void Momvo::move_narrowly(std::size_t i, double tdr, base::RandomStream& random) {
  const auto d = static_cast<std::size_t>(dimension_);
  double* x = x_.data() + i * d;
  const auto [focused, which] = random.uniform_pair();
  const std::size_t first = std::min(archive_.size(), static_cast<std::size_t>(settings_.focused));
  const std::size_t member =
      focused < settings_.focus ? static_cast<std::size_t>(which * static_cast<double>(first)) : archive_.draw(random);
  const double* leader = archive_.x(member).data();
  const double share = settings_.narrow_variables / static_cast<double>(d);
  for (std::size_t j = 0; j < d; ++j) {
    const double moved = narrow_wormhole(leader[j], tdr, lower_[j], upper_[j], random);
    x[j] = random.uniform() < share ? std::clamp(moved, lower_[j], upper_[j]) : leader[j];
  }
}

std::span<const double> Momvo::representative() {
  if (archive_.size() == 0) {
    const auto i = static_cast<std::size_t>(random_.below(universes_));
    representative_cost_ = costs_[i];
    return universe(i);
  }
  const std::size_t member = archive_.draw(random_);
  representative_cost_ = archive_.cost(member);
  return archive_.x(member);
}

void Momvo::replace_worst(std::size_t rank, std::span<const double> x) {
  assert(order_.size() == universes_);
  const std::size_t position = universes_ - 1 - std::min(rank, universes_ - 1);
  const auto worst = static_cast<std::size_t>(order_[position]);
  place(worst, x);
  kinds_[worst] = Move::kReceived;
}

}  // namespace jink::planner::optimizer
