// SPDX-License-Identifier: BSD-3-Clause
// NSGA-II, NSPSO and MOEA/D as pagmo2 has them: K. Deb, A. Pratap, S. Agarwal and T. Meyarivan, IEEE Transactions on
// Evolutionary Computation 6(2), 2002; X. Li, GECCO 2003; Q. Zhang and H. Li, ibid. 11(6), 2007, with the differential
// evolution of H. Li and Q. Zhang, ibid. 13(2), 2009. No other file of the project's library sees pagmo2.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <pagmo/algorithms/moead.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/config.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "planner/optimizer/archive.hpp"
#include "tools/lab/algorithms/bounded_front.hpp"
#include "tools/lab/algorithms/common.hpp"
#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::algorithms {
namespace {

using pagmo::vector_double;

/// What an infeasible solution costs at least, in every objective; far above any feasible cost here, and its
/// resolution (1e-10) fine enough to tell violations apart.
constexpr double kInfeasible = 1e6;
constexpr std::size_t kLeastPopulation = 8;  // NSGA-II: five, and a multiple of four
constexpr std::uint64_t kArchive = 1;        // the substream of the archive's draws

/// Thrown through pagmo2 when the budget is spent: it knows no other end than a number of whole generations.
struct Spent {};

/// Evaluates for pagmo2, keeps the archive, and counts. A generation of the budget is `population` evaluations,
/// whatever pagmo2's own generation is.
class Evaluator {
 public:
  Evaluator(const planner::optimizer::Problem& problem, std::size_t population, const planner::base::Budget& budget,
            planner::optimizer::Archive& archive, const planner::base::RandomStream& random)
      : problem_(problem), population_(population), budget_(budget), archive_(archive), random_(random) {}

  /// What pagmo2 is told of solutions, one after the other. It has no constraints in these algorithms, so feasible
  /// solutions cost what they cost and others kInfeasible plus their violation in each objective: constrained
  /// domination, but for solutions of one violation. Throws Spent when the budget is.
  vector_double operator()(const vector_double& x) {
    const auto lower = problem_.lower();
    const auto upper = problem_.upper();
    const std::size_t d = lower.size();
    x_ = x;
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = std::clamp(x_[i], lower[i % d], upper[i % d]);
    vector_double told;
    for (std::size_t begin = 0; begin < x_.size(); begin += d * costs_.size()) {
      const std::size_t left = population_ - evaluated_ % population_;
      costs_.resize(std::min(x_.size() / d - begin / d, left));
      problem_.evaluate(std::span(x_).subspan(begin, d * costs_.size()), costs_);
      for (std::size_t i = 0; i < costs_.size(); ++i) {
        planner::optimizer::make_rankable(costs_[i]);
        archive_.add(std::span(x_).subspan(begin + i * d, d), costs_[i], random_);
        tell(costs_[i], told);
      }
      evaluated_ += costs_.size();
      if (evaluated_ % population_ == 0) end_generation();
    }
    return told;
  }

  [[nodiscard]] const planner::optimizer::Problem& problem() const { return problem_; }
  [[nodiscard]] planner::optimizer::RunReport report() const {
    return {static_cast<std::int64_t>(evaluated_), static_cast<int>(evaluated_ / population_), deadline_reached_};
  }

 private:
  void tell(const planner::optimizer::Cost& cost, vector_double& told) const {
    for (std::size_t k = 0; k < static_cast<std::size_t>(problem_.objectives()); ++k) {
      told.push_back(cost.violation > 0.0 ? kInfeasible + cost.violation : cost.f[k]);
    }
  }

  void end_generation() {
    archive_.settle(random_);
    const auto done = static_cast<int>(evaluated_ / population_);
    deadline_reached_ = done < budget_.generations && budget_.expired();
    if (deadline_reached_ || done >= std::min(budget_.generations, budget_.stop_after)) throw Spent{};
  }

