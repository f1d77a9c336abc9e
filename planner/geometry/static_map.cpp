// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/static_map.hpp"

#include <Eigen/Geometry>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "planner/base/solid.hpp"
#include "planner/geometry/validity.hpp"

namespace jink::planner::geometry {

base::Box box_around(const base::Track& track) {
  base::Box box{track.position.array() - track.radius, track.position.array() + track.radius};
  if (track.body.solid == nullptr) return box;
  const Eigen::AngleAxisd back(-track.body.yaw, Vec3::UnitZ());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vec3 along = back * Vec3::Unit(axis);
    box.min[axis] = track.position[axis] - track.body.solid->extent(-along);
    box.max[axis] = track.position[axis] + track.body.solid->extent(along);
  }
  return box;
}

StaticMap::StaticMap(std::vector<base::Track> tracks) : tracks_(std::move(tracks)), order_(tracks_.size()) {
  boxes_.reserve(tracks_.size());
  for (base::Track& track : tracks_) {
    if (!is_valid(track)) throw std::invalid_argument("static map: a track that is none");
    if (!is_at_rest(track)) throw std::invalid_argument("static map: a track that moves");
    track.id = kFirstId + boxes_.size();
    boxes_.push_back(box_around(track));
  }
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!tracks_.empty()) build(0, tracks_.size());
}

// Halves by the middle of the boxes, along the axis on which these lie farthest apart.
std::size_t StaticMap::build(std::size_t first, std::size_t last) {
  const std::size_t place = nodes_.size();
  nodes_.emplace_back();
  base::Box all = boxes_[order_[first]];
  base::Box middles{all.min + all.max, all.min + all.max};
  for (std::size_t i = first; i < last; ++i) {
    const base::Box& box = boxes_[order_[i]];
    all = {all.min.cwiseMin(box.min), all.max.cwiseMax(box.max)};
    middles = {middles.min.cwiseMin(box.min + box.max), middles.max.cwiseMax(box.min + box.max)};
  }
  std::size_t right = 0;
  if (last - first > kLeaf) {
    Eigen::Index axis = 0;
    (middles.max - middles.min).maxCoeff(&axis);
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t half = first + (last - first) / 2;
    std::nth_element(at(first), at(half), at(last), [&](std::size_t a, std::size_t b) {
      const double at_a = boxes_[a].min[axis] + boxes_[a].max[axis];
      const double at_b = boxes_[b].min[axis] + boxes_[b].max[axis];
      return at_a < at_b || (at_a == at_b && a < b);
    });
    build(first, half);
    right = build(half, last);
  }
  nodes_[place] = {all, first, last, right};
  return place;
}

void StaticMap::near(base::Box where, double up, std::vector<base::Track>& found) const {
  where.min.z() -= up;
  where.max.z() -= up;
  std::vector<std::size_t> indices;
  visit(where, 0.0, [&](std::size_t index) {
    indices.push_back(index);
    return 0.0;
  });
  std::sort(indices.begin(), indices.end());
  found.reserve(found.size() + indices.size());
  for (const std::size_t index : indices) {
    found.push_back(tracks_[index]);
    found.back().position.z() += up;
  }
}

}  // namespace jink::planner::geometry
