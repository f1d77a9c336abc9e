// SPDX-License-Identifier: BSD-3-Clause
#include "planner/pmomvo.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace jink::planner {
namespace {

void check(const OptimizerSettings& s, int objectives) {
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

Pmomvo::Pmomvo(const OptimizerSettings& settings, int dimension, int objectives)
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
                         std::uint64_t stream, const Budget& budget, WorkerPool& pool) {
  if (budget.generations < 1)
    throw std::invalid_argument("generations: " + std::to_string(budget.generations) + " is not at least 1");
  const auto slaves = static_cast<std::uint32_t>(slaves_.size());
  pool.run(slaves, [&](std::uint32_t j) { slaves_[j].reset(problem, RandomStream(seed, stream, j)); });
  place_initial(initial);
  report_ = {};
  const int cycles = settings_.sharing + 1;
  int done = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    // The iteration counter runs on over the cycles.
    const int stop = static_cast<int>(static_cast<std::int64_t>(budget.generations) * (cycle + 1) / cycles);
    if (stop == done) continue;
    if (done > 0) share();  // cycles without an iteration have nothing to share
    pool.run(slaves, [&](std::uint32_t j) {
      for (int iteration = done; iteration < stop; ++iteration) {
        slaves_[j].iterate(static_cast<double>(iteration + 1) / budget.generations);
      }
    });
    done = stop;
    if (done >= budget.stop_after) break;
    if (done < budget.generations && budget.expired()) {
      report_.deadline_reached = true;
      break;
    }
  }
  report_.generations = done;
  report_.evaluations = static_cast<std::int64_t>(done) * settings_.population;
  merge();
  return front_;
}

void Pmomvo::place_initial(std::span<const double> initial) {
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t count = initial.size() / d;
  for (std::size_t i = 0; i < count; ++i) {
    Momvo& slave = slaves_[i % slaves_.size()];
    const std::size_t slot = i / slaves_.size();
    if (slot < slave.universes()) slave.place(slot, initial.subspan(i * d, d));
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

}  // namespace jink::planner
