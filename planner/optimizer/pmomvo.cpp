// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/pmomvo.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace jink::planner::optimizer {
namespace {

void check(const base::OptimizerSettings& s, int objectives) {
  if (s.slaves < 1) throw std::invalid_argument("slaves: " + std::to_string(s.slaves) + " is not at least 1");
  if (s.population < s.slaves) {
    throw std::invalid_argument("population: " + std::to_string(s.population) + " leaves a slave of " +
                                std::to_string(s.slaves) + " without a universe");
  }
  if (s.iterations < 1)
    throw std::invalid_argument("iterations: " + std::to_string(s.iterations) + " is not at least 1");
  if (s.sharing < 0) throw std::invalid_argument("sharing: " + std::to_string(s.sharing) + " is negative");
  if (s.archive <= objectives) {
    throw std::invalid_argument("archive: " + std::to_string(s.archive) + " does not hold the extremes of " +
                                std::to_string(objectives) + " objectives");
  }
}

}  // namespace

Pmomvo::Pmomvo(const base::OptimizerSettings& settings, int dimension, int objectives)
    : settings_(settings), dimension_(dimension), objectives_(objectives) {
  check(settings, objectives);
  const int slaves = settings.slaves;
  slaves_.reserve(static_cast<std::size_t>(slaves));
  for (int j = 0; j < slaves; ++j) {
    const int universes = settings.population / slaves + (j < settings.population % slaves ? 1 : 0);
    slaves_.emplace_back(static_cast<std::size_t>(universes), dimension, objectives, settings);
  }
  front_.dimension = dimension;
  shared_.reserve(static_cast<std::size_t>(slaves) * static_cast<std::size_t>(dimension));
  shared_costs_.reserve(static_cast<std::size_t>(slaves));
}

const Front& Pmomvo::run(const Problem& problem, std::span<const double> initial, std::uint64_t seed,
                         std::uint64_t stream, const base::Budget& budget, base::WorkerPool& pool) {
  if (budget.generations < 1)
    throw std::invalid_argument("generations: " + std::to_string(budget.generations) + " is not at least 1");
  const auto slaves = static_cast<std::uint32_t>(slaves_.size());
  report_ = {};
  // The iteration counter runs on over the cycles. Where a deadline is to be kept, the master looks at the clock after
  // every generation.
  const auto cycle_end = [&](int cycle) {
    return static_cast<int>(static_cast<std::int64_t>(budget.generations) * (cycle + 1) / (settings_.sharing + 1));
  };
  const auto start = [&](std::uint32_t j) { begin(j, problem, initial, base::RandomStream(seed, stream, j)); };
  const bool shares_first = settings_.operators == base::Operators::kPrinted && settings_.sharing > 0;
  if (shares_first) {  // Algorithm 2, steps 3 and 6
    pool.run(slaves, [&](std::uint32_t j) {
      start(j);
      slaves_[j].rank();
    });
    share();
  }
  int done = 0;
  int cycle = 0;
  while (done < std::min(budget.generations, budget.stop_after) && !report_.deadline_reached) {
    while (cycle_end(cycle) <= done) ++cycle;
    const int stop = budget.has_deadline() ? done + 1 : std::min(cycle_end(cycle), budget.stop_after);
    extend_schedule(budget.generations, stop);
    pool.run(slaves, [&](std::uint32_t j) {
      if (done == 0 && !shares_first) start(j);
      for (int iteration = done; iteration < stop; ++iteration) {
        slaves_[j].iterate(schedule_[static_cast<std::size_t>(iteration)]);
      }
    });
    done = stop;
    if (done < budget.generations && done == cycle_end(cycle)) share();
    report_.deadline_reached = done < budget.generations && budget.expired();
  }
  report_.generations = done;
  report_.evaluations = static_cast<std::int64_t>(done + (shares_first ? 1 : 0)) * settings_.population;
  merge();
  return front_;
}

// The schedule of a run of so many generations, as far as generation `stop`: the same for all slaves, and mostly the
// same as in the run before.
void Pmomvo::extend_schedule(int generations, int stop) {
  if (scheduled_ != generations) schedule_.clear();
  scheduled_ = generations;
  for (auto i = static_cast<int>(schedule_.size()) + 1; i <= stop; ++i) {
    schedule_.push_back(schedule_at(static_cast<double>(i) / generations, settings_));
  }
}

// A slave starts over, with every m-th of the initial solutions from its own number on.
void Pmomvo::begin(std::uint32_t j, const Problem& problem, std::span<const double> initial,
                   const base::RandomStream& random) {
  Momvo& slave = slaves_[j];
  slave.reset(problem, random);
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t count = initial.size() / d;
  std::size_t slot = 0;
  for (std::size_t i = j; i < count && slot < slave.universes(); i += slaves_.size()) {
    slave.place(slot++, initial.subspan(i * d, d));
  }
}

// One sharing: each slave sends a representative, the master returns the non-dominated ones to all.
void Pmomvo::share() {
  shared_.clear();
  shared_costs_.clear();
  for (Momvo& slave : slaves_) {
    const auto x = slave.representative();
    shared_.insert(shared_.end(), x.begin(), x.end());
    shared_costs_.push_back(slave.representative_cost());
  }
  const auto d = static_cast<std::size_t>(dimension_);
  std::size_t rank = 0;
  for (std::size_t i = 0; i < shared_costs_.size(); ++i) {
    const bool dominated = std::any_of(shared_costs_.begin(), shared_costs_.end(), [&](const Cost& other) {
      return dominates(other, shared_costs_[i], objectives_);
    });
    if (dominated) continue;
    for (Momvo& slave : slaves_) {
      if (rank < slave.universes()) slave.replace_worst(rank, {shared_.data() + i * d, d});
    }
    ++rank;
  }
}

// The global front: the slaves' fronts without duplicates and dominated solutions, in the order of the slaves.
void Pmomvo::merge() {
  front_.x.clear();
  front_.costs.clear();
  for (std::size_t s = 0; s < slaves_.size(); ++s) {
    const Archive& archive = slaves_[s].archive();
    for (std::size_t i = 0; i < archive.size(); ++i) {
      const Cost& cost = archive.cost(i);
      bool keep = true;
      for (std::size_t other = 0; other < slaves_.size() && keep; ++other) {
        if (other == s) continue;  // an archive is free of both already
        for (const Cost& rival : slaves_[other].archive().costs()) {
          const bool same = rival.f == cost.f && rival.violation == cost.violation;
          keep = keep && !dominates(rival, cost, objectives_) && !(same && other < s);
        }
      }
      if (!keep) continue;
      const auto x = archive.x(i);
      front_.x.insert(front_.x.end(), x.begin(), x.end());
      front_.costs.push_back(cost);
    }
  }
}

}  // namespace jink::planner::optimizer
