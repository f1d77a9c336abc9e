// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/archive.hpp"

#include <algorithm>
#include <cassert>

namespace jink::planner::optimizer {
namespace {

constexpr double kLeastExtent = 1e-300;  // below, cells per extent overflow
constexpr std::size_t kCellsPerObjective = 10;
constexpr std::size_t kSlack = 32;  // members beyond the capacity that a batch may add

std::size_t cell_count(int objectives) {
  std::size_t cells = 1;
  for (int k = 0; k < objectives; ++k) cells *= kCellsPerObjective;
  return cells;
}

/// No worse in every objective, for costs of equal violation.
bool covers(const Cost& a, const Cost& b) {
  return a.f[0] <= b.f[0] && a.f[1] <= b.f[1] && a.f[2] <= b.f[2];
}

}  // namespace

Archive::Archive(std::size_t capacity, int dimension, int objectives)
    : dimension_(dimension),
      objectives_(objectives),
      capacity_(capacity),
      x_((capacity + kSlack) * static_cast<std::size_t>(dimension)),
      cells_(cell_count(objectives)) {
  assert(capacity > static_cast<std::size_t>(objectives) && "the extremes of every objective must fit");
  const std::size_t room = capacity + kSlack;
  costs_.reserve(room);
  slots_.reserve(room);
  free_.reserve(room);
  occupied_.reserve(room);
  cell_of_.reserve(room);
  members_.reserve(room);
  clear();
}

void Archive::clear() {
  costs_.clear();
  slots_.clear();
  free_.clear();
  for (std::size_t slot = capacity_ + kSlack; slot > 0; --slot) free_.push_back(slot - 1);
}

void Archive::erase(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  const auto from = static_cast<std::ptrdiff_t>(begin);
  const auto to = static_cast<std::ptrdiff_t>(end);
  free_.insert(free_.end(), slots_.begin() + from, slots_.begin() + to);
  slots_.erase(slots_.begin() + from, slots_.begin() + to);
  costs_.erase(costs_.begin() + from, costs_.begin() + to);
}

bool Archive::add(std::span<const double> x, const Cost& cost, base::RandomStream& random) {
  // Constrained domination leaves one value of violation in the archive, the smallest.
  if (!costs_.empty() && cost.violation != costs_.front().violation) {
    if (cost.violation > costs_.front().violation) return false;
    clear();
  }
  // What covers the newcomer comes before it in the order, what it covers comes after. With two objectives the second
  // falls along the order, so that the neighbours tell.
  const auto after =
      std::upper_bound(costs_.begin(), costs_.end(), cost, [](const Cost& a, const Cost& b) { return a.f < b.f; });
  const auto at = static_cast<std::size_t>(after - costs_.begin());
  for (std::size_t i = at; i > 0; --i) {
    if (covers(costs_[i - 1], cost)) return false;
    if (objectives_ <= 2) break;
  }
  if (objectives_ <= 2) {
    std::size_t end = at;
    while (end < costs_.size() && covers(cost, costs_[end])) ++end;
    erase(at, end);
  } else {
    for (std::size_t i = costs_.size(); i > at; --i) {
      if (covers(cost, costs_[i - 1])) erase(i - 1, i);
    }
  }
  if (free_.empty()) {
    settle(random);
    return add(x, cost, random);
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  costs_.insert(costs_.begin() + static_cast<std::ptrdiff_t>(at), cost);
  slots_.insert(slots_.begin() + static_cast<std::ptrdiff_t>(at), slot);
  std::copy(x.begin(), x.end(), x_.begin() + static_cast<std::ptrdiff_t>(slot * static_cast<std::size_t>(dimension_)));
  return true;
}

void Archive::find_cells() {
  std::array<double, kMaxObjectives> low{};
  std::array<double, kMaxObjectives> scale{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(objectives_); ++k) {
    std::size_t lowest = 0;
    double high = costs_[0].f[k];
    for (std::size_t i = 1; i < costs_.size(); ++i) {
      if (costs_[i].f[k] < costs_[lowest].f[k]) lowest = i;
      high = std::max(high, costs_[i].f[k]);
    }
    best_[k] = lowest;
    low[k] = costs_[lowest].f[k];
    const double extent = high - low[k];
    scale[k] = extent > kLeastExtent ? kCellsPerObjective / extent : 0.0;
  }
  for (const std::size_t cell : occupied_) cells_[cell] = {};
  occupied_.clear();
  cell_of_.resize(costs_.size());
  members_.resize(costs_.size());
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(objectives_); ++k) {
      const auto along = static_cast<std::size_t>((costs_[i].f[k] - low[k]) * scale[k]);
      cell = cell * kCellsPerObjective + std::min(along, kCellsPerObjective - 1);
    }
    cell_of_[i] = cell;
    if (cells_[cell].count++ == 0) occupied_.push_back(cell);
  }
  std::size_t begin = 0;
  for (const std::size_t cell : occupied_) {
    cells_[cell].begin = begin;
    begin += static_cast<std::size_t>(cells_[cell].count);
    cells_[cell].count = 0;
  }
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    Cell& cell = cells_[cell_of_[i]];
    members_[cell.begin + static_cast<std::size_t>(cell.count++)] = i;
  }
}

bool Archive::extreme(std::size_t i) const {
  const auto end = best_.begin() + objectives_;
  return std::find(best_.begin(), end, i) != end;
}

void Archive::settle(base::RandomStream& random) {
  if (costs_.empty()) return;
  find_cells();
  if (costs_.size() <= capacity_) return;
  thin_out(random);
  find_cells();
}

// The cells stay those of the batch's end while members go.
void Archive::thin_out(base::RandomStream& random) {
  const auto objectives = static_cast<std::size_t>(objectives_);
  for (std::size_t k = 0; k < objectives; ++k) {
    const bool counted = std::find(best_.begin(), best_.begin() + static_cast<std::ptrdiff_t>(k), best_[k]) !=
                         best_.begin() + static_cast<std::ptrdiff_t>(k);
    if (!counted) ++cells_[cell_of_[best_[k]]].extremes;
  }
  // Weight N for each of the N - extremes members that may go.
  const auto weight = [&](std::size_t cell) {
    return static_cast<double>(cells_[cell].count) * (cells_[cell].count - cells_[cell].extremes);
  };
  std::size_t excess = costs_.size() - capacity_;
  constexpr std::size_t kGone = static_cast<std::size_t>(-1);
  for (; excess > 0; --excess) {
    double total = 0.0;
    for (const std::size_t cell : occupied_) total += weight(cell);
    double left = random.uniform() * total;
    std::size_t last = occupied_.front();  // rounding must not end in a cell without weight
    for (const std::size_t cell : occupied_) {
      if (weight(cell) == 0.0) continue;
      last = cell;
      left -= weight(cell);
      if (left < 0.0) break;
    }
    Cell& cell = cells_[last];
    auto nth = random.below(static_cast<std::uint64_t>(cell.count - cell.extremes));
    std::size_t position = cell.begin;
    while (extreme(members_[position]) || nth > 0) {
      if (!extreme(members_[position])) --nth;
      ++position;
    }
    free_.push_back(slots_[members_[position]]);
    slots_[members_[position]] = kGone;
    members_[position] = members_[cell.begin + static_cast<std::size_t>(--cell.count)];
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    if (slots_[i] == kGone) continue;
    costs_[kept] = costs_[i];
    slots_[kept++] = slots_[i];
  }
  costs_.resize(kept);
  slots_.resize(kept);
}

}  // namespace jink::planner::optimizer
