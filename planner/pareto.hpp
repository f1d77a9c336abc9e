// SPDX-License-Identifier: BSD-3-Clause
// Objective vectors, constrained domination, ranking. All objectives are minimised.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace jink::planner {

inline constexpr int kMaxObjectives = 3;

/// What evaluating one solution gives. Unused objectives are 0.
struct Cost {
  std::array<double, kMaxObjectives> f{};
  double violation = 0.0;  ///< total constraint violation, 0: feasible
};

/// Replaces a cost with any NaN or infinity by the worst cost there is, so that it ranks last everywhere.
void make_rankable(Cost& cost);

/// True where a constrained-dominates b: a smaller violation wins, then Pareto. differs: [Paper] Eq. (17) uses static
/// penalties instead, which leave `violation` at 0. Precondition: finite costs (make_rankable).
bool dominates(const Cost& a, const Cost& b, int objectives);

/// Orders solutions from best to worst by non-dominated front, then by crowding distance (wider first), then by index.
/// Owns its workspace: no allocation once constructed for `capacity` solutions. O(n² · objectives).
class Ranking {
 public:
  explicit Ranking(std::size_t capacity);

  /// Indices of `costs`, best first; valid until the next call. Precondition: costs.size() <= capacity.
  std::span<const int> order(std::span<const Cost> costs, int objectives);

  /// Front number of each solution of the last order(), 0 the non-dominated.
  [[nodiscard]] std::span<const int> fronts() const { return {front_.data(), size_}; }

 private:
  void peel_fronts(std::span<const Cost> costs, int objectives);
  void crowd(std::span<const Cost> costs, int objectives);

  std::size_t size_ = 0;
  std::vector<int> order_;
  std::vector<int> front_;
  std::vector<int> dominators_;
  std::vector<int> sorted_;
  std::vector<double> crowding_;
};

}  // namespace jink::planner
