// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/topsis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "planner/base/portable_math.hpp"

namespace jink::planner::optimizer {
namespace {

struct Column {
  double low = 0.0;
  double high = 0.0;
  double norm = 0.0;  // length of the shifted column
  double sum = 0.0;   // sum of the shifted column
};

Column column(std::span<const Cost> costs, int objective) {
  const auto k = static_cast<std::size_t>(objective);
  Column c;
  c.low = costs[0].f[k];
  c.high = c.low;
  for (const Cost& cost : costs) {
    c.low = std::min(c.low, cost.f[k]);
    c.high = std::max(c.high, cost.f[k]);
  }
  double squares = 0.0;
  for (const Cost& cost : costs) {
    squares += (cost.f[k] - c.low) * (cost.f[k] - c.low);
    c.sum += cost.f[k] - c.low;
  }
  c.norm = std::sqrt(squares);
  return c;
}

std::vector<double> closeness(std::span<const Cost> costs, int objectives, std::span<const double> weights) {
  std::vector<double> entropy;
  if (weights.empty()) {
    entropy = entropy_weights(costs, objectives);
    weights = entropy;
  }
  std::vector<double> to_ideal(costs.size(), 0.0);
  std::vector<double> to_anti_ideal(costs.size(), 0.0);
  for (int objective = 0; objective < objectives; ++objective) {
    const auto k = static_cast<std::size_t>(objective);
    const Column c = column(costs, objective);
    if (c.norm == 0.0) continue;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double from_ideal = (costs[i].f[k] - c.low) / c.norm;
      const double from_anti_ideal = (c.high - costs[i].f[k]) / c.norm;
      to_ideal[i] += weights[k] * from_ideal * from_ideal;
      to_anti_ideal[i] += weights[k] * from_anti_ideal * from_anti_ideal;
    }
  }
  std::vector<double> result(costs.size(), 1.0);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double sum = std::sqrt(to_ideal[i]) + std::sqrt(to_anti_ideal[i]);
    if (sum > 0.0) result[i] = std::sqrt(to_anti_ideal[i]) / sum;
  }
  return result;
}

}  // namespace

std::vector<double> entropy_weights(std::span<const Cost> costs, int objectives) {
  std::vector<double> weights(static_cast<std::size_t>(objectives), 0.0);
  double total = 0.0;
  for (int objective = 0; objective < objectives; ++objective) {
    const auto k = static_cast<std::size_t>(objective);
    const Column c = column(costs, objective);
    if (c.sum == 0.0 || costs.size() < 2) continue;
    double entropy = 0.0;
    for (const Cost& cost : costs) {
      const double p = (cost.f[k] - c.low) / c.sum;
      if (p > 0.0) entropy -= p * base::logarithm(p);
    }
    weights[k] = 1.0 - entropy / base::logarithm(static_cast<double>(costs.size()));
    total += weights[k];
  }
  for (double& weight : weights) weight = total > 0.0 ? weight / total : 1.0 / objectives;
  return weights;
}

std::vector<int> topsis_order(std::span<const Cost> costs, int objectives, std::span<const double> weights) {
  std::vector<int> order(costs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto violation = [&](int i) { return costs[static_cast<std::size_t>(i)].violation; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return violation(a) < violation(b); });
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    std::vector<Cost> group;
    while (end < order.size() && violation(order[end]) == violation(order[begin])) {
      group.push_back(costs[static_cast<std::size_t>(order[end++])]);
    }
    const std::vector<double> score = closeness(group, objectives, weights);
    std::vector<std::size_t> by_score(group.size());
    std::iota(by_score.begin(), by_score.end(), std::size_t{0});
    std::stable_sort(by_score.begin(), by_score.end(),
                     [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
    const std::vector<int> members(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                   order.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t i = 0; i < members.size(); ++i) order[begin + i] = members[by_score[i]];
    begin = end;
  }
  return order;
}

}  // namespace jink::planner::optimizer
