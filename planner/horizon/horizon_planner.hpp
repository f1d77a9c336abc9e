// SPDX-License-Identifier: BSD-3-Clause
// Horizon mode: what is flown. Plans the remaining path from the present state, verified, again and again.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "planner/base/budget.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/optimizer/optimizer.hpp"
#include "planner/verify/plan.hpp"

namespace jink::planner::horizon {

/// Where the search for a plan starts: solutions of `problem`, which is prepared for `request`, one after another.
/// Straight on; `previous`, where there is one; and, with settings.seeding, what a pilot would try first. Allocates.
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
  /// search, and it is kept where it is still free and a new plan is not clearly better; where it asks for more than 1.1
  /// times the vehicle's limits, only if no new plan is free.
  /// `number` counts the plans of a flight and names the random stream.
  ///
  /// The returned path starts at time 0 in the request's state and leads to the target. Its status says how much of it
  /// was verified free in continuous time, apart from the optimizer. Where nothing was found that keeps the margin, the
  /// search is repeated with more of the vehicle's acceleration (settings.emergency_share), and where that finds
  /// nothing free either the path is the candidate that stays free the longest, then has the softest contact. A request
  /// that is_valid() in path_check.hpp refuses gets kInvalid and no path.
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
  /// How far a plan looks ahead, s.
  [[nodiscard]] double horizon() const { return problem_.horizon(); }

 private:
  /// Names the random numbers of a plan.
  struct Random {
    std::uint64_t seed = 1, stream = 0;
  };
  /// With one budget for each search.
  verify::Plan make(const PathRequest& request, const base::TimedPath& before, const Random& random,
                    const std::array<base::Budget, 2>& budgets, base::WorkerPool& pool);
  [[nodiscard]] std::optional<Vec3> around(const PathRequest& request) const;
  [[nodiscard]] std::optional<verify::Plan> without_search(const PathRequest& request,
                                                           const base::TimedPath& previous) const;
  verify::Plan search(PathProblem& problem, const PathRequest& request, const base::TimedPath& previous,
                      const Random& random, const base::Budget& budget, base::WorkerPool& pool);
  [[nodiscard]] int affordable_generations(const base::Budget& budget) const;
  [[nodiscard]] verify::Plan choose(const PathProblem& problem, const PathRequest& request,
                                    const optimizer::Front& front) const;
  [[nodiscard]] std::vector<optimizer::Cost> quantized(std::span<const optimizer::Cost> costs) const;
  void keep_previous(const PathRequest& request, const base::TimedPath& previous, verify::Plan& plan) const;

  base::HorizonSettings settings_;
  PathProblem problem_;
  PathProblem emergency_;  // the same with a harder acceleration
  std::unique_ptr<optimizer::Optimizer> optimizer_;
  std::vector<double> initial_;
  double pace_ = 0.0;  // s per generation, of the plan before; 0: not known
};

}  // namespace jink::planner::horizon
