// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/bounded_front.hpp"

#include "planner/base/random.hpp"

namespace jink::tools::lab::algorithms {
namespace {

constexpr std::uint64_t kThinning = ~std::uint64_t{0};  // a substream that no slave has

}  // namespace

void copy_front(const planner::optimizer::Archive& archive, int dimension, planner::optimizer::Front& front) {
  front.dimension = dimension;
  front.x.clear();
  front.costs.assign(archive.costs().begin(), archive.costs().end());
  for (std::size_t i = 0; i < archive.size(); ++i) {
    const auto x = archive.x(i);
    front.x.insert(front.x.end(), x.begin(), x.end());
  }
}

BoundedPmomvo::BoundedPmomvo(const planner::base::OptimizerSettings& settings, int dimension, int objectives)
    : pmomvo_(settings, dimension, objectives),
      archive_(static_cast<std::size_t>(settings.archive), dimension, objectives) {}

const planner::optimizer::Front& BoundedPmomvo::run(const planner::optimizer::Problem& problem,
                                                    std::span<const double> initial, std::uint64_t seed,
                                                    std::uint64_t stream, const planner::base::Budget& budget,
                                                    planner::base::WorkerPool& pool) {
  const planner::optimizer::Front& merged = pmomvo_.run(problem, initial, seed, stream, budget, pool);
  planner::base::RandomStream random(seed, stream, kThinning);
  archive_.clear();
  for (std::size_t i = 0; i < merged.size(); ++i) archive_.add(merged.solution(i), merged.costs[i], random);
  archive_.settle(random);
  copy_front(archive_, problem.dimension(), front_);
  return front_;
}

}  // namespace jink::tools::lab::algorithms
