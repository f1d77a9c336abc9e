// SPDX-License-Identifier: BSD-3-Clause
// Objective vectors, constrained domination, ranking. All objectives are minimised.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace jink::planner::optimizer {

/// The most objectives that a problem may have.
inline constexpr int kMaxObjectives = 3;

/// What evaluating one solution gives. Unused objectives are 0.
struct Cost {
  std::array<double, kMaxObjectives> f{};  ///< objectives, minimised
  double violation = 0.0;                  ///< total constraint violation, 0: feasible
};

/// Replaces a cost with any NaN or infinity by the worst cost there is, so that it ranks last everywhere.
inline void make_rankable(Cost& cost) {
  const double sum = cost.violation + cost.f[0] + cost.f[1] + cost.f[2];
  if (std::isfinite(sum)) return;
  constexpr double kWorst = 1e300;
  cost = {{kWorst, kWorst, kWorst}, kWorst};
}

/// True where a constrained-dominates b: a smaller violation wins, then Pareto. differs: [Paper] Eq. (17) uses static
/// penalties instead, which leave `violation` at 0. Precondition: finite costs (make_rankable).
inline bool dominates(const Cost& a, const Cost& b, int objectives) {
  if (a.violation != b.violation) return a.violation < b.violation;
  bool worse = false;
  bool better = false;
  for (std::size_t k = 0; k < static_cast<std::size_t>(objectives); ++k) {
    worse |= a.f[k] > b.f[k];
    better |= a.f[k] < b.f[k];
  }
  return better && !worse;
}

/// Orders solutions from best to worst by non-dominated front, then by crowding distance (wider first), then by index.
/// Owns its workspace: no allocation once constructed for `capacity` solutions. Efficient non-dominated sorting with
/// sequential search (Zhang et al. 2015): O(n log n + n · fronts) for two objectives, at worst O(n²) for more.
class Ranking {
 public:
  /// Takes the memory for `capacity` solutions.
  explicit Ranking(std::size_t capacity);

  /// Indices of `costs`, best first, valid until the next call. Preconditions: finite costs, at most `capacity` of
  /// them.
  std::span<const int> order(std::span<const Cost> costs, int objectives);

  /// Front of each solution in the last order(), 0 the non-dominated one; by index of `costs`.
  [[nodiscard]] std::span<const int> fronts() const { return {front_.data(), order_.size()}; }

 private:
  void assign_fronts(std::span<const Cost> costs, int objectives);
  void gather_fronts();
  void crowd(std::span<const Cost> costs, std::span<int> front, int objectives);

  std::vector<int> sorted_;  // lexicographically
  std::vector<int> order_;
  std::vector<int> front_;
  std::vector<int> last_;      // of each front, the member found last
  std::vector<int> previous_;  // of each member, the one before in its front
  std::vector<std::size_t> ends_;
  std::vector<double> crowding_;
};

}  // namespace jink::planner::optimizer
