// SPDX-License-Identifier: BSD-3-Clause
#include "planner/archive.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace jink::planner {
namespace {

constexpr double kLeastExtent = 1e-300;  // below, cells per extent overflow
constexpr int kCellsPerObjective = 10;   // neighbourhoods of Eq. (21): a tenth of the front's extent in each objective

std::size_t cell_count(int objectives) {
  std::size_t cells = 1;
  for (int k = 0; k < objectives; ++k) cells *= kCellsPerObjective;
  return cells;
}

}  // namespace

Archive::Archive(std::size_t capacity, int dimension, int objectives, double crowding)
    : dimension_(dimension),
      objectives_(objectives),
      alpha_(crowding),
      capacity_(capacity),
      x_(capacity * static_cast<std::size_t>(dimension)),
      cost_(capacity),
      cell_(capacity),
      occupancy_(cell_count(objectives)),
      cumulative_(capacity) {
  assert(capacity > static_cast<std::size_t>(objectives) && "the extremes of every objective must fit");
}

bool Archive::add(std::span<const double> x, const Cost& cost, RandomStream& random) {
  for (std::size_t i = 0; i < size_;) {
    if (dominates(cost_[i], cost, objectives_)) return false;
    if (cost_[i].f == cost.f && cost_[i].violation == cost.violation) return false;
    if (dominates(cost, cost_[i], objectives_)) {
      remove(i);
    } else {
      ++i;
    }
  }
  if (size_ == capacity_) remove_crowded(random);
  std::copy(x.begin(), x.end(), x_.begin() + static_cast<std::ptrdiff_t>(size_ * static_cast<std::size_t>(dimension_)));
  cost_[size_++] = cost;
  return true;
}

void Archive::remove(std::size_t i) {
  --size_;
  if (i == size_) return;
  const auto d = static_cast<std::size_t>(dimension_);
  std::copy_n(x_.begin() + static_cast<std::ptrdiff_t>(size_ * d), d, x_.begin() + static_cast<std::ptrdiff_t>(i * d));
  cost_[i] = cost_[size_];
}

void Archive::count_neighbours() {
  std::array<double, kMaxObjectives> low{};
  std::array<double, kMaxObjectives> scale{};
  for (int k = 0; k < objectives_; ++k) {
    const auto objective = static_cast<std::size_t>(k);
    double high = cost_[0].f[objective];
    low[objective] = high;
    for (std::size_t i = 1; i < size_; ++i) {
      low[objective] = std::min(low[objective], cost_[i].f[objective]);
      high = std::max(high, cost_[i].f[objective]);
    }
    const double extent = high - low[objective];
    scale[objective] = extent > kLeastExtent ? kCellsPerObjective / extent : 0.0;
  }
  std::fill(occupancy_.begin(), occupancy_.end(), 0);
  for (std::size_t i = 0; i < size_; ++i) {
    int cell = 0;
    for (int k = 0; k < objectives_; ++k) {
      const auto objective = static_cast<std::size_t>(k);
      const int along = static_cast<int>((cost_[i].f[objective] - low[objective]) * scale[objective]);
      cell = cell * kCellsPerObjective + std::clamp(along, 0, kCellsPerObjective - 1);
    }
    cell_[i] = cell;
    ++occupancy_[static_cast<std::size_t>(cell)];
  }
}

void Archive::weigh() {
  if (size_ == 0) return;
  count_neighbours();
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    sum += alpha_ / occupancy_[static_cast<std::size_t>(cell_[i])];
    cumulative_[i] = sum;
  }
}

std::size_t Archive::draw(RandomStream& random) const {
  assert(size_ > 0);
  const auto end = cumulative_.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto hit = std::upper_bound(cumulative_.begin(), end, random.uniform() * *(end - 1));
  return std::min(static_cast<std::size_t>(hit - cumulative_.begin()), size_ - 1);
}

void Archive::remove_crowded(RandomStream& random) {
  count_neighbours();
  std::array<std::size_t, kMaxObjectives> extreme{};
  for (int k = 0; k < objectives_; ++k) {
    const auto objective = static_cast<std::size_t>(k);
    for (std::size_t i = 1; i < size_; ++i) {
      if (cost_[i].f[objective] < cost_[extreme[objective]].f[objective]) extreme[objective] = i;
    }
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    const bool keep = std::find(extreme.begin(), extreme.begin() + objectives_, i) != extreme.begin() + objectives_;
    sum += keep ? 0.0 : occupancy_[static_cast<std::size_t>(cell_[i])] / alpha_;  // Eq. (21)
    cumulative_[i] = sum;
  }
  remove(draw(random));
}

}  // namespace jink::planner
