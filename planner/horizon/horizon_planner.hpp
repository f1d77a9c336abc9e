// SPDX-License-Identifier: BSD-3-Clause
// Horizon mode: what is flown. Plans the remaining path from the present state, verified, again and again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "planner/base/budget.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/horizon/encounters.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/verify/plan.hpp"

namespace jink::planner::horizon {

/// Where the search for a plan starts: solutions of `problem`, which is prepared for `request`, one after another.
/// Straight on; `previous`, where there is one; and, with settings.seeding, what a pilot would try first. The horizon
/// is that of `problem`. Allocates.
[[nodiscard]] std::vector<double> initial_solutions(const PathProblem& problem, const PathRequest& request,
                                                    const base::TimedPath& previous,
                                                    const base::HorizonSettings& settings);

/// One planner serves one flight at a time; not thread-safe. plan() is a pure function of its arguments: the same bits
/// for the same request, previous plan, seed and generations, whatever the number of threads. Where a deadline is
/// given, the plan says how far its searches went, and repeat() makes it again from that.
class HorizonPlanner {
 public:
  /// `optimizer` gives the operators; its size (slaves, sharing, population, iterations) is that of `settings`. `make`
  /// makes the optimizer, for problems of three objectives. Throws std::invalid_argument for settings that PathProblem
  /// or the optimizer refuses.
  explicit HorizonPlanner(const base::HorizonSettings& settings, const base::OptimizerSettings& optimizer = {},
                          const optimizer::MakeOptimizer& make = {});

  /// Plans from `request` on. `previous` is the plan now flown with its times shifted so that 0 is this plan's start;
  /// empty: none, as one that does not begin in the request's state (continues() in path_check.hpp). It seeds the
  /// search, and it is kept where it is still free and a new plan is neither clearly better nor, along the same way,
  /// shorter and no less clear; where it asks for more than 1.1 times the vehicle's limits, only if no new plan is
  /// free. `number` counts the plans of a flight and names the random stream. Among very many that move a search has
  /// fewer generations than `budget`.
  ///
  /// How far it looks ahead and aside is extent_of()'s choice. The returned path starts at time 0 in the request's
  /// state and leads to the target. Its status says how much of it was verified free in continuous time, apart from the
  /// optimizer. Where nothing was found that keeps the margin, the search is repeated with more of the vehicle's
  /// acceleration (settings.emergency_share), and where that finds nothing free either the path is the candidate that
  /// stays free the longest, then has the softest contact. A request that is_valid() in path_check.hpp refuses gets
  /// kInvalid and no path.
  verify::Plan plan(const PathRequest& request, const base::TimedPath& previous, std::uint64_t seed,
                    std::uint64_t number, const base::Budget& budget, base::WorkerPool& pool);

  /// Makes a plan again whose searches went as far as `searches` says (Plan::searches): the same bits, though the clock
  /// had a say in the first one. Where other settings or another request lead to a search that is not among them, it
  /// goes as far as the first, or as the settings say where the first made none.
  verify::Plan repeat(const PathRequest& request, const base::TimedPath& previous, std::uint64_t seed,
                      std::uint64_t number, const std::array<verify::SearchExtent, 2>& searches,
                      base::WorkerPool& pool);

  /// The settings given at construction.
  [[nodiscard]] const base::HorizonSettings& settings() const { return settings_; }

 private:
  /// Names the random numbers of a plan.
  struct Random {
    std::uint64_t seed = 1, stream = 0;
  };
  /// For one Extent: what is planned with, and the same with a harder acceleration.
  struct Problems {
    PathProblem usual, emergency;
    double pace = 0.0;  // s per generation, of the plan before; 0: not known

    explicit Problems(const base::HorizonSettings& settings) : usual(settings), emergency(settings.for_emergencies()) {}
  };
  /// With one budget for each search.
  verify::Plan make(const PathRequest& asked, const base::TimedPath& before, const Random& random,
                    const std::array<base::Budget, 2>& budgets, base::WorkerPool& pool);
  Problems& problems(Extent extent) { return problems_[static_cast<std::size_t>(extent)]; }
  [[nodiscard]] std::optional<verify::Plan> without_search(const PathProblem& problem, const PathRequest& request,
                                                           const base::TimedPath& previous) const;
  verify::Plan search(PathProblem& problem, const PathRequest& request, const base::TimedPath& previous,
                      const Random& random, const base::Budget& budget, double& pace, base::WorkerPool& pool);
  [[nodiscard]] verify::Plan choose(const PathProblem& problem, const PathRequest& request,
                                    const optimizer::Front& front) const;
  [[nodiscard]] std::vector<optimizer::Cost> quantized(std::span<const optimizer::Cost> costs) const;
  [[nodiscard]] std::optional<verify::Plan> improved(const PathProblem& problem, const PathRequest& request,
                                                     const base::TimedPath& previous,
                                                     const optimizer::Cost& cost) const;
  void keep_previous(const PathProblem& problem, const PathRequest& request, const base::TimedPath& previous,
                     verify::Plan& plan) const;

  base::HorizonSettings settings_;
  std::array<Problems, 3> problems_;  // by Extent
  std::unique_ptr<optimizer::Optimizer> optimizer_;
  const optimizer::Front* front_ = nullptr;  // of the last search; the optimizer's
  std::vector<double> initial_;
  std::array<double, 3> weights_{};  // of the objectives, in the choice for the present request
  double longer_ = 0.0;              // m, that it may be longer than the shortest besides the band
};

}  // namespace jink::planner::horizon
