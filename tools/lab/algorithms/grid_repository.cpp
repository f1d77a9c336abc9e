// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/grid_repository.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "planner/base/portable_math.hpp"

namespace jink::tools::lab::algorithms {
namespace {

constexpr double kLeastExtent = 1e-300;  // below, cells per extent overflow
constexpr double kMostExponent = 700.0;  // what exponential() takes

double power(double base, int exponent) {
  double result = 1.0;
  for (int k = 0; k < exponent; ++k) result *= base;
  return result;
}

double falling(double exponent) {
  return planner::base::exponential(-std::min(exponent, kMostExponent));
}

bool contains(std::span<const std::size_t> list, std::size_t i) {
  return std::find(list.begin(), list.end(), i) != list.end();
}

}  // namespace

GridRepository::GridRepository(const GridSettings& settings, std::size_t capacity, int dimension, int objectives)
    : settings_(settings), capacity_(capacity), members_(dimension, objectives) {}

void GridRepository::clear() {
  members_.clear();
  cell_of_.clear();
  counts_.clear();
}

double GridRepository::leader_weight(int count) const {
  if (count == 0) return 0.0;
  return settings_.pressure == Pressure::kPower ? 1.0 / power(count, settings_.leader)
                                                : falling(settings_.leader * count);
}

// Against the most crowded cell, so that nothing overflows.
double GridRepository::deletion_weight(int count, int most) const {
  if (count == 0) return 0.0;
  return settings_.pressure == Pressure::kPower ? power(count, settings_.deletion)
                                                : falling(settings_.deletion * (most - count));
}

void GridRepository::lay_grid() {
  const auto costs = members_.costs();
  const auto objectives = static_cast<std::size_t>(members_.objectives());
  std::array<double, planner::optimizer::kMaxObjectives> low{};
  std::array<double, planner::optimizer::kMaxObjectives> scale{};
  for (std::size_t k = 0; k < objectives; ++k) {
    const auto [least, most] =
        std::minmax_element(costs.begin(), costs.end(), [&](const auto& a, const auto& b) { return a.f[k] < b.f[k]; });
    const double extent = most->f[k] - least->f[k];
    low[k] = least->f[k] - settings_.inflation * extent;
    scale[k] = extent > kLeastExtent ? settings_.cells / (extent * (1.0 + 2.0 * settings_.inflation)) : 0.0;
  }
  cell_of_.clear();
  std::vector<std::size_t>& occupied = cell_of_;  // first the cells' own numbers
  for (const planner::optimizer::Cost& cost : costs) {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < objectives; ++k) {
      const auto along = static_cast<int>((cost.f[k] - low[k]) * scale[k]);
      cell = cell * static_cast<std::size_t>(settings_.cells) +
             static_cast<std::size_t>(std::clamp(along, 0, settings_.cells - 1));
    }
    occupied.push_back(cell);
  }
  std::vector<std::size_t> numbers = occupied;
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  counts_.assign(numbers.size(), 0);
  for (std::size_t& cell : cell_of_) {
    cell = static_cast<std::size_t>(std::lower_bound(numbers.begin(), numbers.end(), cell) - numbers.begin());
    ++counts_[cell];
  }
}

std::size_t GridRepository::nth_of_cell(std::size_t cell, std::uint64_t nth,
                                        std::span<const std::size_t> excluded) const {
  std::size_t i = 0;
  for (;; ++i) {
    assert(i < cell_of_.size());
    if (cell_of_[i] != cell || contains(excluded, i)) continue;
    if (nth-- == 0) return i;
  }
}

void GridRepository::take_one_out(planner::base::RandomStream& random) {
  const int most = *std::max_element(counts_.begin(), counts_.end());
  weights_.clear();
  for (const int count : counts_) weights_.push_back(deletion_weight(count, most));
  const std::size_t cell = roulette(weights_, random);
  const std::size_t goes = nth_of_cell(cell, random.below(static_cast<std::uint64_t>(counts_[cell])), {});
  members_.remove(goes);
  cell_of_.erase(cell_of_.begin() + static_cast<std::ptrdiff_t>(goes));
  --counts_[cell];
}

void GridRepository::settle(planner::base::RandomStream& random) {
  if (members_.size() == 0) return;
  lay_grid();
  if (members_.size() <= capacity_) return;
  while (members_.size() > capacity_) take_one_out(random);
  lay_grid();
}

std::size_t GridRepository::draw(planner::base::RandomStream& random, std::span<const std::size_t> excluded) const {
  assert(members_.size() > excluded.size());
  const auto left_of = [&](std::size_t cell) {
    return counts_[cell] - static_cast<int>(std::count_if(excluded.begin(), excluded.end(),
                                                          [&](std::size_t i) { return cell_of_[i] == cell; }));
  };
  weights_.clear();
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) weights_.push_back(leader_weight(left_of(cell)));
  const std::size_t cell = roulette(weights_, random);
  return nth_of_cell(cell, random.below(static_cast<std::uint64_t>(left_of(cell))), excluded);
}

}  // namespace jink::tools::lab::algorithms
