// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/grid_search.hpp"

#include <algorithm>
#include <cmath>

namespace jink::planner::horizon {
namespace {

constexpr double kWeight = 1.2;   // of the estimate of what is left: a way may be longer by that, and is found sooner
constexpr double kNarrow = 10.0;  // times its length, that a way costs more where only the least is kept

}  // namespace

void GridSearch::begin(const GridQuery& query) {
  query_ = query;
  nodes_.clear();
  index_.clear();
  open_.clear();
  last_ = -1;
  state_ = State::kSearching;
}

double GridSearch::length(const Vec3& way) const {
  return std::max(way.norm(), query_.steepness * std::abs(way.z()));
}

// Its index; nobody may be where too little is kept.
int GridSearch::node_at(const Eigen::Vector3i& place, const Standing& standing) {
  const auto [found, is_new] = index_.try_emplace(grid_key(place), static_cast<int>(nodes_.size()));
  if (!is_new) return found->second;
  Node node;
  node.place = place;
  const Vec3 where = at(place);
  node.cost = base::kInfinity;
  const bool closed = std::any_of(query_.closed.begin(), query_.closed.end(), [&](const GridQuery::Column& column) {
    return (where - column.center).head<2>().norm() < column.radius;
  });
  node.spare = !closed && query_.volume.contains(where) && place.cwiseAbs().maxCoeff() < kFarthestCell
                   ? standing.distance(where, query_.radius + query_.wanted) - query_.radius
                   : -base::kInfinity;
  node.done = node.spare < query_.least;
  nodes_.push_back(node);
  return found->second;
}

GridSearch::State GridSearch::advance(const Standing& standing, int places) {
  if (state_ != State::kSearching) return state_;
  if (nodes_.empty()) {
    const int root = node_at(Eigen::Vector3i::Zero(), standing);
    Node& node = nodes_[static_cast<std::size_t>(root)];
    if (!node.done) {
      node.cost = 0.0;
      open_.push(0.0, root);
    }
  }
  for (int n = 0; n < places && last_ < 0; ++n) {
    if (open_.empty() || nodes_.size() > kMostPlaces) return state_ = State::kNone;
    visit(open_.pop(), standing);
  }
  if (last_ >= 0) state_ = State::kFound;
  return state_;
}

void GridSearch::visit(int index, const Standing& standing) {
  const auto i = static_cast<std::size_t>(index);
  if (nodes_[i].done) return;
  nodes_[i].done = true;
  if (ends_at(nodes_[i], standing)) {
    last_ = index;
    return;
  }
  const Vec3 here = at(nodes_[i].place);
  const double range = query_.wanted - query_.least;
  for (int n = 0; n < kGridSteps; ++n) {
    const int other = node_at(nodes_[i].place + grid_step(n), standing);
    Node& next = nodes_[static_cast<std::size_t>(other)];
    if (next.done) continue;
    const Node& node = nodes_[i];
    const Vec3 there = at(next.place);
    const double lacking = (query_.wanted - 0.5 * (node.spare + next.spare)) / range;
    const double cost = node.cost + length(there - here) * (1.0 + kNarrow * lacking * lacking);
    if (cost >= next.cost) continue;
    // Nowhere between them is nearer to anything than by half of what both have more than the way between.
    const bool is_clear = node.spare + next.spare - (there - here).norm() >= 2.0 * query_.least ||
                          standing.is_clear(here, there, query_.radius + query_.least);
    if (!is_clear) continue;
    next.cost = cost;
    next.parent = index;
    open_.push(cost + kWeight * length(query_.from - there), other);
  }
}

// The vehicle may stand nearer to something than a way leads by.
bool GridSearch::ends_at(const Node& node, const Standing& standing) const {
  const Vec3 place = at(node.place);
  if ((place - query_.from).norm() > std::sqrt(3.0) * query_.cell) return false;
  const double kept = query_.radius + query_.least;
  return standing.is_clear(query_.from, place, std::min(kept, standing.distance(query_.from, kept)));
}

std::vector<Vec3> GridSearch::way() const {
  std::vector<Vec3> way{query_.from};
  for (int i = last_; i >= 0; i = nodes_[static_cast<std::size_t>(i)].parent)
    way.push_back(at(nodes_[static_cast<std::size_t>(i)].place));
  return way;
}

}  // namespace jink::planner::horizon
