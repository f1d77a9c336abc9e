// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/bench/pagmo_nsga2.hpp"

#include <algorithm>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/config.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kPopulation = 52;

/// A problem of the project as pagmo2 wants it.
struct BorrowedProblem {
  const planner::optimizer::Problem* problem = nullptr;  // pagmo2 asks for default construction and copies

  [[nodiscard]] pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    planner::optimizer::Cost cost;
    problem->evaluate(x, {&cost, 1});
    return {cost.f.begin(), cost.f.begin() + problem->objectives()};
  }
  [[nodiscard]] std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const auto lower = problem->lower();
    const auto upper = problem->upper();
    return {{lower.begin(), lower.end()}, {upper.begin(), upper.end()}};
  }
  [[nodiscard]] pagmo::vector_double::size_type get_nobj() const {
    return static_cast<pagmo::vector_double::size_type>(problem->objectives());
  }
};

/// The batch evaluator: all solutions in one call. pagmo2 counts them.
struct BatchEvaluation {
  pagmo::vector_double operator()(const pagmo::problem& wrapped, const pagmo::vector_double& x) const {
    const planner::optimizer::Problem& problem = *wrapped.extract<BorrowedProblem>()->problem;
    std::vector<planner::optimizer::Cost> costs(x.size() / wrapped.get_nx());
    problem.evaluate(x, costs);
    pagmo::vector_double result;
    result.reserve(costs.size() * wrapped.get_nobj());
    for (const planner::optimizer::Cost& cost : costs) {
      result.insert(result.end(), cost.f.begin(), cost.f.begin() + problem.objectives());
    }
    return result;
  }
};

/// The non-dominated set without duplicates.
void collect(const pagmo::population& population, int objectives, planner::optimizer::Front& front) {
  std::vector<planner::optimizer::Cost> costs(population.size());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    std::copy(population.get_f()[i].begin(), population.get_f()[i].end(), costs[i].f.begin());
  }
  front.x.clear();
  front.costs.clear();
  for (std::size_t i = 0; i < costs.size(); ++i) {
    bool keep = true;
    for (std::size_t j = 0; j < costs.size() && keep; ++j) {
      keep = !planner::optimizer::dominates(costs[j], costs[i], objectives) && !(j < i && costs[j].f == costs[i].f);
    }
    if (!keep) continue;
    const pagmo::vector_double& x = population.get_x()[i];
    front.x.insert(front.x.end(), x.begin(), x.end());
    front.costs.push_back(costs[i]);
  }
}

}  // namespace

const planner::optimizer::Front& PagmoNsga2::run(const planner::optimizer::Problem& problem,
                                                 std::span<const double> /*initial*/, std::uint64_t seed,
                                                 std::uint64_t stream, const planner::base::Budget& /*budget*/,
                                                 planner::base::WorkerPool& /*pool*/) {
  // The first population is evaluated too.
  const int generations = std::max(1, (evaluations_ + kPopulation / 2) / kPopulation - 1);
  planner::base::RandomStream seeds(seed, stream);
  const auto population_seed = static_cast<unsigned>(seeds.next());
  const auto algorithm_seed = static_cast<unsigned>(seeds.next());
  pagmo::nsga2 nsga2(static_cast<unsigned>(generations));
  nsga2.set_seed(algorithm_seed);
  if (evaluation_ == Evaluation::kBatch) nsga2.set_bfe(pagmo::bfe(BatchEvaluation{}));
  const pagmo::population last =
      nsga2.evolve(pagmo::population(BorrowedProblem{&problem}, kPopulation, population_seed));
  front_.dimension = problem.dimension();
  collect(last, problem.objectives(), front_);
  report_ = {static_cast<std::int64_t>(last.get_problem().get_fevals()), generations, false};
  return front_;
}

const char* pagmo_version() {
  return PAGMO_VERSION;
}

}  // namespace jink::tools::lab::bench
