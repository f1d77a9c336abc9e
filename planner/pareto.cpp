// SPDX-License-Identifier: BSD-3-Clause
#include "planner/pareto.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace jink::planner {
void make_rankable(Cost& cost) {
  double sum = cost.violation;
  for (const double f : cost.f) sum += f;
  if (std::isfinite(sum)) return;
  constexpr double kWorst = 1e300;
  cost = {{kWorst, kWorst, kWorst}, kWorst};
}

bool dominates(const Cost& a, const Cost& b, int objectives) {
  if (a.violation != b.violation) return a.violation < b.violation;
  bool better = false;
  for (int k = 0; k < objectives; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (a.f[i] > b.f[i]) return false;
    better = better || a.f[i] < b.f[i];
  }
  return better;
}

Ranking::Ranking(std::size_t capacity)
    : order_(capacity), front_(capacity), dominators_(capacity), sorted_(capacity), crowding_(capacity) {}

void Ranking::peel_fronts(std::span<const Cost> costs, int objectives) {
  const std::size_t n = costs.size();
  std::fill_n(dominators_.begin(), n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (dominates(costs[i], costs[j], objectives)) {
        ++dominators_[j];
      } else if (dominates(costs[j], costs[i], objectives)) {
        ++dominators_[i];
      }
    }
  }
  std::fill_n(front_.begin(), n, -1);
  std::size_t placed = 0;
  for (int level = 0; placed < n; ++level) {
    const std::size_t before = placed;
    for (std::size_t i = 0; i < n; ++i) {
      if (front_[i] < 0 && dominators_[i] == 0) {
        front_[i] = level;
        sorted_[placed++] = static_cast<int>(i);
      }
    }
    assert(placed > before && "constrained domination is acyclic");
    for (std::size_t k = before; k < placed; ++k) {
      const auto i = static_cast<std::size_t>(sorted_[k]);
      for (std::size_t j = 0; j < n; ++j) {
        if (front_[j] < 0 && dominates(costs[i], costs[j], objectives)) --dominators_[j];
      }
    }
  }
}

void Ranking::crowd(std::span<const Cost> costs, int objectives) {
  const std::size_t n = costs.size();
  std::fill_n(crowding_.begin(), n, 0.0);
  for (int k = 0; k < objectives; ++k) {
    const auto objective = static_cast<std::size_t>(k);
    const auto value = [&](std::size_t position) {
      return costs[static_cast<std::size_t>(sorted_[position])].f[objective];
    };
    std::iota(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(n), 0);
    std::sort(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(n), [&](int a, int b) {
      const auto i = static_cast<std::size_t>(a);
      const auto j = static_cast<std::size_t>(b);
      if (front_[i] != front_[j]) return front_[i] < front_[j];
      if (costs[i].f[objective] != costs[j].f[objective]) return costs[i].f[objective] < costs[j].f[objective];
      return a < b;
    });
    for (std::size_t low = 0; low < n;) {
      std::size_t high = low;
      while (high + 1 < n &&
             front_[static_cast<std::size_t>(sorted_[high + 1])] == front_[static_cast<std::size_t>(sorted_[low])]) {
        ++high;
      }
      const double extent = value(high) - value(low);
      crowding_[static_cast<std::size_t>(sorted_[low])] = std::numeric_limits<double>::infinity();
      crowding_[static_cast<std::size_t>(sorted_[high])] = std::numeric_limits<double>::infinity();
      for (std::size_t i = low + 1; i < high && extent > 0.0; ++i) {
        crowding_[static_cast<std::size_t>(sorted_[i])] += (value(i + 1) - value(i - 1)) / extent;
      }
      low = high + 1;
    }
  }
}

std::span<const int> Ranking::order(std::span<const Cost> costs, int objectives) {
  const std::size_t n = costs.size();
  assert(n <= order_.size());
  size_ = n;
  peel_fronts(costs, objectives);
  crowd(costs, objectives);
  std::iota(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(n), 0);
  std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(n), [&](int a, int b) {
    const auto i = static_cast<std::size_t>(a);
    const auto j = static_cast<std::size_t>(b);
    if (front_[i] != front_[j]) return front_[i] < front_[j];
    if (crowding_[i] != crowding_[j]) return crowding_[i] > crowding_[j];
    return a < b;
  });
  return {order_.data(), n};
}

}  // namespace jink::planner
