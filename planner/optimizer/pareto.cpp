// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/pareto.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "planner/base/multiversion.hpp"

namespace jink::planner::optimizer {
namespace {

// Few elements are the rule here: a slave has a handful of universes. The order is total, so that the algorithm has no
// influence on the result.
template <typename Element, typename Less>
void sort_few(std::span<Element> elements, const Less& less) {
  constexpr std::size_t kFew = 24;
  if (elements.size() > kFew) {
    std::sort(elements.begin(), elements.end(), less);
    return;
  }
  for (std::size_t i = 1; i < elements.size(); ++i) {
    const Element element = elements[i];
    std::size_t hole = i;
    for (; hole > 0 && less(element, elements[hole - 1]); --hole) elements[hole] = elements[hole - 1];
    elements[hole] = element;
  }
}

}  // namespace

Ranking::Ranking(std::size_t capacity)
    : sorted_(capacity), order_(capacity), front_(capacity), previous_(capacity), crowding_(capacity) {
  last_.reserve(capacity);
  ends_.reserve(capacity);
}

namespace {

constexpr std::size_t kFew = 16;

// Whether p comes before q in lexicographic order of (violation, objectives, index).
bool before(const Cost& p, const Cost& q, int index_p, int index_q) {
  if (p.violation != q.violation) return p.violation < q.violation;
  for (std::size_t k = 0; k < kMaxObjectives; ++k) {
    if (p.f[k] != q.f[k]) return p.f[k] < q.f[k];
  }
  return index_p < index_q;
}

// The place of each of at most kFew costs in that order is the number of those before it: for a handful, counting them
// without a branch is quicker than any sorting, whose branches nobody can predict.
JINK_MULTIVERSION void count_before(std::span<const Cost> costs, std::array<std::int64_t, kFew>& place) {
  std::array<std::array<double, kFew>, 4> key{};
  std::array<double, kFew> index{};
  const std::size_t n = costs.size();
  for (std::size_t j = 0; j < n; ++j) {
    key[0][j] = costs[j].violation;
    for (std::size_t k = 0; k < kMaxObjectives; ++k) key[k + 1][j] = costs[j].f[k];
    index[j] = static_cast<double>(j);
  }
  place.fill(0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < kFew; ++j) {
      int less = static_cast<int>(index[i] < index[j]);
      for (std::size_t k = key.size(); k > 0; --k) {
        const double p = key[k - 1][i];
        const double q = key[k - 1][j];
        less = static_cast<int>(p < q) | (static_cast<int>(p == q) & less);
      }
      place[j] += less;
    }
  }
}

void sort_lexicographically(std::span<const Cost> costs, std::span<int> sorted) {
  if (costs.size() <= kFew) {
    std::array<std::int64_t, kFew> place;  // NOLINT(cppcoreguidelines-pro-type-member-init): count_before fills it
    count_before(costs, place);
    for (std::size_t i = 0; i < costs.size(); ++i) sorted[static_cast<std::size_t>(place[i])] = static_cast<int>(i);
    return;
  }
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(), [&](int a, int b) {
    return before(costs[static_cast<std::size_t>(a)], costs[static_cast<std::size_t>(b)], a, b);
  });
}

}  // namespace

// In lexicographic order nobody is dominated by a later one, and with two objectives, of the members of a front, the
// last one found dominates if any does.
void Ranking::assign_fronts(std::span<const Cost> costs, int objectives) {
  sort_lexicographically(costs, sorted_);
  last_.clear();
  for (const int i : sorted_) {
    const Cost& cost = costs[static_cast<std::size_t>(i)];
    const auto dominated_in = [&](int member) {
      for (; member >= 0; member = previous_[static_cast<std::size_t>(member)]) {
        if (dominates(costs[static_cast<std::size_t>(member)], cost, objectives)) return true;
        if (objectives <= 2) break;
      }
      return false;
    };
    // Whom a front dominates, the fronts before it dominate: the first that does not is the place.
    std::size_t level = 0;
    while (level < last_.size() && dominated_in(last_[level])) ++level;
    if (level == last_.size()) last_.push_back(-1);
    front_[static_cast<std::size_t>(i)] = static_cast<int>(level);
    previous_[static_cast<std::size_t>(i)] = last_[level];
    last_[level] = i;
  }
}

// Into order_, front after front, each in lexicographic order. ends_: where each front ends.
void Ranking::gather_fronts() {
  ends_.assign(last_.size(), 0);
  for (const int level : front_) ++ends_[static_cast<std::size_t>(level)];
  std::size_t begin = 0;
  for (std::size_t& end : ends_) begin = std::exchange(end, begin) + begin;
  for (const int i : sorted_) {
    order_[ends_[static_cast<std::size_t>(front_[static_cast<std::size_t>(i)])]++] = i;
  }
}

// Crowding distances of one front, then its members by them.
void Ranking::crowd(std::span<const Cost> costs, std::span<int> front, int objectives) {
  for (const int i : front) crowding_[static_cast<std::size_t>(i)] = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(objectives); ++k) {
    const auto f = [&](int i) { return costs[static_cast<std::size_t>(i)].f[k]; };
    if (k > 0 || objectives > 2) {  // two objectives: the lexicographic order is that of the first
      sort_few(front, [&](int a, int b) { return f(a) != f(b) ? f(a) < f(b) : a < b; });
    }
    const double extent = f(front.back()) - f(front.front());
    crowding_[static_cast<std::size_t>(front.front())] = std::numeric_limits<double>::infinity();
    crowding_[static_cast<std::size_t>(front.back())] = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i + 1 < front.size() && extent > 0.0; ++i) {
      crowding_[static_cast<std::size_t>(front[i])] += (f(front[i + 1]) - f(front[i - 1])) / extent;
    }
  }
  sort_few(front, [&](int a, int b) {
    const double at_a = crowding_[static_cast<std::size_t>(a)];
    const double at_b = crowding_[static_cast<std::size_t>(b)];
    return at_a != at_b ? at_a > at_b : a < b;
  });
}

std::span<const int> Ranking::order(std::span<const Cost> costs, int objectives) {
  const std::size_t n = costs.size();
  assert(n <= order_.capacity());
  for (std::vector<int>* list : {&sorted_, &order_, &front_, &previous_}) list->resize(n);
  crowding_.resize(n);
  assign_fronts(costs, objectives);
  gather_fronts();
  std::size_t begin = 0;
  for (const std::size_t end : ends_) {
    crowd(costs, std::span(order_).subspan(begin, end - begin), objectives);
    begin = end;
  }
  return order_;
}

}  // namespace jink::planner::optimizer