  const planner::optimizer::Problem& problem_;
  std::size_t population_;
  planner::base::Budget budget_;
  planner::optimizer::Archive& archive_;
  planner::base::RandomStream random_;
  std::vector<double> x_;
  std::vector<planner::optimizer::Cost> costs_;
  std::size_t evaluated_ = 0;
  bool deadline_reached_ = false;
};

/// A problem of the project as pagmo2 wants it. A variable without extent, which pagmo2 refuses, is given one here and
/// put back by the evaluator.
struct BorrowedProblem {
  Evaluator* evaluator = nullptr;  // pagmo2 asks for default construction and copies

  [[nodiscard]] vector_double fitness(const vector_double& x) const { return (*evaluator)(x); }
  [[nodiscard]] std::pair<vector_double, vector_double> get_bounds() const {
    const auto lower = evaluator->problem().lower();
    const auto upper = evaluator->problem().upper();
    std::pair<vector_double, vector_double> bounds{{lower.begin(), lower.end()}, {upper.begin(), upper.end()}};
    for (std::size_t j = 0; j < lower.size(); ++j) {
      if (lower[j] == upper[j]) bounds.second[j] = lower[j] + 1.0;
    }
    return bounds;
  }
  [[nodiscard]] vector_double::size_type get_nobj() const {
    return static_cast<vector_double::size_type>(evaluator->problem().objectives());
  }
};

/// All solutions of a generation in one call.
struct BatchEvaluation {
  vector_double operator()(const pagmo::problem& wrapped, const vector_double& x) const {
    return (*wrapped.extract<BorrowedProblem>()->evaluator)(x);
  }
};

/// What makes up one of pagmo2's algorithms here.
struct Method {
  const char* name;
  /// pagmo2's population for ours: as large, or the next size that it takes.
  std::size_t (*size)(std::size_t population);
  /// Evolves until the evaluator throws Spent.
  void (*evolve)(const pagmo::population& first, unsigned generations, unsigned seed);
};

/// The archive of all solutions evaluated is the front. pagmo2 takes the standard library's random distributions, so
/// that its runs repeat bit by bit with one standard library only. One thread.
class PagmoComparator final : public planner::optimizer::Optimizer {
 public:
  PagmoComparator(const Method& method, const planner::base::OptimizerSettings& settings, int dimension, int objectives)
      : method_(method),
        population_(checked(method, settings, objectives)),
        dimension_(dimension),
        archive_(static_cast<std::size_t>(settings.archive), dimension, objectives) {}

  const planner::optimizer::Front& run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                       std::uint64_t seed, std::uint64_t stream, const planner::base::Budget& budget,
                                       planner::base::WorkerPool& /*pool*/) override {
    check_budget(budget);
    planner::base::RandomStream random(seed, stream);
    archive_.clear();
    Evaluator evaluator(problem, population_, budget, archive_, planner::base::RandomStream(seed, stream, kArchive));
    try {
      search(evaluator, initial, static_cast<unsigned>(budget.generations), random);
    } catch (const Spent&) {  // as it is meant to end
    }
    report_ = evaluator.report();
    copy_front(archive_, dimension_, front_);
    return front_;
  }

  [[nodiscard]] const planner::optimizer::RunReport& report() const override { return report_; }

 private:
  static std::size_t checked(const Method& method, const planner::base::OptimizerSettings& settings, int objectives) {
    check_settings(settings, objectives);
    if (objectives < 2) throw std::invalid_argument(std::string(method.name) + ": needs two objectives or more");
    return static_cast<std::size_t>(settings.population);
  }

  void search(Evaluator& evaluator, std::span<const double> initial, unsigned generations,
              planner::base::RandomStream& random) const {
    const auto d = static_cast<std::size_t>(dimension_);
    vector_double x(method_.size(population_) * d);
    first_solutions(evaluator.problem(), initial, random, x);
    const auto population_seed = static_cast<unsigned>(random.next());
    const auto seed = static_cast<unsigned>(random.next());
    const vector_double told = evaluator(x);
    pagmo::population first(BorrowedProblem{&evaluator}, 0, population_seed);
    const auto objectives = static_cast<std::ptrdiff_t>(first.get_problem().get_nobj());
    for (std::ptrdiff_t i = 0; i * static_cast<std::ptrdiff_t>(d) < static_cast<std::ptrdiff_t>(x.size()); ++i) {
      const auto at = x.begin() + i * static_cast<std::ptrdiff_t>(d);
      const auto f = told.begin() + i * objectives;
      first.push_back(vector_double(at, at + static_cast<std::ptrdiff_t>(d)), vector_double(f, f + objectives));
    }
    method_.evolve(first, generations, seed);
  }

