// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/standing.hpp"

#include <algorithm>
#include <iterator>
#include <unordered_set>
#include <utility>

namespace jink::planner::horizon {
namespace {

base::Track at_rest(base::Track track) {
  track.velocity = track.acceleration = Vec3::Zero();
  return track;
}

}  // namespace

void set_apart(std::span<const std::uint64_t> ids, std::vector<base::Track>& tracks,
               std::vector<base::Track>& standing) {
  if (ids.empty()) return;
  const std::unordered_set<std::uint64_t> stands(ids.begin(), ids.end());
  std::erase_if(tracks, [&](const base::Track& track) {
    if (!stands.contains(track.id)) return false;
    standing.push_back(at_rest(track));
    return true;
  });
}

void Standing::set(std::span<const base::Track> tracks, const MapPlace& map, double sigmas) {
  const auto is_same = [](const base::Track& a, const base::Track& b) {
    return a.position == b.position && a.radius == b.radius && a.body.solid == b.body.solid && a.body.yaw == b.body.yaw;
  };
  const std::span<const base::Track> before = tracked_.tracks();
  if (!std::equal(tracks.begin(), tracks.end(), before.begin(), before.end(), is_same)) {
    std::vector<base::Track> still;
    std::transform(tracks.begin(), tracks.end(), std::back_inserter(still), at_rest);
    tracked_ = geometry::StaticMap(std::move(still));
    tracks_.solids = placed(tracked_);
  }
  double sigma = 0.0;
  for (const base::Track& track : tracks) sigma = std::max(sigma, track.position_sigma);
  tracks_.more = sigmas * sigma;
  if (map.map != given_) map_.solids = map.map != nullptr ? placed(*map.map) : std::vector<PlacedSolid>();
  given_ = map.map;
  map_.more = sigmas * map.sigma;
  map_.up = map.up;
  map_.floor = map.floor;
}

std::vector<PlacedSolid> Standing::placed(const geometry::StaticMap& map) {
  std::vector<PlacedSolid> solids;
  solids.reserve(map.tracks().size());
  for (const base::Track& track : map.tracks()) solids.emplace_back(track.body, track.position, 0.0);
  return solids;
}

double Standing::distance(const Vec3& place, double most) const {
  const double least = distance(tracked_, tracks_, place, most);
  return given_ != nullptr ? distance(*given_, map_, place, least) : least;
}

double Standing::distance(const geometry::StaticMap& map, const Known& known, const Vec3& place, double most) {
  double least = most;
  const Vec3 there = place - Vec3(0.0, 0.0, known.up);
  map.visit({there, there}, least + known.more, [&](std::size_t i) {
    if (map.box(i).max.z() + known.up > known.floor) {
      const base::Track& track = map.tracks()[i];
      const PlacedSolid& solid = known.solids[i];
      const double off = solid.is_none() ? (there - track.position).norm() - track.radius : solid.distance(there);
      least = std::min(least, off - known.more);
    }
    return least + known.more;
  });
  return least;
}

bool Standing::is_clear(const Vec3& from, const Vec3& to, double kept) const {
  constexpr double kShortestStep = 0.02;  // m, of a step
  constexpr double kLongestStep = 5.0;    // m, of one: farther obstacles need not be looked at
  const double length = (to - from).norm();
  for (double at = 0.0;;) {
    const Vec3 place = length > 0.0 ? Vec3(from + std::min(1.0, at / length) * (to - from)) : from;
    const double spare = distance(place, kept + std::min(length, kLongestStep)) - kept;
    if (spare < 0.0) return false;
    if (at >= length) return true;
    at = std::min(length, at + std::max(kShortestStep, spare));
  }
}

}  // namespace jink::planner::horizon
