// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/standing.hpp"

#include <algorithm>
#include <cmath>

namespace jink::planner::horizon {

void Standing::set(std::span<const base::Track> tracks, const MapPlace& map, double sigmas) {
  tracks_.assign(tracks.begin(), tracks.end());
  things_.clear();
  for (const base::Track& track : tracks_) {
    const double more = sigmas * track.position_sigma;
    things_.push_back({track.position, track.radius + more, more, {track.body, track.position, 0.0}});
  }
  map_more_ = sigmas * map.sigma;
  const bool is_another = map.map != map_.map;
  map_ = map;
  if (!is_another) return;
  mapped_.clear();
  if (map_.map == nullptr) return;
  for (const base::Track& track : map_.map->tracks()) mapped_.emplace_back(track.body, track.position, 0.0);
}

double Standing::distance(const Vec3& place, double most) const {
  double least = most;
  for (const Thing& thing : things_) {
    const double squared = (place - thing.center).squaredNorm();
    const double near = thing.radius + least;
    if (near <= 0.0 || squared >= near * near) continue;
    least = std::min(
        least, thing.solid.is_none() ? std::sqrt(squared) - thing.radius : thing.solid.distance(place) - thing.more);
  }
  if (mapped_.empty()) return least;
  const Vec3 there = place - Vec3(0.0, 0.0, map_.up);
  map_.map->visit({there, there}, least + map_more_, [&](std::size_t i) {
    if (map_.map->box(i).max.z() + map_.up > map_.floor) {
      const base::Track& track = map_.map->tracks()[i];
      const double off =
          mapped_[i].is_none() ? (there - track.position).norm() - track.radius : mapped_[i].distance(there);
      least = std::min(least, off - map_more_);
    }
    return least + map_more_;
  });
  return least;
}

bool Standing::is_clear(const Vec3& from, const Vec3& to, double kept) const {
  constexpr double kLeast = 0.02;    // m, of a step
  constexpr double kFarthest = 5.0;  // m, of one: farther obstacles need not be looked at
  const double length = (to - from).norm();
  for (double at = 0.0;;) {
    const Vec3 place = length > 0.0 ? Vec3(from + std::min(1.0, at / length) * (to - from)) : from;
    const double spare = distance(place, kept + std::min(length, kFarthest)) - kept;
    if (spare < 0.0) return false;
    if (at >= length) return true;
    at = std::min(length, at + std::max(kLeast, spare));
  }
}

}  // namespace jink::planner::horizon