  Method method_;
  std::size_t population_;
  int dimension_;
  planner::optimizer::Archive archive_;
  planner::optimizer::Front front_;
  planner::optimizer::RunReport report_;
};

std::size_t as_large(std::size_t population) {
  return std::max(population, kLeastPopulation);
}

std::size_t multiple_of_four(std::size_t population) {
  return (as_large(population) + 3) / 4 * 4;
}

/// [Paper] section 5.5: crossover probability 0.7; mutation probability 0.4 and rate 0.02, which in the code that
/// circulates (Yarpiz) means that 40 % of the children have 2 % of their variables changed, at least one. pagmo2 asks
/// for the probability of each variable of each child: as many changes on average. The distribution indices, which
/// [Paper] does not give, are pagmo2's defaults.
void evolve_nsga2(const pagmo::population& first, unsigned generations, unsigned seed) {
  constexpr double kCrossover = 0.7;
  constexpr double kCrossoverIndex = 10.0;
  constexpr double kMutants = 0.4;
  constexpr double kMutationRate = 0.02;
  constexpr double kMutationIndex = 50.0;
  const auto variables = static_cast<double>(first.get_problem().get_nx());
  const double mutation = kMutants * std::ceil(kMutationRate * variables) / variables;
  pagmo::nsga2 nsga2(generations, kCrossover, kCrossoverIndex, mutation, kMutationIndex, seed);
  nsga2.set_bfe(pagmo::bfe(BatchEvaluation{}));
  nsga2.evolve(first);
}

/// pagmo2's defaults (c1 = c2 = 2 among them).
void evolve_nspso(const pagmo::population& first, unsigned generations, unsigned seed) {
  pagmo::nspso nspso(generations);
  nspso.set_seed(seed);
  nspso.set_bfe(pagmo::bfe(BatchEvaluation{}));
  nspso.evolve(first);
}

/// pagmo2's defaults: Tchebycheff decomposition, 20 neighbours. Weights on a grid for two objectives; for three, where
/// a grid fits certain populations alone, of low discrepancy.
void evolve_moead(const pagmo::population& first, unsigned generations, unsigned seed) {
  constexpr pagmo::population::size_type kNeighbours = 20;
  const char* weights = first.get_problem().get_nobj() == 2 ? "grid" : "low discrepancy";
  pagmo::moead moead(generations, weights, "tchebycheff", std::min(kNeighbours, first.size() - 1));
  moead.set_seed(seed);
  moead.evolve(first);
}

}  // namespace

/// Multiples of four: 50 is 52 here. The evaluations are what they would be for 50, so the last of pagmo2's generations
/// is cut: of 5000, the first population and 95 generations of 52 make 4992, and the next one's first 8 children are
/// evaluated too.
std::unique_ptr<planner::optimizer::Optimizer> make_nsga2(const planner::base::OptimizerSettings& settings,
                                                          int dimension, int objectives) {
  return std::make_unique<PagmoComparator>(Method{"nsga2", multiple_of_four, evolve_nsga2}, settings, dimension,
                                           objectives);
}

std::unique_ptr<planner::optimizer::Optimizer> make_nspso(const planner::base::OptimizerSettings& settings,
                                                          int dimension, int objectives) {
  return std::make_unique<PagmoComparator>(Method{"nspso", as_large, evolve_nspso}, settings, dimension, objectives);
}

std::unique_ptr<planner::optimizer::Optimizer> make_moead(const planner::base::OptimizerSettings& settings,
                                                          int dimension, int objectives) {
  return std::make_unique<PagmoComparator>(Method{"moead", as_large, evolve_moead}, settings, dimension, objectives);
}

std::string_view pagmo_version() {
  return PAGMO_VERSION;
}

}  // namespace jink::tools::lab::algorithms
